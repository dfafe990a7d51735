//! The laws of names, refusals and known scans, one claim per test.

use super::*;

#[test]
fn where_a_hundred_wait_one_more_is_a_crowd_and_one_of_them_again_is_not() {
    for by_press in [true, false] {
        let mut captures = Rounds::new(Rules { by_press, ..rules() }, Vec::new(), Names::default());
        for n in 0..100 {
            let id = n.to_string();
            assert!(!captures.is_crowded(&id));
            captures.named(order(&id), n, at(10), &[]);
        }
        assert!(captures.is_crowded("100") && !captures.is_crowded("7"), "{by_press}");
        captures.call_off();
        assert!(!captures.is_crowded("100"));
    }
}

fn after_press() -> Rounds {
    let rules = Rules { orders: OrdersWhen::AfterPress, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.receives(at(0) - 360 * SECOND);
    captures.uncertain = None;
    captures
}

pub(super) fn pressed_for(captures: &mut Rounds, id: &str, number: i64, second: u64) {
    captures.named(named(id), number, at(second), &[]);
    captures.pressed(number, at(second));
}

#[test]
fn a_refused_export_leaves_its_capture_to_the_next_one_without_a_press() {
    let mut captures = captures();
    pressed_for(&mut captures, "4711", 1, 0);
    let first = taken(&mut captures, seen(20));
    refuse(&mut captures, &first, at(100));
    assert!(!captures.is_armed(), "nobody pressed for it");
    assert_eq!(patient_of(&export(&mut captures, seen(150))), Some("4711"));
    assert_eq!(export(&mut captures, seen(151)), CaptureMatch::Unpressed);
}

#[test]
fn an_order_soon_after_a_start_may_be_for_a_press_that_nobody_heard() {
    let awaited = rules().awaited();
    for orders in [OrdersWhen::BeforePress, OrdersWhen::AfterPress] {
        let mut soon = Rounds::new(Rules { orders, ..rules() }, Vec::new(), Names::default());
        soon.receives(at(0));
        soon.uncertain = None;
        let mut later = soon.clone();
        soon.named(order("4711"), 1, at(0) + awaited - SECOND, &[]);
        later.named(order("4711"), 1, at(0) + awaited, &[]);
        let is_certain = later.next().is_some_and(Next::is_certain);
        assert_eq!(is_certain, orders == OrdersWhen::BeforePress);
        soon.pressed(1, at(1) + awaited);
        let export = Appeared { absent: Some(at(2) + awaited), seen: at(3) + awaited };
        let why = if is_certain { UNHEARD } else { AMBIGUOUS };
        assert_eq!(code(&soon.match_export(export, export.seen)), why);
    }
}

#[test]
fn a_press_that_a_doubtful_order_pairs_with_is_still_owed_its_own() {
    let mut captures = Rounds::new(
        Rules { orders: OrdersWhen::AfterPress, ..rules() },
        Vec::new(),
        Names::default(),
    );
    captures.receives(Duration::ZERO);
    captures.pressed(1, at(0));
    captures.doubtful(order("4711"), Doubt::Repeated, 2, at(1), &[]);
    assert_eq!(code(&export(&mut captures, seen(20))), REPEATED);
    captures.named(order("0815"), 2, at(30), &[]);
    captures.pressed(2, at(31));
    assert_eq!(code(&export(&mut captures, seen(50))), AMBIGUOUS, "0815 may have been the first");
}

#[test]
fn a_refused_capture_is_over_after_the_same_time_without_an_alarm() {
    let mut captures = captures();
    pressed_for(&mut captures, "4711", 1, 0);
    let first = taken(&mut captures, seen(20));
    refuse(&mut captures, &first, at(100));
    assert_eq!(captures.pass(at(161), &[all_seen(161)]), Passed::default());
    assert_eq!(captures.pass(at(461), &[all_seen(461)]).over, [1]);
    pressed_for(&mut captures, "0815", 2, 462);
    assert_eq!(patient_of(&export(&mut captures, seen(480))), Some("0815"));
}

#[test]
fn the_same_patient_scanned_again_is_not_in_doubt_and_any_other_press_holds_for_both() {
    let mut again = captures();
    pressed_for(&mut again, "4711", 1, 0);
    let first = taken(&mut again, seen(20));
    refuse(&mut again, &first, at(30));
    again.named(named("4711"), 2, at(40), &[]);
    again.pressed(2, at(41));
    assert_eq!(patient_of(&export(&mut again, seen(60))), Some("4711"));
    assert_eq!(again.waiting().count(), 0);

    for id in [None, Some("0815")] {
        let mut captures = captures();
        pressed_for(&mut captures, "4711", 1, 0);
        let first = taken(&mut captures, seen(20));
        refuse(&mut captures, &first, at(30));
        if let Some(id) = id {
            captures.named(named(id), 2, at(40), &[]);
        }
        captures.pressed(2, at(41));
        let judged = export(&mut captures, seen(60));
        let all: Vec<&str> = ["4711"].into_iter().chain(id).collect();
        assert_eq!((code(&judged), candidates(&judged)), (AMBIGUOUS, all.clone()));
        // The other export is still to come, and may belong to either patient.
        let second = export(&mut captures, seen(70));
        assert!(all.iter().all(|id| candidates(&second).contains(id)), "{second:?}");
    }
}

#[test]
fn two_orders_before_a_press_stay_in_doubt_until_the_booth_says_who_it_is() {
    let mut captures = captures();
    captures.named(order("1"), 1, at(0), &[]);
    captures.named(order("2"), 1, at(1), &[]);
    captures.pressed(1, at(2));
    let first = taken(&mut captures, seen(20));
    assert_eq!(candidates(&first), ["1", "2"]);
    captures.decided(&first, "1", at(21));
    captures.measured(1);
    // One of the two has entered the booth, but it is not known which, so the third order makes three
    // candidates.
    captures.named(order("3"), 2, at(30), &[]);
    captures.pressed(2, at(31));
    let second = taken(&mut captures, seen(40));
    assert_eq!(candidates(&second), ["1", "2", "3"]);
    captures.decided(&second, "2", at(41));
    captures.measured(2);
    captures.named(by_whom("4", SourceKind::Reader), 3, at(50), &[]);
    captures.pressed(3, at(51));
    assert_eq!(patient_of(&export(&mut captures, seen(60))), Some("4"));
}

#[test]
fn a_name_whose_time_is_over_is_still_a_candidate_and_the_one_who_is_left_in_doubt() {
    let mut captures = captures();
    captures.named(order("1"), 1, at(0), &[]);
    captures.named(order("2"), 1, at(500), &[]);
    captures.pressed(1, at(550));
    let first = taken(&mut captures, seen(560));
    captures.decided(&first, "1", at(570));
    captures.measured(1);
    captures.named(order("3"), 2, at(700), &[]);
    captures.pressed(2, at(701));
    assert_eq!(candidates(&export(&mut captures, seen(710))), ["2", "3", "1"]);
}

#[test]
fn an_order_that_comes_after_a_press_without_a_name_is_in_doubt_with_it_and_so_is_the_next() {
    let mut captures = captures();
    captures.pressed(1, at(0));
    let order_1 = captures.named(order("1"), 2, at(1), &[]);
    assert_eq!(order_1, NamedNext::Waits { replaced: false, in_doubt: true });
    assert_eq!(candidates(&export(&mut captures, seen(20))), ["1"]);
    // The practice continues like this: every order arrives after its press.
    for patient in 2..6 {
        let second = 100 * patient;
        captures.pressed(i64::try_from(patient).unwrap(), at(second));
        captures.named(order(&patient.to_string()), 9, at(second + 1), &[]);
        let judged = export(&mut captures, seen(second + 20));
        assert_eq!(code(&judged), AMBIGUOUS);
        assert!(candidates(&judged).contains(&&*patient.to_string()), "{judged:?}");
    }
}

#[test]
fn an_order_soon_after_an_answered_press_without_a_name_may_be_for_that_one() {
    let mut captures = captures();
    captures.pressed(1, at(0));
    assert_eq!(patient_of(&export(&mut captures, seen(5))), None);
    captures.named(order("1"), 2, at(10), &[]);
    captures.pressed(2, at(20));
    assert_eq!(code(&export(&mut captures, seen(40))), AMBIGUOUS);
}

#[test]
fn where_orders_come_after_the_press_one_pairs_with_the_one_press_that_is_open() {
    let mut captures = after_press();
    for patient in 1..5 {
        let (number, second) = (i64::try_from(patient).unwrap(), 100 * patient);
        captures.pressed(number, at(second));
        let named = captures.named(order(&patient.to_string()), number + 1, at(second + 1), &[]);
        assert!(matches!(named, NamedNext::Paired(_)), "{named:?}");
        let judged = export(&mut captures, seen(second + 20));
        assert_eq!(patient_of(&judged), Some(&*patient.to_string()));
    }
}

#[test]
fn two_open_presses_or_two_orders_are_held_where_orders_come_after_the_press() {
    let mut two_presses = after_press();
    two_presses.pressed(1, at(0));
    two_presses.pressed(2, at(10));
    two_presses.named(order("1"), 3, at(11), &[]);
    assert_eq!(code(&export(&mut two_presses, seen(20))), AMBIGUOUS);
    assert_eq!(code(&export(&mut two_presses, seen(30))), AMBIGUOUS);

    let mut two_orders = after_press();
    two_orders.pressed(1, at(0));
    two_orders.named(order("1"), 2, at(1), &[]);
    two_orders.named(order("2"), 2, at(2), &[]);
    assert_eq!(candidates(&export(&mut two_orders, seen(20))), ["1", "2"]);
    two_orders.pressed(2, at(30));
    assert_eq!(code(&export(&mut two_orders, seen(40))), AMBIGUOUS);
}

#[test]
fn a_naming_that_failed_disarms_the_name_that_waits_until_a_word_at_the_booth() {
    let mut captures = captures();
    captures.named(order("1"), 1, at(0), &[]);
    captures.unread(Some(at(900)));
    captures.pressed(1, at(2));
    assert_eq!(code(&export(&mut captures, seen(20))), UNREAD);

    for good in [named("1"), by_whom("1", SourceKind::Reader)] {
        let mut captures = self::captures();
        captures.named(order("1"), 1, at(0), &[]);
        captures.unread(Some(at(900)));
        captures.named(good, 1, at(1), &[]);
        captures.pressed(1, at(2));
        assert_eq!(patient_of(&export(&mut captures, seen(20))), Some("1"));
    }
    captures.named(order("1"), 2, at(100), &[]);
    captures.unread(Some(at(900)));
    // The corrected order names who is expected, not who is there.
    captures.named(order("2"), 2, at(101), &[]);
    captures.pressed(2, at(102));
    assert_eq!(candidates(&export(&mut captures, seen(120))), ["1", "2"]);
}

#[test]
fn without_a_button_a_naming_that_failed_disarms_what_waits_for_its_export() {
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.named(named("1"), 1, at(0), &[]);
    captures.unread(Some(at(900)));
    assert_eq!(code(&export(&mut captures, seen(5))), UNREAD);
}

#[test]
fn an_order_that_is_repeated_is_in_doubt() {
    let mut captures = captures();
    captures.doubtful(order("1"), Doubt::Repeated, 1, at(0), &[]);
    captures.pressed(1, at(2));
    assert_eq!(code(&export(&mut captures, seen(20))), REPEATED);
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.uncertain = None;
    captures.doubtful(order("1"), Doubt::Repeated, 1, at(0), &[]);
    assert_eq!(code(&export(&mut captures, seen(20))), REPEATED);
}

#[test]
fn a_press_that_could_not_be_kept_puts_in_doubt_what_comes_within_its_time() {
    let mut captures = captures();
    pressed_for(&mut captures, "1", 1, 0);
    captures.missed_press(at(10));
    let first = taken(&mut captures, seen(20));
    assert_eq!(code(&first), UNHEARD);
    captures.decided(&first, "1", at(30));
    captures.measured(1);
    pressed_for(&mut captures, "2", 2, 369);
    let second = taken(&mut captures, seen(380));
    assert_eq!(code(&second), UNHEARD);
    captures.decided(&second, "2", at(390));
    captures.measured(2);
    pressed_for(&mut captures, "3", 3, 400);
    assert_eq!(patient_of(&export(&mut captures, seen(420))), Some("3"));
}

#[test]
fn a_known_scan_answers_nothing_and_the_rest_of_a_refused_one_is_no_other_patients() {
    let mut captures = captures();
    pressed_for(&mut captures, "2", 1, 0);
    let content = |is_known, completes| {
        let (began, others, is_cut_short) = (seen(20), Vec::new(), false);
        ExportContent { began, others, is_known, is_cut_short, completes }
    };
    assert_eq!(captures.match_content(&content(true, None), at(20)), CaptureMatch::Known);
    let of_2 = captures.match_content(&content(false, Some(vec![named("2")])), at(20));
    assert_eq!(patient_of(&of_2), Some("2"));
    let of_1 = captures.match_content(&content(false, Some(vec![named("1")])), at(20));
    assert_eq!((code(&of_1), candidates(&of_1)), (AMBIGUOUS, vec!["2", "1"]));
    let of_nobody = captures.match_content(&content(false, Some(Vec::new())), at(20));
    assert_eq!(code(&of_nobody), AMBIGUOUS);
    captures.answer(&of_nobody, at(20));
    assert_eq!(captures.waiting().count(), 1, "it goes on waiting for its own");
    // If nothing is open, its own name decides the patient.
    let unpressed = self::captures().match_content(&content(false, Some(vec![named("1")])), at(20));
    assert_eq!(unpressed, CaptureMatch::Unpressed);
}

#[test]
fn an_order_after_the_press_for_a_patient_with_a_press_by_name_is_for_no_other_press() {
    let mut captures = after_press();
    pressed_for(&mut captures, "1", 1, 0);
    captures.pressed(2, at(10));
    assert!(matches!(captures.named(order("1"), 3, at(11), &[]), NamedNext::Paired(_)));
    assert!(captures.has_unnamed_press(at(11)), "the second press has no patient yet");
}

#[test]
fn an_order_after_the_press_that_may_be_for_an_earlier_unnamed_press_is_held() {
    let mut captures = after_press();
    captures.pressed(1, at(0));
    export(&mut captures, seen(10));
    captures.pressed(2, at(30));
    let in_doubt = NamedNext::Waits { replaced: false, in_doubt: true };
    assert_eq!(captures.named(order("1"), 3, at(31), &[]), in_doubt);
    assert_eq!(code(&export(&mut captures, seen(40))), AMBIGUOUS);
}

#[test]
fn an_order_beside_a_waiting_name_makes_both_candidates_after_the_press_too() {
    let mut captures = after_press();
    captures.pressed(1, at(0));
    captures.named(by_whom("2", SourceKind::Reader), 2, at(10), &[]);
    captures.named(order("3"), 2, at(11), &[]);
    assert_eq!(captures.next_ids(), ["2", "3"]);
}

#[test]
fn an_order_soon_after_a_press_with_a_name_in_doubt_may_be_for_that_press() {
    let mut captures = captures();
    captures.doubtful(order("2"), Doubt::Repeated, 1, at(0), &[]);
    captures.pressed(1, at(10));
    export(&mut captures, seen(20));
    captures.named(order("3"), 2, at(25), &[]);
    captures.pressed(2, at(40));
    assert_eq!(code(&export(&mut captures, seen(50))), AMBIGUOUS);
}

#[test]
fn two_contents_at_once_and_one_of_before_the_press_are_no_clean_round() {
    let content = |began, others| ExportContent {
        began,
        others,
        is_known: false,
        is_cut_short: false,
        completes: None,
    };
    // Seen since the press and not taken: either may be this patient's.
    let mut captures = captures();
    pressed_for(&mut captures, "1", 1, 100);
    let first = captures.match_content(&content(seen(110), vec![seen(90), seen(112)]), at(115));
    assert_eq!((code(&first), candidates(&first)), (BESIDE, vec!["1"]));
    captures.answer(&first, at(115));
    let second = captures.match_content(&content(seen(112), Vec::new()), at(116));
    assert_eq!((code(&second), candidates(&second)), (AMBIGUOUS, vec!["1"]));
    // Seen before the press and not taken: it may be of before, and never is of this press.
    let mut captures = self::captures();
    pressed_for(&mut captures, "1", 1, 100);
    let own = captures.match_content(&content(seen(110), vec![seen(90)]), at(115));
    assert_eq!(patient_of(&own), Some("1"));
    // Taken since: there was no rest at the press.
    let before = captures.match_content(&content(seen(90), Vec::new()), at(112));
    assert_eq!(before, CaptureMatch::Unpressed);
    captures.answer(&before, at(112));
    assert_eq!(code(&captures.match_content(&content(seen(110), Vec::new()), at(115))), AMBIGUOUS);
}

/// Somebody is ordered, named at the booth if the light asks, and scanned; whether it asked.
fn is_asked_about(captures: &mut Rounds, id: &str, second: u64) -> bool {
    captures.named(order(id), 1, at(second), &[]);
    let is_asked = captures.asks_who();
    if is_asked {
        captures.named(named(id), 1, at(second + 1), &[]);
    }
    captures.pressed(1, at(second + 2));
    assert_eq!(patient_of(&export(captures, seen(second + 10))), Some(id));
    is_asked
}

#[test]
fn an_order_whose_patient_never_comes_costs_two_answers_or_one_or_none_if_it_is_given_up() {
    let asked = |captures: &mut Rounds| {
        [("2", 100), ("3", 200), ("4", 300)]
            .map(|(id, second)| is_asked_about(captures, id, second))
    };
    let mut waits = captures();
    waits.named(order("1"), 1, at(0), &[]);
    let (mut asked_first, mut before) = (waits.clone(), waits.clone());
    assert_eq!(asked(&mut waits), [true, true, false]);
    before.call_off();
    assert_eq!(asked(&mut before), [false, false, false]);
    asked_first.named(order("2"), 1, at(90), &[]);
    assert!(asked_first.asks_who());
    asked_first.call_off();
    asked_first.named(named("2"), 1, at(95), &[]);
    assert_eq!(asked(&mut asked_first), [false, false, false]);
}
