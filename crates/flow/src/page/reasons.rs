//! Codes → the situation and what to do, each in one sentence. docs/codes.md and docs/patients.md have the same in
//! more detail; an unknown code is shown as it is.

use gaiter_language::Language;
use serde::Serialize;

use crate::complaint::Complaint;

/// The codes of a port begin so.
pub(super) const OF_PORT: &str = "trigger-";

/// The port of a card reader; the others are buttons.
const READER: &str = "reader";

/// The situation, and what the operator can do.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Advice {
    /// A sentence on the situation.
    pub what: String,
    /// A sentence on what to do.
    pub next: String,
}

impl Advice {
    fn new(what: impl Into<String>, next: impl Into<String>) -> Advice {
        Advice { what: what.into(), next: next.into() }
    }

    /// Both sentences.
    pub(super) fn in_a_row(&self) -> String {
        format!("{} {}", self.what, self.next)
    }

    /// This situation first, then the other; what to do is that of this one.
    pub(super) fn before(self, other: &Advice) -> Advice {
        Advice { what: format!("{} {}", self.what, other.what), ..self }
    }

    /// A further sentence on the situation.
    pub(super) fn and(self, more: &str) -> Advice {
        Advice { what: format!("{} {more}", self.what), ..self }
    }

    /// The advice for a code in a table of texts; `None` for an unknown code.
    fn find(table: &str, code: &str, language: Language) -> Option<Advice> {
        let what = language.find(&format!("{table}.{code}.what"))?;
        Some(Advice::new(what, language.find(&format!("{table}.{code}.next"))?))
    }
}

/// Why a scan is held.
pub fn of_held(code: &str, language: Language) -> Advice {
    Advice::find("page.held", code, language).unwrap_or_else(|| {
        Advice::new(language.text("page.held.other.what"), language.text("page.held.other.next"))
    })
}

/// Why a scan was refused.
pub fn of_refused(code: &str, language: Language) -> Advice {
    Advice::find("page.refused", code, language)
        .unwrap_or_else(|| verbatim(code, "page.do.retry", language))
}

/// The button is not there; its complaint follows a minute later.
pub(super) fn of_button_away(language: Language) -> String {
    let advice = Advice::find("page.complaint", "trigger-absent", language);
    advice.map(|advice| advice.in_a_row()).unwrap_or_default()
}

/// What keeps the station from being ready.
pub fn of_complaint(complaint: &Complaint, language: Language) -> Advice {
    let (code, own) = (complaint.code.as_str(), complaint.own_code());
    let is_reader = complaint.subject.as_deref() == Some(READER);
    let of_reader = is_reader.then_some("trigger-any-reader");
    let any = code.starts_with(OF_PORT).then_some("trigger-any");
    let codes = [own.as_deref(), of_reader, Some(code), any];
    let found =
        codes.into_iter().flatten().find_map(|of| Advice::find("page.complaint", of, language));
    found.unwrap_or_else(|| verbatim(code, "page.do.technician", language))
}

/// Why a decision was not carried out; `None` for an unknown code.
pub fn of_fault(code: &str, language: Language) -> Option<&'static str> {
    language.find(&format!("page.fault.{code}"))
}

fn verbatim(code: &str, next: &'static str, language: Language) -> Advice {
    Advice::new(language.filled("page.says", &[("code", &code)]), language.text(next))
}
