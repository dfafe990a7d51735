//! Every mapping of `fixtures/cases/orders`, and those of `config/orders`, with the file that it makes of an order
//! or the faults that are told of it.
//!
//! `GAITER_RENEW=1 cargo test --test orders cases::` writes the expected files anew; read the difference
//! before you keep it.

#![allow(clippy::unwrap_used)]

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use gaiter_record::order::{Order, OrderRef, mapped, mapped_name};
use gaiter_sizes::mapping::parse;
use support::cases;

use super::{ID, RECORD, SCANNED, garment, order};

/// The expected file: beside a case, and for the shipped examples among the cases.
fn expected(case: &Path) -> PathBuf {
    let folder = support::root().join("fixtures/cases/orders");
    folder.join(case.file_name().unwrap()).with_extension("expected")
}

/// The order of a case: those that begin with `again_` repeat one of what the scanner measured.
fn ordered(name: &str) -> Order {
    if !name.starts_with("again_") {
        return order();
    }
    let order_ref = |text: &str| OrderRef::new(text, &RECORD).unwrap();
    let last = Order::from_record(&SCANNED, &garment(), Some(&order_ref("A-0077")), 1.0);
    Order::with_changes(&last, &RECORD, &garment(), Some(&order_ref("A-1042")), 1.0).unwrap()
}

/// Bytes as text: what is not printable ASCII is told by its number, a line end stays one.
fn readable(bytes: &[u8]) -> String {
    let mut text = String::new();
    for byte in bytes {
        match byte {
            b'\n' => text.push('\n'),
            b'\t' => text.push_str("<tab>"),
            b'\r' => text.push_str("<cr>"),
            b' '..=b'~' => text.push(char::from(*byte)),
            _ => write!(text, "<{byte:02x}>").unwrap(),
        }
    }
    text
}

fn said(case: &Path) -> String {
    let name = case.file_name().unwrap().to_str().unwrap();
    match parse(&fs::read(case).unwrap()) {
        Ok(mapping) => {
            let order = ordered(name);
            let bytes = mapped(&order, &mapping, Some(ID));
            format!("{}\n{}", mapped_name(&order, &mapping), readable(&bytes))
        }
        Err(faults) => faults.iter().map(|fault| format!("{fault}\n")).collect(),
    }
}

#[test]
fn every_mapping_makes_the_expected_file_or_is_told_its_faults() {
    let cases = cases::with_ending(&["fixtures/cases/orders", "config/orders"], "toml", 16);
    cases::are_as_expected(cases.iter().map(|case| (expected(case), said(case))));
}
