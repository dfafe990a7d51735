//! The files that docs/sizes.md shows, and what it says about them.

#![allow(clippy::unwrap_used)]

use gaiter_sizes::check::{Remark, remarks};
use gaiter_sizes::{Garment, garment, parse, table};
use jiff::civil::date;

const PAGE: &str = include_str!("../../../../docs/sizes.md");

/// The block of the page that is a file of this format.
fn block_of_page(format: &str) -> &'static str {
    let first = format!("format = \"{format}\"");
    PAGE.split("```toml\n")
        .find(|block| block.starts_with(&first))
        .unwrap()
        .split("```")
        .next()
        .unwrap()
}

#[test]
fn the_table_and_the_garment_that_the_page_shows_are_read_without_a_fault() {
    let table = parse(block_of_page(table::FORMAT).as_bytes()).unwrap();
    assert_eq!((table.sizes.len(), table.lengths.len()), (2, 2));
    let garment = Garment::read(block_of_page(garment::FORMAT).as_bytes()).unwrap();
    assert_eq!(garment.boxes()[2].name, "U B");
}

#[test]
fn the_faults_that_the_page_shows_are_those_of_the_two_slips() {
    let slips = block_of_page(table::FORMAT)
        .replace("cB = [18, 20.5]", "cB = [18, 20,5]")
        .replace("cC = [30, 36]", "cC = [36, 30]");
    let faults = parse(slips.as_bytes()).unwrap_err();
    let page = PAGE.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(faults.len(), 2);
    for fault in &faults {
        assert!(page.contains(&fault.to_string()), "{fault}");
    }
}

#[test]
fn the_page_explains_every_key_and_every_remark_of_the_shipped_example() {
    let keys = [table::FORMAT, garment::FORMAT].map(block_of_page).concat();
    for line in keys.lines().filter_map(|line| line.split_once(" = ")) {
        let key = line.0.split('.').next().unwrap();
        assert!(PAGE.contains(&format!("`{key}")) || PAGE.contains(&format!("`[{key}")), "{key}");
    }
    let example = parse(include_bytes!("../../../../config/sizes/invented-example.toml")).unwrap();
    let said = remarks(&example, date(2026, 11, 25), &["AD", "AF", "AG", "AT"]);
    assert_eq!(said.len(), 4, "the page says four: {said:?}");
    for code in said.iter().map(Remark::code) {
        assert!(PAGE.contains(&format!("`{code}`")), "{code}");
    }
}
