//! What a person decides holds on the real station, whatever happens meanwhile: the store away, the
//! journal lost, a delivery in hand, a record changed by hand.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::process::Command;

use rig::verb::{code, gaiter_told, stderr, stdout};
use rig::{Booth, Daemon, names, sha256};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use support::{body, coarse_body};

/// Nothing is to be delivered and nothing to be taken back.
const OPEN: &str = "SELECT count(*) FROM deliveries WHERE state IN ('pending', 'withdrawing')";

/// Folders for a station that keeps spooled bytes for a while.
fn booth() -> Booth {
    let booth = Booth::new();
    booth.reconfigure(|text| text + "[retention]\nspool = \"24h\"\n");
    booth
}

#[track_caller]
fn said(booth: &Booth, args: &[&str]) -> String {
    let output = booth.gaiter(args);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    stdout(&output)
}

/// Waits until a record that could not be taken back is shown as such: the alarm comes before.
#[track_caller]
fn shown_as_kept(booth: &Booth, scan: &str) {
    let kept = "withdrawing [record-kept], to be withdrawn";
    booth.wait_for("the kept record", || said(booth, &["show", scan]).contains(kept));
}

/// Has a delivery tried again at once, unless the station has done so by itself.
#[track_caller]
fn try_again(booth: &Booth, scan: &str) {
    let output = booth.gaiter(&["retry", scan]);
    assert!(matches!(code(&output), Some(0 | 64)), "{}", stderr(&output));
}

#[track_caller]
fn assign(booth: &Booth, scan: &str, id: &str) {
    let output = gaiter_told(&booth.path("station.toml"), &["assign", scan], &format!("{id}\n"));
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
}

fn complaints(booth: &Booth) -> Vec<String> {
    let status = booth.status();
    let complaints = status["complaints"].as_array().unwrap().iter();
    complaints.map(|complaint| complaint["code"].as_str().unwrap().to_owned()).collect()
}

/// Loses the journal of a station that is stopped.
fn lose_journal(booth: &Booth) {
    for file in ["journal.db", "journal.db-wal", "journal.db-shm", "history.head"] {
        let _ = fs::remove_file(booth.path("state").join(file));
    }
}

/// Waits until nothing is to be done, and says whose folders hold the scan's records.
#[track_caller]
fn at_rest(booth: &Booth, what: &str, patients: &[&str], scan: &[u8]) {
    let expected: Vec<_> = patients.iter().map(|id| ((*id).to_owned(), sha256(scan))).collect();
    booth.wait_for(what, || {
        let (records, _) = rig::invariants::records(&booth.path("records"));
        booth.journal(OPEN) == Some(0) && records == expected
    });
}

fn copy(from: &Path, to: &Path) {
    assert!(Command::new("cp").arg("-a").arg(from).arg(to).status().unwrap().success());
}

#[test]
fn what_was_taken_back_while_the_store_was_away_stays_so_when_the_journal_is_lost() {
    for next in [None, Some("990815")] {
        let booth = booth();
        let daemon = booth.start_ready();
        let scan = coarse_body(1);
        booth.export("4711_a.obj", &scan);
        at_rest(&booth, "the record", &["4711"], &scan);
        let id = &sha256(&scan)[..8];
        booth.take_records_away();
        said(&booth, &["unassign", id]);
        if let Some(next) = next {
            assign(&booth, id, next);
        }
        assert_eq!(daemon.stop().code(), Some(0));
        lose_journal(&booth);
        let daemon = booth.start_ready();
        assert!(booth.log().contains("journal-rebuilt"), "{}", booth.log());
        fs::rename(booth.path("unmounted"), booth.path("records")).unwrap();
        at_rest(&booth, "the decision", &[next.unwrap_or("_unassigned")], &scan);
        assert_eq!(daemon.stop().code(), Some(0));
        assert!(!booth.log_names("990815"), "{}", booth.log());
    }
}

