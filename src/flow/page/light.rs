//! The one light: its word, and one sentence on what to do next.

use serde::Serialize;

use super::reasons::Advice;
use super::words::{Both, say};
use crate::flow::booth::Signal;
use crate::record::Language;

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
    /// How many exports are expected.
    pub awaited: usize,
    /// The ids of the patients who may be next: one if it is certain, several if it is in doubt.
    pub next: &'a [String],
    /// The ids of the patients whose exports are expected; without a button a name opens the capture.
    pub awaited_for: &'a [String],
    /// A press may have been missed.
    pub is_in_doubt: bool,
}

/// The light; `first` is the most serious fault, if there is one.
pub(super) fn shown(
    booth: &Situation<'_>,
    first: Option<&Advice>,
    is_any_undecided: bool,
    language: Language,
) -> LightShown {
    let sentence = match (booth.signal, first) {
        (Signal::Attention, Some(advice)) => format!("{} {}", advice.what, advice.next),
        (Signal::Attention, None) if is_any_undecided => say(language, DECIDE).to_owned(),
        (Signal::Ready, _) if is_any_undecided => {
            format!("{} {}", say(language, next_step(Signal::Ready, booth)), say(language, DECIDE))
        }
        (signal, _) => say(language, next_step(signal, booth)).to_owned(),
    };
    let word = say(language, word(booth.signal));
    LightShown { signal: booth.signal.word(), word, sentence }
}

const DECIDE: Both = (
    "A scan waits for your decision on the page.",
    "Ein Scan wartet auf der Seite auf Ihre Entscheidung.",
);

fn word(signal: Signal) -> Both {
    match signal {
        Signal::Ready => ("Ready", "Bereit"),
        Signal::Armed => ("Waiting for the export", "Warte auf den Export"),
        Signal::Receiving => ("Measuring", "Vermessung läuft"),
        Signal::Done => ("Done", "Fertig"),
        Signal::Attention => ("Attention", "Achtung"),
        Signal::NoExport => ("No export", "Kein Export"),
    }
}

fn next_step(signal: Signal, booth: &Situation<'_>) -> Both {
    match (signal, booth.has_button) {
        (Signal::Ready, true) if booth.next.len() > 1 => (
            "Say who is in the booth, then press the button.",
            "Sagen, wer in der Kabine ist, dann den Knopf drücken.",
        ),
        (Signal::Ready, true) if !booth.next.is_empty() => (
            "Press the button, then scan the patient who is named.",
            "Knopf drücken, dann den genannten Patienten scannen.",
        ),
        (Signal::Ready, true) => ("Press the button, then scan.", "Knopf drücken, dann scannen."),
        (Signal::Ready, false) => ("Scan the next patient.", "Den nächsten Patienten scannen."),
        (Signal::Armed, _) => ("Scan now, then export.", "Jetzt scannen, dann exportieren."),
        (Signal::Receiving, _) => {
            ("Please wait. This takes a few seconds.", "Bitte warten. Das dauert einige Sekunden.")
        }
        (Signal::Done, _) => (
            "The record is stored. The patient may get dressed.",
            "Die Messung ist gespeichert. Der Patient kann sich anziehen.",
        ),
        (Signal::Attention, _) => ("Look at the scans below.", "Bitte die Scans unten ansehen."),
        (Signal::NoExport, true) => (
            "No export came. Press the button and scan again.",
            "Es kam kein Export. Knopf drücken und noch einmal scannen.",
        ),
        (Signal::NoExport, false) => (
            "No export came. Name the patient and scan again.",
            "Es kam kein Export. Den Patienten benennen und noch einmal scannen.",
        ),
    }
}
