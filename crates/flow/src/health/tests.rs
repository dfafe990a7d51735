//! What the station complains of, and what not.

use std::collections::BTreeMap;
use std::path::PathBuf;

use gaiter_language::Language;
use proptest::prelude::*;

use super::*;
use crate::complaint::Severity;
use crate::export::passed_over::PassedOver;
use crate::facts::{Alarm, StoreAttempt, StoreFacts, TriggerFacts, WaitingFile, WorklistFacts};
use crate::settle::Wait;
use crate::trigger::PortState;

const OVERDUE: Duration = Duration::from_secs(600);
const EMPTY: Backlog = Backlog {
    pending: 0,
    oldest: None,
    revisions_refused: 0,
    moved: BTreeMap::new(),
    certificates: BTreeMap::new(),
};

fn at(second: i64) -> Timestamp {
    Timestamp::from_second(1_800_000_000 + second).unwrap()
}

fn facts() -> Facts {
    let mut facts = Facts::new(at(0), 2);
    facts.sources.iter_mut().for_each(|source| source.state = SourceState::Watched);
    facts
}

fn codes(facts: &Facts, backlog: &Backlog, now: Timestamp) -> Vec<String> {
    complaints(facts, backlog, OVERDUE, now).into_iter().map(|found| found.code).collect()
}

fn fault(why: &str) -> Option<StoreRefusal> {
    Some(StoreRefusal::Fault(why.into()))
}

fn source(state: SourceState) -> Facts {
    let mut facts = facts();
    facts.sources[1].state = state;
    facts
}

#[test]
fn a_station_in_order_is_ready_before_its_first_look_too() {
    assert_eq!(complaints(&facts(), &EMPTY, OVERDUE, at(99)), []);
    assert_eq!(complaints(&Facts::new(at(0), 3), &EMPTY, OVERDUE, at(99)), []);
}

#[test]
fn every_fault_has_its_code_and_something_to_do() {
    let stored =
        StoreFacts { refusal: fault("writing failed"), since: at(0), is_of_delivery: false };
    let alarm = Alarm { figures: ComplaintFigures::why(&"it was damaged".into()), since: at(0) };
    let waiting = WaitingFile { wait: Wait::Turn, since: at(0), overdue: true };
    let cases: Vec<(&str, Facts)> = vec![
        ("paused", Facts { intake: IntakeState::Paused, ..facts() }),
        ("disk-low", Facts { intake: IntakeState::DiskLow { free: 1, floor: 2 }, ..facts() }),
        ("store-fault", Facts { stores: BTreeMap::from([("folder", stored)]), ..facts() }),
        ("source-out-of-reach", source(SourceState::OutOfReach("no such file".into()))),
        ("source-not-mounted", source(SourceState::NotMounted("no marker file".into()))),
        ("source-stalled", source(SourceState::Stalled)),
        ("export-not-taken", {
            let mut facts = facts();
            facts.sources[0].waiting.insert(PathBuf::from("/e/4711.obj"), waiting);
            facts
        }),
        ("export-gone", {
            let mut facts = facts();
            facts.sources.iter_mut().for_each(|source| source.gone_count = 1);
            facts
        }),
        (
            "journal-rebuilt",
            Facts { alarms: BTreeMap::from([("journal-rebuilt", alarm)]), ..facts() },
        ),
        ("reload-refused", Facts { refused_reload: Some("1 fault".into()), ..facts() }),
    ];
    for (code, facts) in cases {
        let found = complaints(&facts, &EMPTY, OVERDUE, at(60));
        assert_eq!(found.iter().map(|found| found.code.as_str()).collect::<Vec<_>>(), [code]);
        assert_stated(&found[0]);
    }
}

/// Its text exists in every language with all its figures, and names no file.
fn assert_stated(found: &Complaint) {
    for language in Language::ALL {
        let (message, remedy) = (found.message(language), found.remedy(language));
        assert!(message != found.code && !remedy.is_empty(), "{found:?}");
        assert!(!message.contains(['?', '{']), "{message}");
        assert!(!message.contains("4711"), "{message}");
    }
}