#[test]
fn a_record_put_back_from_a_backup_goes_to_whom_the_scan_was_given() {
    let booth = Booth::new();
    let daemon = booth.start_ready();
    let scan = coarse_body(2);
    booth.export("4711_a.obj", &scan);
    at_rest(&booth, "the record", &["4711"], &scan);
    copy(&booth.path("records/4711"), &booth.path("backup"));
    let id = &sha256(&scan)[..8];
    said(&booth, &["unassign", id]);
    at_rest(&booth, "the take-back", &["_unassigned"], &scan);
    assign(&booth, id, "990815");
    at_rest(&booth, "the assignment", &["990815"], &scan);
    assert_eq!(daemon.stop().code(), Some(0));
    // The bytes are in no spool, and the only record lies with the wrong patient.
    fs::remove_dir_all(booth.path("records/990815")).unwrap();
    fs::remove_dir_all(booth.path("records/4711")).unwrap();
    copy(&booth.path("backup"), &booth.path("records/4711"));
    fs::remove_file(booth.path("export/4711_a.obj")).unwrap();
    lose_journal(&booth);
    let daemon = booth.start_ready();
    at_rest(&booth, "the decision", &["990815"], &scan);
    assert_eq!(daemon.stop().code(), Some(0));
    assert!(booth.log().contains("record-against-decision"), "{}", booth.log());
}

/// A backup of the state from before the scan, put back after it was assigned to another patient; or no
/// backup at all, on a new machine with the old station's id.
#[test]
fn a_state_folder_older_than_the_records_gives_no_scan_to_a_second_patient() {
    for has_backup in [true, false] {
        let booth = Booth::new();
        assert_eq!(booth.start_ready().stop().code(), Some(0));
        copy(&booth.path("state"), &booth.path("backup"));
        let daemon = booth.start_ready();
        let scan = coarse_body(3);
        booth.export("4711_a.obj", &scan);
        at_rest(&booth, "the record", &["4711"], &scan);
        let id = &sha256(&scan)[..8];
        said(&booth, &["unassign", id]);
        at_rest(&booth, "the take-back", &["_unassigned"], &scan);
        assign(&booth, id, "990815");
        at_rest(&booth, "the assignment", &["990815"], &scan);
        assert_eq!(daemon.stop().code(), Some(0));
        fs::remove_dir_all(booth.path("state")).unwrap();
        if has_backup {
            copy(&booth.path("backup"), &booth.path("state"));
        }
        let daemon = booth.start_ready();
        let held = || booth.journal("SELECT count(*) FROM deliveries WHERE state = 'held'");
        booth.wait_for("the export to be held", || held() == Some(1));
        at_rest(&booth, "the record where it was", &["990815"], &scan);
        assert_eq!(daemon.stop().code(), Some(0));
        assert!(booth.log().contains("journal-rebuilt"), "{}", booth.log());
    }
}

/// The process that measures for a station; none while none does.
fn measuring(daemon: &Daemon) -> Option<Pid> {
    let of = |process: &str| -> Option<Pid> {
        let stat = fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
        // What follows the name, which may hold anything: the state, then the parent.
        let parent = stat.rsplit_once(')')?.1.split_whitespace().nth(1)?.parse::<u32>().ok()?;
        let words = fs::read(format!("/proc/{process}/cmdline")).ok()?;
        let measures = words.split(|byte| *byte == 0).any(|word| word == b"measure");
        (parent == daemon.id() && measures).then(|| Pid::from_raw(process.parse().ok()?)).flatten()
    };
    names(Path::new("/proc")).iter().find_map(|process| of(process))
}

