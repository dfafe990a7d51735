//! Decisions that outlive the journal, and what a crash between the two leaves.

use std::fs;
use std::path::Path;

use gaiter_flow::{DeliveryState, Whose};
use gaiter_record::Acquired;

use super::super::tests::{
    BYTES, admit, erase, found_record, open, open_with_server, patient, reason, says, stored,
};
use super::super::{Acted, Verdict};
use super::*;
use crate::station::journal::{Due, Task};
use crate::store::sums;

/// Custody whose journal was lost, at its next start.
fn rebuilt(custody: Custody, dir: &Path) -> Custody {
    rebuilt_by(open, custody, dir)
}

fn rebuilt_by(open: fn(&Path) -> Custody, custody: Custody, dir: &Path) -> Custody {
    drop(custody);
    for file in ["journal.db", "journal.db-wal", "journal.db-shm", "history.head"] {
        let _ = fs::remove_file(dir.join(file));
    }
    started(open(dir))
}

/// Custody after what a start does.
fn started(custody: Custody) -> Custody {
    custody.recover().unwrap();
    custody.adopt_quarantined().unwrap();
    assert_eq!(custody.carry_out().unwrap(), []);
    custody
}

/// 4711's scan, delivered, with its bytes gone from the spool.
fn delivered(custody: &Custody) -> ScanRow {
    admit(custody, says("4711"));
    let due = custody.journal.pending().unwrap();
    custody.delivered(&due[0], Path::new("/r/4711/x")).unwrap();
    custody.journal.scan(&sums::scan_id(BYTES)).unwrap().unwrap()
}

/// What to do: for whom, and what.
fn to_do(custody: &Custody) -> Vec<(String, Task)> {
    let due = custody.journal.pending().unwrap();
    due.iter().map(|due| (due.patient_cell().to_owned(), due.task)).collect()
}

fn deliver(custody: &Custody) {
    for due in custody.journal.pending().unwrap() {
        if due.task == Task::Deliver {
            custody.delivered(&due, Path::new("/r/x")).unwrap();
        }
    }
}

#[test]
fn what_was_taken_back_is_not_the_patients_again_when_the_journal_is_lost() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let row = delivered(&custody);
    assert_eq!(custody.unassign(&row, "4711", Some(stored())).unwrap(), Acted::Done(1));
    // The store is away, so nothing is done of it; the bytes are in the spool again.
    let custody = rebuilt(custody, dir.path());
    assert_eq!(to_do(&custody), [(String::new(), Task::Deliver)]);
    let record = found_record();
    assert!(custody.contradicts(&record).unwrap());
    custody.found_against(&record, "folder", None).unwrap();
    assert_eq!(custody.journal.owners(&row.scan).unwrap(), [""; 0]);
    deliver(&custody);
    assert_eq!(to_do(&custody), [("4711".to_owned(), Task::Withdraw)]);
}

#[test]
fn a_record_found_with_the_wrong_patient_gives_its_bytes_to_the_right_one() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let row = delivered(&custody);
    custody.unassign(&row, "4711", Some(stored())).unwrap();
    custody.assign(&row, &patient("0815"), None).unwrap();
    deliver(&custody);
    assert!(!custody.spool.holds(&row.scan), "the bytes have served");
    // The journal is lost, and so is 0815's record; somebody put 4711's back from a backup.
    let custody = rebuilt(custody, dir.path());
    assert!(custody.journal.scan(&row.scan).unwrap().is_none());
    custody.found_against(&found_record(), "folder", Some(stored())).unwrap();
    assert_eq!(fs::read(custody.spool.scan_file(&row.scan, "obj")).unwrap(), BYTES);
    assert_eq!(to_do(&custody), [("0815".to_owned(), Task::Deliver)]);
    deliver(&custody);
    assert_eq!(to_do(&custody), [("4711".to_owned(), Task::Withdraw)]);
    assert_eq!(custody.journal.owners(&row.scan).unwrap(), ["0815"]);
}

#[test]
fn a_wrong_record_beside_the_right_one_goes_without_any_bytes() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let row = delivered(&custody);
    custody.unassign(&row, "4711", Some(stored())).unwrap();
    deliver(&custody);
    let custody = rebuilt(custody, dir.path());
    let unassigned = FoundRecord { patient: None, ..found_record() };
    assert!(!custody.contradicts(&unassigned).unwrap());
    custody.found(&unassigned, "folder").unwrap();
    custody.found_against(&found_record(), "folder", Some(stored())).unwrap();
    assert_eq!(to_do(&custody), [("4711".to_owned(), Task::Withdraw)]);
}

