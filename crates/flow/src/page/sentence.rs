//! Sentences that name patients, and the same for readers who may not know them.

use gaiter_language::{Piece, pieces};
use serde::Serialize;

use super::PatientShown;

/// A sentence or two that may name patients.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Sentence {
    /// The whole.
    #[serde(rename = "sentence")]
    pub text: String,
    /// The same in pieces, words and ids in turn, so that an id is set apart from the words.
    pub pieces: Vec<String>,
    /// The same without ids.
    #[serde(skip)]
    anonymous: String,
}

impl Sentence {
    /// A text, and the same without ids.
    pub(super) fn new(Text(pieces): Text, anonymous: String) -> Sentence {
        Sentence { text: pieces.concat(), pieces, anonymous }
    }

    /// Removes the ids.
    pub(super) fn hide_ids(&mut self) {
        self.text.clone_from(&self.anonymous);
        self.pieces = vec![self.anonymous.clone()];
    }
}

/// Words and ids in turn, starting and ending with words.
pub(super) struct Text(Vec<String>);

impl Text {
    /// Nothing yet.
    pub(super) fn new() -> Text {
        Text(vec![String::new()])
    }

    /// Followed by these words.
    pub(super) fn words(mut self, words: &str) -> Text {
        if let Some(last) = self.0.last_mut() {
            last.push_str(words);
        }
        self
    }

    /// Followed by this text.
    pub(super) fn text(self, Text(more): Text) -> Text {
        let mut more = more.into_iter();
        let mut text = self.words(&more.next().unwrap_or_default());
        text.0.extend(more);
        text
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

    /// A sentence with the ids in its place, after a space if there is a sentence before.
    pub(super) fn sentence(
        self,
        words: &str,
        patients: &[PatientShown],
        before_last: &str,
    ) -> Text {
        let text = if self.is_empty() { self } else { self.words(" ") };
        pieces(words).fold(text, |text, piece| match piece {
            Piece::Words(words) => text.words(words),
            Piece::Place { .. } => text.ids(patients, before_last),
        })
    }

    /// Whether it has no text.
    pub(super) fn is_empty(&self) -> bool {
        self.0.iter().all(String::is_empty)
    }
}
