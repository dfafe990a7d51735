//! What the light says: after a scan, while a person is needed, in a pause.

use gaiter_language::Language;

use super::{BOTH, at, booth, page};
use crate::booth::Signal;
use crate::facts::{Facts, TriggerFacts};
use crate::health::Complaint;
use crate::light::{Outcome, Progress};
use crate::page::{Known, Situation, shown};
use crate::trigger::PortState;

fn sentence(last: &Outcome, complaints: &[Complaint], language: Language) -> String {
    let booth = Situation { last: Some(last), ..booth(Signal::Attention) };
    page(booth, complaints, language).light.said.text
}

#[test]
fn what_is_to_be_done_with_the_patient_stands_at_the_light_and_a_fault_before_it() {
    let to_do = ["Scan again: legs apart.", "Or measure by hand: right leg: C."].map(str::to_owned);
    let last = Outcome::Incomplete { to_do: to_do.into() };
    let said = sentence(&last, &[], Language::En);
    assert_eq!(said, "Scan again: legs apart. Or measure by hand: right leg: C.");
    let said = sentence(&last, &[Complaint::journal()], Language::En);
    assert!(!said.contains("legs apart"), "{said}");
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
        let last = Outcome::Refused { code: code.to_owned() };
        for (language, words) in BOTH.into_iter().zip([english, german]) {
            let said = sentence(&last, &[], language);
            assert!(said.to_lowercase().contains(&words.to_lowercase()), "{code}: {said}");
            assert!(!said.contains(language.text("page.decide")), "{code}: {said}");
        }
    }
}

#[test]
fn a_held_scan_is_told_with_its_reason_before_an_export_that_is_expected() {
    let last = Outcome::Held { code: "patients-differ".to_owned() };
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

/// What the light says while a button's port is in this state.
fn with_port(booth: Situation<'_>, state: PortState, language: Language) -> String {
    let mut facts = Facts::new(at(0), 1);
    facts.triggers.insert("serial", TriggerFacts { state, ..TriggerFacts::new(at(0)) });
    let known =
        Known { page: "1", station: "b", facts: &facts, complaints: &[], booth, now: at(1) };
    shown(&known, Vec::new(), 0, Vec::new(), language).light.said.text
}

#[test]
fn a_button_that_is_not_there_is_told_instead_of_to_be_pressed() {
    for signal in [Signal::Ready, Signal::Armed, Signal::NoExport] {
        for (language, words) in BOTH.into_iter().zip(["is not there", "nicht angeschlossen"]) {
            let away = Situation { is_button_away: true, ..booth(signal) };
            let said = with_port(away, PortState::Absent, language);
            assert!(said.contains(words), "{signal:?}: {said}");
            let said = with_port(away, PortState::Settling, language);
            assert!(!said.contains(words), "at a start: {said}");
            let without = Situation { has_button: false, ..away };
            assert!(!with_port(without, PortState::Absent, language).contains(words));
        }
    }
}

#[test]
fn a_held_scan_goes_before_the_alarm_for_an_export_that_did_not_come() {
    let last = Outcome::Held { code: "export-late".to_owned() };
    let late = Complaint { code: crate::light::NO_EXPORT.to_owned(), ..Complaint::journal() };
    let said = sentence(&last, &[late], Language::En);
    assert!(said.starts_with("The last scan is held."), "{said}");
}

#[test]
fn the_light_names_the_patient_of_the_last_scan_to_those_who_may_know_it() {
    let (one, two) = (["4711".to_owned()], ["4711", "0815"].map(str::to_owned));
    let held = || Outcome::Held { code: "capture-unclear".to_owned() };
    let to_do = || Outcome::Incomplete { to_do: vec!["Measure by hand.".to_owned()] };
    for (signal, last, of, said) in [
        (Signal::Done, Outcome::Delivered, &one[..], "The record of 4711 is stored."),
        (Signal::Attention, to_do(), &one, "The scan of 4711 lacks measures. Measure by hand."),
        (Signal::Attention, to_do(), &two, "The scan of 4711 and 0815 lacks measures."),
        (Signal::Attention, held(), &one, "The scan of 4711 is held."),
        (Signal::Attention, held(), &two, "The scan of 4711 or 0815 is held."),
        (
            Signal::Attention,
            Outcome::Refused { code: "no-leg".to_owned() },
            &one,
            "The scan of 4711 cannot be used.",
        ),
        (
            Signal::Attention,
            Outcome::Known,
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
