//! Measures that a person sets at the running station: every store gets them, across crashes and a lost
//! journal; and neither the reason nor the name gets into what the station tells.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;
use std::process::Output;

use rig::verb::{code, gaiter_told, stderr, stdout};
use rig::{Booth, names, sha256};
use serde_json::Value;
use support::coarse_body;
use support::gdt_check::{Line, contents};

use crate::gdt::{fetch, practice, visible};

/// What a person typed; it stands in the record and in the practice software, and nowhere else.
const PLANTED: [&str; 2] = ["Quastenflosser", "geschwollen"];

/// A practice with a second folder of records.
fn practice_with_copy() -> Booth {
    let booth = practice("");
    let copy = booth.path("copy");
    fs::create_dir(&copy).unwrap();
    booth.reconfigure(|text| format!("{text}[store.copy]\npath = \"{}\"\n", copy.display()));
    booth
}

/// Sets the girth of C on the right leg of a scan.
fn amend(booth: &Booth, scan: &[u8], cm: &str) -> Output {
    let id = &sha256(scan)[..8];
    let what = ["--leg", "right", "--level", "C", "--girth-cm", cm];
    let said = ["--reason", PLANTED[1], "--by", PLANTED[0]];
    booth.gaiter(&[&["amend", id][..], &what, &said].concat())
}

#[track_caller]
fn set(booth: &Booth, scan: &[u8], cm: &str) {
    let output = amend(booth, scan, cm);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
}

/// The girth of C on the right leg in a result, and the remark at it.
fn c_right(result: &[Line]) -> (String, Option<String>) {
    let at = result.iter().position(|(field, text)| field == "8410" && text == b"LC_R").unwrap();
    let block = &result[at..];
    let end = block[1..].iter().position(|(field, _)| field == "8410").unwrap();
    let of = |wanted: &str| {
        let line = block[..=end].iter().find(|(field, _)| field == wanted);
        line.map(|(_, text)| String::from_utf8_lossy(text).into_owned())
    };
    (of("8420").unwrap(), of("8470"))
}

/// The folders of the patient's records in a store.
fn records(booth: &Booth, store: &str) -> Vec<PathBuf> {
    visible(&booth.path(store).join("4711"))
}

fn record(folder: &std::path::Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("record.json")).unwrap()).unwrap()
}

const DUE: &str = "SELECT count(*) FROM deliveries WHERE amended <> ''";

#[test]
fn every_store_gets_the_amended_measure_once_and_nothing_else_tells_who_set_it() {
    let booth = practice_with_copy();
    let daemon = booth.start();
    let scan = coarse_body(1);
    booth.export("4711_a.obj", &scan);
    let first = fetch(&booth);
    booth.wait_for_records(1);
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'delivered'", 1);
    let (scanned, remark) = c_right(&first);
    assert_ne!((scanned.as_str(), remark.as_deref()), ("36.7", Some("von Hand eingetragen")));
    set(&booth, &scan, "36.7");
    let second = fetch(&booth);
    assert_eq!(c_right(&second), ("36.7".to_owned(), Some("von Hand eingetragen".to_owned())));
    let comments = contents(&second, "6227").join(" ");
    assert!(PLANTED.iter().all(|planted| comments.contains(planted)), "{comments}");
    booth.wait_for_journal(DUE, 0);
    for store in ["records", "copy"] {
        let folders = records(&booth, store);
        assert_eq!(folders.len(), 2, "{store}: {folders:?}");
        let [was, is] = [0, 1].map(|at| record(&folders[at]));
        assert_eq!(was["legs"], is["legs"], "{store}");
        assert_eq!(is["amendments"][0]["girth_mm"], 367.0);
        assert_eq!(names(&folders[0]), names(&folders[1]));
    }
    let events = "SELECT count(*) FROM history WHERE event = 'amended'";
    assert_eq!(booth.journal(events), Some(1));
    // A refused one changes nothing and sends nothing.
    let refused = amend(&booth, &scan, "4.17");
    assert_eq!(code(&refused), Some(64), "{}", stderr(&refused));
    assert!(stderr(&refused).contains("girth 4.2 cm is not between"), "{}", stderr(&refused));
    booth.wait_for_journal(DUE, 0);
    assert_eq!(records(&booth, "records").len(), 2);
    let told = ["status", "scans"].map(|verb| stdout(&booth.gaiter(&[verb, "--json"]))).concat();
    assert_eq!(daemon.stop().code(), Some(0));
    assert!(visible(&booth.path("results")).is_empty(), "it was handed over once");
    let journal = fs::read(booth.path("state/journal.db")).unwrap();
    for planted in PLANTED {
        assert!(!told.contains(planted) && !booth.log().contains(planted), "{planted} is told");
        let is_kept = journal.windows(planted.len()).any(|part| part == planted.as_bytes());
        assert!(!is_kept, "{planted} is in the journal");
    }
}

