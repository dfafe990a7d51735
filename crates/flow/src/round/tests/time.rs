//! How captures end by time, and what a restart of the machine leaves of them.

use super::laws::pressed_for;
use super::*;

#[test]
fn a_capture_without_an_export_expires_once_and_its_late_export_is_held() {
    let mut captures = captures();
    captures.named(named("4711"), 1, at(0), &[]);
    captures.pressed(1, at(0));
    assert_eq!(captures.pass(at(60), &[all_seen(60)]), Passed::default());
    assert_eq!(captures.pass(at(61), &[all_seen(61)]).expired, [1]);
    assert_eq!(captures.pass(at(62), &[all_seen(62)]), Passed::default());
    let judged = export(&mut captures, seen(90));
    assert_eq!(code(&judged), LATE);
    assert!(matches!(judged, CaptureMatch::Held { answered: Some(1), .. }));
    assert_eq!(captures.waiting().count(), 0);
}

#[test]
fn a_file_that_is_coming_in_keeps_its_capture_from_expiring() {
    let mut captures = captures();
    captures.pressed(1, at(0));
    let coming = |files: &[u64]| Sights {
        looked: Some(at(300)),
        coming: files.iter().map(|file| seen(*file)).collect(),
        ..Sights::default()
    };
    assert_eq!(captures.pass(at(100), &[coming(&[50])]), Passed::default());
    assert_eq!(patient_of(&export(&mut captures, seen(50))), None);
    captures.pressed(2, at(200));
    assert_eq!(
        captures.pass(at(300), &[coming(&[150, 290])]).expired,
        [2],
        "those are not its own"
    );
}

#[test]
fn a_capture_is_over_only_when_every_folder_was_looked_at_after_its_end() {
    let mut captures = captures();
    pressed_for(&mut captures, "4711", 1, 0);
    let end = 60 + 300;
    let before = [all_seen(end), all_seen(end + 40)];
    assert_eq!(captures.pass(at(end + 50), &before).expired, [1], "the alarm does not wait");
    let unseen = [Sights::default(), all_seen(end + 40)];
    assert_eq!(captures.pass(at(end + 50), &unseen), Passed::default());
    // The next look finds a file that was not there at the look before the end.
    let mut found = captures.clone();
    pressed_for(&mut found, "0815", 2, end - 10);
    let away = Appeared { absent: Some(at(end - 5)), seen: at(end + 51) };
    assert_eq!(code(&export(&mut found, away)), AMBIGUOUS);
    // It is also not over while there is a file that may be renamed to its export.
    let part = Sights { beside: vec![seen(end)], ..all_seen(end + 1) };
    assert_eq!(captures.pass(at(end + 50), &[part]), Passed::default());
    assert_eq!(captures.pass(at(end + 50), &[all_seen(end + 1)]).over, [1]);
}

#[test]
fn an_export_awaited_when_the_machine_starts_anew_is_held_beside_the_next_patients() {
    let rules = Rules { by_press: false, ..rules() };
    let mut before = Rounds::new(rules, Vec::new(), Names::default());
    before.named(named("4711"), 1, at(0), &[]);
    let capture = before.open()[0].clone();
    let carried = |age| capture.clone().carried_over(age, rules.late, SECOND * 20);
    let longest = rules.name_lasts + rules.late;
    assert_eq!(carried(Some(longest + SECOND)), None);
    assert_eq!(carried(None), carried(Some(longest)), "the clock on the wall has gone back");
    let waiting = carried(Some(SECOND * 50)).unwrap();
    assert_eq!((waiting.opened, waiting.state), (Duration::ZERO, CaptureState::Expired));

    let mut captures = Rounds::new(rules, vec![waiting], Names::default());
    captures.receives(Duration::ZERO);
    let seen = Appeared { absent: Some(SECOND * 30), seen: SECOND * 31 };
    let of_the_first = captures.match_export(seen, seen.seen);
    assert_eq!((code(&of_the_first), candidates(&of_the_first)), (UNHEARD, vec!["4711"]));
    captures.named(order("0815"), 2, SECOND * 25, &[]);
    let judged = captures.match_export(seen, seen.seen);
    assert_eq!((code(&judged), candidates(&judged)), (AMBIGUOUS, vec!["4711", "0815"]));
    let over = SECOND * 21 + longest;
    let sights = Sights { looked: Some(over), ..Sights::default() };
    assert_eq!(captures.pass(over, &[sights]).over, [1]);
}
