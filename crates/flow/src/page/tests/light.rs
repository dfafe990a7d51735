//! What the light shows: after a scan, while a person is needed, in a pause.

use std::time::Duration;

use gaiter_language::Language;

use super::{BOTH, booth, delivery, page, page_with, whole};
use crate::booth::Signal;
use crate::complaint::Complaint;
use crate::light::{LastOutcome, Progress};
use crate::page::{ScanDetails, Situation, scan_shown};
use crate::round::{HeldNext, HoldReason};

fn sentence(last: &LastOutcome, complaints: &[Complaint], language: Language) -> String {
    let booth = Situation { last: Some(last), ..booth(Signal::Attention) };
    page(booth, complaints, language).light.said.text
}

#[test]
fn what_is_to_be_done_with_the_patient_stands_at_the_light_and_a_fault_before_it() {
    let to_do = ["Scan again: legs apart.", "Or measure by hand: right leg: C."].map(str::to_owned);
    let last = LastOutcome::Incomplete { to_do: to_do.into() };
    let said = sentence(&last, &[], Language::En);
    assert_eq!(said, "Scan again: legs apart. Or measure by hand: right leg: C.");
    let said = sentence(&last, &[Complaint::journal()], Language::En);
    assert!(
        said.starts_with("The journal cannot be read.") && said.ends_with("right leg: C."),
        "{said}"
    );
}

#[test]
fn a_refused_scan_is_told_with_its_reason_and_what_to_do_at_the_booth() {
    for (code, english, german) in [
        ("scan-empty", "Export it again.", "noch einmal exportieren"),
        (
            "body-not-two-legs",
            "Scan again: standing, with the legs apart.",
            "die Beine auseinander",
        ),
        ("no-leg", "Scan again with the legs bare and apart.", "frei und auseinander"),
    ] {
        let last = LastOutcome::Refused { code: code.to_owned() };
        for (language, words) in BOTH.into_iter().zip([english, german]) {
            let said = sentence(&last, &[], language);
            assert!(said.to_lowercase().contains(&words.to_lowercase()), "{code}: {said}");
            assert!(!said.contains(language.text("page.decide")), "{code}: {said}");
        }
    }
}

#[test]
fn a_held_scan_is_told_with_its_reason_before_an_export_that_is_expected() {
    let last = LastOutcome::Held { code: "patients-differ".to_owned() };
    let booth = Situation { last: Some(&last), awaited: 1, ..booth(Signal::Attention) };
    let said = page(booth, &[], Language::En).light.said.text;
    assert_eq!(
        said,
        "The last scan is held. Two sources name different patients. Decide on the page whose it is."
    );
}

#[test]
fn a_pause_has_its_own_word_and_says_how_it_ends() {
    for (language, word) in BOTH.into_iter().zip(["Paused", "Pause"]) {
        let light = page(booth(Signal::Paused), &[], language).light;
        assert_eq!((light.signal, light.word), ("paused", word));
    }
}

#[test]
fn a_button_that_is_not_there_is_told_instead_of_to_be_pressed_and_after_what_else_there_is_to_say()
{
    let (delivered, unread) = (LastOutcome::Delivered, LastOutcome::NameUnread);
    for (language, words) in BOTH.into_iter().zip(["is not there", "nicht angeschlossen"]) {
        for (signal, last, begins) in [
            (Signal::Ready, None, true),
            (Signal::Armed, None, false),
            (Signal::NoExport, None, true),
            (Signal::Attention, None, true),
            (Signal::Attention, Some(&unread), false),
            (Signal::Done, Some(&delivered), false),
            (Signal::Receiving, None, false),
            (Signal::Paused, None, false),
        ] {
            let away = Situation { is_button_away: true, last, ..booth(signal) };
            let said = page(away, &[], language).light.said.text;
            let away = said.find(words).unwrap_or_else(|| panic!("{signal:?}: {said}"));
            assert_eq!(away < 20, begins, "{signal:?}: {said}");
            assert_eq!(said.matches(words).count(), 1, "{signal:?}: {said}");
        }
    }
}

fn held_next(why: HoldReason) -> HeldNext {
    let left = Some(Duration::from_secs(301));
    match why {
        HoldReason::Uncertain => HeldNext { why, of: Vec::new(), left: None },
        HoldReason::Unheard => HeldNext { why, of: Vec::new(), left },
        _ => HeldNext { why, of: vec!["4711".to_owned()], left },
    }
}

#[test]
fn what_must_be_done_before_the_next_scan_stands_before_it_with_how_long() {
    // Without a scan that waits for a decision, a held one was given up.
    for (why, begins, names) in [
        (HoldReason::MayComeAgain, "First scan 4711 again, or give that scan up. Until then", true),
        (HoldReason::Undecided, "The export of 4711 has not come: if it does not come any", true),
        (HoldReason::Unheard, "A press of the button may have been missed: scans of named", false),
        (HoldReason::NotCome, "The export of 4711 has not come: if it does not come any", true),
        (HoldReason::Uncertain, "It is not certain who is in the booth: the next scan is", false),
    ] {
        let held = held_next(why);
        let ready = Situation { held_next: Some(&held), ..booth(Signal::Ready) };
        let shown = page(ready, &[], Language::En);
        let said = shown.light.said.text.clone();
        assert!(
            said.starts_with(begins) && said.ends_with("Press the button, then scan."),
            "{said}"
        );
        assert_eq!(said.contains("for up to 6 min"), why != HoldReason::Uncertain, "{said}");
        assert_eq!(said.contains("4711"), names, "{said}");
        assert!(!shown.without_ids().light.said.text.contains("4711"));
        // Once the button is pressed it is too late for that.
        let armed = Situation { held_next: Some(&held), ..booth(Signal::Armed) };
        let said = page(armed, &[], Language::En).light.said.text;
        assert_eq!(said, "Scan now, then export. You will be asked whose scan it is.");
        // A missing patient can be scanned again without being held, unless a press may have been missed.
        let missed = Situation { held_next: Some(&held), ..booth(Signal::NoExport) };
        let said = page(missed, &[], Language::En).light.said.text;
        let others = "If another patient is next, call off first. Until then, or for up to 6 min,";
        let is_told = match why {
            HoldReason::Uncertain => !said.contains("held"),
            HoldReason::Unheard => said.contains("A press of the button may have been missed"),
            _ => said.contains(others),
        };
        assert!(is_told, "{why:?}: {said}");
    }
}