#[test]
fn a_complaint_is_said_with_its_figures_in_each_language() {
    let both = |facts: &Facts| {
        let found = complaints(facts, &EMPTY, OVERDUE, at(180));
        Language::ALL.map(|language| found[0].message(language))
    };
    let low = Facts { intake: IntakeState::DiskLow { free: 1_500_000, floor: 2 }, ..facts() };
    let [english, german] = both(&low);
    assert!(english.contains(" 1.5 MB free ") && german.contains(" 1,5 MB frei"), "{german}");
    let [english, german] = both(&source(SourceState::Stalled));
    assert_eq!(english, "export folder 1 has not answered for 3 minutes");
    assert!(german.ends_with(" seit 3 Minuten nicht"), "{german}");
    let [english, german] = both(&source(SourceState::OutOfReach("no such file".into())));
    assert_eq!(english, "export folder 1 cannot be listed: no such file");
    assert!(german.ends_with(": no such file"), "{german}");
    let lacks = Cause::known("no-marker", []);
    let [english, german] = both(&source(SourceState::NotMounted(lacks)));
    assert!(english.ends_with(": lacks the file that scanner.marker names"), "{english}");
    assert!(german.ends_with(": ihm fehlt die Datei, die scanner.marker nennt"), "{german}");
    let counts = BTreeMap::from([(PassedOver::Packed, 2)]);
    let alarm = Alarm { figures: ComplaintFigures::default().unread(counts), since: at(0) };
    let passed = Facts { alarms: BTreeMap::from([(EXPORT_PASSED_OVER, alarm)]), ..facts() };
    let [english, german] = both(&passed);
    assert!(english.ends_with(": packed files 2"), "{english}");
    assert!(german.ends_with(": gepackte Dateien 2"), "{german}");
}

#[test]
fn a_fault_that_passes_at_once_is_no_complaint() {
    let gone = source(SourceState::OutOfReach("timed out".into()));
    assert_eq!(codes(&gone, &EMPTY, at(4)), [""; 0]);
    assert_eq!(codes(&gone, &EMPTY, at(5)), ["source-out-of-reach"]);
    let fault = StoreFacts { refusal: fault("busy"), since: at(0), is_of_delivery: false };
    let store = Facts { stores: BTreeMap::from([("folder", fault)]), ..facts() };
    assert_eq!(codes(&store, &EMPTY, at(4)), [""; 0]);
    assert_eq!(codes(&store, &EMPTY, at(5)), ["store-fault"]);
}

#[test]
fn the_fault_of_a_delivery_stays_until_a_record_is_delivered_or_none_waits() {
    let after = |before: &StoreFacts, attempt: StoreAttempt, is_awaited: bool, second: i64| {
        StoreFacts::after(Some(before), attempt, is_awaited, at(second))
    };
    let well = StoreFacts::after(None, StoreAttempt::Look(None), true, at(0));
    assert_eq!((well.refusal.clone(), well.since), (None, at(0)));
    let full = after(&well, StoreAttempt::Delivery(fault("full")), true, 10);
    // The folder can be written, as long as the file is small.
    let looked = after(&full, StoreAttempt::Look(None), true, 20);
    assert_eq!((looked.refusal.clone(), looked.since), (fault("full"), at(10)));
    let away = after(&looked, StoreAttempt::Look(fault("away")), true, 30);
    let back = after(&away, StoreAttempt::Look(None), true, 40);
    assert_eq!((back.refusal.clone(), back.since), (fault("away"), at(10)));
    assert_eq!(after(&back, StoreAttempt::Look(None), false, 50).refusal, None);
    let delivered = after(&back, StoreAttempt::Delivery(None), true, 50);
    assert_eq!((delivered.refusal, delivered.since), (None, at(50)));
    // What a look finds, a look disproves.
    let away = after(&well, StoreAttempt::Look(fault("away")), true, 60);
    assert_eq!(after(&away, StoreAttempt::Look(None), true, 70).refusal, None);
}

#[test]
fn a_scan_is_overdue_only_after_the_time_and_whatever_the_reason() {
    let backlog = Backlog { pending: 1, oldest: Some(at(0)), ..EMPTY };
    assert_eq!(codes(&facts(), &backlog, at(600)), [""; 0]);
    assert_eq!(codes(&facts(), &backlog, at(601)), ["delivery-overdue"]);
}

