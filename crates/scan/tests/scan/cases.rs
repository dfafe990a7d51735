//! What every decoder makes of the hand-written files in `fixtures/cases/scan`: the points and
//! triangles that `NAME.ENDING.expected` says, or the refusal with its code and words.
//! `GAITER_RENEW=1 cargo test --test scan cases::` writes them anew; read the difference.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use gaiter_scan::{End, Format, Reading, Scan, ScanFault, completeness, read, reading};
use support::cases::are_as_expected;

/// Fewer files than this, and the folder was not found.
const CASES_MIN: usize = 80;

fn cases() -> Vec<PathBuf> {
    let root = support::root().join("fixtures/cases/scan");
    let list = |folder: &Path| fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = list(&root).flat_map(|folder| list(&folder).collect::<Vec<_>>());
    let is_input = |path: &PathBuf| path.extension().is_some_and(|ending| ending != "expected");
    let mut found: Vec<PathBuf> = files.filter(is_input).collect();
    found.sort();
    assert!(found.len() >= CASES_MIN, "only {} cases were found", found.len());
    found
}

/// All of a small scan, or why it is none.
fn told(found: &Result<Scan, ScanFault>) -> String {
    let mut text = String::new();
    match found {
        Ok(scan) => {
            for p in &scan.points {
                // Turned points come out with an error in the last digit.
                let tidy = [p.x, p.y, p.z].map(|value| (value * 1e9).round() / 1e9 + 0.0);
                writeln!(text, "point {} {} {}", tidy[0], tidy[1], tidy[2]).unwrap();
            }
            for [a, b, c] in &scan.triangles {
                writeln!(text, "triangle {a} {b} {c}").unwrap();
            }
        }
        Err(fault) => writeln!(text, "{}\n{fault}", fault.code()).unwrap(),
    }
    text
}

#[test]
fn every_file_is_read_or_refused_as_it_is_written_beside_it() {
    are_as_expected(cases().iter().map(|path| {
        let bytes = fs::read(path).unwrap();
        let name = path.file_name().unwrap().to_str().unwrap();
        let told = told(&read(&bytes, Format::of_file_name(name).unwrap()));
        (path.with_file_name(format!("{name}.expected")), told)
    }));
}

#[test]
fn the_quick_look_awaits_more_only_where_reading_finds_the_file_cut_short() {
    for path in cases() {
        let bytes = fs::read(&path).unwrap();
        let format = Format::of_file_name(path.to_str().unwrap()).unwrap();
        let waits = |fault: &ScanFault| fault.may_be_mended_by_waiting();
        let quick = completeness(&bytes, format).err().filter(waits);
        let Reading { scan, end } = reading(&bytes, format);
        let whole = scan.err().filter(waits);
        if end == End::NoLineEnd {
            assert!(quick.is_some() && whole.is_none(), "{}", path.display());
            continue;
        }
        assert_eq!(quick, whole, "{}", path.display());
        assert_eq!(quick.is_some(), end == End::CutShort, "{}", path.display());
    }
}

#[test]
fn every_prefix_of_every_file_is_refused_or_has_no_more_than_the_file() {
    for path in cases() {
        let bytes = fs::read(&path).unwrap();
        let format = Format::of_file_name(path.to_str().unwrap()).unwrap();
        let Ok(whole) = read(&bytes, format) else { continue };
        for end in 0..bytes.len() {
            let Ok(part) = read(&bytes[..end], format) else { continue };
            let place = format!("{} up to byte {end}", path.display());
            assert!(
                part.points.iter().all(|point| whole.points.contains(point)),
                "{place}: a point that is not in the file"
            );
            assert!(
                part.triangles.is_empty() || part.triangles.len() <= whole.triangles.len(),
                "{place}: {part:?}"
            );
        }
    }
}

#[test]
fn every_message_is_one_line_that_says_what_to_look_at() {
    let mut codes = Vec::new();
    for path in cases() {
        let bytes = fs::read(&path).unwrap();
        let format = Format::of_file_name(path.to_str().unwrap()).unwrap();
        let Err(fault) = read(&bytes, format) else { continue };
        let said = fault.to_string();
        assert!(said.chars().all(|letter| !letter.is_control() && letter.is_ascii()), "{said}");
        assert!((20..250).contains(&said.len()), "{said}");
        codes.push(fault.code());
    }
    codes.sort_unstable();
    codes.dedup();
    assert_eq!(codes.len(), 7, "all codes but those of no file: {codes:?}");
}
