//! Custody on real folders: what is kept, for whom, and what a crash between two steps leaves.

use std::fs;
use std::sync::atomic::Ordering;

use gaiter_flow::patient::erasure::{ERASED, OwedStep};
use gaiter_flow::patient::identity::{PATIENTS_DIFFER, SAME_SCAN_OTHER_PATIENT};
use gaiter_flow::patient::person::WhoseScan;
use gaiter_flow::{Disposition, Stamp};
use gaiter_record::{ImagingRequest, Source, SourceKind};

use super::*;
use crate::station::custody::quarantine::Stage;
use crate::station::custody::spool::Intake;
use crate::station::journal::Task;
use crate::store::{FoundRecord, StoredScan, sums};

pub(super) const BYTES: &[u8] = b"v 0 0 0\n";

pub(super) fn open(dir: &Path) -> Custody {
    open_for(dir, vec!["folder"])
}

fn open_for(dir: &Path, stores: Vec<&'static str>) -> Custody {
    let journal = Journal::open(&dir.join("journal.db")).unwrap();
    Custody::open(dir, journal, stores, Duration::ZERO).unwrap()
}

/// The same, with a hospital's server as a second store.
pub(super) fn open_with_server(dir: &Path) -> Custody {
    let custody = open_for(dir, vec!["folder", "fhir"]);
    Custody { named_only: vec!["fhir"], ..custody }.with_servers(vec!["fhir"]).unwrap()
}

pub(super) fn patient(id: &str) -> Patient {
    Patient { id: id.to_owned(), sources: vec![Source::from_kind(SourceKind::FileName)] }
}

pub(super) fn says(id: &str) -> Whose {
    Whose { patient: Some(patient(id)), ..Whose::default() }
}

pub(super) fn arrival(scan: &ScanId, whose: Whose) -> Arrival<'_> {
    Arrival {
        scan,
        bytes: BYTES,
        format: Format::Obj,
        file_time: None,
        whose,
        judged: CaptureMatch::Unpressed,
        pressed_at: None,
        companions: &[],
        geometry: "",
        known: None,
    }
}

pub(super) fn admit(custody: &Custody, whose: Whose) -> Verdict {
    let scan = sums::scan_id(BYTES);
    custody.enter_kept(|_, _| {}).unwrap();
    let known = custody.known(&scan, "").unwrap();
    custody.admit(&Arrival { known, ..arrival(&scan, whose) }).unwrap()
}

pub(super) fn stored() -> StoredScan {
    StoredScan { bytes: BYTES.to_vec(), ord: Some(b"MEASURE Calf=1\n".to_vec()) }
}

/// 4711's record of the scan, found in a store.
pub(super) fn found_record() -> FoundRecord {
    FoundRecord {
        scan: sums::scan_id(BYTES),
        patient: Some("4711".to_owned()),
        request: None,
        acquired: None,
        first_seen: "2026-11-20T09:15:00Z".parse().unwrap(),
        format: "obj".to_owned(),
        size: 8,
        folder: "/r/4711/x".into(),
    }
}

pub(super) fn reason() -> Reason {
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

    assert_eq!(admit(&custody, says("0815")), Verdict::Held(SAME_SCAN_OTHER_PATIENT));
    assert!(custody.journal.pending().unwrap().is_empty());
    let intake = custody.spool.intake(&scan).unwrap();
    assert_eq!((intake.held, intake.first_seen), (true, first_seen));
    custody.recover().unwrap();
    assert!(custody.spool.holds(&scan));

    // Even where the journal is lost, held bytes stay held.
    drop(custody);
    for file in ["journal.db", "journal.db-wal", "journal.db-shm", "history.head"] {
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
    admit(&custody, Whose::default());
    assert_eq!(admit(&custody, says("4711")), Verdict::Held(SAME_SCAN_OTHER_PATIENT));
    let due = custody.journal.pending().unwrap();
    custody.delivered(&due[0], Path::new("/r/x")).unwrap();
    assert!(custody.spool.holds(&sums::scan_id(BYTES)));
}

#[test]
fn spooled_bytes_that_the_journal_does_not_know_are_adopted_with_their_first_sight() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    let arrival = arrival(&scan, says("4711"));
    let first_seen = "2026-11-21T09:15:00Z".parse().unwrap();
    let kept = Intake { first_seen, ..intake(&arrival, None, None) };
    custody.spool.keep(&scan, kept, BYTES, &[]).unwrap();
    custody.unentered.store(true, Ordering::Relaxed);
    // The journal failed here. Either a start adopts it, or the file is seen again first.
    assert_eq!(admit(&custody, says("4711")), Verdict::Already);
    assert_eq!(custody.recover().unwrap(), 0);
    assert_eq!(custody.journal.scan(&scan).unwrap().unwrap().first_seen, first_seen);
    assert_eq!(custody.journal.pending().unwrap().len(), 1);
}