#[test]
fn a_clock_that_was_set_back_hides_no_fault() {
    let stalled = source(SourceState::Stalled);
    assert_eq!(codes(&stalled, &EMPTY, at(-7200)), ["source-stalled"]);
    let backlog = Backlog { pending: 1, oldest: Some(at(0)), ..EMPTY };
    assert_eq!(codes(&facts(), &backlog, at(-1)), ["delivery-overdue"]);
    assert_stated(&complaints(&facts(), &backlog, OVERDUE, at(-1))[0]);
}

proptest! {
    /// However old a backlog is, it is complained of from one moment on and ever after.
    #[test]
    fn a_backlog_once_overdue_stays_overdue(seen in 0_i64..10_000, a in 0_i64..20_000, b in 0_i64..20_000) {
        let backlog = Backlog { pending: 1, oldest: Some(at(seen)), ..EMPTY };
        let late = |now: i64| !codes(&facts(), &backlog, at(seen + now)).is_empty();
        prop_assert!(!late(a.min(b)) || late(a.max(b)));
    }
}

#[test]
fn a_port_that_is_not_sound_for_a_minute_has_the_code_of_its_state() {
    let at_port = |state, unsound_since| {
        let port = TriggerFacts { state, unsound_since, ..TriggerFacts::new(at(0)) };
        Facts { triggers: BTreeMap::from([("serial", port)]), ..facts() }
    };
    let cases = [
        (PortState::Absent, "trigger-absent"),
        (PortState::Busy, "trigger-busy"),
        (PortState::Denied, "trigger-denied"),
        (PortState::Failed, "trigger-failed"),
        (PortState::Stuck, "trigger-stuck"),
        (PortState::Hung, "trigger-hung"),
        (PortState::Open, "trigger-unsteady"),
    ];
    for (state, code) in cases {
        let facts = at_port(state, Some(at(0)));
        assert_eq!(codes(&facts, &EMPTY, at(59)), Vec::<String>::new());
        assert_eq!(codes(&facts, &EMPTY, at(60)), [code]);
        assert_stated(&complaints(&facts, &EMPTY, OVERDUE, at(60))[0]);
        assert_eq!(codes(&at_port(state, None), &EMPTY, at(600)), Vec::<String>::new());
    }
}

#[test]
fn a_result_that_nobody_fetched_is_a_notice_of_a_station_that_is_ready() {
    let refusal = Some(StoreRefusal::NotFetched);
    let waits = StoreFacts { refusal, since: at(0), is_of_delivery: true };
    let facts = Facts { stores: BTreeMap::from([("gdt", waits)]), ..facts() };
    assert_eq!(complaints(&facts, &EMPTY, OVERDUE, at(4)), []);
    let found = complaints(&facts, &EMPTY, OVERDUE, at(3600));
    let [notice] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!((notice.code.as_str(), notice.is_fault()), ("result-not-fetched", false));
    assert_eq!(notice.subject.as_deref(), Some("gdt"));
    assert_stated(notice);
}

#[test]
fn a_revision_that_a_store_refuses_is_a_notice_until_none_is_left() {
    for count in [1, 2] {
        let backlog = Backlog { revisions_refused: count, ..EMPTY };
        let found = complaints(&facts(), &backlog, OVERDUE, at(0));
        let [notice] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((notice.code.as_str(), notice.is_fault()), ("revision-refused", false));
        assert_stated(notice);
    }
    assert_eq!(complaints(&facts(), &EMPTY, OVERDUE, at(0)), []);
}

#[test]
fn the_advice_for_a_server_is_that_of_disks_while_the_disk_is_full() {
    let of = |number: i32, store: &str| {
        let why = Cause::of_system(&std::io::Error::from_raw_os_error(number));
        Complaint::new("store-fault", ComplaintFigures::why(&why.after("noting failed")))
            .about(store)
    };
    for language in Language::ALL {
        for store in ["fhir", "hl7", "dicom", "archive"] {
            let [full, refused] = [28, 111].map(|number| of(number, store));
            assert_ne!(full.remedy(language), refused.remedy(language));
            assert!(full.message(language).contains(store), "{full:?}");
            let next = |of: &Complaint| crate::page::of_complaint(of, language).next;
            assert_ne!(next(&full), next(&refused));
        }
        assert_eq!(of(28, "folder").remedy(language), of(111, "folder").remedy(language));
    }
}

