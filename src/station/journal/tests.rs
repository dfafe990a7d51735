//! The journal on real files.

use std::collections::BTreeSet;

use jiff::Timestamp;

use super::*;

mod one_state;
mod ruin;

use gaiter_flow::account::Filter;
use gaiter_flow::round::CaptureMatch;
use gaiter_flow::{DeliveryState, Disposition, ScanId, ScanState, Stamp};
use gaiter_record::{Patient, Source, SourceKind};
use ruin::edit;

fn journal() -> (tempfile::TempDir, Journal) {
    let dir = tempfile::tempdir().unwrap();
    let journal = Journal::open(&dir.path().join("journal.db")).unwrap();
    (dir, journal)
}

impl Journal {
    /// The scans whose kept disposition differs from that of their rows, with the kept one.
    pub fn misjudged(&self) -> Vec<(String, String)> {
        let connection = self.connection();
        let mut query = connection.prepare("SELECT sha256, disposition FROM scans").unwrap();
        let rows = query.query_map([], |row| Ok((row.get(0)?, row.get(1)?))).unwrap();
        let kept: Vec<(String, String)> = rows.collect::<Result<_, _>>().unwrap();
        let is_wrong = |(scan, word): &(String, String)| {
            disposition::of_scan(&connection, scan).unwrap().map(Disposition::word) != Some(word)
        };
        kept.into_iter().filter(is_wrong).collect()
    }
}

#[test]
fn a_journal_is_its_users_alone_wherever_it_lies() {
    use std::fs::{Permissions, metadata, set_permissions};
    use std::os::unix::fs::PermissionsExt;
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("journal.db");
    let modes = || {
        ["journal.db", "journal.db-wal"]
            .map(|name| metadata(dir.path().join(name)).unwrap().permissions().mode() & 0o777)
    };
    let journal = Journal::open(&path).unwrap();
    assert_eq!(modes(), [0o600; 2]);
    drop(journal);
    // As a restored backup may have it.
    set_permissions(&path, Permissions::from_mode(0o644)).unwrap();
    let _journal = Journal::open(&path).unwrap();
    assert_eq!(modes(), [0o600; 2]);
}

fn row(digit: char) -> ScanRow {
    ScanRow {
        scan: ScanId::parse(&digit.to_string().repeat(64)).unwrap(),
        format: "obj".to_owned(),
        size: 12,
        first_seen: "2026-11-21T09:15:00Z".parse().unwrap(),
        file_time: None,
        pressed_at: None,
        state: ScanState::Spooled,
    }
}

fn patient(id: &str) -> Patient {
    Patient { id: id.to_owned(), sources: vec![Source::from_kind(SourceKind::FileName)] }
}

fn enter(journal: &Journal, row: &ScanRow, id: Option<&str>, state: DeliveryState) {
    let (patient, held) = (id.map(patient), (state == DeliveryState::Held).then_some("held"));
    let (patient, judged) = (patient.as_ref(), &CaptureMatch::Unpressed);
    let entry = Entry { row, patient, held, claims: &[], judged, geometry: "", candidates: &[] };
    journal.enter(&entry, &["folder"]).unwrap();
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
    for (due, has_served) in due.iter().zip([true, false]) {
        journal.delivered(due, folder).unwrap();
        assert_eq!(journal.has_served(&due.scan).unwrap(), has_served);
    }
    assert!(journal.whole(&row('b').scan).unwrap().unwrap().held_for().is_some());
    assert_eq!(journal.scans_in(ScanState::Delivered).unwrap(), [row('a').scan, row('b').scan]);
    assert!(journal.pending().unwrap().is_empty());
    let again = journal.delivered(&due[0], folder);
    assert!(matches!(again, Err(JournalError::Step(_))), "{again:?}");
}

#[test]
fn measurements_without_a_result_count_until_one_has_a_result() {
    let (_dir, journal) = journal();
    [row('a'), row('b')].iter().for_each(|row| enter(&journal, row, None, DeliveryState::Pending));
    let crashed = |name| journal.crashed(&row(name).scan).unwrap();
    assert_eq!(['a', 'a', 'b'].map(crashed), [1, 2, 1]);
    journal.measured(&row('a').scan).unwrap();
    assert_eq!(['a', 'b'].map(crashed), [1, 2]);
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
    journal.sighted_again(path, &row('b').scan).unwrap();
    assert_eq!(journal.same_as(path).unwrap(), Some(row('b').scan));
    journal.sighted(path, Stamp { ctime_ns: 6, ..stamp }, Some(&row('a').scan)).unwrap();
    assert_eq!(journal.same_as(path).unwrap(), None, "it has changed");
}

