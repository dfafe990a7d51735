//! What happens to captures when their exports are taken, measured, refused or given up, one claim per
//! test.

use super::laws::pressed_for;
use super::*;

#[test]
fn while_a_scan_is_measured_an_export_for_somebody_else_may_be_another_one_of_it() {
    let mut captures = captures();
    pressed_for(&mut captures, "1", 1, 0);
    let first = taken(&mut captures, seen(10));
    assert_eq!(patient_of(&first), Some("1"));
    pressed_for(&mut captures, "2", 2, 11);
    let second = taken(&mut captures, seen(15));
    assert_eq!((code(&second), candidates(&second)), (AMBIGUOUS, vec!["1", "2"]));
    // Whichever it was, the other export is still to come.
    refuse(&mut captures, &first, at(16));
    let third = export(&mut captures, seen(20));
    assert_eq!(code(&third), AMBIGUOUS);
}

#[test]
fn once_a_scan_is_measured_the_next_export_is_the_next_patients() {
    let mut captures = captures();
    pressed_for(&mut captures, "1", 1, 0);
    assert_eq!(patient_of(&taken(&mut captures, seen(10))), Some("1"));
    // A second export of the same press belongs to no patient in any case.
    assert_eq!(captures.match_export(seen(12), at(12)), CaptureMatch::Unpressed);
    captures.measured(1);
    pressed_for(&mut captures, "2", 2, 11);
    assert_eq!(patient_of(&export(&mut captures, seen(15))), Some("2"));
}

#[test]
fn a_scan_that_cannot_be_measured_for_long_is_in_nobodys_way() {
    let mut captures = captures();
    pressed_for(&mut captures, "1", 1, 0);
    assert_eq!(patient_of(&taken(&mut captures, seen(10))), Some("1"));
    // Window and late are 360 s.
    captures.pass(at(371), &[all_seen(371)]);
    pressed_for(&mut captures, "2", 2, 372);
    assert_eq!(patient_of(&export(&mut captures, seen(380))), Some("2"));
}

#[test]
fn a_held_export_that_was_cut_short_uses_up_no_press_and_a_whole_one_does() {
    for (is_cut_short, left) in [(true, 2), (false, 1)] {
        let mut captures = captures();
        pressed_for(&mut captures, "1", 1, 0);
        pressed_for(&mut captures, "2", 2, 10);
        let (began, others, is_known, completes) = (seen(20), Vec::new(), false, None);
        let content = ExportContent { began, others, is_known, is_cut_short, completes };
        let judged = captures.match_content(&content, at(20));
        assert_eq!(code(&judged), AMBIGUOUS);
        captures.answer(&judged, at(20));
        assert_eq!(captures.waiting().count(), left);
    }
}

#[test]
fn the_rest_of_a_scan_that_is_measured_is_its_captures_and_its_part_opens_that_no_more() {
    let mut captures = captures();
    pressed_for(&mut captures, "1", 1, 0);
    taken(&mut captures, seen(10));
    let of = |id: &str| ExportContent {
        began: seen(10),
        others: Vec::new(),
        is_known: false,
        is_cut_short: false,
        completes: Some(vec![named(id)]),
    };
    assert_eq!(captures.match_content(&of("2"), at(10)), CaptureMatch::Unpressed);
    let rest = captures.match_content(&of("1"), at(10));
    assert_eq!(patient_of(&rest), Some("1"));
    captures.answer(&rest, at(12));
    captures.measured(1);
    assert!(captures.refused(1, at(14)).is_none());
    assert_eq!(captures.waiting().count(), 0);
}

#[test]
fn what_was_given_up_is_not_opened_again_by_a_refusal() {
    let mut pressed = captures();
    pressed_for(&mut pressed, "1", 1, 0);
    taken(&mut pressed, seen(10));
    assert_eq!(pressed.call_off().captures, [1]);
    assert!(pressed.refused(1, at(12)).is_none());
}

#[test]
fn a_scan_that_was_refused_long_after_it_was_taken_opens_no_capture() {
    let mut captures = captures();
    pressed_for(&mut captures, "1", 1, 0);
    taken(&mut captures, seen(10));
    // Window and late are 360 s.
    captures.pass(at(371), &[all_seen(371)]);
    assert!(captures.refused(1, at(372)).is_none());
}

#[test]
fn what_a_start_finds_unmeasured_is_in_doubt_when_it_is_refused() {
    let mut captures = captures();
    pressed_for(&mut captures, "1", 1, 0);
    let CaptureMatch::Of(capture) = taken(&mut captures, seen(10)) else { panic!("it is held") };
    let taken = vec![Capture { state: CaptureState::Taken, ..capture }];
    let mut started = Rounds::new(rules(), Vec::new(), Names::default()).with_taken(taken, at(20));
    let doubt = started.refused(1, at(21)).and_then(|capture| capture.doubt);
    assert_eq!(doubt, Some(Doubt::Unheard));
}

#[test]
fn an_export_that_may_be_older_than_every_press_uses_up_none() {
    let mut captures = captures();
    pressed_for(&mut captures, "1", 1, 10);
    pressed_for(&mut captures, "2", 2, 20);
    let judged = taken(&mut captures, Appeared { absent: Some(at(5)), seen: at(30) });
    assert_eq!((code(&judged), captures.waiting().count()), (AMBIGUOUS, 2));
}

