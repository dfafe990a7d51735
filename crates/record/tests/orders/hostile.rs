//! Whatever stands in a mapping or in the file of a last order, it is answered.

#![allow(clippy::unwrap_used)]

use gaiter_record::json;
use gaiter_record::order::{BYTES_MAX, LastFault, Order, csv, mapped, mapped_name, read};
use gaiter_sizes::mapping::parse;
use proptest::prelude::*;
use serde_json::{Value, json};

use super::{ID, RECORD, garment, order};
use crate::placed::placed;

const MAPPINGS: [&str; 5] = [
    include_str!("../../../../config/orders/example-points.toml"),
    include_str!("../../../../config/orders/example-wide.toml"),
    include_str!("../../../../config/orders/german-spreadsheet.toml"),
    include_str!("../../../../fixtures/cases/orders/levels_as_json.toml"),
    include_str!("../../../../fixtures/cases/orders/again_all_values.toml"),
];

/// Reads a text as a mapping, and uses what comes of it.
fn used(text: &str) -> Result<(), TestCaseError> {
    match parse(text.as_bytes()) {
        Err(faults) => placed(text, &faults),
        Ok(mapping) => {
            let order = order();
            let name = mapped_name(&order, &mapping);
            prop_assert!(
                name.is_ascii() && name.starts_with("order") && !name.contains('/'),
                "{name}"
            );
            prop_assert!(!["order.csv", "order.json"].contains(&name.as_str()));
            prop_assert!(mapped(&order, &mapping, Some(ID)).len() < 10_000_000);
            Ok(())
        }
    }
}

/// The last order, changed at a path.
fn changed(path: &str, value: Value) -> Result<Order, LastFault> {
    let mut file: Value = serde_json::from_slice(&json(&order()).unwrap()).unwrap();
    *file.pointer_mut(path).unwrap() = value;
    read(&serde_json::to_vec(&file).unwrap())
}

#[test]
fn a_last_order_with_a_figure_of_no_leg_is_refused_with_its_place() {
    for mm in [-1.0, 3000.1, 1e300] {
        let fault = changed("/rows/1/girth/mm", json!(mm)).unwrap_err();
        assert!(matches!(&fault, LastFault::Range { place, .. } if place == "right cC"), "{fault}");
    }
    for (path, value) in [
        ("/rows/1/girth/mm", Value::Null),
        ("/rows/0/girth/is", json!("not-measured")),
        ("/rows/0/girth/is", json!("doubtful")),
    ] {
        let fault = changed(path, value).unwrap_err();
        assert!(matches!(fault, LastFault::Mismatch { .. }), "{path}: {fault}");
    }
}

#[test]
fn what_is_no_order_is_told_so() {
    let fault = |bytes: &[u8]| read(bytes).unwrap_err();
    assert!(matches!(fault(b"{"), LastFault::NotJson(_)));
    assert!(matches!(fault(b"{}"), LastFault::Format { .. }));
    assert!(matches!(fault(br#"{"schema": "gaiter.leg-record/1"}"#), LastFault::Format { .. }));
    assert!(matches!(fault(br#"{"schema": "gaiter.order/1"}"#), LastFault::Shape(_)));
    assert!(matches!(fault(&vec![b' '; BYTES_MAX + 1]), LastFault::TooLong { .. }));
    // The row of the scan's girth, before the one that counts.
    let fault = changed("/rows/1/counts", json!(true)).unwrap_err();
    assert_eq!(fault, LastFault::Twice { side: "right", point: "C".to_owned() });
    for (path, place) in [("/order_ref", "order_ref"), ("/garment/name", "garment.name")] {
        let fault = changed(path, json!("a\u{1b}[2J\nb")).unwrap_err();
        assert_eq!(fault, LastFault::Text { place });
        let fault = changed(path, json!("x".repeat(501))).unwrap_err();
        assert_eq!(fault, LastFault::Text { place });
    }
}

#[test]
fn deep_or_long_json_is_refused_without_a_crash() {
    let deep = "[".repeat(100_000);
    assert!(matches!(read(deep.as_bytes()), Err(LastFault::NotJson(_))));
    let schema = format!("{{\"schema\": \"{}\"}}", "x".repeat(1000));
    let told = read(schema.as_bytes()).unwrap_err().to_string();
    assert!(told.len() < 200, "{told}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn a_mangled_mapping_is_used_or_has_faults_with_a_place(
        which in 0..MAPPINGS.len(), from in 0..3000_usize, length in 0..60_usize,
        typed in "[\\[\\]{}\"'=.,#\\\\ü\u{feff}\u{1b}\u{202e}\n\r a-cB0-9e-]{0,16}",
    ) {
        let whole = MAPPINGS[which];
        let from = whole.floor_char_boundary(from);
        let to = whole.floor_char_boundary(from + length);
        used(&[&whole[..from], &typed, &whole[to..]].concat())?;
    }

    #[test]
    fn a_line_of_another_place_is_used_or_has_faults_with_a_place(
        which in 0..MAPPINGS.len(), line in 0..120_usize, to in 0..120_usize,
    ) {
        let mut lines: Vec<&str> = MAPPINGS[which].lines().collect();
        let moved = lines.remove(line % lines.len());
        lines.insert(to % (lines.len() + 1), moved);
        used(&lines.join("\n"))?;
    }

    #[test]
    fn a_mangled_last_order_is_refused_or_can_be_ordered_again(
        from in 0..20_000_usize, length in 0..40_usize, typed in "[\\[\\]{}\":,a-z0-9.e-]{0,12}",
    ) {
        let whole = String::from_utf8(json(&order()).unwrap()).unwrap();
        let from = whole.floor_char_boundary(from % whole.len());
        let to = whole.floor_char_boundary((from + length).min(whole.len()));
        if let Ok(last) = read([&whole[..from], &typed, &whole[to..]].concat().as_bytes()) {
            let again = Order::with_changes(&last, &RECORD, &garment(), None, 1.0);
            let exact = Order::exact(&last, &RECORD, &garment(), None);
            for order in again.into_iter().chain(exact) {
                csv(&order);
                json(&order).unwrap();
            }
        }
    }
}