#[test]
fn a_take_back_at_an_earlier_address_of_a_server_is_a_notice() {
    for count in [1, 2] {
        let backlog = Backlog { moved: BTreeMap::from([("fhir".to_owned(), count)]), ..EMPTY };
        let found = complaints(&facts(), &backlog, OVERDUE, at(0));
        let [notice] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((notice.code.as_str(), notice.is_fault()), ("store-moved", false));
        assert_eq!(notice.subject.as_deref(), Some("fhir"));
        assert_stated(notice);
    }
}

#[test]
fn a_certificate_of_the_station_is_a_notice_from_30_days_before_it_ends() {
    const DAY: i64 = 24 * 3600;
    let told = |ends: i64| {
        let certificates = BTreeMap::from([("hl7".to_owned(), at(ends))]);
        complaints(&facts(), &Backlog { certificates, ..EMPTY }, OVERDUE, at(0))
    };
    assert_eq!(told(30 * DAY), []);
    for (ends, says) in [(30 * DAY - 1, "ends in 29 days"), (-1, "has ended")] {
        let found = told(ends);
        let [notice] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((notice.code.as_str(), notice.is_fault()), ("certificate-ends", false));
        assert!(notice.message(Language::En).contains(says), "{notice:?}");
        assert_stated(notice);
    }
}

#[test]
fn a_store_that_is_a_server_has_words_of_its_own() {
    let remedy = |store: &str, language| {
        Complaint::new("store-fault", ComplaintFigures::default()).about(store).remedy(language)
    };
    for language in [Language::En, Language::De] {
        assert_ne!(remedy("fhir", language), remedy("folder", language));
        for store in ["hl7", "dicom", "archive"] {
            assert_eq!(remedy(store, language), remedy("fhir", language));
        }
    }
}

#[test]
fn a_worklist_that_is_away_for_a_minute_is_a_notice_of_a_station_that_is_ready() {
    let mut worklist = WorklistFacts::new(at(0));
    worklist.note(None, at(10));
    worklist.note(Some("it does not answer".into()), at(70));
    worklist.note(Some("it does not answer".into()), at(130));
    let facts = Facts { worklist: Some(worklist.clone()), ..facts() };
    assert_eq!(codes(&facts, &EMPTY, at(71)), [""; 0]);
    let found = complaints(&facts, &EMPTY, OVERDUE, at(140));
    let found: Vec<_> = found.iter().map(|of| (of.code.as_str(), of.severity)).collect();
    assert_eq!(found, [("worklist-out-of-reach", Severity::Notice)]);
    // One that never answered since the start, too.
    let mut never = WorklistFacts::new(at(0));
    for second in [1, 61, 121] {
        never.note(Some("it does not answer".into()), at(second));
    }
    let silent = Facts { worklist: Some(never), ..facts.clone() };
    assert_eq!(codes(&silent, &EMPTY, at(122)), ["worklist-out-of-reach"]);
    worklist.note(None, at(150));
    let facts = Facts { worklist: Some(worklist), ..facts };
    assert_eq!(codes(&facts, &EMPTY, at(999)), [""; 0]);
}

#[test]
fn ids_that_name_nobody_where_they_are_read_are_a_notice_of_a_station_that_is_ready() {
    let told = |numbers, second| {
        let worklist = WorklistFacts { numbers, ..WorklistFacts::new(at(0)) };
        let facts = Facts { worklist: Some(worklist), ..facts() };
        let found = complaints(&facts, &EMPTY, OVERDUE, at(second));
        assert!(found.iter().all(|of| of.severity == Severity::Notice));
        found.into_iter().map(|of| of.code).collect::<Vec<_>>()
    };
    let like_ids = Some(AccessionNumbers::LikeIds);
    assert_eq!(told(like_ids, 1), ["worklist-numbers-like-ids"]);
    let unseen = Some(AccessionNumbers::Unseen);
    assert_eq!(
        (told(unseen, 1).len(), told(unseen, 61)),
        (0, vec!["worklist-numbers-unseen".into()])
    );
    for quiet in [Some(AccessionNumbers::Apart), None] {
        assert!(told(quiet, 999).is_empty(), "{quiet:?}");
    }
}