#[test]
fn a_scan_taken_back_and_assigned_again_while_a_delivery_runs_ends_with_the_last_word() {
    for (next, left) in [("4711", 0), ("990815", 1)] {
        let booth = booth();
        let daemon = booth.start_ready();
        let scan = body(3);
        booth.export("4711_a.obj", &scan);
        at_rest(&booth, "the record", &["4711"], &scan);
        let id = &sha256(&scan)[..8];
        said(&booth, &["unassign", id]);
        // The unassigned delivery runs: it is stopped in the middle, and goes on after the next word.
        let mut stopped = None;
        booth.wait_for("the measurement", || {
            stopped = measuring(&daemon);
            stopped.is_some_and(|pid| kill_process(pid, Signal::STOP).is_ok())
        });
        assign(&booth, id, next);
        kill_process(stopped.unwrap(), Signal::CONT).unwrap();
        at_rest(&booth, "the last word", &[next], &scan);
        let show = said(&booth, &["show", id]);
        assert!(!show.contains("to be withdrawn"), "{show}");
        let withdrawn =
            "SELECT count(*) FROM deliveries WHERE state = 'withdrawn' AND patient <> ''";
        booth.wait_for_journal(withdrawn, left);
        assert_eq!(daemon.stop().code(), Some(0));
    }
}

