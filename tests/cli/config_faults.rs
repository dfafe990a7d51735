//! Every file of `fixtures/cases/config` and, beside it, exactly what gaiter says about it.
//!
//! `GAITER_RENEW=1 cargo test --test cli config_faults::` writes the expected files anew; read the
//! difference before you keep it.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};

use gaiter::config;
use proptest::prelude::*;

fn cases() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/cases/config");
    let mut cases: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    cases.sort();
    assert!(!cases.is_empty(), "there are no cases");
    cases
}

/// The faults as `gaiter check` prints them, or the configuration where there are none.
fn said(case: &Path) -> String {
    let loaded = match fs::read_to_string(case) {
        Ok(text) => config::load(&text),
        Err(_) => match config::read(case) {
            Err(config::ConfigError::Faults { mut faults, .. }) => {
                faults.iter_mut().for_each(|fault| fault.file = "station.toml".into());
                Err(faults)
            }
            other => panic!("{}: {other:?}", case.display()),
        },
    };
    match loaded {
        Ok(config) => format!("{config:#?}\n"),
        Err(faults) => faults.iter().map(|fault| format!("{fault:#}\n")).collect(),
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

#[test]
fn every_fault_shows_its_place_and_has_a_caret_within_its_line() {
    let mut faults_seen = 0;
    for case in cases() {
        for fault in
            config::load(&fs::read_to_string(&case).unwrap_or_default()).err().into_iter().flatten()
        {
            faults_seen += 1;
            let length = fault.source_line.chars().count();
            assert!(fault.line >= 1 && fault.column >= 1 && fault.width >= 1, "{fault}");
            assert!(fault.column + fault.width <= length + 2, "{}: {fault}", case.display());
        }
    }
    assert!(faults_seen > 20);
}

proptest! {
    // A case found here is kept as a file among the fixtures, by name.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// The shipped file with a stroke of an eraser and a few wrong keys: whatever comes of it, it
    /// is answered, and every fault has a place that exists.
    #[test]
    fn a_mangled_file_is_answered_with_faults_that_have_a_place(
        from in 0..5000_usize, length in 0..40_usize, typed in "[\\[\\]\"'=.#\\\\ü\u{feff}\u{1b}\n\r a0-]{0,12}",
    ) {
        let shipped = include_str!("../../config/station.toml");
        let from = shipped.floor_char_boundary(from);
        let to = shipped.floor_char_boundary(from + length);
        let text = [&shipped[..from], &typed, &shipped[to..]].concat();
        for fault in config::load(&text).err().into_iter().flatten() {
            let lines = text.matches('\n').count() + 1;
            prop_assert!((1..=lines).contains(&fault.line), "{fault}");
            let end = fault.source_line.chars().count() + 2;
            prop_assert!(fault.column >= 1 && fault.column + fault.width <= end, "{fault}");
            prop_assert!(!format!("{fault:#}").contains('\u{1b}'), "{fault}");
        }
    }
}
