//! How two red teams brought a body under another's name, one sequence per test: each is held now.

use super::laws::pressed_for;
use super::*;

/// The export that appeared in this second is held for these patients.
fn is_held(captures: &mut Rounds, second: u64, whose: &[&str]) -> CaptureMatch {
    let judged = taken(captures, seen(second));
    let mut found = candidates(&judged);
    found.sort_unstable();
    assert_eq!(found, whose, "{judged:?}");
    judged
}

#[test]
fn a_press_after_one_without_an_export_is_not_certain_by_the_next_order() {
    let mut captures = captures();
    captures.named(order("1"), 1, at(0), &[]);
    captures.pressed(1, at(5));
    captures.named(order("2"), 2, at(20), &[]);
    assert_eq!(captures.pass(at(400), &[all_seen(400)]).over, [1]);
    assert!(!captures.next().is_some_and(Next::is_certain), "the light asks");
    let mut asked = captures.clone();
    captures.pressed(2, at(410));
    is_held(&mut captures, 420, &["1", "2"]);
    asked.named(by_whom("1", SourceKind::Reader), 2, at(405), &[]);
    asked.pressed(2, at(410));
    assert_eq!(patient_of(&export(&mut asked, seen(420))), Some("1"));
}

#[test]
fn a_name_that_waited_while_a_source_of_names_was_away_is_not_certain() {
    let mut away = captures();
    away.named(by_whom("1", SourceKind::Reader), 1, at(0), &[]);
    let names = away.names().clone();
    away.missed_name();
    let mut started = Rounds::new(rules(), Vec::new(), names);
    started.receives(at(0) - 360 * SECOND);
    for mut captures in [away, started] {
        let mut again = captures.clone();
        captures.pressed(1, at(10));
        is_held(&mut captures, 20, &["1"]);
        let mut other = again.clone();
        again.named(by_whom("1", SourceKind::Reader), 1, at(5), &[]);
        again.pressed(1, at(10));
        assert_eq!(patient_of(&export(&mut again, seen(20))), Some("1"));
        other.named(by_whom("2", SourceKind::Reader), 1, at(5), &[]);
        other.pressed(1, at(10));
        is_held(&mut other, 20, &["1", "2"]);
    }
}

