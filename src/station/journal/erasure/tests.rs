//! After an erasure the id is in no byte of the journal's files, and the journal is as sound as before.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::time::Duration;

use gaiter_flow::patient::person::WhoseScan;
use gaiter_flow::round::{
    Capture, CaptureMatch, CaptureState, Doubt, Names, Next, Opener, Rounds, Rules,
};
use gaiter_flow::{DeliveryState, DeliveryStep, OrderState, OrdersWhen, ScanState, Stamp};
use gaiter_record::{Patient, Source, SourceKind};
use serde_json::json;

use super::*;
use crate::station::journal::{BoothChange, Entry, ScanRow};

/// An id that no other text of these tests holds.
const ID: &str = "P-73190426";

const OTHER: &str = "P-51660018";

fn scan(digit: char) -> ScanId {
    ScanId::parse(&digit.to_string().repeat(64)).unwrap()
}

fn row(digit: char) -> ScanRow {
    ScanRow {
        scan: scan(digit),
        format: "obj".to_owned(),
        size: 12,
        first_seen: "2026-11-21T09:15:00Z".parse().unwrap(),
        file_time: None,
        pressed_at: None,
        state: ScanState::Spooled,
    }
}

fn enter(journal: &Journal, digit: char, id: &str, held: Option<&'static str>, others: &[&str]) {
    let patient =
        Patient { id: id.to_owned(), sources: vec![Source::from_kind(SourceKind::FileName)] };
    let candidates: Vec<String> = others.iter().map(|id| (*id).to_owned()).collect();
    let claims = [patient.clone()];
    let entry = Entry {
        row: &row(digit),
        patient: Some(&patient),
        held,
        claims: if held.is_some() { &claims } else { &[] },
        judged: &CaptureMatch::Unpressed,
        geometry: "",
        candidates: &candidates,
    };
    journal.enter(&entry, &["folder"]).unwrap();
}

fn deliver(journal: &Journal, digit: char, id: &str) {
    let due = journal.pending().unwrap();
    let due = due.iter().find(|due| due.scan == scan(digit) && due.patient_cell() == id).unwrap();
    journal.delivered(due, &Path::new("/r").join(id)).unwrap();
}

fn named(id: &str) -> Named {
    Named::new(id.to_owned(), SourceKind::Operator)
}

/// A press that waits for its export, and a name that waits for a press.
fn wait_for(journal: &Journal, id: &str) {
    let rules = Rules {
        by_press: true,
        window: Duration::from_secs(60),
        late: Duration::ZERO,
        name_lasts: Duration::from_secs(60),
        orders: OrdersWhen::BeforePress,
    };
    let capture = Capture {
        number: 1,
        opened: Duration::ZERO,
        until: Duration::from_secs(60),
        by: Opener::Press,
        patient: Some(named(OTHER)),
        others: vec![named(id)],
        state: CaptureState::Open,
        is_refused: false,
        doubt: Some(Doubt::Shared),
    };
    let before = Rounds::new(rules, Vec::new(), Names::default());
    let next = Next::one(named(id), Duration::ZERO, None);
    let after = Rounds::new(rules, vec![capture], Names { next: Some(next), unsure: Vec::new() });
    let in_history = Some((Event::Named, json!({ "patient": id })));
    let change = BoothChange {
        before: &before,
        after: &after,
        boot: "boot",
        ended_as: "over",
        answers: None,
        event: in_history,
    };
    journal.booth_changed(&change).unwrap();
}

