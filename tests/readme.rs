//! The README tells what every code means that an operator can meet.

#![allow(clippy::unwrap_used)]

use std::fs;

/// Files whose `code` functions give codes to records, `reason.json` or standard error.
const SOURCES: [&str; 9] = [
    "src/scan/fault.rs",
    "src/leg/mod.rs",
    "src/leg/body_fault.rs",
    "src/leg/segment.rs",
    "src/leg/finding.rs",
    "src/leg/doubt.rs",
    "src/leg/opinion.rs",
    "src/store/mod.rs",
    "src/cad/kind.rs",
];

/// Codes that a source hands out: what stands in quotes behind an arrow.
fn codes(source: &str) -> Vec<String> {
    let text = fs::read_to_string(format!("{}/{source}", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let quoted = text.split("=> \"").skip(1).filter_map(|rest| rest.split('"').next());
    let is_code = |word: &&str| word.chars().all(|c| c.is_ascii_lowercase() || c == '-');
    quoted.filter(is_code).map(str::to_owned).collect()
}

#[test]
fn every_code_stands_in_the_readme() {
    let readme = include_str!("../README.md");
    let all: Vec<String> = SOURCES.iter().flat_map(|source| codes(source)).collect();
    assert!(all.len() > 20, "only {} codes were found: {all:?}", all.len());
    let not_codes = ["info", "warning", "error", "folder"];
    for code in all.iter().filter(|code| !not_codes.contains(&code.as_str())) {
        assert!(readme.contains(&format!("`{code}`")), "the README does not explain `{code}`");
    }
}
