//! The one light: its word, and one sentence on what to do next.

use gaiter_language::Language;
use serde::Serialize;

use super::reasons::{Advice, of_held, of_refused};
use crate::booth::Signal;
use crate::light::Outcome;

/// The light on the page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LightShown {
    /// The signal's stable word; it decides colour and sign.
    pub signal: &'static str,
    /// The word that is read from a distance.
    pub word: &'static str,
    /// What to do next.
    pub sentence: String,
}

/// The state of the booth.
#[derive(Debug, Clone, Copy)]
pub struct Situation<'a> {
    /// What its light shows.
    pub signal: Signal,
    /// A button is connected to the station.
    pub has_button: bool,
    /// It is not there, or another one is not: presses may be missed.
    pub is_button_away: bool,
    /// How many exports are expected.
    pub awaited: usize,
    /// The ids of the patients who may be next: one if it is certain, several if it is in doubt.
    pub next: &'a [String],
    /// The ids of the patients whose exports are expected; without a button a name opens the capture.
    pub awaited_for: &'a [String],
    /// It is not certain who is next: somebody at the booth must say so.
    pub is_asked: bool,
    /// A press may have been missed.
    pub is_in_doubt: bool,
    /// How the last scan since the last press ended; `None` if none has ended since.
    pub last: Option<&'a Outcome>,
}

/// The light; `first` is the most serious fault, if there is one.
pub(super) fn shown(
    booth: &Situation<'_>,
    first: Option<&Advice>,
    is_any_undecided: bool,
    language: Language,
) -> LightShown {
    let decide = language.text("page.decide");
    let step = language.text(next_step(booth));
    let sentence = match (booth.signal, first) {
        (Signal::Attention, Some(advice)) => advice.in_a_row(),
        // The patient waits, a decision can wait.
        (Signal::Attention, None) => match booth.last.and_then(|last| of_last(last, language)) {
            Some(sentence) => sentence,
            None if is_any_undecided => decide.to_owned(),
            None => step.to_owned(),
        },
        (Signal::Ready | Signal::Done, _) if is_any_undecided => format!("{step} {decide}"),
        _ => step.to_owned(),
    };
    let signal = booth.signal.word();
    LightShown { signal, word: language.word("page.light", signal), sentence }
}

/// What the last scan needs from a person at the booth; `None` if nothing.
fn of_last(last: &Outcome, language: Language) -> Option<String> {
    let text = |key| language.text(key);
    Some(match last {
        Outcome::Delivered => return None,
        Outcome::Incomplete { to_do } => to_do.join(" "),
        Outcome::Held { code } => {
            let why = of_held(code, language).what;
            format!("{} {why} {}", text("page.step.held"), text("page.step.decide_held"))
        }
        Outcome::Refused { code } => {
            format!("{} {}", text("page.step.refused"), of_refused(code, language).in_a_row())
        }
        Outcome::NameUnread => text("page.step.name_unread").to_owned(),
        Outcome::Known => text("page.step.known").to_owned(),
    })
}

/// The key of the sentence on what to do next.
fn next_step(booth: &Situation<'_>) -> &'static str {
    match (booth.signal, booth.has_button) {
        (Signal::Ready | Signal::Armed | Signal::NoExport, true) if booth.is_button_away => {
            "page.step.button_away"
        }
        (Signal::Ready, true) if booth.is_asked => "page.step.say_who",
        (Signal::Ready, true) if !booth.next.is_empty() => "page.step.press_for_named",
        (Signal::Ready, true) => "page.step.press",
        (Signal::Ready, false) => "page.step.scan",
        (Signal::Armed, _) => "page.step.armed",
        (Signal::Receiving, _) => "page.step.receiving",
        (Signal::Done, _) => "page.step.done",
        (Signal::Attention, _) => "page.step.attention",
        (Signal::Paused, _) => "page.step.paused",
        (Signal::NoExport, true) => "page.step.no_export",
        (Signal::NoExport, false) => "page.step.no_export_without_button",
    }
}
