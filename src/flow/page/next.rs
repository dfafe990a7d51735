//! Who is next: the named patients, and the expected exports.

use serde::Serialize;

use super::light::Situation;
use super::words::{Both, say};
use super::{PatientShown, distinct};
use crate::record::Language;

/// The next patient on the page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NextShown {
    /// Who is next, in a sentence or two.
    pub sentence: String,
    /// The same sentence in pieces, words and ids in turn, so that an id is set apart from the words.
    pub pieces: Vec<String>,
    /// The patients who may be next: one if it is certain, several if it is in doubt.
    pub who: Vec<PatientShown>,
    /// There is something to call off.
    pub can_be_called_off: bool,
    /// The warning that a press may have been missed.
    pub doubt: Option<&'static str>,
    /// The same sentence without an id.
    #[serde(skip)]
    anonymous: String,
}

impl NextShown {
    /// Removes the ids.
    pub(super) fn hide_ids(&mut self) {
        self.sentence.clone_from(&self.anonymous);
        self.pieces = vec![self.anonymous.clone()];
        self.who.clear();
    }
}

/// Who is next.
pub fn shown(booth: &Situation<'_>, language: Language) -> NextShown {
    let who = next(booth);
    let Text(pieces) = told(booth, &who, language);
    let doubt = (
        "A press of the button may have been missed: scans of named patients are held.",
        "Ein Knopfdruck wurde vielleicht nicht gehört: Scans benannter Patienten werden zurückgehalten.",
    );
    NextShown {
        sentence: pieces.concat(),
        pieces,
        anonymous: anonymous(booth, &who, language),
        can_be_called_off: !who.is_empty() || booth.awaited > 0,
        who,
        doubt: booth.is_in_doubt.then(|| say(language, doubt)),
    }
}

/// The patients who may be next. Without a button there is no press to come, so they are those whose
/// export is expected.
fn next(booth: &Situation<'_>) -> Vec<PatientShown> {
    let awaited = if booth.has_button { &[] } else { booth.awaited_for };
    distinct(booth.next.iter().chain(awaited))
}

const NOBODY: Both = ("Nobody is named.", "Niemand ist benannt.");

const ONE: Both = ("The next patient is named.", "Der nächste Patient ist benannt.");

const SEVERAL: Both = (
    "More than one patient is named: who is in the booth?",
    "Mehr als ein Patient ist benannt: Wer ist in der Kabine?",
);

/// Words and ids in turn, starting and ending with words.
struct Text(Vec<String>);

impl Text {
    fn new() -> Text {
        Text(vec![String::new()])
    }

    fn words(mut self, words: &str) -> Text {
        if let Some(last) = self.0.last_mut() {
            last.push_str(words);
        }
        self
    }

    fn id(mut self, patient: &PatientShown) -> Text {
        self.0.extend([patient.shown.clone(), String::new()]);
        self
    }

    /// Ids separated by commas, with this word before the last.
    fn ids(self, patients: &[PatientShown], before_last: &str) -> Text {
        let last = patients.len().saturating_sub(1);
        patients.iter().enumerate().fold(self, |text, (at, patient)| match at {
            0 => text.id(patient),
            at if at == last => text.words(before_last).id(patient),
            _ => text.words(", ").id(patient),
        })
    }

    /// Adds a space if there is a sentence before.
    fn blank(self) -> Text {
        if self.is_empty() { self } else { self.words(" ") }
    }

    fn is_empty(&self) -> bool {
        self.0.iter().all(String::is_empty)
    }
}

/// Who is next and whose exports are expected.
fn told(booth: &Situation<'_>, who: &[PatientShown], language: Language) -> Text {
    let text = match who {
        [_, _, ..] => {
            let text = Text::new().ids(who, say(language, (" or ", " oder ")));
            text.words(say(language, (": who is in the booth?", ": Wer ist in der Kabine?")))
        }
        [next] if booth.has_button => {
            Text::new().words(say(language, ("Next: ", "Als Nächstes: "))).id(next).words(".")
        }
        _ => Text::new(),
    };
    let is_asked = !booth.has_button && who.len() > 1;
    let awaited_for = if is_asked { Vec::new() } else { distinct(booth.awaited_for) };
    let (before, and, behind) = match (awaited_for.len(), language) {
        (0, _) => ("", "", ""),
        (1, Language::En) => ("", "", "'s export is expected."),
        (1, Language::De) => ("Der Export von ", "", " wird erwartet."),
        (_, Language::En) => ("The exports of ", " and ", " are expected."),
        (_, Language::De) => ("Die Exporte von ", " und ", " werden erwartet."),
    };
    let mut text = match awaited_for.as_slice() {
        [] => text,
        awaited_for => text.blank().words(before).ids(awaited_for, and).words(behind),
    };
    if let Some(count) = counted(unnamed(booth), language) {
        text = text.blank().words(&count);
    }
    if text.is_empty() { text.words(say(language, NOBODY)) } else { text }
}

/// The same without ids.
fn anonymous(booth: &Situation<'_>, who: &[PatientShown], language: Language) -> String {
    let named = match who.len() {
        0 => None,
        1 => Some(ONE),
        _ => Some(SEVERAL),
    };
    // Without a button, the expected export is that of the named patient.
    let awaited = if booth.has_button { booth.awaited } else { unnamed(booth) };
    let awaited = counted(awaited, language);
    let named = named.map(|both| say(language, both).to_owned());
    let sentences: Vec<String> = named.into_iter().chain(awaited).collect();
    if sentences.is_empty() { say(language, NOBODY).to_owned() } else { sentences.join(" ") }
}

/// How many exports are expected without a known patient.
fn unnamed(booth: &Situation<'_>) -> usize {
    booth.awaited.saturating_sub(booth.awaited_for.len())
}

/// A sentence on how many exports are expected.
fn counted(count: usize, language: Language) -> Option<String> {
    match (count, language) {
        (0, _) => None,
        (1, Language::En) => Some("One export is expected.".to_owned()),
        (1, Language::De) => Some("Ein Export wird erwartet.".to_owned()),
        (count, Language::En) => Some(format!("{count} exports are expected.")),
        (count, Language::De) => Some(format!("{count} Exporte werden erwartet.")),
    }
}