#[test]
fn every_scan_that_was_kept_and_not_entered_is_entered_before_the_next_and_told_once() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let both = [BYTES, b"v 1 1 1\n"];
    for bytes in both {
        let scan = sums::scan_id(bytes);
        let arrival = Arrival { bytes, ..arrival(&scan, says("4711")) };
        let kept = intake(&arrival, None, None);
        custody.spool.keep(&scan, kept, bytes, &[]).unwrap();
    }
    custody.unentered.store(true, Ordering::Relaxed);
    let mut entered = Vec::new();
    custody.enter_kept(|scan, _| entered.push(scan.clone())).unwrap();
    custody.enter_kept(|scan, _| entered.push(scan.clone())).unwrap();
    entered.sort();
    let mut expected = both.map(sums::scan_id);
    expected.sort();
    assert_eq!(entered, expected);
}

#[test]
fn a_content_that_begins_with_what_the_same_file_was_is_whose_that_was() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    admit(&custody, says("4711"));
    let grown = [BYTES, b"v 1 1 1\n"].concat();
    let whose = |bytes: &[u8], read: &[u64]| {
        let whose = custody.completed_by(bytes, read).unwrap();
        whose.map(|whose| whose.into_iter().map(|named| named.id).collect::<Vec<_>>())
    };
    assert_eq!(whose(&grown, &[8]), Some(vec!["4711".to_owned()]));
    assert_eq!(whose(&grown, &[4]), None, "no scan came in at that length");
    assert_eq!(whose(&grown, &[]), None, "a short beginning in another file tells nothing");
    assert_eq!(whose(BYTES, &[8]), None, "it has not grown");
}

#[test]
fn a_refused_scan_lies_in_quarantine_with_its_reason_and_bytes() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, Whose::default());
    custody.refuse(&scan, reason()).unwrap();
    assert!(!custody.spool.holds(&scan));
    assert_eq!(custody.quarantine.reason(&scan).unwrap(), Some(reason()));
    let place = dir.path().join("quarantine").join(scan.as_str());
    assert_eq!(fs::read(place.join("scan.obj")).unwrap(), BYTES);
    assert!(custody.journal.pending().unwrap().is_empty());
    assert_eq!(admit(&custody, Whose::default()), Verdict::Already);
}

#[test]
fn a_crash_between_quarantine_and_journal_is_made_good() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, Whose::default());
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
    admit(&custody, Whose::default());
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
    admit(&custody, Whose::default());
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

/// A scan that was refused while it was measured.
pub(super) fn refused(custody: &Custody) -> ScanId {
    let scan = sums::scan_id(BYTES);
    admit(custody, says("4711"));
    custody.refuse(&scan, reason()).unwrap();
    scan
}

