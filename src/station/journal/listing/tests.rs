//! Lists and counts of a journal on a real file.

use gaiter_flow::DeliveryState::{Delivered as Done, Held, Pending};
use gaiter_flow::account::{Search, SearchState};
use gaiter_flow::round::CaptureMatch;
use gaiter_record::{Patient, Source, SourceKind};
use jiff::Timestamp;

use super::*;
use crate::station::journal::{Due, Task};
use crate::station::journal::{Entry, ScanRow};

fn scan(digits: &str) -> ScanId {
    ScanId::parse(&format!("{digits:0<64}")).unwrap()
}

fn patient(id: &str) -> Patient {
    Patient { id: id.to_owned(), sources: vec![Source::from_kind(SourceKind::FileName)] }
}

/// Enters a delivery of a scan first seen at this second.
fn enter(journal: &Journal, digits: &str, second: i64, id: Option<&str>, state: DeliveryState) {
    let scanned = if state == Held { ScanState::Delivered } else { ScanState::Spooled };
    let row = ScanRow {
        scan: scan(digits),
        format: "obj".to_owned(),
        size: 12,
        first_seen: Timestamp::from_second(second).unwrap(),
        file_time: None,
        pressed_at: None,
        state: scanned,
    };
    let held = (state == Held).then_some("same-scan-other-patient");
    let (row, patient, judged) = (&row, id.map(patient), &CaptureMatch::Unpressed);
    let entry = Entry {
        row,
        patient: patient.as_ref(),
        held,
        claims: &[],
        judged,
        geometry: "",
        candidates: &[],
    };
    journal.enter(&entry, &["folder"]).unwrap();
    if state == Done {
        let due = journal.pending().unwrap().into_iter().find(|due| due.scan == row.scan).unwrap();
        journal.delivered(&due, "/r".as_ref()).unwrap();
    }
}

/// A scan in each state: abcd waits, abce is refused, 1111 is delivered and held for another.
fn journal() -> (tempfile::TempDir, Journal) {
    let dir = tempfile::tempdir().unwrap();
    let journal = Journal::open(&dir.path().join("journal.db")).unwrap();
    enter(&journal, "abcd", 300, Some("4711"), Pending);
    enter(&journal, "abce", 200, None, Pending);
    journal.refused(&scan("abce"), "scan-empty", "the file is empty").unwrap();
    enter(&journal, "1111", 100, Some("4711"), Done);
    enter(&journal, "1111", 100, Some("0815"), Held);
    (dir, journal)
}

fn listed(journal: &Journal, filter: Option<Filter>, limit: u32) -> Vec<String> {
    let rows = journal.list(filter, limit).unwrap();
    rows.into_iter().map(|row| row.scan[..4].to_owned()).collect()
}

#[test]
fn an_empty_journal_has_every_state_and_nothing_in_it() {
    let dir = tempfile::tempdir().unwrap();
    let tally = Journal::open(&dir.path().join("journal.db")).unwrap().tally().unwrap();
    assert_eq!(tally.scans, BTreeMap::from([("delivered", 0), ("refused", 0), ("spooled", 0)]));
    assert_eq!((tally.held, tally.oldest, tally.last), (0, BTreeMap::new(), None));
}

#[test]
fn the_tally_counts_each_state_and_knows_the_oldest_and_the_last() {
    let (_dir, journal) = journal();
    enter(&journal, "2222", 50, Some("1"), Pending);
    let tally = journal.tally().unwrap();
    assert_eq!(tally.scans, BTreeMap::from([("delivered", 1), ("refused", 1), ("spooled", 2)]));
    assert_eq!(tally.held, 1);
    assert_eq!(tally.deliveries[&("folder".to_owned(), "pending".to_owned())], 2);
    assert_eq!(tally.oldest["folder"].scan, "22220000", "the refused one waits for nothing");
    assert_eq!(tally.last.unwrap().scan, "abcd0000");
}

#[test]
fn lists_are_newest_first_and_filtered_by_state() {
    let (_dir, journal) = journal();
    assert_eq!(listed(&journal, None, 9), ["abcd", "abce", "1111"]);
    assert_eq!(listed(&journal, None, 2), ["abcd", "abce"]);
    assert_eq!(listed(&journal, Some(Filter::Spooled), 9), ["abcd"]);
    assert_eq!(listed(&journal, Some(Filter::Refused), 9), ["abce"]);
    assert_eq!(listed(&journal, Some(Filter::Delivered), 9), ["1111"]);
    assert_eq!(listed(&journal, Some(Filter::Held), 9), ["1111"]);
    let held = journal.list(Some(Filter::Held), 9).unwrap().remove(0);
    assert_eq!((held.code.as_deref(), held.held), (Some("same-scan-other-patient"), true));
    assert_eq!(
        journal.list(Some(Filter::Refused), 9).unwrap()[0].code.as_deref(),
        Some("scan-empty")
    );
}