#[test]
fn a_button_that_is_not_there_is_told_after_another_fault_and_once_with_its_own() {
    let away = Situation { is_button_away: true, ..booth(Signal::Attention) };
    let own = Complaint { code: "trigger-absent".to_owned(), ..Complaint::journal() };
    for (complaint, begins) in
        [(Complaint::journal(), "The journal cannot be read."), (own, "The button is not there.")]
    {
        let said = page(away, &[complaint], Language::En).light.said.text;
        assert!(said.starts_with(begins), "{said}");
        assert_eq!(said.matches("The button is not there.").count(), 1, "{said}");
    }
}

#[test]
fn a_scan_that_waits_for_a_decision_is_decided_first() {
    let held = held_next(HoldReason::Undecided);
    let booth = Situation { held_next: Some(&held), ..booth(Signal::Ready) };
    let waiting = whole("delivered", None, vec![delivery(Some("1"), "held", Some("export-late"))]);
    let undecided = vec![scan_shown(&waiting, &ScanDetails::default(), Language::En)];
    let said = page_with(booth, &[], undecided, Language::En).light.said.text;
    assert!(said.starts_with("First decide about the scan that is held. Until then"), "{said}");
}

#[test]
fn a_refused_or_held_scan_is_told_with_what_it_keeps_others_from_and_how_long() {
    let refused = LastOutcome::Refused { code: "no-leg".to_owned() };
    let held = LastOutcome::Held { code: "capture-unclear".to_owned() };
    let until = "Until then, or for up to 6 min, other scans are held.";
    for (last, why) in [(&refused, HoldReason::MayComeAgain), (&held, HoldReason::Undecided)] {
        let alone = Situation { last: Some(last), ..booth(Signal::Attention) };
        assert!(!page(alone, &[], Language::En).light.said.text.contains(until));
        let why = held_next(why);
        let booth = Situation { held_next: Some(&why), ..alone };
        let said = page(booth, &[], Language::En).light.said.text;
        assert!(said.ends_with(until), "{said}");
    }
}

#[test]
fn a_held_scan_goes_before_the_alarm_for_an_export_that_did_not_come() {
    let last = LastOutcome::Held { code: "export-late".to_owned() };
    let late = Complaint { code: crate::light::NO_EXPORT.to_owned(), ..Complaint::journal() };
    let said = sentence(&last, &[late], Language::En);
    assert!(said.starts_with("The last scan is held."), "{said}");
}

#[test]
fn the_light_names_the_patient_of_the_last_scan_to_those_who_may_know_it() {
    let (one, two) = (["4711".to_owned()], ["4711", "0815"].map(str::to_owned));
    let held = || LastOutcome::Held { code: "capture-unclear".to_owned() };
    let to_do = || LastOutcome::Incomplete { to_do: vec!["Measure by hand.".to_owned()] };
    for (signal, last, of, said) in [
        (Signal::Done, LastOutcome::Delivered, &one[..], "The record of 4711 is stored."),
        (Signal::Attention, to_do(), &one, "The scan of 4711 lacks measures. Measure by hand."),
        (Signal::Attention, to_do(), &two, "The scan of 4711 and 0815 lacks measures."),
        (Signal::Attention, held(), &one, "The scan of 4711 is held."),
        (Signal::Attention, held(), &two, "The scan of 4711 or 0815 is held."),
        (
            Signal::Attention,
            LastOutcome::Refused { code: "no-leg".to_owned() },
            &one,
            "The scan of 4711 cannot be used.",
        ),
        (
            Signal::Attention,
            LastOutcome::Known,
            &one,
            "The scanner has exported an old scan again, that of 4711. Export the new scan",
        ),
    ] {
        for language in BOTH {
            let booth = Situation { last: Some(&last), last_of: of, ..booth(signal) };
            let page = page(booth, &[], language);
            assert!(page.light.said.text.contains("4711"), "{}", page.light.said.text);
            assert_eq!(page.light.said.text, page.light.said.pieces.concat());
            if language == Language::En {
                assert!(page.light.said.text.starts_with(said), "{}", page.light.said.text);
            }
            let hidden = page.without_ids().light.said;
            assert!(!(hidden.text + &hidden.pieces.concat()).contains("4711"));
        }
    }
}

#[test]
fn an_export_that_comes_in_one_that_stopped_and_a_scan_that_is_measured_are_told_apart() {
    for (progress, word, said) in [
        (Progress::ComingIn, "Coming in", "The scanner is still writing"),
        (Progress::Stopped, "Export stopped", "The export stopped halfway."),
        (Progress::Measuring, "Measuring", "This takes a few seconds."),
    ] {
        let booth = Situation { progress: Some(progress), ..booth(Signal::Receiving) };
        let light = page(booth, &[], Language::En).light;
        assert_eq!((light.signal, light.word), ("receiving", word));
        assert!(light.said.text.contains(said), "{}", light.said.text);
    }
}
