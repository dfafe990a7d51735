//! Each line of the table above, and the ways time and people can cross them.

use gaiter_record::{Confidence, ImagingRequest, SourceKind};

use super::*;
use crate::settle::Sights;

const UNCLEAR: &str = Why::Unclear.word();
const LATE: &str = Why::Late.word();
const UNHEARD: &str = Why::Unheard.word();
const UNREAD: &str = Why::Unread.word();
const REPEATED: &str = Why::Repeated.word();

const SECOND: Duration = Duration::from_secs(1);

fn at(seconds: u64) -> Duration {
    SECOND * u32::try_from(1000 + seconds).unwrap()
}

fn rules() -> Rules {
    Rules {
        by_press: true,
        window: 60 * SECOND,
        late: 300 * SECOND,
        name_lasts: 600 * SECOND,
        orders: OrdersWhen::BeforePress,
    }
}

/// A station that has listened for long, since somebody was named at the booth.
fn captures() -> Rounds {
    let mut captures = Rounds::new(rules(), Vec::new(), Names::default());
    captures.receives(at(0) - 360 * SECOND);
    captures.uncertain = None;
    captures
}

fn named(id: &str) -> Named {
    Named::new(id.to_owned(), SourceKind::Operator)
}

/// First seen in this second, in which a look began, and absent in the second before.
fn seen(second: u64) -> Appeared {
    Appeared { absent: Some(at(second - 1)), seen: at(second) }
}

/// Every folder was looked at a moment ago, and no file is coming in.
fn all_seen(second: u64) -> Sights {
    Sights { looked: Some(at(second)), ..Sights::default() }
}

/// Judges and takes.
fn taken(captures: &mut Rounds, appeared: Appeared) -> CaptureMatch {
    let judged = captures.match_export(appeared, appeared.seen);
    captures.answer(&judged, appeared.seen);
    judged
}

/// Judges, takes and measures.
fn export(captures: &mut Rounds, appeared: Appeared) -> CaptureMatch {
    let judged = taken(captures, appeared);
    let answered = match &judged {
        CaptureMatch::Unpressed | CaptureMatch::Known => None,
        CaptureMatch::Of(capture) => Some(capture.number),
        CaptureMatch::Held { answered, .. } => *answered,
    };
    answered.into_iter().for_each(|number| captures.measured(number));
    judged
}

fn patient_of(judged: &CaptureMatch) -> Option<&str> {
    match judged {
        CaptureMatch::Of(capture) => capture.patient.as_ref().map(|patient| patient.id.as_str()),
        other => panic!("{other:?}"),
    }
}

fn by_whom(id: &str, by: SourceKind) -> Named {
    Named::new(id.to_owned(), by)
}

fn order(id: &str) -> Named {
    by_whom(id, SourceKind::Order)
}

fn candidates(judged: &CaptureMatch) -> Vec<&str> {
    match judged {
        CaptureMatch::Held { candidates, .. } => {
            candidates.iter().map(|named| &*named.id).collect()
        }
        other => panic!("{other:?}"),
    }
}

/// The export of the capture that the last one answered is refused.
fn refuse(captures: &mut Rounds, judged: &CaptureMatch, now: Duration) {
    match judged {
        CaptureMatch::Of(capture) => assert!(captures.refused(capture.number, now).is_some()),
        other => panic!("{other:?}"),
    }
}