/// A journal that knows the person in every way: a scan of theirs, one that another has, too, one that is held
/// and may be another's, one that was taken back, files, orders, a press and a name.
fn journal_of(dir: &Path) -> Journal {
    let journal = Journal::open(&dir.join("journal.db")).unwrap();
    enter(&journal, 'a', ID, None, &[]);
    deliver(&journal, 'a', ID);
    enter(&journal, 'b', OTHER, None, &[]);
    deliver(&journal, 'b', OTHER);
    enter(&journal, 'b', ID, Some("same-scan-other-patient"), &[ID]);
    let held = journal.deliveries_in(&scan('b'), DeliveryState::Held).unwrap();
    journal.reopened(&scan('b'), &held, DeliveryStep::Release, Some(1)).unwrap();
    deliver(&journal, 'b', ID);
    enter(&journal, 'c', ID, Some("patients-differ"), &[ID, OTHER]);
    enter(&journal, 'd', ID, None, &[]);
    deliver(&journal, 'd', ID);
    let taken = json!({ "patients": [ID], "decision": 1 });
    journal.given_to(&scan('d'), &[], &["folder"], Event::Unassigned, &taken).unwrap();
    enter(&journal, 'e', OTHER, None, &[]);
    let stamp = Stamp { dev: 1, ino: 2, size: 3, mtime_ns: 4, ctime_ns: 5 };
    for (name, digit) in [(format!("{ID}_a.obj"), 'a'), (format!("{OTHER}_e.obj"), 'e')] {
        journal.sighted(&Path::new("/export").join(name), stamp, Some(&scan(digit))).unwrap();
    }
    let state = OrderState { size: 3, mtime_ns: 1, digest: "d".into() };
    journal.order_handled(&Path::new("/orders").join(format!("{ID}.gdt")), &state).unwrap();
    wait_for(&journal, ID);
    journal
}

fn erase(journal: &Journal) {
    let (whole, detail) = ([scan('a')], json!({ "person": "0123456789abcdef" }));
    let stores = ["folder"];
    let erasing = Erasing { patient: ID, whole: &whole, stores: &stores, detail: &detail };
    journal.erase(&erasing).unwrap();
    journal.shred().unwrap();
}

/// The files of a folder that hold a text.
fn holding(dir: &Path, text: &str) -> Vec<String> {
    let holds = |bytes: Vec<u8>| bytes.windows(text.len()).any(|part| part == text.as_bytes());
    let entries = fs::read_dir(dir).unwrap().map(|entry| entry.unwrap());
    let found = entries.filter(|entry| holds(fs::read(entry.path()).unwrap()));
    found.map(|entry| entry.file_name().into_string().unwrap()).collect()
}

#[test]
fn the_id_is_in_no_byte_of_the_journal_afterwards_and_others_stay() {
    let dir = tempfile::tempdir().unwrap();
    let journal = journal_of(dir.path());
    assert!(!holding(dir.path(), ID).is_empty(), "else the test sees nothing");
    for _ in 0..2 {
        erase(&journal);
        assert_eq!(holding(dir.path(), ID), [""; 0]);
        assert_eq!(journal.misjudged(), []);
        journal.check().unwrap();
    }
    assert!(!holding(dir.path(), OTHER).is_empty());
    drop(journal);
    let journal = Journal::open(&dir.path().join("journal.db")).unwrap();
    assert_eq!(journal.scan(&scan('a')).unwrap(), None);
    assert_eq!(journal.owners(&scan('b')).unwrap(), [OTHER]);
    assert_eq!(
        journal.candidates(&scan('c')).unwrap(),
        [OTHER, ERASED],
        "one tap must not be a guess"
    );
    assert!(
        journal.whole(&scan('c')).unwrap().unwrap().held_for().is_some(),
        "it is still to be decided"
    );
    assert!(!journal.has_served(&scan('c')).unwrap(), "its bytes are still needed");
    assert_eq!(journal.patients(&scan('e')).unwrap(), [Some(OTHER.to_owned())]);
    let waiting = journal.captures_waiting().unwrap();
    assert!(waiting.is_empty() && journal.names().unwrap().is_none());
    assert!(journal.scans_of_person(ID).unwrap().is_empty());
    assert!(journal.history_of_person(ID, &[]).unwrap().is_empty());
}