#[test]
fn a_refused_scan_that_is_retried_is_to_be_delivered_and_back_in_the_spool() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = refused(&custody);
    assert_eq!(custody.retry(&scan).unwrap(), Acted::Done(1));
    assert_eq!(custody.journal.pending().unwrap().len(), 1);
    assert_eq!(fs::read(custody.spool.scan_file(&scan, "obj")).unwrap(), BYTES);
    assert!(!custody.quarantine.holds(&scan));
    assert_eq!(custody.retry(&scan).unwrap(), Acted::Nothing);
    // And refused again, with its reason.
    custody.refuse(&scan, reason()).unwrap();
    assert_eq!(custody.quarantine.reason(&scan).unwrap(), Some(reason()));
    let events: Vec<String> =
        custody.journal.history(&scan).unwrap().into_iter().map(|row| row.event).collect();
    assert_eq!(events, ["entered", "refused", "retried", "refused"]);
}

#[test]
fn the_first_reason_of_a_refusal_stands_and_is_the_one_that_is_told() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, says("4711"));
    // As where the journal failed then: the next attempt finds the spool without the bytes.
    custody.quarantined(&scan, &reason()).unwrap();
    let lost = Reason { code: "spool-lost".to_owned(), ..reason() };
    assert_eq!(custody.refuse(&scan, lost).unwrap(), reason());
    assert_eq!(custody.quarantine.reason(&scan).unwrap(), Some(reason()));
}

#[test]
fn a_scan_whose_bytes_are_gone_cannot_be_retried() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = refused(&custody);
    fs::remove_dir_all(dir.path().join("quarantine").join(scan.as_str())).unwrap();
    assert_eq!(custody.retry(&scan).unwrap(), Acted::NoBytes);
    assert!(custody.journal.pending().unwrap().is_empty());
}

#[test]
fn a_held_scan_that_is_released_goes_to_the_patient_it_was_held_for_and_to_nobody_else() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, says("4711"));
    let due = custody.journal.pending().unwrap();
    custody.delivered(&due[0], Path::new("/r/4711/x")).unwrap();
    admit(&custody, says("0815"));
    assert_eq!(custody.release(&scan).unwrap(), Acted::Done(1));
    let due = custody.journal.pending().unwrap();
    assert_eq!(due.iter().map(Due::patient_cell).collect::<Vec<_>>(), ["0815"]);
    custody.delivered(&due[0], Path::new("/r/0815/x")).unwrap();
    assert!(!custody.spool.holds(&scan), "nothing is pending, held or refused any more");
}

pub(super) fn erase(custody: &Custody, state_dir: &Path, id: &str) {
    custody.ask_for_erasure(id, "uid 0", false).unwrap();
    let whose = custody.erasures().hash(id);
    let erasure = custody.erasures().of(&whose).unwrap();
    custody.clear_own(&whose, erasure, id, state_dir).unwrap();
}

#[test]
fn a_held_scan_keeps_that_it_may_be_an_erased_persons_until_all_it_may_belong_to_are_erased() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    let claims = vec![patient("4711"), patient("0815")];
    let whose = Whose { held: Some(PATIENTS_DIFFER), claims, ..Whose::default() };
    assert_eq!(admit(&custody, whose), Verdict::Held(PATIENTS_DIFFER));
    let theirs = custody.journal.scans_of_person("4711").unwrap();
    assert!(!custody.goes_whole(&theirs[0], "4711").unwrap(), "it may be 0815's");
    erase(&custody, dir.path(), "4711");
    assert_eq!(custody.journal.candidates(&scan).unwrap(), ["0815", ERASED]);
    // A journal that is made again has the same.
    assert_eq!(custody.spool.intake(&scan).unwrap().candidates, ["0815", ERASED]);
    assert_eq!(custody.release(&scan).unwrap(), Acted::Several);
    // What the next erasure will do is known before.
    let theirs = custody.journal.scans_of_person("0815").unwrap();
    assert_eq!(theirs.iter().map(|of| of.whose).collect::<Vec<_>>(), [WhoseScan::Uncertain]);
    assert!(custody.goes_whole(&theirs[0], "0815").unwrap());
    erase(&custody, dir.path(), "0815");
    assert_eq!(custody.journal.scan(&scan).unwrap(), None);
    assert!(!custody.spool.holds(&scan), "nobody is left who could decide whose it is");
}