#[test]
fn a_store_that_is_away_gets_it_later_also_after_a_kill_and_a_lost_journal() {
    let booth = practice_with_copy();
    let daemon = booth.start();
    let scan = coarse_body(1);
    booth.export("4711_a.obj", &scan);
    fetch(&booth);
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'delivered'", 1);
    let away = |store: &str| (booth.path(store), booth.path(&format!("{store}-away")));
    for store in ["results", "copy"] {
        let (here, there) = away(store);
        fs::rename(here, there).unwrap();
    }
    set(&booth, &scan, "36.7");
    set(&booth, &scan, "36.8");
    assert_eq!(records(&booth, "records").len(), 3);
    booth.wait_for_journal(DUE, 2);
    daemon.kill();
    for store in ["results", "copy"] {
        let (here, there) = away(store);
        fs::rename(there, here).unwrap();
    }
    let daemon = booth.start();
    assert_eq!(c_right(&fetch(&booth)).0, "36.8");
    booth.wait_for_journal(DUE, 0);
    let copied = records(&booth, "copy");
    let [first, last] = [copied.first(), copied.last()].map(|folder| record(folder.unwrap()));
    assert_eq!((&first["revision"], &last["revision"]), (&1.into(), &3.into()));
    assert_eq!(last["amendments"].as_array().unwrap().len(), 2);

    // A journal that is lost does not know what was handed over: nothing is handed over twice.
    assert_eq!(daemon.stop().code(), Some(0));
    for file in ["journal.db", "journal.db-wal", "journal.db-shm", "history.head"] {
        let _ = fs::remove_file(booth.path("state").join(file));
    }
    let daemon = booth.start();
    booth.wait_for("the search", || booth.log().matches("store-searched").count() == 3);
    booth.wait_for_journal(DUE, 0);
    assert_eq!(daemon.stop().code(), Some(0));
    assert!(visible(&booth.path("results")).is_empty());
    assert_eq!(records(&booth, "copy"), copied);
}

