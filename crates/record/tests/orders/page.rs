//! What docs/orders.md shows and names.

#![allow(clippy::unwrap_used)]

use gaiter_record::order::{State, Way, csv, mapped, mapped_name};
use gaiter_sizes::mapping::{self, parse};

use super::{ID, order};

const PAGE: &str = include_str!("../../../../docs/orders.md");

/// The mapping that the page shows.
fn mapping_of_page() -> &'static str {
    let first = format!("format = \"{}\"", mapping::FORMAT);
    let mut blocks = PAGE.split("```toml\n");
    blocks.find(|block| block.starts_with(&first)).unwrap().split("```").next().unwrap()
}

#[test]
fn the_mapping_that_the_page_shows_makes_a_row_per_leg() {
    let mapping = parse(mapping_of_page().as_bytes()).unwrap();
    assert_eq!(mapped_name(&order(), &mapping), "order-muster-A-1042.csv");
    let file = mapped(&order(), &mapping, Some(ID));
    let lines: Vec<&[u8]> = file.split(|byte| *byte == b'\n').collect();
    assert!(lines[0].starts_with(b"Auftrag;Messdatum;Bein;Artikel;Umfang B;H\xf6he D"));
    // The girth of 212.5 mm is between 21 and 21.5 cm, and the scan was taken after midnight there.
    assert_eq!(lines[1], b"A-1042;20.11.2026;re;Muster Flach KKL 2;21,5;43,0\r");
    assert_eq!(lines[2], b"A-1042;20.11.2026;li;Muster Flach KKL 2;21,5;fehlt\r");
    assert_eq!(lines.len(), 4);
}

#[test]
fn the_page_names_every_key_value_column_and_word() {
    let named = |word: &str| {
        assert!(PAGE.contains(&format!("`{word}`")), "docs/orders.md does not name {word}");
    };
    for line in mapping_of_page().lines().filter_map(|line| line.split_once(" = ")) {
        named_loosely(line.0);
    }
    csv(&order()).lines().next().unwrap().split(';').for_each(named);
    let states = [
        State::ByHand,
        State::Estimated,
        State::Doubtful,
        State::NotMeasured,
        State::NotMeasurable,
        State::NotByScan,
    ];
    states.map(State::word).into_iter().for_each(named);
    [Way::Scan, Way::Tape, Way::ByHand].map(Way::word).into_iter().for_each(named);
}

/// A key of the page's mapping, in its tables.
fn named_loosely(key: &str) {
    let is_named = [format!("`{key}`"), format!("`[{key}]`")].iter().any(|of| PAGE.contains(of));
    assert!(is_named, "docs/orders.md does not explain {key}");
}
