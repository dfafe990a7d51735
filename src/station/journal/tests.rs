//! The journal on real files.

use super::*;
use crate::flow::{DeliveryState, ScanId, ScanState, Stamp};
use crate::record::{Patient, Source, SourceKind};

fn journal() -> (tempfile::TempDir, Journal) {
    let dir = tempfile::tempdir().unwrap();
    let journal = Journal::open(&dir.path().join("journal.db")).unwrap();
    (dir, journal)
}

fn row(digit: char) -> ScanRow {
    ScanRow {
        scan: ScanId::parse(&digit.to_string().repeat(64)).unwrap(),
        format: "obj".to_owned(),
        size: 12,
        first_seen: "2026-11-21T09:15:00Z".parse().unwrap(),
        file_time: None,
        state: ScanState::Spooled,
    }
}

fn patient(id: &str) -> Patient {
    Patient { id: id.to_owned(), sources: vec![Source { kind: SourceKind::FileName }] }
}

fn enter(journal: &Journal, row: &ScanRow, id: Option<&str>, state: DeliveryState) {
    let patient = id.map(patient);
    journal.enter(row, patient.as_ref(), &["folder"], state, None).unwrap();
}

#[test]
fn what_was_entered_is_there_after_reopening() {
    let (dir, journal) = journal();
    enter(&journal, &row('a'), Some("4711"), DeliveryState::Pending);
    enter(&journal, &row('b'), None, DeliveryState::Pending);
    drop(journal);
    let journal = Journal::open(&dir.path().join("journal.db")).unwrap();
    assert_eq!(journal.scan(&row('a').scan).unwrap(), Some(row('a')));
    assert_eq!(journal.patients(&row('b').scan).unwrap(), [None]);
    let due = journal.pending().unwrap();
    let due_to = |scan, patient| Due {
        scan,
        patient,
        store: "folder".to_owned(),
        task: Task::Deliver,
        first_seen: row('a').first_seen,
        attempts: 0,
    };
    assert_eq!(due, [due_to(row('a').scan, Some(patient("4711"))), due_to(row('b').scan, None)]);
}

#[test]
fn the_first_sight_of_a_scan_is_kept() {
    let (_dir, journal) = journal();
    enter(&journal, &row('a'), Some("4711"), DeliveryState::Pending);
    let later = ScanRow { first_seen: "2027-01-01T00:00:00Z".parse().unwrap(), ..row('a') };
    enter(&journal, &later, Some("0815"), DeliveryState::Held);
    let known = journal.scan(&row('a').scan).unwrap().unwrap();
    assert_eq!(known.first_seen, row('a').first_seen);
}

#[test]
fn spooled_bytes_have_served_with_the_last_delivery_unless_one_is_held() {
    let (_dir, journal) = journal();
    let folder = Path::new("/r/x");
    enter(&journal, &row('a'), Some("4711"), DeliveryState::Pending);
    enter(&journal, &row('b'), None, DeliveryState::Pending);
    enter(&journal, &row('b'), Some("4711"), DeliveryState::Held);
    let due = journal.pending().unwrap();
    assert!(journal.delivered(&due[0], folder).unwrap());
    assert!(!journal.delivered(&due[1], folder).unwrap());
    assert!(journal.is_held(&row('b').scan).unwrap());
    assert_eq!(journal.scans_in(ScanState::Delivered).unwrap(), [row('a').scan, row('b').scan]);
    assert!(journal.pending().unwrap().is_empty());
    let again = journal.delivered(&due[0], folder);
    assert!(matches!(again, Err(JournalError::Step(_))), "{again:?}");
}

#[test]
fn a_refused_scan_is_not_pending_any_more() {
    let (_dir, journal) = journal();
    enter(&journal, &row('a'), None, DeliveryState::Pending);
    journal.refused(&row('a').scan, "no-body", "no body").unwrap();
    assert!(journal.pending().unwrap().is_empty());
    assert_eq!(journal.scans_in(ScanState::Refused).unwrap(), [row('a').scan]);
    let unknown = journal.refused(&row('c').scan, "x", "x");
    assert!(matches!(unknown, Err(JournalError::Unknown { what: "scan" })));
}

#[test]
fn failed_attempts_are_counted() {
    let (_dir, journal) = journal();
    enter(&journal, &row('a'), None, DeliveryState::Pending);
    enter(&journal, &row('b'), None, DeliveryState::Pending);
    let due = journal.pending().unwrap();
    let at = "2026-11-21T09:15:01Z".parse().unwrap();
    journal.put_off(&due[0], "store-unavailable", at).unwrap();
    let attempts: Vec<u32> = journal.pending().unwrap().iter().map(|due| due.attempts).collect();
    assert_eq!(attempts, [1, 0]);
}

#[test]
fn a_sighting_holds_for_one_state_of_the_file() {
    let (_dir, journal) = journal();
    let stamp = Stamp { dev: u64::MAX, ino: 2, size: 3, mtime_ns: -1, ctime_ns: 5 };
    let path = Path::new("/e/a.obj");
    assert!(!journal.was_sighted(path, stamp).unwrap());
    journal.sighted(path, stamp, Some(&row('a').scan)).unwrap();
    assert!(journal.was_sighted(path, stamp).unwrap());
    assert!(!journal.was_sighted(path, Stamp { ctime_ns: 6, ..stamp }).unwrap());
    assert!(!journal.was_sighted(Path::new("/e/b.obj"), stamp).unwrap());
}

#[test]
fn durability_is_set_and_a_foreign_schema_is_refused() {
    let (dir, journal) = journal();
    let pragma = |name| -> String {
        let read = |row: &rusqlite::Row<'_>| row.get::<_, rusqlite::types::Value>(0);
        format!("{:?}", journal.connection().pragma_query_value(None, name, read).unwrap())
    };
    assert_eq!(pragma("journal_mode"), "Text(\"wal\")");
    assert_eq!(pragma("synchronous"), "Integer(2)");
    journal.connection().pragma_update(None, "user_version", 99).unwrap();
    drop(journal);
    let refused = Journal::open(&dir.path().join("journal.db")).unwrap_err();
    assert!(matches!(refused, JournalError::Schema { found: 99, known: schema::KNOWN }));
}

#[test]
fn a_second_station_on_the_same_state_is_told_who_has_it() {
    let dir = tempfile::tempdir().unwrap();
    let first = StateLock::take(dir.path()).unwrap();
    let refused = StateLock::take(dir.path()).unwrap_err().to_string();
    assert!(refused.ends_with(&format!("process {}", std::process::id())), "{refused}");
    drop(first);
    StateLock::take(dir.path()).unwrap();
}
