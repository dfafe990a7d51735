//! One line of what `gaiter check` has to say.

use std::fmt::Display;
use std::io;
use std::path::Path;

use serde::Serialize;

/// How a check went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Verdict {
    /// As it should be.
    Ok,
    /// The station works, but a person should look at this.
    Warn,
    /// The station cannot work like this.
    Fail,
}

impl Verdict {
    /// The word in the table, as in the JSON.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Ok => "ok",
            Verdict::Warn => "warn",
            Verdict::Fail => "fail",
        }
    }
}

/// One check and how it went.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Row {
    /// What was checked.
    pub check: &'static str,
    /// The folder or file it was checked on.
    pub place: String,
    /// How it went.
    pub verdict: Verdict,
    /// What was found.
    pub detail: String,
    /// Names of files and the patients that they name, for the person who checks.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub examples: Vec<Example>,
}

/// A file's name and the patient that it names.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Example {
    /// The file's name.
    pub name: String,
    /// The patient's id.
    pub patient: String,
}

impl Row {
    /// A check that went well.
    pub fn ok(check: &'static str, place: &Path, detail: impl Into<String>) -> Row {
        Row::new(check, place, Verdict::Ok, detail)
    }

    /// A check on a folder or file, and how it went.
    pub fn new(
        check: &'static str,
        place: &Path,
        verdict: Verdict,
        detail: impl Into<String>,
    ) -> Row {
        Row::at(check, place.display(), verdict, detail)
    }

    /// A check on what has no path, a key say, and how it went.
    pub fn at(
        check: &'static str,
        place: impl Display,
        verdict: Verdict,
        detail: impl Into<String>,
    ) -> Row {
        let (place, detail) = (place.to_string(), detail.into());
        Row { check, place, verdict, detail, examples: Vec::new() }
    }

    pub fn of(check: &'static str, place: &Path, tried: io::Result<String>) -> Row {
        match tried {
            Ok(detail) => Row::ok(check, place, detail),
            Err(error) => Row::new(check, place, Verdict::Fail, error.to_string()),
        }
    }
}
