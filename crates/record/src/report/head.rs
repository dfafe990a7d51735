//! What stands on every page of a report.

use gaiter_language::Language;

use super::content::Content;

/// What stands on every page of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Head {
    /// The language of the texts.
    pub language: Language,
    /// The kind of document.
    pub title: String,
    /// The patient's id with nothing hidden in it, or that there is none.
    pub patient: String,
    /// When it was taken, in one line.
    pub taken: String,
}

impl Head {
    /// The head of a record's report.
    pub fn of(content: &Content) -> Head {
        Head {
            language: content.language,
            title: content.title.clone(),
            patient: content.patient.clone(),
            taken: content.taken.clone(),
        }
    }
}
