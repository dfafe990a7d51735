//! Custody on real folders: what is kept, for whom, and what a crash between two steps leaves.

use std::fs;

use super::*;
use crate::record::{Source, SourceKind};
use crate::station::quarantine::Stage;
use crate::store::sums;

const BYTES: &[u8] = b"v 0 0 0\n";

fn open(dir: &Path) -> Custody {
    let journal = Journal::open(&dir.join("journal.db")).unwrap();
    let spool = Spool::open(dir).unwrap();
    Custody::new(journal, spool, Quarantine::open(dir).unwrap(), vec!["folder"])
}

fn says(id: &str) -> NameSays {
    let sources = vec![Source { kind: SourceKind::FileName }];
    NameSays::Patient(Patient { id: id.to_owned(), sources })
}

fn admit(custody: &Custody, says: NameSays) -> Verdict {
    let scan = sums::scan_id(BYTES);
    let arrival = Arrival { scan: &scan, bytes: BYTES, format: Format::Obj, file_time: None, says };
    custody.admit(&arrival).unwrap()
}

fn reason() -> Reason {
    let seen = "2026-11-21T09:15:00Z".parse().unwrap();
    Reason::new("no-body", "no body in it".to_owned(), Stage::Measure, seen)
}

#[test]
fn bytes_are_kept_until_they_are_delivered() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    assert_eq!(admit(&custody, says("4711")), Verdict::New);
    assert_eq!(admit(&custody, says("4711")), Verdict::Already);
    let due = custody.journal.pending().unwrap();
    assert_eq!(due.len(), 1);
    assert_eq!(fs::read(custody.spool.scan_file(&scan, "obj")).unwrap(), BYTES);
    custody.delivered(&due[0], Path::new("/r/x")).unwrap();
    assert!(!custody.spool.holds(&scan));
    assert_eq!(admit(&custody, says("4711")), Verdict::Already);
    assert!(!custody.spool.holds(&scan));
}

#[test]
fn held_bytes_are_kept_and_never_delivered_by_themselves() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, says("4711"));
    let due = custody.journal.pending().unwrap();
    custody.delivered(&due[0], Path::new("/r/x")).unwrap();
    let first_seen = custody.journal.scan(&scan).unwrap().unwrap().first_seen;

    assert_eq!(admit(&custody, says("0815")), Verdict::Held);
    assert!(custody.journal.pending().unwrap().is_empty());
    let intake = custody.spool.intake(&scan).unwrap();
    assert_eq!((intake.held, intake.first_seen), (true, first_seen));
    custody.recover().unwrap();
    assert!(custody.spool.holds(&scan));

    // Even where the journal is lost, held bytes stay held.
    drop(custody);
    for file in ["journal.db", "journal.db-wal", "journal.db-shm"] {
        let _ = fs::remove_file(dir.path().join(file));
    }
    let custody = open(dir.path());
    assert_eq!(custody.recover().unwrap(), 1);
    assert!(custody.journal.pending().unwrap().is_empty());
    assert_eq!(custody.journal.patients(&scan).unwrap(), [Some("0815".to_owned())]);
    assert_eq!(custody.journal.scans_in(ScanState::Delivered).unwrap(), [scan]);
}

#[test]
fn a_delivery_made_while_another_is_held_leaves_the_bytes() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    admit(&custody, NameSays::Nothing);
    assert_eq!(admit(&custody, says("4711")), Verdict::Held);
    let due = custody.journal.pending().unwrap();
    custody.delivered(&due[0], Path::new("/r/x")).unwrap();
    assert!(custody.spool.holds(&sums::scan_id(BYTES)));
}

#[test]
fn spooled_bytes_that_the_journal_does_not_know_are_adopted_with_their_first_sight() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    let says = says("4711");
    let arrival = Arrival { scan: &scan, bytes: BYTES, format: Format::Obj, file_time: None, says };
    let NameSays::Patient(patient) = &arrival.says else { panic!() };
    let first_seen = "2026-11-21T09:15:00Z".parse().unwrap();
    let kept = Intake { first_seen, ..intake(&arrival, None, Some(patient), false) };
    custody.spool.keep(&scan, kept, BYTES).unwrap();
    // The crash was here. Either the start adopts it, or the file is seen again first.
    assert_eq!(custody.admit(&arrival).unwrap(), Verdict::Already);
    assert_eq!(custody.recover().unwrap(), 0);
    assert_eq!(custody.journal.scan(&scan).unwrap().unwrap().first_seen, first_seen);
    assert_eq!(custody.journal.pending().unwrap().len(), 1);
}

#[test]
fn a_refused_scan_lies_in_quarantine_with_its_reason_and_bytes() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, NameSays::Nothing);
    custody.refuse(&scan, &reason()).unwrap();
    assert!(!custody.spool.holds(&scan));
    assert_eq!(custody.quarantine.reason(&scan).unwrap(), Some(reason()));
    let place = dir.path().join("quarantine").join(scan.as_str());
    assert_eq!(fs::read(place.join("scan.obj")).unwrap(), BYTES);
    assert!(custody.journal.pending().unwrap().is_empty());
    assert_eq!(admit(&custody, NameSays::Nothing), Verdict::Already);
}

#[test]
fn a_crash_between_quarantine_and_journal_is_made_good() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, NameSays::Nothing);
    custody.quarantined(&scan, &reason()).unwrap();
    custody.recover().unwrap();
    assert!(custody.journal.pending().unwrap().is_empty());
    assert_eq!(custody.journal.scans_in(ScanState::Refused).unwrap(), [scan]);
}

#[test]
fn a_crash_between_journal_and_spool_after_delivery_is_made_good() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, NameSays::Nothing);
    let due = custody.journal.pending().unwrap();
    custody.journal.delivered(&due[0], Path::new("/r/x")).unwrap();
    custody.recover().unwrap();
    assert!(!custody.spool.holds(&scan));
}

#[test]
fn bytes_removed_from_outside_end_in_a_named_refusal() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, NameSays::Nothing);
    fs::remove_dir_all(custody.spool.entry(&scan)).unwrap();
    custody.recover().unwrap();
    assert!(custody.journal.pending().unwrap().is_empty());
    assert_eq!(custody.quarantine.reason(&scan).unwrap().unwrap().code, "spool-lost");
}

#[test]
fn a_damaged_intake_is_quarantined_and_does_not_stop_the_start() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    fs::create_dir(custody.spool.entry(&scan)).unwrap();
    fs::write(custody.spool.entry(&scan).join("intake.json"), "{").unwrap();
    custody.recover().unwrap();
    assert_eq!(custody.quarantine.reason(&scan).unwrap().unwrap().code, "spool-damaged");
}