#[test]
fn a_content_that_is_gone_may_have_been_the_export_of_every_capture_that_may_have_it() {
    for (second, holds) in [(5, true), (1, false)] {
        let mut captures = captures();
        pressed_for(&mut captures, "1", 1, 1);
        captures.gone(seen(second));
        let judged = export(&mut captures, seen(20));
        match holds {
            true => assert_eq!((code(&judged), candidates(&judged)), (AMBIGUOUS, vec!["1"])),
            false => assert_eq!(patient_of(&judged), Some("1")),
        }
    }
    // Without a button the name opens the capture.
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.named(named("1"), 1, at(0), &[]);
    captures.gone(seen(5));
    assert_eq!(code(&export(&mut captures, seen(20))), AMBIGUOUS);
}

#[test]
fn a_content_without_a_press_that_is_gone_puts_the_name_that_waits_in_doubt() {
    for (second, holds) in [(5, true), (1, false)] {
        let mut captures = captures();
        captures.named(named("1"), 1, at(1), &[]);
        captures.gone(seen(second));
        captures.pressed(1, at(10));
        let judged = export(&mut captures, seen(20));
        assert_eq!(matches!(judged, CaptureMatch::Held { .. }), holds, "{judged:?}");
    }
    // Where nobody is named, nobody can be mistaken.
    let mut captures = captures();
    captures.pressed(1, at(1));
    captures.gone(seen(5));
    assert_eq!(patient_of(&export(&mut captures, seen(20))), None);
}

/// Why the next scan would be held, and whom that names.
fn told(captures: &Rounds, now: Duration) -> Option<(HoldReason, Vec<String>)> {
    captures.held_next(now).map(|held| (held.why, held.of))
}

#[test]
fn a_scan_that_would_be_held_is_foreseen_with_the_reason_that_a_person_can_end() {
    let mut captures = captures();
    let of = |id: &str| vec![id.to_owned()];
    assert_eq!(captures.held_next(at(0)), None);
    pressed_for(&mut captures, "1", 1, 0);
    assert_eq!(captures.held_next(at(1)), None, "its own press");
    let first = taken(&mut captures, seen(10));
    refuse(&mut captures, &first, at(16));
    // The same patient may be scanned again, another not.
    captures.named(named("1"), 2, at(17), &[]);
    assert_eq!(captures.held_next(at(17)), None);
    captures.named(named("2"), 2, at(18), &[]);
    assert_eq!(told(&captures, at(18)), Some((HoldReason::MayComeAgain, of("1"))));
    captures.pressed(2, at(19));
    assert_eq!(told(&captures, at(19)), Some((HoldReason::MayComeAgain, of("1"))));
    // That press was made while it might have come; one after it is not.
    captures.given_up(1);
    assert_eq!(told(&captures, at(20)), Some((HoldReason::Uncertain, Vec::new())));
    captures.call_off();
    captures.named(named("2"), 3, at(21), &[]);
    assert_eq!(captures.held_next(at(21)), None);
}

#[test]
fn a_held_scan_a_missing_export_and_a_missed_press_are_foreseen_to_hold_the_next() {
    let of = |id: &str| vec![id.to_owned()];
    let mut held = captures();
    pressed_for(&mut held, "1", 1, 0);
    held.open[0].doubt = Some(Doubt::Unread);
    assert_eq!(code(&taken(&mut held, seen(10))), UNREAD);
    held.named(named("2"), 2, at(11), &[]);
    assert_eq!(told(&held, at(11)), Some((HoldReason::Undecided, of("1"))));

    let mut missing = captures();
    pressed_for(&mut missing, "1", 1, 0);
    missing.pass(at(61), &[all_seen(61)]);
    missing.named(named("2"), 2, at(62), &[]);
    assert_eq!(told(&missing, at(62)), Some((HoldReason::NotCome, of("1"))));
    // Window and late are 360 s.
    assert_eq!(missing.held_next(at(62)).and_then(|held| held.left), Some(298 * SECOND));
    missing.call_off();
    missing.named(named("2"), 2, at(63), &[]);
    assert_eq!(missing.held_next(at(63)), None);

    let mut unheard = captures();
    unheard.deaf();
    unheard.receives(at(0));
    unheard.named(named("1"), 1, at(1), &[]);
    assert_eq!(told(&unheard, at(1)), Some((HoldReason::Unheard, Vec::new())));
    assert_eq!(unheard.held_next(at(0) + rules().awaited()), None);
    // A source of names that was away is no button that was.
    let mut unread = captures();
    unread.named(order("1"), 1, at(0), &[]);
    unread.missed_name();
    assert_eq!(told(&unread, at(1)), Some((HoldReason::Uncertain, Vec::new())));
    let nobody = Rounds { names: Names::default(), ..unheard };
    assert_eq!(nobody.held_next(at(1)), None, "nobody can be mistaken");
}

#[test]
fn without_a_button_a_name_beside_a_refused_scan_is_foreseen_to_be_held() {
    let rules = Rules { by_press: false, ..rules() };
    let mut captures = Rounds::new(rules, Vec::new(), Names::default());
    captures.uncertain = None;
    captures.receives(at(0));
    captures.named(order("1"), 1, at(0), &[]);
    assert_eq!(captures.held_next(at(1)), None);
    let first = taken(&mut captures, seen(10));
    refuse(&mut captures, &first, at(16));
    assert_eq!(captures.held_next(at(17)), None, "its own repetition");
    captures.named(order("2"), 2, at(18), &[]);
    let again = (HoldReason::MayComeAgain, vec!["1".to_owned()]);
    assert_eq!(told(&captures, at(19)), Some(again));
}
