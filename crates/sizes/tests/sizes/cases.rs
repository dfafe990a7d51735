//! Every file of `fixtures/cases/sizes` and, beside it, exactly what gaiter says about it.
//!
//! `GAITER_RENEW=1 cargo test --test sizes cases::` writes the expected files anew; read the difference before
//! you keep it.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;

use gaiter_sizes::check::{Remark, remarks};
use gaiter_sizes::garment::FormBox;
use gaiter_sizes::{Garment, parse};
use jiff::civil::date;
use support::cases;

/// The faults of a table or garment, or the remarks on it on a day of 2026.
fn said(case: &Path) -> String {
    let bytes = fs::read(case).unwrap();
    if case.file_name().unwrap().to_str().unwrap().starts_with("garment_") {
        return match Garment::read(&bytes) {
            Ok(garment) => {
                let of = |of: &FormBox| {
                    let optional = if of.is_optional { ", optional" } else { "" };
                    format!("{} = {}{optional}\n", of.name, of.point)
                };
                garment.boxes().iter().map(of).collect()
            }
            Err(faults) => faults.iter().map(|fault| format!("{fault}\n")).collect(),
        };
    }
    match parse(&bytes) {
        Ok(table) => {
            let remarks = remarks(&table, date(2026, 11, 25), &["AD", "AF", "AG", "AT"]);
            remarks.iter().map(|remark: &Remark| format!("{remark:?}\n")).collect()
        }
        Err(faults) => faults.iter().map(|fault| format!("{fault}\n")).collect(),
    }
}

#[test]
fn every_case_is_told_exactly_as_expected() {
    let cases = cases::with_ending(&["fixtures/cases/sizes"], "toml", 11);
    cases::are_as_expected(cases.iter().map(|case| (case.with_extension("expected"), said(case))));
}
