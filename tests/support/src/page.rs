//! A reader of the pages that gaiter writes, strict where browsers are lenient.

#![allow(clippy::unwrap_used, clippy::panic)]

/// Elements without an end.
const VOID: [&str; 5] = ["meta", "col", "br", "input", "!doctype"];

/// Fails where an element is not closed in its order, an attribute is not in double quotes, or an id
/// stands twice. Content of scripts and styles is passed over.
pub fn check_markup(page: &str) {
    let mut open: Vec<String> = Vec::new();
    let mut ids: Vec<String> = Vec::new();
    let mut rest = page;
    while let Some(at) = rest.find('<') {
        assert!(!rest[..at].contains('>'), "a bare > in {:?}", &rest[..at.min(80)]);
        let inside = &rest[at + 1..];
        let end = inside.find('>').unwrap_or_else(|| panic!("no > behind {:?}", near(inside)));
        let tag = &inside[..end];
        rest = &inside[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "before {:?}", near(rest));
            continue;
        }
        let name = tag.split([' ', '\n', '/']).next().unwrap();
        ids.extend(
            attributes(&tag[name.len()..]).into_iter().filter(|(n, _)| n == "id").map(|p| p.1),
        );
        if tag.ends_with('/') || VOID.contains(&name) {
            continue;
        }
        open.push(name.to_owned());
        if name == "script" || name == "style" {
            rest = &rest[rest.find(&format!("</{name}>")).unwrap()..];
        }
    }
    assert!(open.is_empty(), "not closed: {open:?}");
    let all = ids.len();
    ids.sort();
    ids.dedup();
    assert_eq!(ids.len(), all, "an id stands twice");
}

fn near(text: &str) -> String {
    text.chars().take(80).collect()
}

/// Names and values of a tag's attributes.
fn attributes(tag: &str) -> Vec<(String, String)> {
    let mut rest = tag.trim().trim_end_matches('/').trim();
    let mut found = Vec::new();
    while !rest.is_empty() && rest != "html" {
        let (name, behind) = rest.split_once("=\"").unwrap_or_else(|| panic!("{rest:?}"));
        assert!(name.chars().all(|c| c.is_ascii_alphanumeric() || "-:".contains(c)), "{name:?}");
        let (value, behind) = behind.split_once('"').unwrap();
        found.push((name.to_owned(), value.to_owned()));
        rest = behind.trim_start();
    }
    found
}

/// The words of a page without its scripts, styles and tags, a blank between them.
pub fn words(page: &str) -> String {
    let mut text = String::new();
    let mut rest = page;
    while let Some(at) = rest.find('<') {
        text += &rest[..at];
        text.push(' ');
        let inside = &rest[at..];
        let end = ["script", "style"]
            .into_iter()
            .filter(|name| inside.starts_with(&format!("<{name}")))
            .find_map(|name| inside.find(&format!("</{name}>")));
        let inside = &inside[end.unwrap_or(0)..];
        rest = &inside[inside.find('>').unwrap() + 1..];
    }
    let text = text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"");
    let text = text.replace("&nbsp;", " ").replace("&amp;", "&");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