#[test]
fn a_decision_that_a_crash_cut_off_before_the_journal_is_carried_out_once() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    admit(&custody, says("4711"));
    let scan = sums::scan_id(BYTES);
    let cut_off = Decision {
        at: Timestamp::now(),
        what: Decided::Unassigned,
        patient: Some("4711".to_owned()),
        request: None,
    };
    custody.decisions.keep(&scan, &[cut_off]).unwrap();
    let custody = started(custody);
    assert_eq!(to_do(&custody), [(String::new(), Task::Deliver)]);
    let events = |custody: &Custody| custody.journal.history(&scan).unwrap().len();
    let before = events(&custody);
    let custody = started(custody);
    assert_eq!(events(&custody), before);
}

#[test]
fn a_decision_that_the_journal_did_not_take_is_none() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    let fails = |_: &Journal, _| Err(JournalError::Gone);
    custody.decide(&scan, &[(Decided::GivenUp, None)], fails).unwrap_err();
    assert_eq!(custody.decisions.of(&scan).unwrap(), []);
    custody.decide(&scan, &[(Decided::Assigned, Some("1".to_owned()))], |_, _| Ok(())).unwrap();
    custody.decide(&scan, &[(Decided::GivenUp, None)], fails).unwrap_err();
    assert_eq!(custody.decisions.of(&scan).unwrap().len(), 1);
}

#[test]
fn a_release_and_what_was_given_up_outlive_the_journal() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    let held = Whose { held: Some("no-press"), ..says("4711") };
    assert_eq!(admit(&custody, held), Verdict::Held("no-press"));
    assert_eq!(custody.release(&scan).unwrap(), Acted::Done(1));
    let custody = rebuilt(custody, dir.path());
    assert_eq!(to_do(&custody), [("4711".to_owned(), Task::Deliver)]);

    custody.refuse(&scan, reason()).unwrap();
    assert_eq!(custody.give_up(&scan).unwrap(), Acted::Done(0));
    let custody = rebuilt(custody, dir.path());
    assert_eq!(custody.journal.open_tasks(9, Timestamp::MAX).unwrap(), []);
    assert_eq!(custody.retry(&scan).unwrap(), Acted::Done(1));
    custody.refuse(&scan, reason()).unwrap();
    let custody = rebuilt(custody, dir.path());
    assert_eq!(
        custody.journal.open_tasks(9, Timestamp::MAX).unwrap(),
        [scan],
        "it was tried again since"
    );
}

#[test]
fn bytes_that_come_again_before_the_store_is_back_go_to_whom_they_were_given() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let row = delivered(&custody);
    custody.unassign(&row, "4711", Some(stored())).unwrap();
    custody.assign(&row, &patient("0815"), None).unwrap();
    deliver(&custody);
    let custody = rebuilt(custody, dir.path());
    assert_eq!(admit(&custody, says("4711")), Verdict::New);
    assert_eq!(to_do(&custody), [("0815".to_owned(), Task::Deliver)]);
}

#[test]
fn decisions_are_kept_as_long_as_the_journal_knows_their_scan() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let row = delivered(&custody);
    custody.unassign(&row, "4711", Some(stored())).unwrap();
    let future = "2099-01-01T00:00:00Z".parse().unwrap();
    assert_eq!(custody.forget(future).unwrap(), 0, "something is to be done");
    deliver(&custody);
    for due in custody.journal.pending().unwrap() {
        custody.journal.withdrawn(&due).unwrap();
    }
    let other = ScanId::of_digest([9; 32]);
    let decisions = custody.decisions.of(&row.scan).unwrap();
    custody.decisions.keep(&other, &decisions).unwrap();
    custody.journal.begin_anew(&["folder"], "a test").unwrap();
    assert_eq!(custody.forget("2001-01-01T00:00:00Z".parse().unwrap()).unwrap(), 0);
    assert_eq!(custody.decisions.scans().unwrap().len(), 2, "the store may know that scan");
    custody.journal.searched("folder").unwrap();
    assert_eq!(custody.forget(future).unwrap(), 1);
    assert_eq!(custody.decisions.scans().unwrap(), []);
}

#[test]
fn decisions_that_cannot_be_read_stop_no_start_and_are_told() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, says("4711"));
    fs::write(dir.path().join(format!("decisions/{scan}.json")), "{").unwrap();
    assert_eq!(custody.carry_out().unwrap(), [scan]);
    assert!(!custody.contradicts(&found_record()).unwrap());
}

