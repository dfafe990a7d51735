//! The rules of the house, read from the source: who may use whom in the program, and how long a file may
//! be. What a crate may use is in its manifest; `crates/clippy.toml` keeps effects out of the pure ones.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

/// The layers of the program, and which others each may use. `cli` uses all.
const LAYERS: [(&str, &[&str]); 3] =
    [("store", &[]), ("config", &["store"]), ("station", &["store", "config"])];

/// Longest file, lines.
const LINES_MAX: usize = 600;

/// Most files of one folder.
const FILES_MAX: usize = 25;

/// Most folders within each other, below `src` or `tests`.
const DEPTH_MAX: usize = 3;

pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The folders of the packages: the program's, and each crate's.
pub fn packages() -> Vec<PathBuf> {
    let crates = fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path());
    let packages = crates.filter(|path| path.is_dir()).chain([root()]).collect::<Vec<_>>();
    assert!(packages.len() > 5, "only {packages:?}");
    packages
}

/// The Rust files of a layer: `src/<layer>.rs` and everything below `src/<layer>/`.
fn files(layer: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let file = root().join(format!("src/{layer}.rs"));
    found.extend(file.exists().then_some(file));
    collect(&root().join("src").join(layer), &mut found);
    assert!(!found.is_empty(), "no file of layer {layer}: the rule looks at nothing");
    found
}

pub fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for path in entries.map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            collect(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

/// Code lines with their places: comments, and the tests at the foot of a file, may name anything.
fn code(path: PathBuf) -> Vec<(PathBuf, usize, String)> {
    if path.file_stem().is_some_and(|stem| stem == "tests") {
        return Vec::new();
    }
    let text = fs::read_to_string(&path).unwrap();
    let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
    let lines = code.lines().enumerate().map(|(index, line)| (index + 1, line));
    let lines = lines.map(|(number, line)| (number, line.split("//").next().unwrap().to_owned()));
    let lines = lines.filter(|(_, line)| !line.trim().is_empty());
    lines.map(|(number, line)| (path.clone(), number, line)).collect()
}

/// Words that follow `prefix` in a line, up to the next character that belongs to no name.
fn named<'a>(line: &'a str, prefix: &'a str) -> impl Iterator<Item = &'a str> {
    let name = |rest: &'a str| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next();
    line.match_indices(prefix).filter_map(move |(at, _)| name(&line[at + prefix.len()..]))
}

#[test]
fn a_layer_uses_only_layers_above_it() {
    let mut faults = Vec::new();
    for (layer, others) in LAYERS {
        for (path, number, line) in files(layer).into_iter().flat_map(code) {
            let used = named(&line, "crate::").filter(|used| *used != layer);
            for used in used.filter(|used| !others.contains(used)) {
                let place = format!("{}:{number}", path.display());
                faults.push(format!("{place}: `{layer}` may not use `crate::{used}`"));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_station_reads_what_is_in_a_scan_only_in_the_confined_process() {
    let readers = ["read", "reading", "completeness", "extract", "extract_crop", "check"];
    let reads = |line: &String| {
        // `record::` ends like `ord::`.
        let called = line.replace("record::", "");
        let modules = ["scan::", "leg::", "ord::", "phantom::"].into_iter();
        let mut called = modules.flat_map(|module| named(&called, module));
        let is_imported = line.starts_with("use gaiter_scan") || line.starts_with("use gaiter_leg");
        let mut words = line.split(|c: char| !c.is_alphanumeric() && c != '_');
        called.any(|name| readers.contains(&name))
            || is_imported && words.any(|word| readers.contains(&word))
    };
    let lines = files("station").into_iter().flat_map(code);
    let mut found: Vec<PathBuf> =
        lines.filter(|(_, _, line)| reads(line)).map(|(path, ..)| path).collect();
    found.dedup();
    assert_eq!(found, [root().join("src/station/measure/child.rs")]);
}

#[test]
fn every_file_says_what_it_is_and_none_is_too_long() {
    let mut found = Vec::new();
    for package in packages() {
        ["src", "tests", "benches", "examples"]
            .iter()
            .for_each(|top| collect(&package.join(top), &mut found));
    }
    assert!(found.len() > 500, "only {} files were looked at", found.len());
    for path in found {
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("//!"), "{} does not open with `//!`", path.display());
        let lines = text.lines().count();
        assert!(lines <= LINES_MAX, "{} has {lines} lines", path.display());
    }
}

#[test]
fn no_folder_is_too_full_or_too_deep() {
    let mut seen = 0;
    for package in packages() {
        let tops = ["src", "tests", "benches", "examples"].map(|top| package.join(top));
        tops.iter().filter(|top| top.exists()).for_each(|top| folders_hold(top, 0, &mut seen));
    }
    assert!(seen > 40, "only {seen} folders were looked at");
}

fn folders_hold(folder: &Path, depth: usize, seen: &mut usize) {
    *seen += 1;
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_code = |path: &PathBuf| !path.ends_with("node_modules");
    let (folders, files): (Vec<_>, Vec<_>) =
        entries.filter(is_code).partition(|path| path.is_dir());
    // x.rs and its folder x are one subject.
    let alone = files.iter().filter(|file| !folders.contains(&file.with_extension(""))).count();
    assert!(alone <= FILES_MAX, "{} has {alone} files", folder.display());
    for folder in folders {
        assert!(depth < DEPTH_MAX, "{} lies too deep", folder.display());
        folders_hold(&folder, depth + 1, seen);
    }
}