#[test]
fn a_record_that_was_changed_by_hand_is_said_to_lie_there_until_it_has_left() {
    let booth = booth();
    let daemon = booth.start_ready();
    let scan = coarse_body(4);
    booth.export("4711_a.obj", &scan);
    at_rest(&booth, "the record", &["4711"], &scan);
    let folder = booth.path("records/4711");
    let record = folder.join(&names(&folder)[0]).join("record.json");
    let sound = fs::read(&record).unwrap();
    fs::write(&record, "{}").unwrap();
    let id = &sha256(&scan)[..8];
    said(&booth, &["unassign", id]);
    booth.wait_for("the alarm", || complaints(&booth).contains(&"record-kept".to_owned()));
    assert_eq!(booth.status()["scans"]["withdrawing"], 1);
    assert!(said(&booth, &["scans"]).contains("withdrawing"));
    shown_as_kept(&booth, id);
    assert!(said(&booth, &["explain", id]).contains("could not be removed yet"));
    assert!(record.exists());
    fs::write(&record, sound).unwrap();
    try_again(&booth, id);
    at_rest(&booth, "the take-back", &["_unassigned"], &scan);
    booth.wait_for("the end of the alarm", || complaints(&booth).is_empty());
    assert_eq!(booth.status()["scans"]["withdrawing"], 0);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_record_with_something_in_its_way_waits_alone_and_the_store_goes_on() {
    let booth = booth();
    let daemon = booth.start_ready();
    let [scan, other] = [6, 7].map(coarse_body);
    booth.export("4711_a.obj", &scan);
    at_rest(&booth, "the record", &["4711"], &scan);
    let id = &sha256(&scan)[..8];
    let stone = booth.path(&format!("records/4711/.staging.booth-1.withdrawn_{id}"));
    fs::write(&stone, "not a folder").unwrap();
    said(&booth, &["unassign", id]);
    booth.wait_for("the alarm", || complaints(&booth) == ["record-kept"]);
    shown_as_kept(&booth, id);
    booth.export("4712_b.obj", &other);
    booth.wait_for_journal(
        "SELECT count(*) FROM deliveries WHERE state = 'delivered' AND patient = '4712'",
        1,
    );
    assert_eq!(complaints(&booth), ["record-kept"]);
    assert!(booth.log().contains("something is in its way"), "{}", booth.log());
    assert!(!booth.log().contains("store-unavailable"), "{}", booth.log());
    fs::remove_file(&stone).unwrap();
    try_again(&booth, id);
    booth.wait_for_journal(OPEN, 0);
    booth.wait_for("the end of the alarm", || complaints(&booth).is_empty());
    assert_eq!(names(&booth.path("records/4711")), [""; 0]);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_scan_held_for_two_is_released_for_neither() {
    let booth = Booth::new();
    let daemon = booth.start_ready();
    let scan = coarse_body(5);
    booth.export("990011_a.obj", &scan);
    booth.wait_for_records(1);
    for (count, name) in [(1, "990012_a.obj"), (2, "990013_a.obj")] {
        booth.export(name, &scan);
        booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'held'", count);
    }
    let output = booth.gaiter(&["release", &sha256(&scan)[..8], "--json"]);
    assert_eq!(code(&output), Some(64), "{}", stdout(&output));
    let fault: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(fault["fault"]["code"], "scan-of-several");
    assert!(fault["fault"]["message"].as_str().unwrap().contains("gaiter assign"), "{fault}");
    assert_eq!(booth.journal(OPEN), Some(0));
    assert_eq!(booth.records(), [("990011".to_owned(), sha256(&scan))]);
    assert_eq!(daemon.stop().code(), Some(0));
    assert!(!booth.log_names("99001"), "{}", booth.log());
}

#[test]
fn a_refused_scan_is_given_up_or_closed_by_the_same_patients_next_good_one() {
    let booth = Booth::new();
    let daemon = booth.start_ready();
    let refused = |count: u64| {
        booth.wait_for("the refusal", || booth.status()["scans"]["refused"] == count);
    };
    let (first, second) = (b"no scan\n".to_vec(), b"no scan either\n".to_vec());
    booth.export("4711_bad.obj", &first);
    refused(1);
    booth.export("4712_bad.obj", &second);
    refused(2);
    let given_up = &sha256(&second)[..8];
    said(&booth, &["give-up", given_up]);
    refused(1);
    assert_eq!(code(&booth.gaiter(&["give-up", given_up])), Some(64), "once is enough");
    booth.export("4711_good.obj", &coarse_body(6));
    booth.wait_for_records(1);
    refused(0);
    assert_eq!(booth.status()["scans"]["closed"], 2);
    let listed = said(&booth, &["scans", "--state", "refused"]);
    assert!(listed.contains("superseded") && listed.contains("given-up"), "{listed}");
    assert_eq!(listed.matches("closed").count(), 2, "{listed}");
    assert!(booth.log().contains("scan-given-up"), "{}", booth.log());
    // And it can still be tried again.
    said(&booth, &["retry", given_up]);
    refused(1);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_scan_whose_bytes_were_lost_is_taken_in_again_when_it_is_exported_again() {
    let booth = Booth::new();
    let daemon = booth.start_ready();
    let scan = coarse_body(7);
    booth.take_records_away();
    booth.export("4711_a.obj", &scan);
    booth.wait_for_journal(OPEN, 1);
    assert_eq!(daemon.stop().code(), Some(0));
    fs::remove_dir_all(booth.path("state/spool").join(sha256(&scan))).unwrap();
    let daemon = booth.start_ready();
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE code = 'spool-lost'", 1);
    fs::rename(booth.path("unmounted"), booth.path("records")).unwrap();
    booth.export("4711_a.obj", &scan);
    at_rest(&booth, "the record", &["4711"], &scan);
    assert!(booth.log().contains("scan-taken-again"), "{}", booth.log());
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_patients_folder_that_is_a_link_gets_no_record() {
    let booth = Booth::new();
    fs::create_dir(booth.path("records/4712")).unwrap();
    std::os::unix::fs::symlink("4712", booth.path("records/4711")).unwrap();
    let daemon = booth.start_ready();
    let scan = coarse_body(8);
    booth.export("4711_a.obj", &scan);
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", 1);
    assert_eq!(booth.reason(&scan)["code"], "patient-folder-is-a-link");
    assert_eq!(names(&booth.path("records/4712")), [""; 0]);
    fs::remove_file(booth.path("records/4711")).unwrap();
    said(&booth, &["retry", &sha256(&scan)[..8]]);
    at_rest(&booth, "the record", &["4711"], &scan);
    assert_eq!(daemon.stop().code(), Some(0));
}