#[test]
fn scans_of_a_person_are_told_apart_by_who_else_has_them() {
    let dir = tempfile::tempdir().unwrap();
    let journal = journal_of(dir.path());
    let theirs: Vec<_> =
        journal.scans_of_person(ID).unwrap().into_iter().map(|of| (of.scan, of.whose)).collect();
    let wanted = [
        (scan('a'), WhoseScan::Theirs),
        (scan('b'), WhoseScan::Shared),
        (scan('c'), WhoseScan::Uncertain),
        (scan('d'), WhoseScan::TakenBack),
    ];
    assert_eq!(theirs, wanted);
}

#[test]
fn what_is_disclosed_of_the_history_names_no_other_patient() {
    let dir = tempfile::tempdir().unwrap();
    let journal = journal_of(dir.path());
    let history = journal.history_of_person(ID, &[scan('a')]).unwrap();
    let text = serde_json::to_string(&history).unwrap();
    assert!(text.contains(ID) && !text.contains(OTHER), "{text}");
    let events: BTreeSet<&str> = history.iter().map(|of| of.happened.event.as_str()).collect();
    for event in ["entered", "delivered", "held", "released", "unassigned", "named"] {
        assert!(events.contains(event), "{event} of {events:?}");
    }
}

#[test]
fn the_chain_of_the_history_goes_on_from_new_hashes_and_an_old_head_is_not_taken_for_a_newer_journal()
 {
    let dir = tempfile::tempdir().unwrap();
    let journal = journal_of(dir.path());
    let old_head = fs::read_to_string(dir.path().join("history.head")).unwrap();
    let in_store = journal.head_line().unwrap().unwrap();
    erase(&journal);
    // The store's is known to be old, until a new one is there.
    assert!(journal.has_old_head("folder").unwrap());
    assert!(journal.holds_head(&in_store).is_err(), "the hash in it is of the history as it was");
    assert!(!journal.has_old_head("").unwrap(), "the state folder has its new one");
    journal.head_renewed("folder").unwrap();
    assert!(!journal.has_old_head("folder").unwrap());
    // A power cut after the commit and before the head: the old head is back, and the note still there.
    journal
        .connection()
        .execute("INSERT INTO meta (name, value) VALUES ('old-head:', '')", [])
        .unwrap();
    drop(journal);
    fs::write(dir.path().join("history.head"), &old_head).unwrap();
    let journal = Journal::open(&dir.path().join("journal.db")).unwrap();
    assert!(!journal.has_old_head("").unwrap());
    drop(journal);
    assert_ne!(fs::read_to_string(dir.path().join("history.head")).unwrap(), old_head);
    // Without the note it is what it always was: a sign of an older copy.
    fs::write(dir.path().join("history.head"), &old_head).unwrap();
    let fault = Journal::open(&dir.path().join("journal.db")).unwrap_err();
    assert!(matches!(fault, JournalError::Behind { .. }), "{fault}");
}

#[test]
fn a_person_whom_the_journal_does_not_know_changes_no_row_of_the_history() {
    let dir = tempfile::tempdir().unwrap();
    let journal = journal_of(dir.path());
    let before = journal.head_line().unwrap().unwrap();
    let detail = json!({});
    let erasing = Erasing { patient: "P-1", whole: &[], stores: &["folder"], detail: &detail };
    journal.erase(&erasing).unwrap();
    journal.holds_head(&before).unwrap();
    assert!(!journal.has_old_head("folder").unwrap());
}

#[test]
fn an_id_gives_way_wherever_it_is_and_nothing_else_does() {
    let mut value = json!({
        "patient": "4711", "decision": 4711, "store": "47110", "patients": ["4711", "4712"],
        "claims": [{"id": "4711", "sources": []}, {"id": "4712", "sources": []}],
        "deep": {"by": ["x", {"patient": "4711"}]},
    });
    assert!(redact(&mut value, "4711"));
    let wanted = json!({
        "patient": ERASED, "decision": 4711, "store": "47110", "patients": ["4712"],
        "claims": [{"id": "4712", "sources": []}], "deep": {"by": ["x", {"patient": ERASED}]},
    });
    assert_eq!(value, wanted);
    assert!(!redact(&mut value, "4711"));
}
