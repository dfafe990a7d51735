//! What stands on every page of a report.

use gaiter_language::Language;

/// What stands on every page of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Head {
    /// The language of the texts.
    pub language: Language,
    /// The kind of document; whether its figures can be trusted, if not.
    pub title: String,
    /// Whether something vouches for the figures.
    pub is_vouched: bool,
    /// The patient's id with nothing hidden in it, or that there is none.
    pub patient: String,
    /// When and where it was taken, in one line.
    pub taken: String,
}
