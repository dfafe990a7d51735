//! Whose scan it is, on the real station: a patient named before the scan, sources that differ, a
//! scan taken back from the wrong patient.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;

use rig::verb::{code, gaiter_told, stderr, stdout};
use rig::{Booth, sha256};
use support::coarse_body;

/// Folders for a station whose scans' names say nothing.
fn booth() -> Booth {
    let booth = Booth::new();
    booth.reconfigure(|text| {
        text.lines()
            .filter(|line| !line.starts_with("file_name"))
            .map(|line| format!("{line}\n"))
            .collect()
    });
    booth
}

/// A verb that is told an id on its standard input.
#[track_caller]
fn told(booth: &Booth, args: &[&str], id: &str) -> String {
    let output = gaiter_told(&booth.path("station.toml"), args, &format!("{id}\n"));
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    stdout(&output)
}

/// Names the next patient and waits for a look that began after that: what appears in the very next
/// one may have lain there before.
#[track_caller]
fn name_next(booth: &Booth, id: &str) -> String {
    let said = told(booth, &["patient", "set"], id);
    booth.wait_for_look();
    said
}

#[track_caller]
fn said(booth: &Booth, args: &[&str]) -> String {
    let output = booth.gaiter(args);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    stdout(&output)
}

fn record(booth: &Booth, patient: &str) -> serde_json::Value {
    let folder = booth.path("records").join(patient);
    let place = fs::read_dir(folder).unwrap().next().unwrap().unwrap().path();
    serde_json::from_slice(&fs::read(place.join("record.json")).unwrap()).unwrap()
}

fn held(booth: &Booth, count: i64) {
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'held'", count);
}

#[test]
fn a_patient_who_is_named_gets_the_next_scan_and_no_other() {
    let booth = booth();
    let daemon = booth.start_ready();
    assert!(name_next(&booth, "4711").contains("next export belongs to this patient"));
    let (first, second) = (coarse_body(1), coarse_body(2));
    booth.export("a.obj", &first);
    booth.wait_for_records(1);
    booth.export("b.obj", &second);
    booth.wait_for_records(2);
    let expected =
        [("4711".to_owned(), sha256(&first)), ("_unassigned".to_owned(), sha256(&second))];
    assert_eq!(booth.records(), expected);
    let patient = &record(&booth, "4711")["patient"];
    assert_eq!(patient["sources"][0]["kind"], "operator");
    assert_eq!(patient["sources"][0]["confidence"], "medium");
    assert_eq!(daemon.stop().code(), Some(0));
    // Nobody's id is where others read.
    assert!(!booth.log_names("4711"), "{}", booth.log());
}

#[test]
fn another_name_before_the_export_replaces_the_first() {
    let booth = booth();
    let daemon = booth.start_ready();
    name_next(&booth, "4711");
    assert!(name_next(&booth, "0815").contains("not to the patient named before"));
    assert_eq!(said(&booth, &["patient", "show"]), "0815's export is expected.\n");
    let scan = coarse_body(3);
    booth.export("a.obj", &scan);
    booth.wait_for_records(1);
    assert_eq!(booth.records(), [("0815".to_owned(), sha256(&scan))]);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_file_name_that_contradicts_the_named_patient_holds_the_scan() {
    let booth = Booth::new();
    let daemon = booth.start_ready();
    name_next(&booth, "4711");
    let scan = coarse_body(4);
    booth.export("0815_a.obj", &scan);
    held(&booth, 1);
    assert!(said(&booth, &["explain", &sha256(&scan)[..8]]).contains("patients-differ"));
    assert!(said(&booth, &["show", &sha256(&scan)[..8]]).contains("0815"));
    // And one that agrees is named by both.
    told(&booth, &["patient", "clear"], "");
    name_next(&booth, "4711");
    booth.export("4711_b.obj", &coarse_body(5));
    booth.wait_for_records(1);
    let sources = &record(&booth, "4711")["patient"]["sources"];
    assert_eq!(
        (&sources[0]["kind"], &sources[1]["kind"]),
        (&"operator".into(), &"file_name".into())
    );
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_name_outlives_the_station_but_what_comes_after_a_start_is_held_for_it() {
    let booth = booth();
    let daemon = booth.start_ready();
    name_next(&booth, "4711");
    assert_eq!(daemon.stop().code(), Some(0));
    let meanwhile = coarse_body(6);
    booth.export("a.obj", &meanwhile);
    let daemon = booth.start();
    // Another card may have been read in vain meanwhile.
    held(&booth, 1);
    let why = said(&booth, &["explain", &sha256(&meanwhile)[..8]]);
    assert!(why.contains("press-unheard"), "{why}");
    said(&booth, &["release", &sha256(&meanwhile)[..8]]);
    booth.wait_for_records(1);
    assert_eq!(booth.records(), [("4711".to_owned(), sha256(&meanwhile))]);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn without_a_name_exports_are_held_where_the_configuration_wants_it() {
    let booth = Booth::new();
    booth.reconfigure(|text| {
        text.replace("[patient]", "[capture]\nwithout_trigger = \"hold\"\n[patient]")
    });
    let daemon = booth.start();
    let scan = coarse_body(8);
    booth.export("4711_a.obj", &scan);
    held(&booth, 1);
    assert!(said(&booth, &["explain", &sha256(&scan)[..8]]).contains("no-press"));
    said(&booth, &["release", &sha256(&scan)[..8]]);
    booth.wait_for_records(1);
    assert_eq!(booth.records(), [("4711".to_owned(), sha256(&scan))]);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_scan_that_is_taken_back_leaves_the_patients_folder_whole_and_goes_to_the_right_one() {
    let booth = Booth::new();
    let daemon = booth.start();
    let scan = coarse_body(9);
    booth.export("4711_a.obj", &scan);
    booth.wait_for_records(1);
    // A delivery that is not noted yet would be called off, and not withdrawn.
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'delivered'", 1);
    let id = &sha256(&scan)[..8];
    assert!(said(&booth, &["unassign", id]).contains("unassigned again"));
    let withdrawn = "SELECT count(*) FROM deliveries WHERE state = 'withdrawn'";
    booth.wait_for_journal(withdrawn, 1);
    assert_eq!(booth.records(), [("_unassigned".to_owned(), sha256(&scan))]);
    let again = booth.gaiter(&["unassign", id]);
    assert!(stderr(&again).contains("unassigned"), "{}", stderr(&again));
    told(&booth, &["assign", id], "0815");
    booth.wait_for_journal(withdrawn, 2);
    assert_eq!(booth.records(), [("0815".to_owned(), sha256(&scan))]);
    assert_eq!(record(&booth, "0815")["patient"]["id"], "0815");
    // And even back to the first: the person erred twice.
    said(&booth, &["unassign", id]);
    told(&booth, &["assign", id], "4711");
    booth.wait_for("4711's record", || {
        booth.journal(withdrawn) == Some(2)
            && booth.records() == [("4711".to_owned(), sha256(&scan))]
    });
    let history = said(&booth, &["show", id]);
    assert!(history.contains("unassigned") && history.contains("assigned"), "{history}");
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn an_id_that_its_check_digit_denies_is_not_believed() {
    let booth = Booth::new();
    booth.reconfigure(|text| text.replace("[patient]", "[patient]\ncheck_digit = \"luhn\""));
    let daemon = booth.start_ready();
    let output = gaiter_told(&booth.path("station.toml"), &["patient", "set"], "17893729975\n");
    assert_eq!(code(&output), Some(64), "{}", stderr(&output));
    name_next(&booth, "17893729974");
    assert_eq!(daemon.stop().code(), Some(0));
}
