//! What the page shows and offers in each state.

mod held;
mod light;
mod next;
mod rows;

use std::collections::BTreeSet;
use std::time::Duration;

use super::*;
use crate::account::{Delivered, Summary, Whole};
use crate::booth::Signal;
use crate::facts::{SourceState, StoreFacts, StoreRefusal};
use crate::round::Why;
use crate::{Closed, DeliveryState, ScanState};

const BOTH: [Language; 2] = [Language::En, Language::De];

fn at(second: i64) -> Timestamp {
    Timestamp::from_second(1_800_000_000 + second).unwrap()
}

fn booth(signal: Signal) -> Situation<'static> {
    Situation {
        signal,
        has_button: true,
        is_button_away: false,
        awaited: 0,
        next: &[],
        awaited_for: &[],
        is_asked: false,
        is_in_doubt: false,
        doubt_left: None,
        held_next: None,
        progress: None,
        last: None,
        last_scan: None,
        last_of: &[],
    }
}

fn page(booth: Situation<'_>, complaints: &[Complaint], language: Language) -> Shown {
    page_with(booth, complaints, Vec::new(), language)
}

/// The page with these scans about which a person must do something.
fn page_with(
    booth: Situation<'_>,
    complaints: &[Complaint],
    undecided: Vec<ScanShown>,
    language: Language,
) -> Shown {
    let facts = Facts::new(at(0), 1);
    let known =
        StationView { page: "1", station: "b", facts: &facts, complaints, booth, now: at(1) };
    assemble(&known, undecided, 0, Vec::new(), language)
}

fn delivery(patient: Option<&str>, state: &str, code: Option<&str>) -> Delivered {
    Delivered {
        patient: patient.map(str::to_owned),
        store: "folder".to_owned(),
        state: DeliveryState::of_word(state).unwrap(),
        code: code.map(str::to_owned),
        attempts: 0,
        next_at: None,
        folder: None,
    }
}

fn scan(state: &str, code: Option<&str>, deliveries: Vec<Delivered>) -> ScanShown {
    scan_shown(&whole(state, code, deliveries), &ScanDetails::default(), Language::En)
}

fn whole(state: &str, code: Option<&str>, deliveries: Vec<Delivered>) -> Whole {
    let summary = Summary {
        state: ScanState::of_word(state).unwrap(),
        first_seen: at(0),
        file_time: None,
        format: "obj".to_owned(),
        size: 12,
        code: code.map(str::to_owned),
        message: None,
        closed: None,
        incomplete: false,
    };
    Whole {
        scan: "ab".repeat(32),
        summary,
        deliveries,
        candidates: Vec::new(),
        preview: None,
        history: Vec::new(),
    }
}

/// The scan of these deliveries, each with a folder named after its patient.
fn with_folders(deliveries: &[(Option<&str>, &str)]) -> Whole {
    let deliveries = deliveries.iter().map(|(patient, state)| Delivered {
        folder: Some(format!("of-{}", patient.unwrap_or("nobody"))),
        ..delivery(*patient, state, None)
    });
    whole("delivered", None, deliveries.collect())
}

#[test]
fn a_record_is_opened_from_a_scan_only_under_the_name_of_its_patient() {
    let (first, second, nobody) = (Some("1"), Some("2"), None);
    for (deliveries, folder) in [
        (vec![(first, "delivered")], Some("of-1")),
        (vec![(nobody, "delivered")], Some("of-nobody")),
        (vec![(nobody, "delivered"), (first, "delivered")], Some("of-1")),
        (vec![(first, "withdrawn"), (nobody, "delivered")], Some("of-nobody")),
        // The same bytes came in for a second patient.
        (vec![(first, "delivered"), (second, "held")], None),
        (vec![(first, "delivered"), (second, "pending")], None),
        (vec![(first, "delivered"), (second, "delivered")], None),
        (vec![(nobody, "delivered"), (second, "held")], Some("of-nobody")),
        (vec![(first, "delivered"), (nobody, "delivered")], Some("of-1")),
        (["withdrawn", "withdrawing", "held", "pending"].map(|state| (first, state)).into(), None),
        (vec![(first, "pending")], None),
    ] {
        let whole = with_folders(&deliveries);
        assert_eq!(record_folder(&whole, "folder"), folder, "{deliveries:?}");
        assert_eq!(record_folder(&whole, "copy"), None);
    }
}

