//! What comes beside a scan: the scanner's own measures are compared with ours, lie in the record,
//! and stay with the scan when a person gives it to a patient.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};

use rig::{Booth, sha256, verb};
use serde_json::Value;
use support::coarse_body;

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
    booth.export("nobody.obj", &coarse_body(1));
    booth.wait_for_records(1);
    assert_has_measures(&record(&booth, "_unassigned"));

    let (config, assign) = (booth.path("station.toml"), &sha256(&coarse_body(1))[..8]);
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
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    let record = record(&booth, "4711");
    assert_eq!(opinions(&record), ["ord-ambiguous"]);
    assert!(!record.join("scanner.ord").exists());
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn what_lies_beside_two_scans_of_one_stem_names_neither() {
    let booth = Booth::new();
    booth.reconfigure(|config| {
        let sidecar = "[patient]\nsidecar = '^PATIENT=(?<patient>.+)$'\nsidecar_wait = \"0s\"\n";
        config.replace("[patient]\n", sidecar)
    });
    fs::write(booth.path("export/x_a.ord"), "PATIENT=4711\n").unwrap();
    booth.export("x a.obj", &coarse_body(1));
    booth.export("x_a.obj", &coarse_body(2));
    let daemon = booth.start();
    booth.wait_for_records(2);
    assert_eq!(fs::read_dir(booth.path("records/_unassigned")).unwrap().count(), 2);
    assert!(!booth.path("records/4711").exists());
    let log = booth.log();
    assert_eq!(log.matches("companion-shared").count(), 2, "{log}");

    fs::write(booth.path("export/y.ord"), "PATIENT=4712\n").unwrap();
    booth.export("y.obj", &coarse_body(3));
    booth.wait_for_records(3);
    record(&booth, "4712");
    assert_eq!(daemon.stop().code(), Some(0));
}

/// Bytes of the files under a folder.
fn size(folder: &Path) -> u64 {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let size = |entry: fs::DirEntry| match entry.metadata().unwrap() {
        found if found.is_dir() => size(&entry.path()),
        found => found.len(),
    };
    entries.map(size).sum()
}

#[test]
fn a_thousand_links_to_what_lies_beside_a_scan_cost_next_to_nothing() {
    let booth = Booth::new();
    booth.reconfigure(|config| config + "[retention]\nspool = \"24h\"\n");
    let first = booth.path("export/0_colours");
    fs::write(&first, vec![b'#'; 1_000_000]).unwrap();
    for n in 0..1000_u32 {
        let bits = (0..10).map(|bit| if n >> bit & 1 == 1 { '+' } else { ' ' });
        let name: String = bits.collect();
        fs::hard_link(&first, booth.path("export").join(format!("4711_{name}a.mtl"))).unwrap();
    }
    let daemon = booth.start();
    booth.export("4711___________a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    let taken = size(&booth.path("state"));
    assert!((4_000_000..6_000_000).contains(&taken), "{taken} bytes");
    let log = booth.log();
    let left_out = log.lines().find(|line| line.contains("companions-left-out")).unwrap();
    assert!(left_out.contains("count=996"), "{left_out}");

    booth.export("4712_a.obj", &coarse_body(2));
    booth.wait_for_records(2);
    assert_eq!(daemon.stop().code(), Some(0));
}
