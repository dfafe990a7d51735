//! Every file of `fixtures/cases/sizes` and, beside it, exactly what gaiter says about it.
//!
//! `GAITER_RENEW=1 cargo test --test sizes cases::` writes the expected files anew; read the difference before
//! you keep it.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

use gaiter_sizes::check::{Remark, remarks};
use gaiter_sizes::garment::FormBox;
use gaiter_sizes::{Garment, parse};
use jiff::civil::date;

fn cases() -> Vec<PathBuf> {
    let folder = support::root().join("fixtures/cases/sizes");
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut cases: Vec<PathBuf> =
        paths.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect();
    cases.sort();
    assert!(cases.len() > 10, "only {} cases", cases.len());
    cases
}

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
    let renew = std::env::var_os("GAITER_RENEW").is_some();
    let mut wrong = String::new();
    for case in cases() {
        let (said, beside) = (said(&case), case.with_extension("expected"));
        if renew {
            fs::write(&beside, &said).unwrap();
        }
        let expected = fs::read_to_string(&beside).unwrap_or_default();
        if said != expected {
            let name = case.file_name().unwrap().display();
            wrong += &format!("--- {name}: expected\n{expected}--- {name}: said\n{said}");
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}