#[test]
fn where_orders_come_after_the_press_one_that_is_late_names_no_later_press() {
    let rules = Rules { orders: OrdersWhen::AfterPress, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.receives(at(0) - 360 * SECOND);
    captures.uncertain = None;
    captures.pressed(1, at(0));
    assert_eq!(patient_of(&export(&mut captures, seen(10))), None);
    captures.named(order("1"), 2, at(400), &[]);
    captures.pressed(2, at(500));
    is_held(&mut captures, 510, &["1"]);
}

#[test]
fn an_export_that_is_held_uses_up_no_press_for_certain() {
    let mut captures = captures();
    pressed_for(&mut captures, "2", 1, 0);
    pressed_for(&mut captures, "3", 2, 1);
    // One that nobody pressed for comes first, and both are measured for their previews.
    for second in [10, 20] {
        let judged = is_held(&mut captures, second, &["2", "3"]);
        if let CaptureMatch::Held { answered: Some(number), .. } = judged {
            captures.measured(number);
        }
    }
    pressed_for(&mut captures, "4", 3, 30);
    is_held(&mut captures, 40, &["2", "3", "4"]);
}

#[test]
fn a_decision_ends_the_round_of_its_patient_when_the_scan_is_measured_and_of_nobody_else() {
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.named(named("1"), 1, at(0), &[]);
    let unclear = Appeared { absent: None, seen: at(5) };
    let judged = taken(&mut captures, unclear);
    assert_eq!(code(&judged), UNCLEAR);
    assert_eq!(captures.decided(&judged, "1", at(10)), Some(1));
    captures.measured(1);
    assert!(captures.open().is_empty());
    assert_eq!(
        export(&mut captures, seen(30)),
        CaptureMatch::Unpressed,
        "the next, whom nobody named"
    );

    let mut captures = self::captures();
    pressed_for(&mut captures, "1", 1, 0);
    pressed_for(&mut captures, "2", 2, 5);
    let judged = is_held(&mut captures, 10, &["1", "2"]);
    assert_eq!(captures.decided(&judged, "2", at(15)), Some(2));
    captures.measured(2);
    pressed_for(&mut captures, "3", 3, 20);
    is_held(&mut captures, 25, &["1", "2", "3"]);
}

#[test]
fn a_scan_that_is_measured_after_all_ends_the_capture_that_its_failure_opened_again() {
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.named(named("1"), 1, at(0), &[]);
    let first = taken(&mut captures, seen(10));
    refuse(&mut captures, &first, at(20));
    captures.measured(1);
    assert_eq!(export(&mut captures, seen(30)), CaptureMatch::Unpressed);
}

#[test]
fn an_export_without_a_press_puts_the_name_that_waits_in_doubt() {
    let mut captures = captures();
    captures.named(by_whom("1", SourceKind::Reader), 1, at(0), &[]);
    assert_eq!(export(&mut captures, seen(10)), CaptureMatch::Unpressed);
    captures.pressed(1, at(20));
    is_held(&mut captures, 30, &["1"]);
}

#[test]
fn a_card_after_a_press_without_a_name_may_be_for_that_press_or_for_the_next() {
    for by in [SourceKind::Reader, SourceKind::Operator] {
        let mut captures = captures();
        captures.pressed(1, at(0));
        captures.named(by_whom("1", by), 2, at(2), &[]);
        is_held(&mut captures, 10, &["1"]);
        captures.pressed(2, at(20));
        captures.named(by_whom("2", by), 3, at(22), &[]);
        is_held(&mut captures, 30, &["1", "2"]);
    }
}

#[test]
fn two_cards_before_a_press_are_asked_about_and_the_next_card_answers() {
    let card = |id| by_whom(id, SourceKind::Reader);
    let mut captures = captures();
    captures.named(card("1"), 1, at(0), &[]);
    captures.named(card("2"), 1, at(1), &[]);
    let mut asked = captures.clone();
    captures.pressed(1, at(2));
    is_held(&mut captures, 10, &["1", "2"]);
    asked.named(card("2"), 1, at(2), &[]);
    asked.pressed(1, at(3));
    assert_eq!(patient_of(&export(&mut asked, seen(10))), Some("2"));
}

#[test]
fn without_a_button_a_refused_export_is_asked_about_before_the_next_name_is_certain() {
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.named(named("1"), 1, at(0), &[]);
    let first = taken(&mut captures, seen(10));
    refuse(&mut captures, &first, at(20));
    captures.named(named("2"), 2, at(30), &[]);
    let mut answered = captures.clone();
    is_held(&mut captures, 40, &["1", "2"]);
    answered.named(named("2"), 3, at(35), &[]);
    assert_eq!(patient_of(&export(&mut answered, seen(40))), Some("2"));
}

#[test]
fn a_name_that_was_given_while_a_source_was_away_is_not_certain_and_nor_is_an_order_since() {
    let mut captures = captures();
    captures.missed_name();
    captures.named(by_whom("1", SourceKind::Reader), 1, at(0), &[]);
    assert!(captures.next().is_some_and(Next::is_certain), "until the gap has ended");
    captures.missed_name();
    let mut ordered = captures.clone();
    captures.pressed(1, at(5));
    is_held(&mut captures, 10, &["1"]);
    ordered.call_off();
    ordered.missed_name();
    ordered.named(order("2"), 1, at(5), &[]);
    ordered.pressed(1, at(6));
    assert_eq!(code(&is_held(&mut ordered, 10, &["2"])), UNHEARD);
}

#[test]
fn without_a_button_whoever_is_expected_is_not_certain_once_a_source_was_away() {
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.named(by_whom("1", SourceKind::Reader), 1, at(0), &[]);
    captures.missed_name();
    let mut again = captures.clone();
    assert_eq!(code(&is_held(&mut captures, 10, &["1"])), UNHEARD);
    // A name at the booth states who is there.
    again.named(by_whom("2", SourceKind::Operator), 2, at(5), &[]);
    assert_eq!(patient_of(&export(&mut again, seen(10))), Some("2"));
}

#[test]
fn an_order_that_lay_there_unread_at_a_press_may_be_for_that_press_or_for_the_next() {
    // Its file was absent at a look before the press; or there was no look before.
    for absent in [Some(at(4)), None] {
        let mut captures = captures();
        captures.named(order("1"), 1, at(0), &[]);
        captures.pressed(1, at(5));
        assert!(captures.overtaken(&order("2"), absent));
        captures.doubtful(order("2"), Doubt::Crossed, 2, at(8), &[]);
        let judged = is_held(&mut captures, 20, &["1", "2"]);
        captures.decided(&judged, "1", at(25));
        captures.measured(1);
        captures.pressed(2, at(30));
        assert_eq!(code(&is_held(&mut captures, 40, &["2"])), AMBIGUOUS);
    }
}

#[test]
fn an_order_that_was_absent_after_the_press_is_for_the_next() {
    let mut captures = captures();
    captures.named(order("1"), 1, at(0), &[]);
    captures.pressed(1, at(5));
    assert!(!captures.overtaken(&order("2"), Some(at(5))));
    captures.named(order("2"), 2, at(8), &[]);
    assert_eq!(patient_of(&export(&mut captures, seen(20))), Some("1"));
    captures.pressed(2, at(30));
    assert_eq!(patient_of(&export(&mut captures, seen(40))), Some("2"));
}

#[test]
fn where_orders_come_after_the_press_one_that_may_have_lain_there_before_it_may_be_of_an_earlier_one()
 {
    for (absent, is_sure) in [(Some(at(9)), false), (None, false), (Some(at(10)), true)] {
        let mut captures = captures();
        captures.rules.orders = OrdersWhen::AfterPress;
        captures.pressed(1, at(10));
        let is_overtaken = captures.overtaken(&order("1"), absent);
        assert_eq!(is_overtaken, !is_sure);
        if is_sure {
            captures.named(order("1"), 2, at(15), &[]);
            assert_eq!(patient_of(&export(&mut captures, seen(20))), Some("1"));
        } else {
            captures.doubtful(order("1"), Doubt::Crossed, 2, at(15), &[]);
            assert_eq!(code(&is_held(&mut captures, 20, &["1"])), AMBIGUOUS);
        }
    }
    // One of somebody whose press is known is theirs, whenever it was written.
    let mut captures = captures();
    captures.rules.orders = OrdersWhen::AfterPress;
    captures.named(by_whom("1", SourceKind::Reader), 1, at(0), &[]);
    captures.pressed(1, at(10));
    assert!(!captures.overtaken(&order("1"), Some(at(4))));
}

#[test]
fn whoever_was_ordered_with_somebody_who_was_scanned_twice_may_come_next() {
    let mut captures = captures();
    captures.named(order("1"), 1, at(0), &[]);
    captures.named(order("2"), 1, at(1), &[]);
    for (number, second) in [(1, 10), (2, 30)] {
        captures.pressed(number, at(second));
        let judged = taken(&mut captures, seen(second + 5));
        assert_eq!(captures.decided(&judged, "1", at(second + 8)), Some(number));
        captures.measured(number);
    }
    captures.named(order("3"), 3, at(40), &[]);
    captures.pressed(3, at(50));
    is_held(&mut captures, 55, &["2", "3"]);
}

#[test]
fn when_each_of_two_orders_has_its_scan_by_a_person_the_next_is_asked_for_nobody_else() {
    for decides_first in [true, false] {
        let mut captures = captures();
        captures.named(order("1"), 1, at(0), &[]);
        captures.named(order("2"), 1, at(1), &[]);
        captures.pressed(1, at(10));
        let first = taken(&mut captures, seen(15));
        if decides_first {
            captures.decided(&first, "1", at(16));
            captures.measured(1);
        }
        captures.pressed(2, at(20));
        let second = taken(&mut captures, seen(25));
        if !decides_first {
            captures.decided(&first, "1", at(26));
            captures.measured(1);
        }
        assert_eq!(captures.decided(&second, "2", at(27)), Some(2));
        captures.measured(2);
        captures.named(order("3"), 3, at(40), &[]);
        captures.pressed(3, at(50));
        assert_eq!(patient_of(&export(&mut captures, seen(55))), Some("3"), "{decides_first}");
    }
}

#[test]
fn without_a_button_the_same_card_answers_what_went_unheard() {
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.uncertain = None;
    captures.named(by_whom("1", SourceKind::Reader), 1, at(0), &[]);
    captures.missed_name();
    let mut unanswered = captures.clone();
    is_held(&mut unanswered, 20, &["1"]);
    captures.named(by_whom("1", SourceKind::Reader), 2, at(10), &[]);
    let mut began_before = captures.clone();
    assert_eq!(taken(&mut began_before, seen(9)), CaptureMatch::Unpressed);
    assert_eq!(patient_of(&export(&mut captures, seen(20))), Some("1"));
}

#[test]
fn a_press_that_was_given_up_crosses_no_card() {
    let mut captures = captures();
    captures.pressed(1, at(0));
    captures.call_off();
    captures.named(by_whom("2", SourceKind::Reader), 2, at(10), &[]);
    captures.pressed(2, at(20));
    assert_eq!(patient_of(&export(&mut captures, seen(30))), Some("2"));
}

#[test]
fn an_order_that_lay_there_at_the_press_of_its_own_patient_is_not_certain_for_the_next_press() {
    let mut captures = captures();
    captures.named(by_whom("1", SourceKind::Reader), 1, at(0), &[]);
    captures.pressed(1, at(5));
    assert!(captures.overtaken(&order("1"), Some(at(4))));
    captures.doubtful(order("1"), Doubt::Crossed, 2, at(8), &[]);
    assert_eq!(patient_of(&export(&mut captures, seen(20))), Some("1"));
    captures.pressed(2, at(30));
    is_held(&mut captures, 40, &["1"]);
}

#[test]
fn without_a_button_a_name_after_an_export_that_is_held_is_of_a_scan_of_its_own() {
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.named(named("1"), 1, at(0), &[]);
    let judged = taken(&mut captures, Appeared { absent: None, seen: at(5) });
    assert_eq!(code(&judged), UNCLEAR);
    captures.named(by_whom("1", SourceKind::Reader), 2, at(6), &[]);
    assert_eq!(captures.decided(&judged, "1", at(10)), Some(1));
    captures.measured(1);
    // The decision was about the first: what was scanned after the card is still to come.
    captures.named(by_whom("2", SourceKind::Reader), 3, at(15), &[]);
    is_held(&mut captures, 20, &["1", "2"]);
}

/// A press and its export, which is taken five seconds later.
fn next_patient(captures: &mut Rounds, number: i64, second: u64) -> CaptureMatch {
    captures.pressed(number, at(second));
    taken(captures, seen(second + 5))
}

#[test]
fn two_cards_contradict_each_other_until_one_of_them_is_read_again() {
    let mut captures = captures();
    for card in ["1", "2", "3"] {
        captures.named(by_whom(card, SourceKind::Reader), 1, at(0), &[]);
    }
    let mut again = captures.clone();
    assert_eq!(candidates(&next_patient(&mut captures, 1, 10)), ["1", "2", "3"]);
    again.named(by_whom("2", SourceKind::Reader), 1, at(5), &[]);
    assert_eq!(patient_of(&next_patient(&mut again, 1, 10)), Some("2"));
}

#[test]
fn a_name_that_expired_is_not_replaced_by_the_next_order() {
    // 1 waits for longer than a name is kept, and goes in after all.
    for both_at_once in [true, false] {
        let mut captures = captures();
        captures.named(order("1"), 1, at(0), &[]);
        let second = if both_at_once { 590 } else { 610 };
        captures.named(order("2"), 1, at(second), &[]);
        assert!(captures.pass(at(620), &[all_seen(620)]).name_expired == both_at_once);
        captures.pressed(1, at(630));
        is_held(&mut captures, 635, &["1", "2"]);
    }
}

#[test]
fn an_order_that_comes_after_a_press_by_card_is_not_for_the_next_press_without_a_name() {
    let rules = Rules { orders: OrdersWhen::AfterPress, ..rules() };
    let mut captures = Rounds { rules, ..captures() };
    captures.named(by_whom("1", SourceKind::Reader), 1, at(0), &[]);
    captures.pressed(1, at(5));
    assert_eq!(patient_of(&export(&mut captures, seen(10))), Some("1"));
    captures.pressed(2, at(60));
    captures.named(order("1"), 3, at(65), &[]);
    assert_eq!(code(&taken(&mut captures, seen(70))), AMBIGUOUS);
}

#[test]
fn an_order_is_for_no_press_that_was_made_while_another_without_a_name_was_open() {
    let rules = Rules { orders: OrdersWhen::AfterPress, ..rules() };
    let mut captures = Rounds { rules, ..captures() };
    captures.pressed(1, at(0));
    // Their window and the time for late ones are over a second later.
    captures.pressed(2, at(359));
    captures.pass(at(361), &[all_seen(361)]);
    captures.named(order("2"), 3, at(362), &[]);
    assert_eq!(code(&taken(&mut captures, seen(365))), AMBIGUOUS);
}

#[test]
fn who_was_named_while_the_button_was_away_may_have_pressed_it() {
    let mut captures = captures();
    captures.deaf();
    captures.named(by_whom("1", SourceKind::Reader), 1, at(0), &[]);
    captures.receives(at(10));
    captures.named(order("1"), 1, at(400), &[]);
    assert_eq!(code(&next_patient(&mut captures, 1, 410)), UNHEARD);
}

#[test]
fn a_second_content_while_the_first_is_measured_leaves_no_certainty_for_a_third() {
    let mut captures = captures();
    pressed_for(&mut captures, "1", 1, 0);
    assert_eq!(patient_of(&taken(&mut captures, seen(10))), Some("1"));
    assert_eq!(taken(&mut captures, seen(15)), CaptureMatch::Unpressed);
    captures.refused(1, at(20));
    assert_eq!(code(&taken(&mut captures, seen(30))), AMBIGUOUS);
}

#[test]
fn the_order_that_a_card_replaced_may_be_of_the_next_patient() {
    // A and B are ordered, A's card is read, and B goes in although C was ordered meanwhile.
    let mut captures = captures();
    captures.named(order("1"), 1, at(0), &[]);
    captures.named(order("2"), 1, at(10), &[]);
    captures.named(by_whom("1", SourceKind::Reader), 1, at(20), &[]);
    captures.pressed(1, at(25));
    assert_eq!(patient_of(&export(&mut captures, seen(45))), Some("1"));
    captures.named(order("3"), 2, at(60), &[]);
    assert!(captures.asks_who());
    let mut asked = captures.clone();
    captures.pressed(2, at(70));
    is_held(&mut captures, 75, &["2", "3"]);
    asked.named(by_whom("2", SourceKind::Reader), 2, at(65), &[]);
    assert_eq!(patient_of(&next_patient(&mut asked, 2, 70)), Some("2"));
}

#[test]
fn the_preview_of_a_held_export_ends_no_round_that_was_refused_before() {
    let mut captures = captures();
    pressed_for(&mut captures, "1", 1, 0);
    taken(&mut captures, seen(10));
    captures.refused(1, at(20));
    pressed_for(&mut captures, "2", 2, 30);
    is_held(&mut captures, 40, &["1", "2"]);
    captures.measured(1);
    assert!(captures.open().iter().any(|of| of.number == 1), "it waits for its own");
}

#[test]
fn without_a_button_a_held_export_of_one_takes_no_time_from_the_other() {
    // A and B are named, and B goes first; A's export comes after the time of a press, within that of a name.
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds { rules, ..captures() };
    captures.named(order("1"), 1, at(0), &[]);
    captures.named(order("2"), 2, at(20), &[]);
    let held = is_held(&mut captures, 30, &["1", "2"]);
    assert_eq!(captures.decided(&held, "2", at(40)), Some(2));
    captures.measured(2);
    assert_eq!(captures.pass(at(500), &[all_seen(500)]).over, [] as [i64; 0]);
    captures.named(by_whom("3", SourceKind::Reader), 3, at(505), &[]);
    is_held(&mut captures, 510, &["1", "2", "3"]);
}

#[test]
fn a_press_of_somebody_whose_earlier_one_may_be_anothers_is_not_at_rest() {
    let mut captures = captures();
    captures.named(by_whom("1", SourceKind::Reader), 1, at(0), &[]);
    captures.unread(Some(at(900)));
    captures.pressed(1, at(5));
    captures.named(by_whom("1", SourceKind::Reader), 2, at(10), &[]);
    captures.pressed(2, at(15));
    is_held(&mut captures, 20, &["1"]);
}

#[test]
fn an_order_that_two_cards_replaced_may_still_come_next() {
    let mut captures = captures();
    captures.named(order("3"), 1, at(0), &[]);
    captures.named(by_whom("1", SourceKind::Reader), 1, at(1), &[]);
    captures.named(by_whom("2", SourceKind::Reader), 1, at(2), &[]);
    for (number, id, second) in [(1, "1", 10), (2, "2", 30)] {
        captures.pressed(number, at(second));
        let judged = is_held(&mut captures, second + 5, &["1", "2"]);
        captures.decided(&judged, id, at(second + 8));
        captures.measured(number);
    }
    captures.named(order("4"), 3, at(50), &[]);
    captures.pressed(3, at(60));
    is_held(&mut captures, 65, &["3", "4"]);
}

#[test]
fn without_a_button_a_word_of_a_person_ends_what_is_held_for_others() {
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.named(by_whom("1", SourceKind::Reader), 1, at(0), &[]);
    taken(&mut captures, seen(10));
    captures.refused(1, at(12));
    captures.named(by_whom("2", SourceKind::Reader), 2, at(20), &[]);
    is_held(&mut captures, 30, &["1", "2"]);
    captures.named(by_whom("3", SourceKind::Reader), 3, at(40), &[]);
    let mut unanswered = captures.clone();
    is_held(&mut unanswered, 60, &["1", "2", "3"]);
    captures.named(by_whom("3", SourceKind::Operator), 4, at(50), &[]);
    assert_eq!(patient_of(&export(&mut captures, seen(60))), Some("3"));
}

#[test]
fn a_refused_export_that_may_come_again_is_not_certain_once_somebody_else_is_named_at_the_booth() {
    let mut captures = captures();
    captures.named(by_whom("1", SourceKind::Reader), 1, at(0), &[]);
    captures.pressed(1, at(1));
    taken(&mut captures, seen(10));
    captures.refused(1, at(15));
    captures.named(by_whom("2", SourceKind::Reader), 2, at(30), &[]);
    let mut hers = captures.clone();
    // What began before the card is the first one's; what begins after it may be of a press that was forgotten.
    assert_eq!(patient_of(&export(&mut hers, seen(25))), Some("1"));
    is_held(&mut captures, 40, &["1", "2"]);
}

#[test]
fn an_export_that_names_somebody_else_leaves_its_capture_in_doubt() {
    let mut captures = captures();
    captures.named(by_whom("1", SourceKind::Reader), 1, at(0), &[]);
    captures.pressed(1, at(1));
    let judged = captures.match_export(seen(10), at(12)).contradicted();
    captures.answer(&judged, at(12));
    // The picture that is made of it ends nothing.
    captures.measured(1);
    let mut after = captures.clone();
    after.named(by_whom("3", SourceKind::Reader), 3, at(20), &[]);
    after.pressed(2, at(21));
    is_held(&mut after, 30, &["1", "3"]);
    // Whose it is does not make the next one certain.
    captures.decided(&judged, "2", at(20));
    is_held(&mut captures, 30, &["1"]);
}

#[test]
fn without_a_button_whoever_was_ordered_and_given_up_for_another_may_come_next() {
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.uncertain = None;
    captures.named(order("1"), 1, at(0), &[]);
    captures.named(by_whom("2", SourceKind::Operator), 2, at(10), &[]);
    assert_eq!(patient_of(&export(&mut captures, seen(20))), Some("2"));
    captures.named(order("3"), 3, at(30), &[]);
    is_held(&mut captures, 40, &["1", "3"]);
}

#[test]
fn an_order_that_cannot_be_read_may_be_for_each_press_since_it_came() {
    for (absent, is_sure) in [(Some(at(4)), false), (None, false), (Some(at(5)), true)] {
        let mut captures = captures();
        captures.named(order("1"), 1, at(0), &[]);
        captures.pressed(1, at(5));
        captures.unread(absent);
        if is_sure {
            assert_eq!(patient_of(&export(&mut captures, seen(20))), Some("1"));
        } else {
            assert_eq!(code(&is_held(&mut captures, 20, &["1"])), UNREAD);
        }
    }
}

#[test]
fn a_press_whose_scan_a_person_decided_crosses_no_card() {
    let mut captures = captures();
    captures.pressed(1, at(0));
    captures.named(by_whom("1", SourceKind::Reader), 1, at(2), &[]);
    let judged = is_held(&mut captures, 10, &["1"]);
    captures.decided(&judged, "1", at(15));
    captures.measured(1);
    // The first card may have been for the next press: the same card again shows who is there.
    captures.named(by_whom("2", SourceKind::Reader), 2, at(30), &[]);
    captures.named(by_whom("2", SourceKind::Reader), 2, at(32), &[]);
    captures.pressed(2, at(35));
    assert_eq!(patient_of(&export(&mut captures, seen(40))), Some("2"));
}