#[test]
fn what_is_set_before_the_practice_software_has_the_record_comes_after_it() {
    let booth = practice("");
    let daemon = booth.start_ready();
    let (results, away) = (booth.path("results"), booth.path("results-away"));
    booth.wait_until_begun("gdt");
    fs::rename(&results, &away).unwrap();
    let scan = coarse_body(1);
    booth.export("4711_a.obj", &scan);
    let stored = "SELECT count(*) FROM deliveries WHERE store = 'folder' AND state = 'delivered'";
    booth.wait_for_journal(stored, 1);
    set(&booth, &scan, "36.7");
    fs::rename(&away, &results).unwrap();
    let [first, second] = [fetch(&booth), fetch(&booth)].map(|result| c_right(&result));
    assert!(first.0 != "36.7" && second.0 == "36.7", "{first:?}, {second:?}");
    booth.wait_for_journal(DUE, 0);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_record_that_is_taken_back_takes_along_what_was_set_without_effect() {
    let booth = Booth::new();
    let daemon = booth.start();
    let scan = coarse_body(1);
    booth.export("4711_a.obj", &scan);
    booth.wait_for_records(1);
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'delivered'", 1);
    set(&booth, &scan, "36.7");
    let output = booth.gaiter(&["unassign", &sha256(&scan)[..8]]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let unassigned = booth.path("records/_unassigned");
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'withdrawn'", 1);
    let folder = visible(&unassigned).remove(0);
    assert!(record(&folder)["amendments"].is_null(), "whose leg was measured is not certain");
    let kept = names(&folder).into_iter().find(|name| name.starts_with("set-by-hand.")).unwrap();
    let kept = fs::read_to_string(folder.join(kept)).unwrap();
    let kept: Value = serde_json::from_str(&kept).unwrap();
    assert_eq!(kept["amendments"][0]["girth_mm"], 367.0);
    assert!(records(&booth, "records").is_empty());
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_record_amended_and_taken_back_again_and_again_leaves_every_wrong_folder_and_loses_nothing() {
    const ROUNDS: usize = 6;
    let booth = Booth::new();
    let daemon = booth.start_ready();
    let scan = coarse_body(1);
    let id = sha256(&scan)[..8].to_owned();
    let at_rest = |what: &str, patient: &str| {
        let open = "SELECT count(*) FROM deliveries WHERE state IN ('pending', 'withdrawing')";
        let folder = booth.path("records").join(patient);
        booth.wait_for(what, || {
            booth.journal(open) == Some(0) && folder.exists() && visible(&folder).len() == 1
        });
    };
    booth.export("4711_a.obj", &scan);
    at_rest("the record", "4711");
    let mut owner = "4711";
    for round in 0..ROUNDS {
        set(&booth, &scan, &format!("36.{}", round + 2));
        let output = booth.gaiter(&["unassign", &id]);
        assert_eq!(code(&output), Some(0), "{}", stderr(&output));
        at_rest("the take-back", "_unassigned");
        assert!(visible(&booth.path("records").join(owner)).is_empty(), "round {round}");
        owner = "1002";
        let config = booth.path("station.toml");
        let output = gaiter_told(&config, &["assign", &id], &format!("{owner}\n"));
        assert_eq!(code(&output), Some(0), "{}", stderr(&output));
        at_rest("the assignment", owner);
        assert!(visible(&booth.path("records/_unassigned")).is_empty(), "round {round}");
    }
    let folder = visible(&booth.path("records").join(owner)).remove(0);
    let kept = names(&folder).into_iter().filter(|name| name.contains("set-by-hand"));
    let kept = kept.map(|name| {
        let kept: Value = serde_json::from_slice(&fs::read(folder.join(name)).unwrap()).unwrap();
        kept["amendments"][0]["girth_mm"].to_string()
    });
    let girths: BTreeSet<String> = kept.collect();
    assert_eq!(girths.len(), ROUNDS, "{girths:?}");
    assert_eq!(code(&booth.gaiter(&["status"])), Some(0), "{}", booth.status());
    assert!(!booth.log().contains("store-unavailable"), "{}", booth.log());
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn what_has_no_record_cannot_be_amended() {
    let booth = Booth::new();
    let daemon = booth.start_ready();
    let unknown = amend(&booth, b"unknown", "36.7");
    assert_eq!(code(&unknown), Some(66), "{}", stderr(&unknown));
    booth.export("4711_a.obj", b"v 0 0 0\n");
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", 1);
    let refused = amend(&booth, b"v 0 0 0\n", "36.7");
    assert_eq!(code(&refused), Some(64), "{}", stderr(&refused));
    assert!(stderr(&refused).contains("has no record in the store"), "{}", stderr(&refused));
    assert_eq!(daemon.stop().code(), Some(0));
}
