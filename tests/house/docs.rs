//! The documents: the README is short, every page stands in the book, every link leads somewhere, and the
//! page of the configuration is the shipped file.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::rules::root;

/// Longest README, lines: what a newcomer reads in five minutes.
const README_LINES_MAX: usize = 200;

/// Pages at the root of the repository, where people look for them.
const AT_ROOT: [&str; 5] =
    ["README.md", "ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md"];

/// The pages of the book, from `docs/`.
fn pages() -> BTreeSet<PathBuf> {
    let entries = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    entries.filter(|path| path.extension().is_some_and(|ending| ending == "md")).collect()
}

/// The targets of a page's links, without those of other sites.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter(|target| !target.contains("://") && !target.starts_with("mailto:"))
}

/// The anchor of a heading, as mdBook and code hosts make it.
fn anchor(heading: &str) -> String {
    let words = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = words.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn has_anchor(page: &Path, wanted: &str) -> bool {
    let text = fs::read_to_string(page).unwrap();
    text.lines().any(|line| line.starts_with('#') && anchor(line) == wanted)
}

#[test]
fn the_readme_is_read_in_five_minutes() {
    let lines = fs::read_to_string(root().join("README.md")).unwrap().lines().count();
    assert!(lines <= README_LINES_MAX, "{lines} lines");
}

#[test]
fn every_page_stands_once_in_the_book() {
    let summary = fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap();
    let mut named: Vec<PathBuf> =
        links(&summary).map(|link| root().join("docs").join(link)).collect();
    let count = named.len();
    named.sort();
    named.dedup();
    assert_eq!(named.len(), count, "a page is named twice");
    let mut pages = pages();
    pages.remove(&root().join("docs/SUMMARY.md"));
    assert_eq!(named.into_iter().collect::<BTreeSet<_>>(), pages);
}

#[test]
fn every_link_leads_somewhere() {
    let at_root = AT_ROOT.map(|name| root().join(name));
    let mut count = 0;
    for page in pages().into_iter().chain(at_root) {
        let text = fs::read_to_string(&page).unwrap();
        for link in links(&text) {
            let (file, place) = link.split_once('#').unwrap_or((link, ""));
            let target =
                if file.is_empty() { page.clone() } else { page.parent().unwrap().join(file) };
            assert!(target.exists(), "{}: {link} leads nowhere", page.display());
            assert!(
                place.is_empty() || has_anchor(&target, place),
                "{}: {link} has no such heading",
                page.display()
            );
            count += 1;
        }
    }
    assert!(count > 30, "only {count} links were found");
}

/// The page of the configuration: for each key of the shipped file its comment, and the line that sets
/// it.
fn configuration_page(file: &str) -> String {
    let mut page = String::from(
        "# Configuration\n\nEvery key of `station.toml`. This page is made from the shipped file: \
         `GAITER_RENEW=1 cargo test --test house docs::`.\n",
    );
    let mut said = Vec::new();
    for line in file.lines() {
        let comment = line.strip_prefix('#').map(|words| words.strip_prefix(' ').unwrap_or(words));
        let setting = comment.unwrap_or(line);
        let key = setting.split_once(" = ").map_or("", |(key, _)| key);
        let is_key = !key.is_empty()
            && key.chars().all(|c| c.is_ascii_lowercase() || "_0123456789".contains(c));
        if line.starts_with('[') {
            page += &format!("\n## `{line}`\n");
        } else if is_key {
            let words = paragraphs(&said);
            page += &format!("\n### `{key}`\n\n{words}\n\n```toml\n{line}\n```\n");
            said.clear();
        } else if let Some(words) = comment {
            said.push(words.to_owned());
        } else if !said.is_empty() {
            page += &format!("\n{}\n", paragraphs(&said));
            said.clear();
        }
    }
    page
}

/// Comment lines as paragraphs: what is indented stays as it is.
fn paragraphs(lines: &[String]) -> String {
    let mut text = String::new();
    for line in lines {
        let is_code = line.starts_with("    ");
        let is_default = line.starts_with("Default:") || line.starts_with("Must be set");
        match (text.is_empty(), is_code || is_default) {
            (true, _) => {}
            (false, true) => text += "\n\n",
            (false, false) => text += "\n",
        }
        text += &line.replace('<', "&lt;");
        if is_code {
            text += "\n";
        }
    }
    text
}

#[test]
fn the_page_of_the_configuration_is_the_shipped_file() {
    let made = configuration_page(&fs::read_to_string(root().join("config/station.toml")).unwrap());
    let path = root().join("docs/configuration.md");
    if std::env::var_os("GAITER_RENEW").is_some() {
        fs::write(&path, &made).unwrap();
    }
    assert_eq!(fs::read_to_string(&path).unwrap_or_default(), made, "renew it with GAITER_RENEW=1");
    for key in ["id", "export_dirs", "mode", "language"] {
        assert!(made.contains(&format!("\n### `{key}`\n")), "{key}");
    }
}