#[test]
fn a_release_or_an_assignment_is_for_exactly_one_person() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let row = delivered(&custody);
    admit(&custody, says("0815"));
    admit(&custody, says("1003"));
    assert_eq!(custody.release(&row.scan).unwrap(), Acted::Several);
    assert_eq!(custody.assign(&row, &patient("0815"), None).unwrap(), Acted::HasPatient);
    assert!(to_do(&custody).is_empty());
    let held = custody.journal.deliveries_in(&row.scan, DeliveryState::Held).unwrap();
    assert_eq!(held.len(), 2, "both still wait");
    assert_eq!(custody.unassign(&row, "0815", None).unwrap(), Acted::Nothing, "it is not theirs");
    custody.unassign(&row, "4711", None).unwrap();
    assert_eq!(custody.assign(&row, &patient("0815"), None).unwrap(), Acted::Done(1));
    assert_eq!(custody.assign(&row, &patient("1003"), None).unwrap(), Acted::HasPatient);
    assert_eq!(custody.journal.owners(&row.scan).unwrap(), ["0815"]);
}

#[test]
fn a_held_duplicate_is_given_up_and_its_bytes_go_as_others_that_have_served() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let row = delivered(&custody);
    admit(&custody, says("0815"));
    assert_eq!(
        custody.journal.open_tasks(9, Timestamp::MAX).unwrap(),
        std::slice::from_ref(&row.scan)
    );
    assert_eq!(custody.give_up(&row.scan).unwrap(), Acted::Done(0));
    assert_eq!(custody.give_up(&row.scan).unwrap(), Acted::Nothing);
    assert_eq!(custody.journal.open_tasks(9, Timestamp::MAX).unwrap(), []);
    assert!(custody.journal.has_served(&row.scan).unwrap());
    assert_eq!(custody.release(&row.scan).unwrap(), Acted::Done(1), "it still can be decided");
    let due: Vec<Due> = custody.journal.pending().unwrap();
    assert_eq!(due[0].patient_cell(), "0815");
}

#[test]
fn a_held_scan_without_a_record_is_given_up_and_its_bytes_stay_as_those_of_a_refused_one() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, Whose { held: Some("no-press"), ..says("4711") });
    assert_eq!(custody.give_up(&scan).unwrap(), Acted::Done(0));
    assert_eq!(custody.journal.open_tasks(9, Timestamp::MAX).unwrap(), []);
    let later = Timestamp::now() + jiff::SignedDuration::from_hours(1);
    assert_eq!(custody.let_go_spooled(later).unwrap(), 0, "no record holds these bytes");
    assert_eq!(custody.forget(later).unwrap(), 0);
    let row = custody.journal.scan(&scan).unwrap().unwrap();
    assert_eq!(custody.assign(&row, &patient("0815"), None).unwrap(), Acted::Done(1));
    assert_eq!(custody.journal.owners(&scan).unwrap(), ["0815"]);
}

#[test]
fn the_bytes_of_what_was_given_up_without_a_record_go_with_the_time_of_refused_ones() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, Whose { held: Some("no-press"), ..says("4711") });
    let later = Timestamp::now() + jiff::SignedDuration::from_hours(1);
    assert_eq!(custody.let_go_quarantined(later).unwrap(), 0, "it still waits for a decision");
    custody.give_up(&scan).unwrap();
    assert_eq!(custody.let_go_quarantined(Timestamp::UNIX_EPOCH).unwrap(), 0);
    assert_eq!(custody.let_go_quarantined(later).unwrap(), 1);
    assert!(!custody.holds(&scan));
}

#[test]
fn a_record_without_a_patient_waits_for_a_decision_until_it_is_left_so() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, Whose::default());
    assert_eq!(
        custody.journal.open_tasks(9, Timestamp::MAX).unwrap(),
        [],
        "its record is not made yet"
    );
    let due = custody.journal.pending().unwrap();
    custody.delivered(&due[0], Path::new("/r/_unassigned/x")).unwrap();
    assert_eq!(custody.journal.open_tasks(9, Timestamp::MAX).unwrap(), std::slice::from_ref(&scan));
    assert_eq!(custody.journal.count_open_tasks(Timestamp::MAX).unwrap(), 1);
    assert_eq!(custody.give_up(&scan).unwrap(), Acted::Done(0));
    assert_eq!(custody.journal.open_tasks(9, Timestamp::MAX).unwrap(), []);
    let row = custody.journal.scan(&scan).unwrap().unwrap();
    let assigned = custody.assign(&row, &patient("4711"), Some(stored()));
    assert_eq!(assigned.unwrap(), Acted::Done(1), "it can still be assigned");
}

