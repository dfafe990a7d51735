//! What comes beside a scan: the scanner's own measures are compared with ours, lie in the record,
//! and stay with the scan when a person gives it to a patient.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "support/station.rs"]
mod support;

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use support::{Booth, coarse_body as coarse, sha256, verb};

/// The body of the fixture in the hundredth of its unit, as a scanner set otherwise writes it.
const WRONG_UNIT: &str = "OPTION UNITS=cm\nMEASURE Height=16043\n";

/// The only record folder of a patient.
fn record(booth: &Booth, patient: &str) -> PathBuf {
    let folders = fs::read_dir(booth.path("records").join(patient)).unwrap();
    let folders: Vec<PathBuf> = folders.map(|entry| entry.unwrap().path()).collect();
    assert_eq!(folders.len(), 1, "{folders:?}");
    folders[0].clone()
}

/// The codes of a record's findings on the scanner's own measures.
fn opinions(record: &Path) -> Vec<String> {
    let record = fs::read(record.join("record.json")).unwrap();
    let record: Value = serde_json::from_slice(&record).unwrap();
    let codes = record["findings"].as_array().unwrap().iter();
    let codes = codes.map(|finding| finding["code"].as_str().unwrap().to_owned());
    codes.filter(|code| code.starts_with("ord-")).collect()
}

fn assert_has_measures(record: &Path) {
    assert_eq!(opinions(record), ["ord-unit"]);
    assert_eq!(fs::read_to_string(record.join("scanner.ord")).unwrap(), WRONG_UNIT);
    let sums = fs::read_to_string(record.join("SHA256SUMS")).unwrap();
    let sum = sha256(WRONG_UNIT.as_bytes());
    assert!(sums.contains(&format!("{sum}  scanner.ord")), "{sums}");
}

#[test]
fn the_scanners_own_measures_are_compared_and_follow_the_scan_to_its_patient() {
    let booth = Booth::new();
    let daemon = booth.start();
    fs::write(booth.path("export/nobody.ord"), WRONG_UNIT).unwrap();
    booth.export("nobody.obj", &coarse(1));
    booth.wait_for_records(1);
    assert_has_measures(&record(&booth, "_unassigned"));

    let (config, assign) = (booth.path("station.toml"), &sha256(&coarse(1))[..8]);
    let assigned = verb::gaiter_told(&config, &["assign", assign], "4711\n");
    assert_eq!(verb::code(&assigned), Some(0), "{}", verb::stderr(&assigned));
    let delivered =
        "SELECT count(*) FROM deliveries WHERE patient = '4711' AND state = 'delivered'";
    booth.wait_for_journal(delivered, 1);
    assert_has_measures(&record(&booth, "4711"));
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn of_two_files_of_measures_none_is_believed_and_none_is_taken_for_the_scans() {
    let booth = Booth::new();
    let daemon = booth.start();
    for name in ["4711_a.ord", "4711 a.ord"] {
        fs::write(booth.path("export").join(name), WRONG_UNIT).unwrap();
    }
    booth.export("4711_a.obj", &coarse(1));
    booth.wait_for_records(1);
    let record = record(&booth, "4711");
    assert_eq!(opinions(&record), ["ord-ambiguous"]);
    assert!(!record.join("scanner.ord").exists());
    assert_eq!(daemon.stop().code(), Some(0));
}
