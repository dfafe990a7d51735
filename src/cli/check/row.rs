//! One row of the output of `gaiter check`.

use std::fmt::Display;
use std::io;
use std::path::Path;

use serde::Serialize;

gaiter_leg::word_enum! {
    /// The result of a check.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
    pub(super) enum Verdict as serde {
        /// Everything is fine.
        Ok => "ok",
        /// The station works, but the operator should look at this.
        Warn => "warn",
        /// The station cannot work this way.
        Fail => "fail",
    }
}

/// One check with its result.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Row {
    pub check: &'static str,
    /// The folder or file it was checked on.
    pub place: String,
    pub verdict: Verdict,
    /// What was found.
    pub detail: String,
    /// File names and the patients they name, for the person who runs the check.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub examples: Vec<Example>,
}

/// A file name and the patient it names.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Example {
    /// The file's name.
    pub name: String,
    /// The patient's id.
    pub patient: String,
}

impl Row {
    /// A check that passed.
    pub fn ok(check: &'static str, place: &Path, detail: impl Into<String>) -> Row {
        Row::at(check, place.display(), Verdict::Ok, detail)
    }

    /// A check of a path, a configuration key or the like, with its result.
    pub fn at(
        check: &'static str,
        place: impl Display,
        verdict: Verdict,
        detail: impl Into<String>,
    ) -> Row {
        let (place, detail) = (place.to_string(), detail.into());
        Row { check, place, verdict, detail, examples: Vec::new() }
    }

    pub fn from_attempt(check: &'static str, place: &Path, tried: io::Result<String>) -> Row {
        match tried {
            Ok(detail) => Row::ok(check, place, detail),
            Err(error) => Row::at(check, place.display(), Verdict::Fail, error.to_string()),
        }
    }
}