#[test]
fn a_scan_of_two_patients_is_taken_back_from_one_and_stays_with_the_other() {
    for loses_journal in [false, true] {
        let dir = tempfile::tempdir().unwrap();
        let mut custody = open(dir.path());
        let row = delivered(&custody);
        admit(&custody, says("0815"));
        custody.release(&row.scan).unwrap();
        let due = custody.journal.pending().unwrap();
        custody.delivered(&due[0], Path::new("/r/0815/x")).unwrap();
        assert_eq!(custody.journal.owners(&row.scan).unwrap(), ["0815", "4711"]);
        assert_eq!(custody.unassign(&row, "4711", Some(stored())).unwrap(), Acted::Done(1));
        if loses_journal {
            custody = rebuilt(custody, dir.path());
            // The stores are searched at the start.
            assert!(custody.contradicts(&found_record()).unwrap(), "4711's record must go");
        }
        assert_eq!(custody.journal.owners(&row.scan).unwrap(), ["0815"]);
    }
}

#[test]
fn which_request_a_scan_answers_outlives_the_journal_by_its_record_and_by_the_decisions_about_it() {
    let dir = tempfile::tempdir().unwrap();
    let mut custody = open_with_server(dir.path());
    let request = ImagingRequest::new("1.2.276.4711", "A1");
    let at_server = |custody: &Custody| {
        let due = custody.journal.pending().unwrap();
        let due = due.into_iter().find(|due| due.store == "fhir").unwrap();
        (due.task, due.patient.unwrap().request().cloned())
    };
    let row = |custody: &Custody| custody.journal.scan(&sums::scan_id(BYTES)).unwrap().unwrap();
    let chosen = Some(by_operator("4711", request.clone()));
    admit(&custody, Whose { patient: chosen, ..Whose::default() });
    deliver(&custody);
    // Lost while the record is in the folder.
    custody = rebuilt_by(open_with_server, custody, dir.path());
    let at = "2026-11-20T09:14:00Z".parse().unwrap();
    let acquired = Some(Acquired::new(at, AcquiredFrom::Press));
    let record = FoundRecord { request: request.clone(), acquired, ..found_record() };
    custody.found(&record, "folder").unwrap();
    assert_eq!((row(&custody).pressed_at, row(&custody).file_time), (Some(at), None));
    custody.unassign(&row(&custody), "4711", Some(stored())).unwrap();
    assert_eq!(at_server(&custody), (Task::Withdraw, request.clone()));
    // Lost when the folder has given it up, and the server has not answered.
    custody = rebuilt_by(open_with_server, custody, dir.path());
    assert_eq!(at_server(&custody), (Task::Withdraw, request.clone()));
    // Lost before it was sent again.
    custody.assign(&row(&custody), &patient("4711"), None).unwrap();
    custody = rebuilt_by(open_with_server, custody, dir.path());
    assert_eq!(at_server(&custody), (Task::Deliver, request));
}

#[test]
fn a_decision_keeps_neither_id_nor_request_of_a_person_who_was_erased() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open(dir.path());
    let chosen = Some(by_operator("4711", ImagingRequest::new("1.2.276.4711", "A1")));
    admit(&custody, Whose { patient: chosen, ..Whose::default() });
    deliver(&custody);
    let row = custody.journal.scan(&sums::scan_id(BYTES)).unwrap().unwrap();
    custody.unassign(&row, "4711", Some(stored())).unwrap();
    custody.assign(&row, &patient("0815"), None).unwrap();
    let holds = |text: &str| {
        let file = dir.path().join(format!("decisions/{}.json", row.scan));
        fs::read_to_string(file).unwrap().contains(text)
    };
    assert!(holds("\"4711\"") && holds("\"1.2.276.4711\""));
    erase(&custody, dir.path(), "4711");
    assert!(holds("\"0815\"") && !holds("\"4711\"") && !holds("\"1.2.276.4711\""));
}

#[test]
fn after_the_loss_of_the_journal_nothing_is_sent_again_and_what_a_server_has_is_still_taken_back() {
    let dir = tempfile::tempdir().unwrap();
    let custody = open_with_server(dir.path());
    let scan = sums::scan_id(BYTES);
    admit(&custody, says("4711"));
    deliver(&custody);
    assert!(!custody.spool.holds(&scan));
    let custody = rebuilt_by(open_with_server, custody, dir.path());
    custody.found(&found_record(), "folder").unwrap();
    assert!(to_do(&custody).is_empty());
    let row = custody.journal.scan(&scan).unwrap().unwrap();
    custody.unassign(&row, "4711", Some(stored())).unwrap();
    let expected = [(String::new(), Task::Deliver), ("4711".to_owned(), Task::Withdraw)];
    let sorted = |custody: &Custody| {
        let mut all = to_do(custody);
        all.sort();
        all
    };
    assert_eq!(sorted(&custody), expected);
    // Lost again before the server had answered.
    let custody = rebuilt_by(open_with_server, custody, dir.path());
    assert_eq!(sorted(&custody), expected);
}
