//! The sentences about a scan in each of its states.

use super::*;
use crate::facts::StoreRefusal;

fn at(second: i64) -> Timestamp {
    Timestamp::from_second(1_800_000_000 + second).unwrap()
}

/// A scan first seen at 0 with one delivery.
fn whole(state: ScanState, delivery: DeliveryState, attempts: u64) -> Whole {
    let refused = state == ScanState::Refused;
    Whole {
        scan: "abcd".repeat(16),
        summary: Summary {
            state,
            first_seen: at(0),
            file_time: None,
            format: "obj".to_owned(),
            size: 12,
            code: refused.then(|| "scan-empty".to_owned()),
            message: refused.then(|| "the file is empty".to_owned()),
            closed: None,
            incomplete: false,
        },
        deliveries: vec![Delivered {
            patient: Some("4711".to_owned()),
            store: "folder".to_owned(),
            state: delivery,
            code: None,
            attempts,
            next_at: (attempts > 0).then(|| at(900)),
            folder: Some("/srv/records/4711/x".to_owned()),
        }],
        candidates: Vec::new(),
        preview: None,
        history: Vec::new(),
    }
}

#[test]
fn each_state_is_said_in_a_sentence_of_its_own() {
    let cases = [
        (
            whole(ScanState::Spooled, DeliveryState::Pending, 0),
            "waits for its turn to be measured.",
        ),
        (whole(ScanState::Spooled, DeliveryState::Pending, 3), "3 attempts"),
        (whole(ScanState::Refused, DeliveryState::Refused, 0), "[scan-empty]: the file is empty."),
        (whole(ScanState::Delivered, DeliveryState::Held, 0), "for another patient"),
        (whole(ScanState::Delivered, DeliveryState::Delivered, 0), "nothing is left to do."),
    ];
    for (whole, expected) in cases {
        let said = explain(&whole, &BTreeMap::new(), at(600), Language::En);
        assert!(said.starts_with("Scan abcdabcd ") && said.ends_with('.'), "{said}");
        assert!(said.contains(expected), "{said}");
        assert!(!said.contains("4711"), "{said} names the patient");
    }
}

#[test]
fn an_attempt_to_come_is_told_with_its_time() {
    let waits = whole(ScanState::Spooled, DeliveryState::Pending, 3);
    let [said, german] =
        Language::ALL.map(|language| explain(&waits, &BTreeMap::new(), at(600), language));
    assert!(said.contains("for 10 minutes") && said.contains("in 5 minutes"), "{said}");
    assert!(german.contains("seit 10 Minuten") && german.contains("in 5 Minuten"), "{german}");
}

#[test]
fn what_is_held_goes_before_what_waits() {
    let mut both = whole(ScanState::Spooled, DeliveryState::Pending, 0);
    let held = Delivered { state: DeliveryState::Held, ..both.deliveries[0].clone() };
    both.deliveries.push(held);
    assert!(
        explain(&both, &BTreeMap::new(), at(1), Language::En).contains("Operator action needed")
    );
}

#[test]
fn a_record_without_a_patient_says_so() {
    let mut nobody = whole(ScanState::Delivered, DeliveryState::Delivered, 0);
    nobody.deliveries[0].patient = None;
    assert!(explain(&nobody, &BTreeMap::new(), at(1), Language::En).contains("_unassigned"));
}

#[test]
fn a_scan_whose_store_is_away_waits_for_the_store_and_not_for_its_turn() {
    let fault = StoreFacts {
        refusal: Some(StoreRefusal::Fault("opening failed".into())),
        since: at(0),
        is_of_delivery: false,
    };
    let stores = BTreeMap::from([("folder", fault)]);
    let said = explain(
        &whole(ScanState::Spooled, DeliveryState::Pending, 0),
        &stores,
        at(1),
        Language::En,
    );
    assert!(said.contains("waits for the store") && said.contains("opening failed"), "{said}");
}

#[test]
fn a_reason_that_is_a_sentence_of_its_own_ends_once() {
    let mut refused = whole(ScanState::Refused, DeliveryState::Refused, 0);
    refused.summary.message = Some("are both legs in the scan?".to_owned());
    let [said, german] =
        Language::ALL.map(|language| explain(&refused, &BTreeMap::new(), at(1), language));
    assert!(said.ends_with("are both legs in the scan?"), "{said}");
    assert!(german.ends_with("bricht mitten darin ab."), "{german}");
}

#[test]
fn a_record_that_is_to_go_is_nobodys() {
    let mut taken_back = whole(ScanState::Delivered, DeliveryState::Delivered, 0);
    assert_eq!(taken_back.disposition(), Disposition::Delivered);
    taken_back.deliveries[0].code = Some(UNASSIGNED.to_owned());
    assert_eq!(taken_back.disposition(), Disposition::Unassigned);
}

#[test]
fn a_scan_whose_last_result_waits_to_be_fetched_is_not_in_work() {
    let mut whole = whole(ScanState::Spooled, DeliveryState::Pending, 0);
    assert!(whole.is_in_work(&BTreeSet::from(["gdt"])), "its own store waits for nobody");
    whole.deliveries[0].store = "gdt".to_owned();
    assert!(whole.is_in_work(&BTreeSet::new()) && !whole.is_in_work(&BTreeSet::from(["gdt"])));
}

/// Red while one sentence stood for all causes.
#[test]
fn a_scan_that_may_be_of_several_says_whether_more_than_one_of_them_is_known() {
    let mut held = whole(ScanState::Delivered, DeliveryState::Held, 0);
    held.deliveries[0].code = Some(AMBIGUOUS.to_owned());
    let said = |held: &Whole| explain(held, &BTreeMap::new(), at(1), Language::En);
    held.candidates = vec!["4711".to_owned()];
    let one = said(&held);
    assert!(one.contains("[capture-ambiguous]: It could be somebody else's"), "{one}");
    held.candidates.push("0815".to_owned());
    let two = said(&held);
    assert!(two.contains("[capture-ambiguous]: It could belong to more than one"), "{two}");
}
