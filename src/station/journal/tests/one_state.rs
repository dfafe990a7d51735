//! Whatever happens to scans: light, page, lists, search and status agree about them.
//!
//! `GAITER_SEQUENCES` is the number of histories, of [`SCANS`] scans each journal.

use std::collections::BTreeSet;

use gaiter_flow::account::{Filter, Search, SearchState, Whole, explain, in_words};
use gaiter_flow::light::LastOutcome;
use gaiter_flow::page::{ScanDetails, scan_shown};
use gaiter_flow::{DeliveryState, DeliveryStep, Disposition, ScanState, Task};
use gaiter_language::Language;
use gaiter_record::{Patient, Source, SourceKind};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use serde_json::json;

use crate::station::journal::{Entry, Event, Journal, ScanRow, Task as At};
use gaiter_flow::ScanId;
use gaiter_flow::round::CaptureMatch;
use jiff::Timestamp;

/// How many scans each journal has.
const SCANS: usize = 10;

/// Only the first takes a record without a patient; the last is a server.
const STORES: [&str; 3] = ["folder", "gdt", "fhir"];

/// What may happen to a scan next.
#[derive(Debug, Clone, Copy)]
enum Step {
    /// It comes in, or comes in again for another patient.
    Comes {
        of: Option<&'static str>,
        is_held: bool,
    },
    /// A record is delivered, or taken back where it is to go.
    Served,
    PutOff,
    /// One store takes no record of it, ever.
    RefusedAtStore,
    Lacks,
    Refused,
    LetGo,
    Retried,
    Released,
    Assigned(&'static str),
    Unassigned,
    GivenUp,
}

fn step() -> impl Strategy<Value = Step> {
    let of = prop::sample::select(vec![None, Some("1"), Some("2")]);
    let id = prop::sample::select(vec!["1", "2"]);
    prop_oneof![
        4 => (of, any::<bool>()).prop_map(|(of, is_held)| Step::Comes { of, is_held }),
        8 => Just(Step::Served),
        1 => Just(Step::PutOff),
        1 => Just(Step::RefusedAtStore),
        1 => Just(Step::Lacks),
        2 => Just(Step::Refused),
        1 => Just(Step::LetGo),
        2 => Just(Step::Retried),
        2 => Just(Step::Released),
        3 => id.prop_map(Step::Assigned),
        2 => Just(Step::Unassigned),
        2 => Just(Step::GivenUp),
    ]
}

fn scan(n: usize) -> ScanId {
    ScanId::of_digest([u8::try_from(n).unwrap(); 32])
}

fn patient(id: &str) -> Patient {
    Patient { id: id.to_owned(), sources: vec![Source::from_kind(SourceKind::Operator)] }
}

fn first_seen() -> Timestamp {
    "2026-11-21T09:15:00Z".parse().unwrap()
}

/// Lets a step happen, where the station would let it.
fn happens(journal: &Journal, n: usize, step: Step) {
    let scan = scan(n);
    let Some(whole) = journal.whole(&scan).unwrap() else {
        if let Step::Comes { of, is_held } = step {
            comes(journal, &scan, of, is_held);
        }
        return;
    };
    let is = whole.disposition();
    let number = journal.last_decision(&scan).unwrap() + 1;
    let in_state = |state| journal.deliveries_in(&scan, state).unwrap();
    let due = journal.pending().unwrap().into_iter().find(|due| due.scan == scan);
    match (step, due) {
        (Step::Comes { of: Some(id), .. }, _)
            if is == Disposition::Delivered && !whole.owners().contains(id) =>
        {
            comes(journal, &scan, Some(id), true);
        }
        (Step::Served, Some(due)) => match due.task {
            At::Deliver => journal.delivered(&due, "/r/x".as_ref()).unwrap(),
            At::Withdraw => journal.withdrawn(&due).unwrap(),
            At::HandOver => {}
        },
        (Step::PutOff, Some(due)) => journal.put_off(&due, "put-off", first_seen()).unwrap(),
        (Step::RefusedAtStore, Some(due)) if due.task == At::Deliver => {
            let (code, message) = ("patient-folder-clash", "it may be another patient's");
            journal.refused_at_store(&due, code, message).map(drop).unwrap();
        }
        (Step::Lacks, Some(due)) if due.task == At::Deliver => {
            journal.lacks_measures(&due).unwrap();
        }
        (Step::Refused, _) if whole.summary.state == ScanState::Spooled => {
            journal.refused(&scan, "no-leg", "neither leg can be measured").unwrap();
        }
        (Step::LetGo, _) if is == Disposition::Refused => journal.let_go_of(&scan).unwrap(),
        (Step::Retried, _) if whole.summary.state == ScanState::Refused => {
            let refused = in_state(DeliveryState::Refused);
            journal.reopened(&scan, &refused, DeliveryStep::Retry, None).unwrap();
        }
        (Step::Released, _) if is == Disposition::Held && whole.owners().len() == 1 => {
            let held = in_state(DeliveryState::Held);
            journal.reopened(&scan, &held, DeliveryStep::Release, Some(number)).unwrap();
        }
        (Step::Assigned(id), _) if journal.owners(&scan).unwrap().is_empty() => {
            let is_there = whole.summary.state != ScanState::Refused;
            if is_there {
                let (theirs, detail) = ([patient(id)], json!({ "decision": number }));
                journal.given_to(&scan, &theirs, &STORES, Event::Assigned, &detail).unwrap();
            }
        }
        (Step::Unassigned, _) if journal.owners(&scan).unwrap().len() == 1 => {
            let detail = json!({ "decision": number });
            journal.given_to(&scan, &[], &STORES[..1], Event::Unassigned, &detail).unwrap();
        }
        (Step::GivenUp, _) if is.needs_decision() => journal.given_up(&scan, number).unwrap(),
        _ => {}
    }
}

fn comes(journal: &Journal, scan: &ScanId, of: Option<&str>, is_held: bool) {
    let row = ScanRow {
        scan: scan.clone(),
        format: "obj".to_owned(),
        size: 12,
        first_seen: first_seen(),
        file_time: None,
        pressed_at: None,
        state: if is_held { ScanState::Delivered } else { ScanState::Spooled },
    };
    let patient = of.map(patient);
    let entry = Entry {
        row: &row,
        patient: patient.as_ref(),
        held: is_held.then_some("capture-unclear"),
        claims: &[],
        judged: &CaptureMatch::Unpressed,
        geometry: "",
        candidates: &[],
    };
    let stores = if of.is_some() { &STORES[..] } else { &STORES[..1] };
    journal.enter(&entry, stores).unwrap();
}

/// Light, page and lists agree about one scan.
fn agrees(journal: &Journal, n: usize) -> Result<(), TestCaseError> {
    let scan = scan(n);
    let Some(whole) = journal.whole(&scan).unwrap() else { return Ok(()) };
    let is = whole.disposition();
    let none = BTreeSet::new();
    let shown = scan_shown(&whole, &ScanDetails::default(), Language::En);
    prop_assert_eq!(shown.state, is.word(), "{:?}", &whole);
    prop_assert_eq!(shown.task == Task::Decide, is.needs_decision(), "{:?}", &whole);
    prop_assert_eq!(journal.is_undecided(&scan).unwrap(), is.needs_decision());
    // What a store refused for good needs a decision once the others have it.
    let is_any = |wanted| whole.deliveries.iter().any(|of| of.state == wanted);
    let is_open = whole.summary.closed.is_none() && !is_any(DeliveryState::Pending);
    if is_open && is_any(DeliveryState::Refused) {
        prop_assert!(is.needs_decision(), "{:?}", &whole);
    }
    // A scan that needs a decision offers one.
    prop_assert!(!(is.needs_decision() && shown.acts.is_empty()), "{:?}", &whole);
    let is_told = matches!(is, Disposition::Held | Disposition::Refused);
    prop_assert_eq!(shown.advice.is_some(), is_told, "{:?}", &whole);
    // The light shows that a person is needed if page and lists do.
    let at_the_light = match LastOutcome::from_whole(&whole, &[]) {
        _ if whole.is_in_work(&none) => vec![Disposition::Spooled],
        Some(LastOutcome::Held { .. }) => vec![Disposition::Held],
        Some(LastOutcome::Refused { .. }) => vec![Disposition::Refused],
        Some(_) => vec![Disposition::Delivered, Disposition::Unassigned],
        None => vec![Disposition::Withdrawing, Disposition::Closed, Disposition::Left],
    };
    prop_assert!(at_the_light.contains(&is), "{:?}: {:?}", at_the_light, &whole);
    // While a result waits to be fetched, the light shows "done" only for a record that a patient has.
    let waits = is == Disposition::Spooled && !whole.is_in_work(&BTreeSet::from(["gdt"]));
    let is_done = LastOutcome::from_whole(&whole, &[]).is_some();
    prop_assert_eq!(waits && is_done, waits && whole.has_record(), "{:?}", &whole);
    let said = in_words(&whole, Language::En);
    prop_assert_eq!(said.starts_with("is held"), is == Disposition::Held, "{}", said);
    prop_assert_eq!(said.ends_with("in quarantine"), is == Disposition::Refused, "{}", said);
    let explained = explain(&whole, &Default::default(), first_seen(), Language::En);
    prop_assert_eq!(explained.contains("action needed"), is == Disposition::Held, "{}", explained);
    prop_assert_eq!(
        explained.contains("in the spool"),
        is == Disposition::Spooled,
        "{}",
        explained
    );
    Ok(())
}

/// Lists, search and status agree about all scans.
fn lists_agree(journal: &Journal) -> Result<(), TestCaseError> {
    prop_assert_eq!(journal.misjudged(), []);
    let all: Vec<Whole> = (0..SCANS).filter_map(|n| journal.whole(&scan(n)).unwrap()).collect();
    let those = |holds: &dyn Fn(&Whole) -> bool| -> BTreeSet<String> {
        all.iter().filter(|whole| holds(whole)).map(|whole| whole.scan.clone()).collect()
    };
    let is = |wanted: Disposition| those(&|whole| whole.disposition() == wanted);
    let listed = |filter| -> BTreeSet<String> {
        let list = journal.list(Some(filter), 99).unwrap();
        list.iter().flat_map(|row| those(&|whole| whole.scan.starts_with(&row.scan))).collect()
    };
    prop_assert_eq!(listed(Filter::Held), is(Disposition::Held));
    let unassigned = those(&|whole| whole.disposition().is_unassigned());
    prop_assert_eq!(listed(Filter::Unassigned), unassigned.clone());
    let found = |state| -> BTreeSet<String> {
        let search = Search { state: Some(state), limit: 99, ..Search::default() };
        journal.search(&search).unwrap().into_iter().map(|scan| scan.as_str().to_owned()).collect()
    };
    let undecided = those(&|whole| whole.task() == Task::Decide);
    prop_assert_eq!(found(SearchState::Undecided), undecided.clone());
    prop_assert_eq!(found(SearchState::Unassigned), unassigned);
    let tally = journal.tally().unwrap();
    for found in Disposition::ALL {
        prop_assert_eq!(tally.dispositions[found.word()] as usize, is(found).len());
    }
    prop_assert_eq!(tally.held as usize, is(Disposition::Held).len());
    prop_assert_eq!(tally.scans["refused"] as usize, is(Disposition::Refused).len());
    // What a person must do stands on the page, as long as the patient may be there.
    let tasks = those(&|whole| whole.task() != Task::Nothing);
    for (since, expected) in [(Timestamp::MIN, &tasks), (Timestamp::MAX, &undecided)] {
        let open = journal.open_tasks(99, since).unwrap();
        let open: BTreeSet<String> = open.iter().map(|scan| scan.as_str().to_owned()).collect();
        prop_assert_eq!(&open, expected);
        prop_assert_eq!(journal.count_open_tasks(since).unwrap() as usize, expected.len());
    }
    Ok(())
}

#[test]
fn light_page_lists_search_and_status_say_the_same_of_every_scan() {
    let histories = std::env::var("GAITER_SEQUENCES").ok().and_then(|count| count.parse().ok());
    let cases = histories.unwrap_or(200_u32).div_ceil(SCANS as u32);
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let steps = prop::collection::vec((0..SCANS, step()), 60..120);
    let mut runner = TestRunner::new(config);
    let all = runner.run(&steps, |steps| {
        let dir = tempfile::tempdir().unwrap();
        let journal = Journal::open(&dir.path().join("journal.db")).unwrap();
        let journal = journal.with_servers(&STORES[2..]).unwrap();
        for (n, step) in steps {
            happens(&journal, n, step);
            agrees(&journal, n)?;
        }
        lists_agree(&journal)
    });
    all.unwrap_or_else(|fault| panic!("{fault}"));
}