#[test]
fn a_scan_for_nobody_that_is_assigned_is_delivered_to_the_patient_and_then_taken_back() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, Whose::default());
    let due = custody.journal.pending().unwrap();
    custody.delivered(&due[0], Path::new("/r/_unassigned/x")).unwrap();
    let row = custody.journal.scan(&scan).unwrap().unwrap();
    let patient = patient("4711");
    assert_eq!(custody.assign(&row, &patient, None).unwrap(), Acted::NoBytes);
    assert_eq!(custody.assign(&row, &patient, Some(stored())).unwrap(), Acted::Done(1));

    let due = custody.journal.pending().unwrap();
    assert_eq!((due.len(), due[0].patient_cell(), due[0].task), (1, "4711", Task::Deliver));
    custody.delivered(&due[0], Path::new("/r/4711/x")).unwrap();
    let due = custody.journal.pending().unwrap();
    assert_eq!((due.len(), due[0].patient_cell(), due[0].task), (1, "", Task::Withdraw));
    let has = custody.journal.keeper(&scan, "folder").unwrap();
    assert_eq!(has, Some(Some("4711".to_owned())));
    custody.journal.withdrawn(&due[0]).unwrap();
    assert!(custody.journal.pending().unwrap().is_empty());
    assert_eq!(
        admit(&custody, says("0815")),
        Verdict::Held(SAME_SCAN_OTHER_PATIENT),
        "it is 4711's"
    );
}

#[test]
fn a_scan_that_is_given_back_to_its_patient_still_answers_its_request() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open_with_server(dir.path());
    let scan = sums::scan_id(BYTES);
    let request = ImagingRequest::new("1.2.276.4711", "A1");
    let sources = vec![Source::from_kind(SourceKind::Operator).with_request(request.clone())];
    let chosen = Patient { id: "4711".to_owned(), sources };
    admit(&custody, Whose { patient: Some(chosen), ..Whose::default() });
    for due in custody.journal.pending().unwrap() {
        custody.delivered(&due, Path::new("/r/4711/x")).unwrap();
    }
    let row = custody.journal.scan(&scan).unwrap().unwrap();
    custody.unassign(&row, "4711", Some(stored())).unwrap();
    let of_server = || {
        let due = custody.journal.pending().unwrap();
        let due = due.into_iter().find(|due| due.store == "fhir").unwrap();
        (due.task, due.patient.unwrap().request().cloned())
    };
    assert_eq!(of_server(), (Task::Withdraw, request.clone()));
    custody.assign(&row, &patient("4711"), None).unwrap();
    assert_eq!(of_server(), (Task::Deliver, request));
    assert_eq!(custody.journal.request_of(&scan, "0815").unwrap(), None);
}

#[test]
fn a_rebuilt_journal_learns_from_the_store_and_holds_what_it_would_have_held() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    // In ignorance of the store: two sightings of one scan, one of them 4711's record long since.
    admit(&custody, says("0815"));
    let record = found_record();
    custody.found(&record, "folder").unwrap();
    assert!(custody.journal.pending().unwrap().is_empty(), "held, not delivered to 0815");
    assert!(custody.journal.whole(&scan).unwrap().unwrap().held_for().is_some());
    assert!(custody.spool.holds(&scan), "a person may still release it");
    custody.found(&record, "folder").unwrap();
    assert_eq!(custody.journal.patients(&scan).unwrap().len(), 2);
}

#[test]
fn a_record_found_in_the_store_is_not_delivered_again() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, Whose::default());
    let record = found_record();
    custody.found(&record, "folder").unwrap();
    assert!(custody.journal.pending().unwrap().is_empty(), "naming nobody adds nothing");
    assert!(!custody.spool.holds(&scan));
    assert_eq!(custody.journal.scan(&scan).unwrap().unwrap().state, ScanState::Delivered);
}