#[test]
fn a_refused_scan_whose_bytes_were_let_go_is_offered_for_no_retry() {
    let mut whole = whole("refused", Some("no-leg"), vec![delivery(Some("1"), "refused", None)]);
    for (closed, acts) in [(Closed::GivenUp, vec!["retry"]), (Closed::LetGo, vec![])] {
        whole.summary.closed = Some(closed);
        assert_eq!(
            scan_shown(&whole, &ScanDetails::default(), Language::En).acts,
            acts,
            "{closed:?}"
        );
    }
}

#[test]
fn every_signal_has_a_word_and_a_sentence_of_its_own_in_both_languages() {
    let said: BTreeSet<(String, String)> = BOTH
        .into_iter()
        .flat_map(|language| Signal::ALL.map(|signal| page(booth(signal), &[], language).light))
        .map(|light| (light.word.to_owned(), light.said.text))
        .collect();
    assert_eq!(said.len(), 2 * Signal::ALL.len(), "{said:?}");
    let sentences: BTreeSet<&String> = said.iter().map(|(_, sentence)| sentence).collect();
    assert_eq!(sentences.len(), said.len(), "{sentences:?}");
    assert!(sentences.iter().all(|sentence| sentence.ends_with('.')), "{sentences:?}");
}

#[test]
fn attention_says_first_what_is_most_wrong_and_what_to_do() {
    let full = Complaint { code: "disk-low".into(), ..Complaint::journal() };
    for (language, words) in BOTH.into_iter().zip(["The disk is nearly full.", "Die Festplatte"]) {
        let light = page(booth(Signal::Attention), std::slice::from_ref(&full), language).light;
        assert!(light.said.text.starts_with(words), "{}", light.said.text);
    }
}

#[test]
fn a_station_that_is_ready_says_that_a_scan_waits_for_a_decision() {
    let waiting = scan("refused", Some("no-leg"), vec![]);
    let facts = Facts::new(at(0), 1);
    let known = StationView {
        page: "1",
        station: "b",
        facts: &facts,
        complaints: &[],
        booth: booth(Signal::Ready),
        now: at(1),
    };
    let light = assemble(&known, vec![waiting], 0, Vec::new(), Language::En).light;
    assert_eq!(
        light.said.text,
        "Press the button, then scan. A scan waits for your decision on the page."
    );
}

#[test]
fn what_is_wrong_is_said_before_a_decision_is_asked_for_and_of_many_faults_the_first() {
    let complaint = |code: &str| Complaint { code: code.into(), ..Complaint::journal() };
    let facts = Facts::new(at(0), 1);
    let sentence = |complaints: &[Complaint]| {
        let booth = booth(Signal::Attention);
        let known =
            StationView { page: "1", station: "b", facts: &facts, complaints, booth, now: at(1) };
        let held = vec![delivery(Some("1"), "held", Some("export-late"))];
        let undecided = vec![scan("delivered", None, held)];
        assemble(&known, undecided, 0, Vec::new(), Language::En).light.said.text
    };
    let both = [complaint("disk-low"), complaint("paused")];
    assert!(sentence(&both).starts_with("The disk is nearly full."), "{}", sentence(&both));
    assert_eq!(sentence(&[]), "A scan waits for your decision on the page.");
}

#[test]
fn a_decision_that_is_missing_goes_before_what_is_under_way() {
    let held = delivery(Some("2"), "held", Some("export-late"));
    let shown = scan("spooled", None, vec![delivery(Some("1"), "pending", None), held]);
    assert_eq!((shown.state, shown.acts), ("held", vec!["release", "assign", "give_up"]));
    let back = vec![delivery(Some("1"), "pending", None), delivery(None, "delivered", None)];
    assert_eq!(scan("spooled", None, back).state, "spooled");
}

#[test]
fn a_press_that_may_have_gone_unheard_is_told() {
    for language in BOTH {
        let doubt = |is_in_doubt, left_s: Option<u64>| {
            let doubt_left = left_s.map(Duration::from_secs);
            let booth = Situation { is_in_doubt, doubt_left, ..booth(Signal::Ready) };
            page(booth, &[], language).next.doubt
        };
        assert!(doubt(true, None).is_some() && doubt(false, Some(0)).is_none());
        assert!(
            doubt(true, Some(7 * 60)).unwrap().contains(" 7 min"),
            "and how long it is in doubt"
        );
    }
}

