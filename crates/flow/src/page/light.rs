//! The one light: its word, and one sentence on what to do next.

use gaiter_language::Language;
use serde::Serialize;

use super::distinct;
use super::reasons::{Advice, of_held, of_refused};
use super::sentence::{Sentence, Text};
use crate::booth::Signal;
use crate::light::{Outcome, Progress};

/// The light on the page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LightShown {
    /// The signal's stable word; it decides colour and sign.
    pub signal: &'static str,
    /// The word that is read from a distance.
    pub word: &'static str,
    /// What to do next.
    #[serde(flatten)]
    pub said: Sentence,
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
    /// How many minutes longer presses are in doubt for that; `None` while the button is not heard.
    pub doubt_left_min: Option<u64>,
    /// How far the export or scan is for which the light says "measuring".
    pub progress: Option<Progress>,
    /// How the last scan since the last press ended; `None` if none has ended since.
    pub last: Option<&'a Outcome>,
    /// The ids of the patients to whom that scan belongs, or may belong if it is held.
    pub last_of: &'a [String],
}

/// The light; `first` is the most serious fault, if there is one.
pub(super) fn shown(
    booth: &Situation<'_>,
    first: Option<&Advice>,
    is_any_undecided: bool,
    language: Language,
) -> LightShown {
    let decide = is_any_undecided.then(|| language.text("page.decide"));
    let step = || Words::new(language.text(next_step(booth)));
    let said = match (booth.signal, first) {
        (Signal::Attention, Some(advice)) => Words::new(&advice.in_a_row()),
        // The patient waits, a decision can wait.
        (Signal::Attention, None) => match of_last(booth, language) {
            Some(words) => words,
            None => decide.map_or_else(step, Words::new),
        },
        // Another scan may have ended since the light was lit.
        (Signal::Done, _) if booth.last == Some(&Outcome::Delivered) => {
            Words::of_last(booth, DONE, language).and(decide)
        }
        (Signal::Ready | Signal::Done, _) => step().and(decide),
        _ => step(),
    };
    let signal = booth.signal.word();
    let word = match (booth.signal, booth.progress) {
        (Signal::Receiving, Some(Progress::ComingIn)) => "coming_in",
        (Signal::Receiving, Some(Progress::Stopped)) => "stopped",
        _ => signal,
    };
    let said = Sentence::new(said.text, said.anonymous);
    LightShown { signal, word: language.word("page.light", word), said }
}

/// Keys of a sentence on the last scan: without ids, and with them.
type Keys = [&'static str; 2];

const DONE: Keys = ["page.step.done", "page.step.done_of"];
const HELD: Keys = ["page.step.held", "page.step.held_of"];
const REFUSED: Keys = ["page.step.refused", "page.step.refused_of"];
const KNOWN: Keys = ["page.step.known", "page.step.known_of"];

/// Sentences that may name patients, and the same without ids.
struct Words {
    text: Text,
    anonymous: String,
}

impl Words {
    fn new(words: &str) -> Words {
        Words { text: Text::new().words(words), anonymous: words.to_owned() }
    }

    /// A sentence on the last scan.
    fn of_last(booth: &Situation<'_>, [without, with]: Keys, language: Language) -> Words {
        let patients = distinct(booth.last_of);
        let words = Words::new(language.text(without));
        if patients.is_empty() {
            return words;
        }
        let is_held = matches!(booth.last, Some(Outcome::Held { .. }));
        let before_last = language.text(if is_held { "page.next.or" } else { "page.next.and" });
        Words { text: Text::new().sentence(language.text(with), &patients, before_last), ..words }
    }

    /// Followed by more sentences that name nobody.
    fn and<'a>(self, more: impl IntoIterator<Item = &'a str>) -> Words {
        more.into_iter().fold(self, |Words { text, anonymous }, more| Words {
            text: text.words(" ").words(more),
            anonymous: format!("{anonymous} {more}"),
        })
    }
}

/// What the last scan needs from a person at the booth; `None` if nothing.
fn of_last(booth: &Situation<'_>, language: Language) -> Option<Words> {
    let text = |key| language.text(key);
    let of = |keys| Words::of_last(booth, keys, language);
    Some(match booth.last? {
        Outcome::Delivered => return None,
        Outcome::Incomplete { to_do } if to_do.is_empty() => Words::new(text("page.step.lacks")),
        Outcome::Incomplete { to_do } => {
            let anonymous = to_do.join(" ");
            let named = Words::of_last(booth, ["page.step.lacks", "page.step.lacks_of"], language);
            match booth.last_of {
                [] => Words::new(&anonymous),
                _ => Words { anonymous, ..named.and(to_do.iter().map(String::as_str)) },
            }
        }
        Outcome::Held { code } => {
            let why = of_held(code, language).what;
            of(HELD).and([why.as_str(), text("page.step.decide_held")])
        }
        Outcome::Refused { code } => {
            of(REFUSED).and([of_refused(code, language).in_a_row().as_str()])
        }
        Outcome::NameUnread => Words::new(text("page.step.name_unread")),
        Outcome::Known => of(KNOWN).and([text("page.step.export_new")]),
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
        (Signal::Receiving, _) => match booth.progress {
            Some(Progress::ComingIn) => "page.step.coming_in",
            Some(Progress::Stopped) => "page.step.stopped",
            Some(Progress::Measuring) | None => "page.step.receiving",
        },
        (Signal::Done, _) => "page.step.done",
        (Signal::Attention, _) => "page.step.attention",
        (Signal::Paused, _) => "page.step.paused",
        (Signal::NoExport, true) => "page.step.no_export",
        (Signal::NoExport, false) => "page.step.no_export_without_button",
    }
}