#[test]
fn a_store_that_never_takes_a_record_does_not_cost_the_other_store_its_own() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open_for(dir.path(), vec!["folder", "copy"]);
    let scan = sums::scan_id(BYTES);
    admit(&custody, says("4711"));
    let due = custody.journal.pending().unwrap();
    let (copy, folder) = match due[0].store.as_str() {
        "copy" => (&due[0], &due[1]),
        _ => (&due[1], &due[0]),
    };
    let occupied = Reason { stage: Stage::Store, ..reason() };
    assert_eq!(custody.refuse_delivery(copy, occupied.clone()).unwrap(), Some(occupied.clone()));
    assert!(custody.spool.holds(&scan));
    custody.delivered(folder, Path::new("/r/x")).unwrap();
    // Red while the scan counted as delivered: nobody was asked about the record that the other store lacks.
    let whole = custody.journal.whole(&scan).unwrap().unwrap();
    assert_eq!(whole.disposition(), Disposition::Refused);
    assert_eq!(whole.summary.code.as_deref(), Some(occupied.code.as_str()));
    assert!(custody.quarantine.holds_bytes(&scan), "the refused delivery may be retried");
    assert!(!custody.spool.holds(&scan));
    assert_eq!(custody.retry(&scan).unwrap(), Acted::Done(1));
    let due = custody.journal.pending().unwrap();
    custody.refuse_delivery(&due[0], occupied.clone()).unwrap();
    assert!(custody.quarantine.holds(&scan), "the last of them refuses the scan");
}

#[test]
fn what_a_server_refuses_is_told_once_the_folder_has_it_and_can_be_given_to_another() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open_with_server(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, says("4711"));
    let pending = custody.journal.pending().unwrap();
    let (folder, server): (Vec<Due>, Vec<Due>) =
        pending.into_iter().partition(|due| due.store == "folder");
    // A server is slower than a folder.
    custody.delivered(&folder[0], Path::new("/r/4711/x")).unwrap();
    let unknown = "the server knows no patient of this id".to_owned();
    let seen = "2026-11-21T09:15:00Z".parse().unwrap();
    let why = Reason::new("patient-not-registered", unknown, Stage::Store, seen);
    custody.refuse_delivery(&server[0], why.clone()).unwrap();
    let whole = custody.journal.whole(&scan).unwrap().unwrap();
    assert_eq!(whole.disposition(), Disposition::Refused);
    assert_eq!(whole.summary.code, Some(why.code));
    assert!(custody.quarantine.holds_bytes(&scan));
    // The id was wrong.
    let row = custody.journal.scan(&scan).unwrap().unwrap();
    assert_eq!(custody.unassign(&row, "4711", None).unwrap(), Acted::Done(1));
    assert_eq!(custody.assign(&row, &patient("0815"), None).unwrap(), Acted::Done(2));
    assert_eq!(custody.retry(&scan).unwrap(), Acted::Done(2));
    for due in custody.journal.pending().unwrap() {
        match due.task {
            Task::Deliver => custody.delivered(&due, Path::new("/r/0815/x")).unwrap(),
            _ => custody.journal.withdrawn(&due).unwrap(),
        }
    }
    for due in custody.journal.pending().unwrap() {
        assert_eq!(due.task, Task::Withdraw);
        custody.journal.withdrawn(&due).unwrap();
    }
    let whole = custody.journal.whole(&scan).unwrap().unwrap();
    assert_eq!(whole.disposition(), Disposition::Delivered);
    assert_eq!(whole.owners().into_iter().collect::<Vec<_>>(), ["0815"]);
}

#[test]
fn an_erasure_waits_for_no_server_that_is_owed_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open_with_server(dir.path());
    custody.ask_for_erasure("4711", "uid 0", false).unwrap();
    let awaited: Vec<String> = custody.erasures().awaited_stores().into_iter().collect();
    assert_eq!(awaited, ["folder"]);
    assert!(!waits(&custody, "4711"));
}

