//! The documents tell what every code means that an operator can meet.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Files whose `code` functions give codes to records, `reason.json`, standard error or `check`.
const SOURCES: [&str; 14] = [
    "crates/scan/src/fault.rs",
    "crates/leg/src/lib.rs",
    "crates/leg/src/frame/body_fault.rs",
    "crates/leg/src/parting/segment.rs",
    "crates/leg/src/finding.rs",
    "crates/leg/src/doubt.rs",
    "crates/leg/src/comparison/difference.rs",
    "crates/leg/src/comparison/opinion.rs",
    "src/store/fault.rs",
    "crates/cad/src/kind.rs",
    "crates/record/src/gdt/order.rs",
    "crates/record/src/report/pdf.rs",
    "src/cli/reextract/again.rs",
    "crates/flow/src/patient/name_check.rs",
];

/// Codes that a source hands out: what stands in quotes behind an arrow.
fn codes(source: &str) -> Vec<String> {
    let text = fs::read_to_string(format!("{}/{source}", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let quoted = text.split("=> \"").skip(1).filter_map(|rest| rest.split('"').next());
    let is_code = |word: &&str| word.chars().all(|c| c.is_ascii_lowercase() || c == '-');
    quoted.filter(is_code).map(str::to_owned).collect()
}

/// The pages with tables of codes.
fn pages() -> String {
    [
        include_str!("../../docs/codes.md"),
        include_str!("../../docs/operate.md"),
        include_str!("../../docs/patients.md"),
        include_str!("../../docs/cli.md"),
        include_str!("../../docs/record.md"),
    ]
    .concat()
}

#[test]
fn every_code_stands_in_the_documents() {
    let pages = pages();
    let all: Vec<String> = SOURCES.iter().flat_map(|source| codes(source)).collect();
    assert!(all.len() > 20, "only {} codes were found: {all:?}", all.len());
    let not_codes = ["info", "warning", "error", "folder"];
    for code in all.iter().filter(|code| !not_codes.contains(&code.as_str())) {
        assert!(pages.contains(&format!("`{code}`")), "no page explains `{code}`");
    }
}

/// The codes of all log events in the source, where they are made.
fn events(folder: &Path, found: &mut BTreeSet<String>) {
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            events(&path, found);
            continue;
        }
        if path.extension().is_none_or(|ending| ending != "rs") {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        // `info!(event = "code", …)`, and a `let (event, …) = ("code", …)` for a long line,
        // or a `let event` that chooses between two.
        let plain = text.split("event = \"").skip(1);
        let bound = text.split("(event, ").skip(1).filter_map(|rest| rest.split_once(") = (\""));
        let chosen = text.split("let event = ").skip(1).filter_map(|rest| rest.split(';').next());
        let chosen = chosen.flat_map(|choice| choice.split('"').skip(1).step_by(2));
        found.extend(chosen.map(str::to_owned));
        let codes =
            plain.chain(bound.map(|(_, rest)| rest)).filter_map(|rest| rest.split('"').next());
        found.extend(codes.map(str::to_owned));
    }
}

#[test]
fn every_log_event_stands_in_its_table_and_no_other() {
    let mut made = BTreeSet::new();
    events(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut made);
    assert!(made.len() > 15, "only {} events were found: {made:?}", made.len());
    let section = include_str!("../../docs/codes.md")
        .split("\n## Log events\n")
        .nth(1)
        .unwrap()
        .split("\n## ")
        .next()
        .unwrap();
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    let named = rows.flat_map(|row| row.split('|').nth(1).unwrap().split('`').skip(1).step_by(2));
    let told: BTreeSet<String> = named.map(str::to_owned).collect();
    let missing: Vec<_> = made.difference(&told).collect();
    assert!(missing.is_empty(), "docs/codes.md does not explain {missing:?}");
    let gone: Vec<_> = told.difference(&made).collect();
    assert!(gone.is_empty(), "docs/codes.md explains {gone:?}, which nothing logs");
}