fn code(judged: &CaptureMatch) -> &'static str {
    match judged {
        CaptureMatch::Held { why, .. } => why.word(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn of_two_requests_of_a_patient_none_is_taken_for_an_export_of_either() {
    let chosen = |number| Named { request: ImagingRequest::new("1.2.3", number), ..named("1") };
    let mut captures = captures();
    captures.named(chosen("A1"), 1, at(1), &[]);
    captures.pressed(1, at(2));
    let mut two = captures.clone();
    assert_eq!(taken(&mut captures, seen(20)).request_of("1"), chosen("A1").request.as_ref());
    two.named(chosen("A2"), 2, at(3), &[]);
    two.pressed(2, at(4));
    let judged = taken(&mut two, seen(20));
    assert_eq!((patient_of(&judged), judged.request_of("1")), (Some("1"), None));
}

#[test]
fn a_held_scan_keeps_the_request_of_each_candidate() {
    let chosen = |id: &str| Named { request: ImagingRequest::new("1.2.3", id), ..named(id) };
    let mut captures = captures();
    captures.named(chosen("1"), 1, at(1), &[]);
    captures.pressed(1, at(2));
    captures.named(chosen("2"), 2, at(3), &[]);
    captures.pressed(2, at(4));
    let judged = taken(&mut captures, seen(20));
    assert_eq!(candidates(&judged), ["1", "2"]);
    for id in ["1", "2"] {
        assert_eq!(judged.request_of(id), chosen(id).request.as_ref());
    }
    assert_eq!(judged.request_of("3"), None);
}

/// Red while any request made its source a high one: a mistyped id may be listed, too.
#[test]
fn who_was_typed_is_of_medium_confidence_and_who_was_chosen_of_high_also_if_typed_since() {
    let typed = Named { request: ImagingRequest::new("1.2.3", "A1"), ..named("1") };
    let chosen = Named { is_chosen: true, ..typed.clone() };
    for (names, confidence) in [
        (vec![typed.clone()], Confidence::Medium),
        (vec![chosen.clone()], Confidence::High),
        (vec![chosen.clone(), typed.clone()], Confidence::High),
        (vec![Named { id: "2".to_owned(), ..chosen }, typed], Confidence::Medium),
    ] {
        let mut captures = captures();
        for (at_s, name) in (1..).zip(names) {
            captures.named(name, 1, at(at_s), &[]);
        }
        let source = captures.pressed(1, at(9)).patient.unwrap().source();
        assert_eq!(
            (source.confidence, source.request),
            (Some(confidence), ImagingRequest::new("1.2.3", "A1"))
        );
    }
}

#[test]
fn a_card_that_confirms_the_choice_keeps_its_request_and_one_of_somebody_else_does_not_get_it() {
    let request = ImagingRequest::new("1.2.3", "A1");
    let chosen = Named { request: request.clone(), ..named("1") };
    for by_press in [true, false] {
        let mut captures = Rounds { rules: Rules { by_press, ..rules() }, ..captures() };
        captures.named(chosen.clone(), 1, at(1), &[]);
        captures.named(by_whom("1", SourceKind::Reader), 2, at(2), &[]);
        let capture = match by_press {
            true => captures.pressed(1, at(3)),
            false => captures.open()[0].clone(),
        };
        assert_eq!((capture.doubt, capture.patient.unwrap().request), (None, request.clone()));
    }
    let mut captures = captures();
    captures.named(chosen, 1, at(1), &[]);
    captures.named(named("2"), 2, at(2), &[]);
    assert_eq!(captures.pressed(1, at(3)).patient, Some(named("2")));
}

#[test]
fn the_export_of_a_press_is_the_patients_who_was_named_before() {
    let mut captures = captures();
    assert_eq!(
        captures.named(named("4711"), 1, at(0), &[]),
        NamedNext::Waits { replaced: false, in_doubt: false }
    );
    captures.pressed(1, at(5));
    assert!(captures.is_armed());
    assert_eq!(captures.next(), None, "a name is used once");
    assert_eq!(patient_of(&export(&mut captures, seen(20))), Some("4711"));
    assert!(!captures.is_armed());
    assert_eq!(captures.pass(at(10_000), &[all_seen(10_000)]), Passed::default());
}

#[test]
fn a_press_without_a_name_is_nobodys_and_the_second_export_is_unpressed() {
    let mut captures = captures();
    captures.pressed(1, at(0));
    assert_eq!(patient_of(&export(&mut captures, seen(20))), None);
    assert_eq!(export(&mut captures, seen(21)), CaptureMatch::Unpressed);
}

#[test]
fn an_export_that_was_seen_before_the_press_is_none_of_its_own() {
    let mut captures = captures();
    captures.pressed(1, at(10));
    assert_eq!(export(&mut captures, seen(10)), CaptureMatch::Unpressed);
    assert_eq!(export(&mut captures, seen(5)), CaptureMatch::Unpressed);
    assert!(captures.is_armed());
}

#[test]
fn an_export_that_may_have_lain_there_before_the_press_is_held_and_so_is_the_next() {
    for absent in [None, Some(at(9))] {
        let mut captures = captures();
        captures.named(named("4711"), 1, at(0), &[]);
        captures.pressed(1, at(10));
        let judged = export(&mut captures, Appeared { absent, seen: at(12) });
        assert_eq!((code(&judged), candidates(&judged)), (UNCLEAR, vec!["4711"]));
        // R4: two contents came since the press, and only one of them can be hers.
        let next = export(&mut captures, seen(20));
        assert_eq!((code(&next), candidates(&next)), (AMBIGUOUS, vec!["4711"]));
    }
}

#[test]
fn two_presses_for_nobody_or_for_the_same_patient_are_answered_in_turn() {
    for id in [None, Some("4711")] {
        let mut captures = captures();
        for number in [1, 2] {
            if let Some(id) = id {
                captures.named(named(id), number, at(0), &[]);
            }
            captures.pressed(number, at(number.unsigned_abs()));
        }
        for number in [1, 2] {
            let judged = export(&mut captures, seen(20));
            assert!(matches!(&judged, CaptureMatch::Of(capture) if capture.number == number));
            assert_eq!(patient_of(&judged), id);
        }
    }
}

#[test]
fn exports_that_two_patients_may_claim_are_held_every_one_of_them() {
    let mut captures = captures();
    for (number, id) in [(1, "4711"), (2, "0815")] {
        captures.named(named(id), number, at(0), &[]);
        captures.pressed(number, at(number.unsigned_abs()));
    }
    let first = export(&mut captures, seen(20));
    assert_eq!(code(&first), AMBIGUOUS);
    assert!(matches!(first, CaptureMatch::Held { patient: None, answered: Some(1), .. }));
    // That only one capture is left does not make the second export its own.
    assert_eq!(code(&export(&mut captures, seen(30))), AMBIGUOUS);
    // Of neither it is known whose it was, so a third may be theirs, too.
    assert_eq!(code(&export(&mut captures, seen(31))), AMBIGUOUS);
}

#[test]
fn a_second_press_without_a_name_after_one_with_a_name_is_not_taken_for_the_same_patient() {
    let mut captures = captures();
    captures.named(named("4711"), 1, at(0), &[]);
    captures.pressed(1, at(1));
    captures.pressed(2, at(10));
    let judged = export(&mut captures, seen(20));
    assert_eq!(code(&judged), AMBIGUOUS);
    // The one patient who was named can be shown to the person who decides.
    assert!(
        matches!(judged, CaptureMatch::Held { patient: Some(patient), .. } if patient.id == "4711")
    );
}

#[test]
fn an_export_first_seen_before_the_second_press_is_the_first_ones_and_the_second_had_no_rest() {
    let mut captures = captures();
    captures.named(named("4711"), 1, at(0), &[]);
    captures.pressed(1, at(1));
    captures.named(named("0815"), 2, at(30), &[]);
    captures.pressed(2, at(31));
    assert_eq!(patient_of(&export(&mut captures, seen(20))), Some("4711"));
    let second = export(&mut captures, seen(40));
    assert_eq!((code(&second), candidates(&second)), (AMBIGUOUS, vec!["0815", "4711"]));
}

#[test]
fn a_late_export_does_not_pass_for_the_next_patients() {
    let mut captures = captures();
    captures.named(named("4711"), 1, at(0), &[]);
    captures.pressed(1, at(0));
    captures.pass(at(61), &[all_seen(61)]);
    captures.named(named("0815"), 2, at(70), &[]);
    captures.pressed(2, at(71));
    assert_eq!(code(&export(&mut captures, seen(75))), AMBIGUOUS);
    // Long after the first window nobody awaits that export any more.
    let mut captures = Rounds::new(rules(), captures.open, Names::default());
    captures.pass(at(1000), &[all_seen(1000)]);
    assert_eq!(captures.waiting().count(), 0);
}

#[test]
fn a_name_that_is_not_used_in_time_is_dropped_by_time_and_by_a_press() {
    let mut captures = captures();
    captures.named(named("4711"), 1, at(0), &[]);
    captures.pressed(1, at(601));
    assert_eq!(captures.open()[0].patient, None);
    captures.named(named("4711"), 2, at(700), &[]);
    assert!(!captures.pass(at(1300), &[all_seen(1300)]).name_expired);
    assert!(captures.pass(at(1301), &[all_seen(1301)]).name_expired);
}

#[test]
fn a_name_replaces_the_one_before_and_says_so() {
    let mut captures = captures();
    captures.named(named("4711"), 1, at(0), &[]);
    assert_eq!(
        captures.named(named("4711"), 1, at(1), &[]),
        NamedNext::Waits { replaced: false, in_doubt: false }
    );
    assert_eq!(
        captures.named(named("0815"), 1, at(2), &[]),
        NamedNext::Waits { replaced: true, in_doubt: false }
    );
    captures.pressed(1, at(3));
    assert_eq!(patient_of(&export(&mut captures, seen(20))), Some("0815"));
}

#[test]
fn what_a_person_gave_up_is_awaited_no_more_and_the_next_capture_is_not_in_doubt() {
    let mut captures = captures();
    captures.named(named("4711"), 1, at(0), &[]);
    captures.pressed(1, at(0));
    captures.named(named("4711"), 1, at(0), &[]);
    assert_eq!(captures.call_off(), CalledOff { captures: vec![1], name: true });
    assert!(!captures.is_armed());
    assert_eq!(
        captures.pass(at(61), &[all_seen(61)]),
        Passed::default(),
        "no alarm for what was given up"
    );
    captures.named(named("0815"), 2, at(62), &[]);
    captures.pressed(2, at(62));
    assert_eq!(patient_of(&export(&mut captures, seen(70))), Some("0815"));
}

#[test]
fn without_a_button_the_name_awaits_the_export_and_is_used_once() {
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    assert!(matches!(captures.named(named("4711"), 1, at(0), &[]), NamedNext::Opened(..)));
    let again = captures.named(named("4711"), 2, at(100), &[]);
    assert!(matches!(again, NamedNext::Prolonged(capture) if capture.until == at(700)));
    assert_eq!(patient_of(&export(&mut captures, seen(650))), Some("4711"));
    assert_eq!(export(&mut captures, seen(651)), CaptureMatch::Unpressed);
}

#[test]
fn without_a_button_two_cards_or_orders_hold_the_export_and_a_word_of_a_person_replaces() {
    let rules = Rules { by_press: false, ..rules() };
    for by in [SourceKind::Order, SourceKind::Reader] {
        let mut captures = Rounds::new(rules, Vec::new(), Names::default());
        captures.named(by_whom("4711", by), 1, at(0), &[]);
        captures.named(by_whom("0815", by), 2, at(5), &[]);
        let judged = export(&mut captures, seen(20));
        assert_eq!((code(&judged), candidates(&judged)), (AMBIGUOUS, vec!["4711", "0815"]));
    }
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.named(named("4711"), 1, at(0), &[]);
    let replaced = captures.named(named("0815"), 2, at(5), &[]);
    assert!(matches!(replaced, NamedNext::Opened(_, given_up) if given_up == [1]));
    assert_eq!(patient_of(&export(&mut captures, seen(20))), Some("0815"));
    // Whose export is coming in is not given up by another name, who then had no rest.
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.named(named("4711"), 1, at(0), &[]);
    captures.named(named("0815"), 2, at(5), &[seen(3)]);
    assert_eq!(patient_of(&export(&mut captures, seen(3))), Some("4711"));
    assert_eq!(candidates(&export(&mut captures, seen(20))), ["0815", "4711"]);
}

#[test]
fn a_press_that_may_have_gone_unheard_casts_doubt_on_captures_with_a_patient() {
    // A port that goes away; one that has just come back; a station that has just started.
    let mut away = captures();
    away.named(named("4711"), 1, at(0), &[]);
    away.pressed(1, at(1));
    away.deaf();
    let mut back = captures();
    back.deaf();
    back.receives(at(0));
    back.named(named("4711"), 1, at(0), &[]);
    back.pressed(1, at(359));
    let mut begun = Rounds::new(rules(), Vec::new(), Names::default());
    begun.named(named("4711"), 1, at(0), &[]);
    begun.pressed(1, at(1));
    for (mut captures, second) in [(away, 20), (back, 370), (begun, 20)] {
        let judged = export(&mut captures, seen(second));
        assert_eq!(code(&judged), UNHEARD);
        assert!(
            matches!(judged, CaptureMatch::Held { patient: Some(patient), .. } if patient.id == "4711")
        );
    }
    let mut long_back = captures();
    long_back.deaf();
    long_back.receives(at(0));
    long_back.named(named("4711"), 1, at(0), &[]);
    long_back.pressed(1, at(360));
    assert_eq!(patient_of(&export(&mut long_back, seen(370))), Some("4711"));
}

#[test]
fn where_no_capture_names_a_patient_nothing_can_be_mistaken() {
    let mut captures = Rounds::new(rules(), Vec::new(), Names::default());
    captures.pressed(1, at(1));
    captures.deaf();
    assert_eq!(patient_of(&export(&mut captures, seen(5))), None);
    captures.pressed(2, at(10));
    let unclear = Appeared { absent: None, seen: at(11) };
    assert_eq!(export(&mut captures, unclear), CaptureMatch::Unpressed);
    assert_eq!(captures.pass(at(71), &[all_seen(71)]).expired, [2]);
    assert_eq!(export(&mut captures, seen(80)), CaptureMatch::Unpressed);
}

#[test]
fn an_order_for_another_patient_before_the_press_holds_the_scan_unless_the_booth_says_who_it_is() {
    let mut two_orders = captures();
    two_orders.named(order("4711"), 1, at(0), &[]);
    two_orders.named(order("0815"), 1, at(1), &[]);
    two_orders.named(order("0815"), 1, at(2), &[]);
    two_orders.pressed(1, at(3));
    assert_eq!(code(&export(&mut two_orders, seen(20))), AMBIGUOUS);

    let mut card_read = captures();
    card_read.named(order("4711"), 1, at(0), &[]);
    card_read.named(order("0815"), 1, at(1), &[]);
    card_read.named(by_whom("4711", SourceKind::Reader), 1, at(2), &[]);
    card_read.pressed(1, at(3));
    assert_eq!(patient_of(&export(&mut card_read, seen(20))), Some("4711"));

    let mut order_again = captures();
    order_again.named(order("4711"), 1, at(0), &[]);
    order_again.named(order("4711"), 1, at(1), &[]);
    order_again.pressed(1, at(3));
    assert_eq!(patient_of(&export(&mut order_again, seen(20))), Some("4711"));
}

mod answers;
mod kinds;
mod laws;
mod time;
