//! Whatever stands in a file of a size table or garment, it is answered, and every fault has a place.

#![allow(clippy::unwrap_used)]

use gaiter_sizes::check::remarks;
use gaiter_sizes::verdict::leg_verdict;
use gaiter_sizes::{Garment, parse};
use jiff::civil::date;
use proptest::prelude::*;

use crate::placed::placed;
use crate::rules::given;

const TABLES: [&str; 2] = [
    include_str!("../../../../config/sizes/invented-example.toml"),
    include_str!("../../../../fixtures/cases/sizes/unattributed_8_sizes.toml"),
];

/// Reads a text, and uses what comes of it.
fn used(text: &str) -> Result<(), TestCaseError> {
    match parse(text.as_bytes()) {
        Err(faults) => placed(text, &faults),
        Ok(table) => {
            remarks(&table, date(2026, 11, 25), &["AD"]);
            for garment in Garment::shipped() {
                let _ = leg_verdict(&table, garment, |_| given(300.0, Some(1.0)));
            }
            Ok(())
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn a_mangled_table_is_read_or_has_faults_with_a_place(
        which in 0..2_usize, from in 0..3000_usize, length in 0..60_usize,
        typed in "[\\[\\]{}\"'=.,#\\\\ü\u{feff}\u{1b}\u{202e}\n\r a-cB0-9e-]{0,16}",
    ) {
        let whole = TABLES[which];
        let from = whole.floor_char_boundary(from);
        let to = whole.floor_char_boundary(from + length);
        used(&[&whole[..from], &typed, &whole[to..]].concat())?;
    }

    #[test]
    fn a_line_of_another_place_is_read_or_has_faults_with_a_place(
        which in 0..2_usize, line in 0..80_usize, to in 0..80_usize,
    ) {
        let mut lines: Vec<&str> = TABLES[which].lines().collect();
        let (line, to) = (line % lines.len(), to % lines.len());
        let moved = lines.remove(line);
        lines.insert(to.min(lines.len()), moved);
        used(&lines.join("\n"))?;
    }

    #[test]
    fn bytes_are_answered(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(parse(&bytes).is_err());
        prop_assert!(Garment::read(&bytes).is_err());
    }

    #[test]
    fn a_mangled_garment_is_read_or_has_faults_with_a_place(
        from in 0..900_usize, length in 0..60_usize,
        typed in "[\\[\\]{}\"'=.,#\\\\ü\u{1b}\n a-cB0-9-]{0,16}",
    ) {
        let whole = include_str!("../../garments/AT.toml");
        let from = whole.floor_char_boundary(from);
        let to = whole.floor_char_boundary(from + length);
        let text = [&whole[..from], &typed, &whole[to..]].concat();
        if let Err(faults) = Garment::read(text.as_bytes()) {
            placed(&text, &faults)?;
        }
    }
}

#[test]
fn a_file_that_is_too_long_or_not_utf_8_is_refused_unread() {
    let long = vec![b'#'; 300_000];
    assert!(parse(&long).unwrap_err()[0].to_string().contains("300000 bytes"));
    assert!(parse(b"\n\xff").unwrap_err()[0].to_string().starts_with("2:1: this is not UTF-8"));
    assert!(parse(b"").is_err());
}

#[test]
fn deep_nesting_is_a_fault_and_no_crash() {
    for (open, close) in [("[", "]"), ("{a=", "}")] {
        let text = format!("a = {}1{}", open.repeat(50_000), close.repeat(50_000));
        assert!(parse(text.as_bytes()).is_err());
    }
}