#[test]
fn a_list_names_no_patient() {
    let (_dir, journal) = journal();
    let rows = serde_json::to_string(&journal.list(None, 9).unwrap()).unwrap();
    assert!(!rows.contains("4711") && !rows.contains("0815"), "{rows}");
}

#[test]
fn the_beginning_of_an_id_finds_all_that_begin_so() {
    let (_dir, journal) = journal();
    assert_eq!(journal.beginning_with("abcd", 9).unwrap(), [scan("abcd")]);
    assert_eq!(journal.beginning_with("abc", 9).unwrap(), [scan("abcd"), scan("abce")]);
    assert_eq!(journal.beginning_with("abc", 1).unwrap().len(), 1);
    assert_eq!(journal.beginning_with(scan("1111").as_str(), 9).unwrap(), [scan("1111")]);
    for digits in ["abcf", "0000", "%", "abcd' OR 1=1"] {
        assert_eq!(journal.beginning_with(digits, 9).unwrap(), [], "{digits}");
    }
}

#[test]
fn a_scan_is_shown_whole_with_its_deliveries() {
    let (_dir, journal) = journal();
    let due = journal.pending().unwrap().remove(0);
    let next_at = Timestamp::from_second(999).unwrap();
    journal.put_off(&due, "store-unavailable", next_at).unwrap();
    let whole = journal.whole(&scan("abcd")).unwrap().unwrap();
    assert_eq!(whole.deliveries[0].attempts, 1);
    assert_eq!(whole.deliveries[0].next_at, Some(next_at));
    assert_eq!(whole.deliveries[0].patient.as_deref(), Some("4711"));
    let whole = journal.whole(&scan("abce")).unwrap().unwrap();
    assert_eq!(whole.summary.message.as_deref(), Some("the file is empty"));
    assert_eq!(whole.deliveries[0].patient, None);
    assert_eq!(journal.whole(&scan("1111")).unwrap().unwrap().deliveries.len(), 2);
    assert_eq!(journal.whole(&scan("9999")).unwrap(), None);
}

#[test]
fn a_later_delivery_to_a_patient_undoes_nothing_that_a_person_has_set_and_one_to_another_does() {
    let (_dir, journal) = journal();
    for (digits, id, lacks) in
        [("abcd", "4711", true), ("1111", "4711", false), ("1111", "0815", true)]
    {
        let due = Due {
            scan: scan(digits),
            patient: Some(patient(id)),
            store: "copy".to_owned(),
            task: Task::Deliver,
            first_seen: Timestamp::UNIX_EPOCH,
            attempts: 0,
        };
        journal.lacks_measures(&due).unwrap();
        let whole = journal.whole(&scan(digits)).unwrap().unwrap();
        assert_eq!(whole.summary.incomplete, lacks, "{digits} {id}");
    }
}

#[test]
fn a_search_finds_scans_by_patient_id_time_and_state_newest_first_and_says_that_there_are_more() {
    let (_dir, journal) = journal();
    enter(&journal, "2222", 50, None, Done);
    journal.still_lacks_measures(&scan("1111"), true).unwrap();
    let all = Search { limit: 9, ..Search::default() };
    let of = |search: &Search| -> Vec<String> {
        let found = journal.search(search).unwrap();
        found.iter().map(|scan| scan.as_str()[..4].to_owned()).collect()
    };
    let text = |text: &str| of(&Search { text: text.to_owned(), ..all.clone() });
    assert_eq!(of(&all), ["abcd", "abce", "1111", "2222"]);
    assert_eq!(text("ABC"), ["abcd", "abce"]);
    assert_eq!(text("471"), ["abcd", "1111"], "a part of the patient's id");
    assert_eq!(text("0815"), ["1111"], "also whom it is held for");
    assert!(text("%").is_empty() && text("_").is_empty());
    let at = |second| Some(Timestamp::from_second(second).unwrap());
    assert_eq!(of(&Search { from: at(100), until: at(300), ..all.clone() }), ["abce", "1111"]);
    let state = |state| of(&Search { state: Some(state), ..all.clone() });
    assert_eq!(state(SearchState::Undecided), ["abce", "1111", "2222"]);
    assert_eq!(state(SearchState::Refused), ["abce"]);
    assert_eq!(state(SearchState::Delivered), ["1111"]);
    assert_eq!(state(SearchState::Unassigned), ["2222"]);
    assert_eq!(of(&Search { incomplete: true, ..all.clone() }), ["1111"]);
    let part = Search { limit: 2, offset: 1, ..all };
    assert_eq!(of(&part), ["abce", "1111", "2222"], "one more than the limit");
}
