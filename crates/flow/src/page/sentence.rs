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
    /// The same in pieces, words and ids in turn, starting and ending with words, so that an id is set apart from
    /// the words.
    pub pieces: Vec<String>,
    /// The same without ids.
    #[serde(skip)]
    pub(super) anonymous: String,
}

impl Sentence {
    /// One that names nobody.
    pub(super) fn new(words: &str) -> Sentence {
        let [text, piece, anonymous] = [words; 3].map(str::to_owned);
        Sentence { text, pieces: vec![piece], anonymous }
    }

    /// One with the ids of these patients, at least one, in its place, separated by commas, with this word before the
    /// last: with nobody in it, words and ids would not take turns. What it is without ids is not known here.
    pub(super) fn naming(words: &str, patients: &[PatientShown], before_last: &str) -> Sentence {
        let last = patients.len().saturating_sub(1);
        let ids = patients.iter().map(|patient| patient.shown.as_str()).enumerate();
        let ids = ids.flat_map(|(at, id)| match at {
            0 => vec![id],
            at if at == last => vec![before_last, id],
            _ => vec![", ", id],
        });
        let parts = pieces(words).flat_map(|piece| match piece {
            Piece::Words(words) => vec![words],
            Piece::Place { .. } => ids.clone().collect(),
        });
        let mut pieces: Vec<String> = parts.map(str::to_owned).collect();
        if pieces.len().is_multiple_of(2) {
            pieces.push(String::new());
        }
        Sentence { text: pieces.concat(), pieces, anonymous: String::new() }
    }

    /// Followed by another.
    pub(super) fn then(mut self, more: Sentence) -> Sentence {
        let mut pieces = more.pieces.into_iter();
        if let (Some(last), Some(first)) = (self.pieces.last_mut(), pieces.next()) {
            *last = format!("{last} {first}");
        }
        self.pieces.extend(pieces);
        self.text = format!("{} {}", self.text, more.text);
        self.anonymous = format!("{} {}", self.anonymous, more.anonymous);
        self
    }

    /// Followed by more that name nobody.
    pub(super) fn and<'a>(self, more: impl IntoIterator<Item = &'a str>) -> Sentence {
        more.into_iter().map(Sentence::new).fold(self, Sentence::then)
    }

    /// Removes the ids.
    pub(super) fn hide_ids(&mut self) {
        self.text.clone_from(&self.anonymous);
        self.pieces = vec![self.anonymous.clone()];
    }
}