#[test]
fn a_store_that_takes_nothing_is_tried_again_first_and_bad_when_that_lasts() {
    let mut facts = Facts::new(at(0), 1);
    let refusal = Some(StoreRefusal::Fault("No space left".into()));
    facts.stores.insert("folder", StoreFacts { refusal, since: at(0), is_of_delivery: false });
    let health = |second: i64| {
        let parts = parts::parts_shown(&facts, at(second), Language::En);
        let store = parts.into_iter().find(|part| part.name == "Records").unwrap();
        (store.health, store.why)
    };
    let why = || Some("No space left".to_owned());
    assert_eq!([health(4), health(5)], [("wait", why()), ("bad", why())]);
}

#[test]
fn a_reason_is_of_its_own_code() {
    use crate::patient::identity;
    use crate::round;
    for (code, english, german) in [
        (round::AMBIGUOUS, "more than one", "mehr als einem"),
        (Why::Beside.word(), "beside it", "Neben ihm"),
        (Why::Unclear.word(), "before the button", "bevor der Knopf"),
        (Why::Late.word(), "after the time", "nach der Zeit"),
        (Why::Unheard.word(), "been missed", "nicht erkannt"),
        (Why::Unread.word(), "could not be read", "nicht lesbar"),
        (Why::Repeated.word(), "second time", "zweites Mal"),
        (identity::NO_PRESS, "Nobody pressed", "Niemand hat"),
        (identity::PATIENTS_DIFFER, "Two sources", "Zwei Quellen"),
        (identity::SAME_SCAN_OTHER_PATIENT, "another patient", "anderen Patienten"),
    ] {
        for (language, words) in BOTH.into_iter().zip([english, german]) {
            let advice = of_held(code, language);
            assert!(advice.what.contains(words), "{code}: {advice:?}");
        }
    }
}

#[test]
fn a_complaint_that_is_not_known_is_told_by_its_code() {
    let unknown = Complaint { code: "new".into(), ..Complaint::journal() };
    for language in BOTH {
        assert!(of_complaint(&unknown, language).what.contains("new"));
    }
}

#[test]
fn without_ids_no_patient_is_named_anywhere() {
    let ids = ["4711".to_owned()];
    let known = Situation { next: &ids, awaited_for: &ids, awaited: 1, ..booth(Signal::Ready) };
    let mut page = page(known, &[], Language::En);
    page.scans.push(scan("delivered", None, vec![delivery(Some("4711"), "delivered", None)]));
    page.undecided.push(scan("delivered", None, vec![delivery(Some("4711"), "held", None)]));
    let mut doubtful = whole("delivered", None, vec![delivery(None, "held", Some("no-press"))]);
    doubtful.candidates = vec!["4711".to_owned()];
    page.undecided.push(scan_shown(&doubtful, &ScanDetails::default(), Language::En));
    let refused = vec![delivery(Some("4711"), "refused", Some("no-leg"))];
    page.undecided.push(scan("refused", Some("no-leg"), refused));
    assert!(page.undecided.iter().any(|scan| scan.again.is_some()));
    assert!(page.scans.iter().any(|scan| scan.owner.is_some()));
    assert!(page.next.said.text.contains("4711") && page.next.who[0].id == "4711");
    assert_eq!(page.undecided[1].candidates[0].id, "4711");
    let page = page.without_ids();
    assert!(!format!("{page:?}").contains("4711") && !page.ids);
    assert!(page.next.can_be_called_off);
    assert_eq!(page.next.said.text, "The next patient is named. One export is expected.");
}