fn waits(custody: &Custody, id: &str) -> bool {
    let whose = custody.erasures().hash(id);
    let mut erasure = custody.erasures().of(&whose).unwrap();
    custody.waits_for_servers(&whose, &mut erasure, id).unwrap()
}

#[test]
fn an_erasure_waits_for_what_a_server_is_owed_of_the_persons_scan_no_matter_whose_record_it_is() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open_with_server(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, says("4711"));
    let deliver = || {
        for due in custody.journal.pending().unwrap() {
            if due.task == Task::Deliver {
                let place = format!("/r/{}/{}", due.patient_cell(), due.store);
                custody.delivered(&due, Path::new(&place)).unwrap();
            }
        }
    };
    deliver();
    let row = custody.journal.scan(&scan).unwrap().unwrap();
    assert_eq!(custody.unassign(&row, "4711", Some(stored())).unwrap(), Acted::Done(1));
    assert_eq!(custody.assign(&row, &patient("0815"), Some(stored())).unwrap(), Acted::Done(2));
    deliver();
    // 4711's record is still to be taken back, also if all of the scan goes with 0815.
    for id in ["0815", "4711"] {
        custody.ask_for_erasure(id, "uid 0", false).unwrap();
        assert!(waits(&custody, id), "{id}");
        let erasure = custody.erasures().of(&custody.erasures().hash(id)).unwrap();
        let owed: Vec<_> = erasure.owed.iter().map(|of| (of.store.as_str(), of.step)).collect();
        assert_eq!(owed, [("fhir", OwedStep::TakeBack)], "{id}");
    }
    assert!(!custody.strike_owed().unwrap());
    for due in custody.journal.pending().unwrap() {
        custody.journal.withdrawn(&due).unwrap();
    }
    assert!(custody.strike_owed().unwrap());
    assert!(!waits(&custody, "0815") && !waits(&custody, "4711"));
}

#[test]
fn what_servers_are_owed_outlives_a_journal_that_was_lost_before_the_erasure_is_asked_for_again() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open_with_server(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, says("4711"));
    for due in custody.journal.pending().unwrap() {
        let place = format!("/r/4711/{}", due.store);
        custody.delivered(&due, Path::new(&place)).unwrap();
    }
    let row = custody.journal.scan(&scan).unwrap().unwrap();
    assert_eq!(custody.unassign(&row, "4711", Some(stored())).unwrap(), Acted::Done(1));
    custody.ask_for_erasure("4711", "uid 0", false).unwrap();
    let erasure = || custody.erasures().of(&custody.erasures().hash("4711")).unwrap();
    let owed = erasure().owed;
    assert_eq!(owed.len(), 1);
    // The journal no longer knows it, and reports that.
    for due in custody.journal.pending().unwrap() {
        custody.journal.withdrawn(&due).unwrap();
    }
    custody.journal.begin_anew(&["folder", "fhir"], "it was lost").unwrap();
    custody.ask_for_erasure("4711", "uid 0", false).unwrap();
    assert_eq!(erasure().owed, owed);
    assert!(waits(&custody, "4711"));
    custody.ask_for_erasure("4711", "uid 0", true).unwrap();
    assert_eq!((erasure().owed, erasure().left), (vec![], owed));
    assert!(!waits(&custody, "4711"));
}

#[test]
fn a_second_format_goes_with_the_scan_that_was_written_nearest_where_a_name_serves_everybody() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    // Two patients within ten minutes, each with both formats: only the second format is a sibling.
    for (name, written_s, expected) in
        [("a.obj", 0, false), ("a.stl", 5, true), ("a.obj", 300, false), ("a.stl", 305, true)]
    {
        let mtime_ns = written_s * 1_000_000_000;
        let stamp = Stamp { dev: 1, ino: 7, size: 8, mtime_ns, ctime_ns: mtime_ns };
        let path = Path::new("/export").join(name);
        assert_eq!(custody.is_sibling(&path, stamp).unwrap(), expected, "{name} {written_s}");
        custody.journal().sighted(&path, stamp, Some(&scan)).unwrap();
    }
}