#[test]
fn durability_is_set_and_the_journal_of_another_version_is_refused() {
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

/// A journal with some history, closed.
fn used() -> (tempfile::TempDir, std::path::PathBuf) {
    let (dir, journal) = journal();
    for digit in "abcdef".chars() {
        enter(&journal, &row(digit), Some("4711"), DeliveryState::Pending);
    }
    drop(journal);
    let path = dir.path().join("journal.db");
    (dir, path)
}

#[test]
fn what_became_of_a_scan_is_decided_anew_when_the_journal_is_opened() {
    let (_dir, journal) = journal();
    enter(&journal, &row('a'), None, DeliveryState::Pending);
    let due = journal.pending().unwrap();
    journal.delivered(&due[0], Path::new("/r/x")).unwrap();
    assert_eq!(journal.open_tasks(9, Timestamp::MAX).unwrap(), [row('a').scan]);
    // As a gaiter left it that decides otherwise.
    let path = journal.path.clone();
    drop(journal);
    edit(&path, "UPDATE scans SET disposition = 'spooled'");
    let journal = Journal::open(&path).unwrap();
    assert_eq!(journal.open_tasks(9, Timestamp::MAX).unwrap(), [row('a').scan]);
    let unassigned = journal.list(Some(Filter::Unassigned), 9).unwrap();
    assert_eq!(unassigned[0].disposition, Disposition::Unassigned);
    assert_eq!(journal.misjudged(), []);
}

#[test]
fn what_rests_is_forgotten_and_what_is_pending_is_not() {
    let (_dir, journal) = journal();
    for digit in "ab".chars() {
        enter(&journal, &row(digit), Some("4711"), DeliveryState::Pending);
    }
    let due = journal.pending().unwrap();
    journal.delivered(&due[0], Path::new("/r/x")).unwrap();
    let future = "2099-01-01T00:00:00Z".parse().unwrap();
    let past = "2001-01-01T00:00:00Z".parse().unwrap();
    assert_eq!(journal.forget(past).unwrap(), 0);
    assert_eq!(journal.forget(future).unwrap(), 1);
    assert_eq!(journal.scan(&due[0].scan).unwrap(), None);
    assert_eq!(journal.pending().unwrap(), due[1..]);
    let path = journal.path.clone();
    drop(journal);
    Journal::open(&path).unwrap();
}

#[test]
fn a_file_is_forgotten_when_it_is_gone_and_its_scan_is_forgotten_and_not_before() {
    let (_dir, journal) = journal();
    enter(&journal, &row('a'), Some("4711"), DeliveryState::Pending);
    let stamp = Stamp { dev: 1, ino: 2, size: 3, mtime_ns: 4, ctime_ns: 5 };
    let sighted = |path: &str, scan: Option<char>| {
        let scan = scan.map(|digit| row(digit).scan);
        journal.sighted(Path::new(path), stamp, scan.as_ref()).unwrap();
    };
    sighted("/export/known.obj", Some('a'));
    sighted("/export/forgotten.obj", Some('b'));
    sighted("/export/there.obj", Some('c'));
    sighted("/export/unread.obj", None);
    sighted("/export/inner/forgotten.obj", Some('d'));
    sighted("/exports/forgotten.obj", Some('e'));
    let there = BTreeSet::from([PathBuf::from("/export/there.obj")]);
    let others = [PathBuf::from("/export/inner")];
    let forget = || journal.forget_sightings(Path::new("/export"), &others, &there).unwrap();
    assert_eq!((forget(), forget()), (2, 0));
    let is_known = |path: &&str| journal.was_sighted(Path::new(path), stamp).unwrap();
    let paths = ["known", "forgotten", "there", "unread", "inner/forgotten"];
    let paths = paths.map(|name| format!("/export/{name}.obj"));
    let known: Vec<&str> = paths.iter().map(String::as_str).filter(is_known).collect();
    assert_eq!(known, ["/export/known.obj", "/export/there.obj", "/export/inner/forgotten.obj"]);
    assert!(is_known(&"/exports/forgotten.obj"));
}

#[test]
fn a_refused_scan_whose_bytes_were_let_go_needs_no_decision_any_more() {
    let (_dir, journal) = journal();
    enter(&journal, &row('a'), Some("4711"), DeliveryState::Pending);
    journal.refused(&row('a').scan, "no-leg", "no leg").unwrap();
    assert_eq!(journal.open_tasks(9, Timestamp::MAX).unwrap(), [row('a').scan]);
    journal.let_go_of(&row('a').scan).unwrap();
    let tally = journal.tally().unwrap();
    assert_eq!(
        (journal.open_tasks(9, Timestamp::MAX).unwrap(), tally.scans["refused"]),
        (vec![], 0)
    );
    assert!(journal.was_let_go(&row('a').scan).unwrap());
}

#[test]
fn a_refused_scan_is_closed_by_the_same_patients_next_good_one_and_by_nobody_elses() {
    let (_dir, journal) = journal();
    let at = |digit: char, second: i64| ScanRow {
        first_seen: jiff::Timestamp::from_second(1_800_000_000 + second).unwrap(),
        ..row(digit)
    };
    let refused = |row: &ScanRow, id: Option<&str>| {
        enter(&journal, row, id, DeliveryState::Pending);
        journal.refused(&row.scan, "no-leg", "no leg").unwrap();
    };
    refused(&at('a', 0), Some("4711"));
    refused(&at('b', 1), Some("0815"));
    refused(&at('c', 2), None);
    refused(&at('d', 9), Some("4711"));
    let undecided = || {
        let scans = journal.open_tasks(9, Timestamp::MAX).unwrap();
        scans.iter().map(|scan| scan.as_str()[..1].to_owned()).collect::<String>()
    };
    assert_eq!(undecided(), "dcba");
    // A next scan without a patient decides nothing about the one before, and waits for a decision itself.
    for (digit, id, left) in [('e', None, "decba"), ('f', Some("4711"), "decb")] {
        enter(&journal, &at(digit, 5), id, DeliveryState::Pending);
        let due = journal.pending().unwrap();
        journal.delivered(&due[0], Path::new("/r/x")).unwrap();
        assert_eq!(undecided(), left, "{digit}");
    }
    let tally = journal.tally().unwrap();
    assert_eq!((tally.scans["refused"], tally.closed), (3, 1));
    let listed = journal.list(None, 9).unwrap();
    let closed = listed.iter().filter(|scan| scan.closed == Some(gaiter_flow::Closed::Superseded));
    assert_eq!(closed.count(), 1);
    let last = journal.history(&row('a').scan).unwrap().pop().unwrap();
    assert_eq!(
        (last.event.as_str(), last.detail.as_str()),
        ("superseded", "{\"by\":\"ffffffff\"}")
    );
}

/// How long a query may take before it counts as one that waits for the writer.
const HANG: std::time::Duration = std::time::Duration::from_secs(30);

#[test]
fn page_and_status_read_what_is_committed_while_a_change_is_being_made() {
    let (_dir, journal) = journal();
    enter(&journal, &row('a'), Some("4711"), DeliveryState::Pending);
    let (scan, edition) = (row('a').scan, journal.edition());
    let (answer, answered) = std::sync::mpsc::channel();
    std::thread::scope(|scope| {
        let change = journal.change(|transaction| {
            transaction.execute("UPDATE scans SET state = 'refused', code = 'scan-empty'", [])?;
            scope.spawn(|| {
                let tally = journal.tally().unwrap();
                let whole = journal.whole(&scan).unwrap().unwrap();
                let newest =
                    (journal.newest(9).unwrap(), journal.open_tasks(9, Timestamp::MAX).unwrap());
                let seen = (tally.scans["refused"], whole.summary.state, newest, journal.edition());
                answer.send(seen).unwrap();
            });
            let seen = answered.recv_timeout(HANG).expect("the readers wait for the writer");
            assert_eq!(seen, (0, ScanState::Spooled, (vec![scan.clone()], vec![]), edition));
            Ok(())
        });
        change.unwrap();
    });
    assert_eq!(journal.tally().unwrap().scans["refused"], 1);
    assert_ne!(journal.edition(), edition);
}

#[test]
fn a_journal_that_was_let_go_answers_no_reader_either() {
    let (dir, journal) = journal();
    enter(&journal, &row('a'), Some("4711"), DeliveryState::Pending);
    journal.let_go().unwrap();
    assert!(journal.tally().is_err() && journal.list(None, 9).is_err());
    let beside = |end| dir.path().join(format!("journal.db{end}"));
    assert!(beside("").exists() && !beside("-wal").exists(), "the last connection closed the log");
}