#[test]
fn what_a_person_can_decide_follows_from_what_became_of_the_scan() {
    let held = |code| vec![delivery(Some("1"), "held", Some(code))];
    for (state, code, deliveries, word, acts) in [
        ("refused", Some("no-leg"), vec![], "refused", vec!["retry", "give_up"]),
        ("delivered", None, held("export-late"), "held", vec!["release", "assign", "give_up"]),
        ("delivered", None, held("patients-differ"), "held", vec!["assign", "give_up"]),
        ("delivered", None, held("capture-ambiguous"), "held", vec!["assign", "give_up"]),
        ("delivered", None, held("same-scan-other-patient"), "held", vec!["release", "give_up"]),
        (
            "delivered",
            None,
            vec![delivery(None, "held", Some("no-press"))],
            "held",
            vec!["assign", "give_up"],
        ),
        (
            "delivered",
            None,
            vec![delivery(None, "delivered", None)],
            "unassigned",
            vec!["assign", "leave"],
        ),
        (
            "delivered",
            None,
            vec![delivery(Some("1"), "delivered", None)],
            "delivered",
            vec!["unassign"],
        ),
        (
            "refused",
            Some("patient-not-registered"),
            vec![
                delivery(Some("1"), "delivered", None),
                delivery(Some("1"), "refused", Some("patient-not-registered")),
            ],
            "refused",
            vec!["retry", "unassign", "give_up"],
        ),
        (
            "refused",
            Some("patient-not-registered"),
            vec![
                delivery(None, "refused", None),
                delivery(Some("1"), "delivered", Some("unassigned")),
            ],
            "refused",
            vec!["assign", "retry", "give_up"],
        ),
        ("spooled", None, vec![delivery(Some("1"), "pending", None)], "spooled", vec![]),
    ] {
        let shown = scan(state, code, deliveries);
        assert_eq!((shown.state, shown.acts), (word, acts), "{state} {:?}", shown.code);
        assert_eq!(shown.advice.is_some(), ["held", "refused"].contains(&word));
    }
    let tried = Delivered { attempts: 3, ..delivery(Some("1"), "pending", None) };
    assert_eq!(scan("spooled", None, vec![tried]).acts, ["retry"]);
}

#[test]
fn what_a_store_does_not_take_of_a_corrected_record_is_told_and_can_be_tried_again() {
    let told = scan(
        "delivered",
        None,
        vec![
            delivery(Some("1"), "delivered", None),
            delivery(Some("1"), "delivered", Some("revision-refused")),
        ],
    );
    assert_eq!((told.state, told.acts), ("delivered", vec!["retry", "unassign"]));
    assert!(told.advice.is_some() && told.code.as_deref() == Some("revision-refused"));
}

#[test]
fn a_patient_who_gave_a_record_back_is_not_named_any_more() {
    let back = vec![delivery(Some("1"), "withdrawn", None), delivery(None, "delivered", None)];
    let shown = scan("delivered", None, back);
    assert_eq!((shown.state, shown.patients), ("unassigned", vec![]));
}

#[test]
fn a_held_scan_is_named_after_those_for_whom_it_is_held() {
    let held = Some("same-scan-other-patient");
    let both = vec![delivery(Some("1"), "delivered", None), delivery(Some("2"), "held", held)];
    assert_eq!(scan("delivered", None, both).patients, ["2"]);
}

#[test]
fn every_code_of_a_held_scan_has_a_reason_of_its_own() {
    use crate::patient::identity;
    use crate::round;
    let codes = [
        round::AMBIGUOUS,
        Why::Beside.word(),
        Why::Unclear.word(),
        Why::Late.word(),
        Why::Unheard.word(),
        Why::Unread.word(),
        Why::Repeated.word(),
        identity::NO_PRESS,
        identity::PATIENTS_DIFFER,
        identity::SAME_SCAN_OTHER_PATIENT,
        "another",
    ];
    for language in BOTH {
        let said: BTreeSet<String> =
            codes.iter().map(|code| of_held(code, language).what).collect();
        assert_eq!(said.len(), codes.len(), "{said:?}");
    }
}

#[test]
fn ids_are_shown_to_whom_the_configuration_says() {
    let shown = |ids: IdsShown| (ids.to(true), ids.to(false));
    assert_eq!(shown(IdsShown::Nobody), (false, false));
    assert_eq!(shown(IdsShown::Operator), (true, false));
    assert_eq!(shown(IdsShown::Everyone), (true, true));
}

#[test]
fn a_part_that_fails_says_so_with_its_reason() {
    let mut facts = Facts::new(at(0), 2);
    facts.sources[1].state = SourceState::OutOfReach("No such device".into());
    let known = StationView {
        page: "1",
        station: "b",
        facts: &facts,
        complaints: &[],
        booth: booth(Signal::Ready),
        now: at(1),
    };
    let parts = assemble(&known, Vec::new(), 0, Vec::new(), Language::De).parts;
    assert_eq!((parts[0].name.as_str(), parts[0].health), ("Exportordner 0", "wait"));
    assert_eq!((parts[1].health, parts[1].why.as_deref()), ("bad", Some("No such device")));
}

#[test]
fn a_decision_that_was_carried_out_is_told() {
    let verbs = ["retry", "release", "assign", "unassign", "give_up", "name_next", "call_off"];
    for language in BOTH {
        for verb in verbs.into_iter().chain(["pause", "resume"]) {
            assert!(language.find(&format!("page.done.{verb}")).is_some(), "{verb}");
        }
    }
}
