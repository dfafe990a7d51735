//! What came of an export, of a name, of a press, of the passing of time, and of giving up.

use serde::{Deserialize, Serialize};

use super::{Capture, Named};

/// Why an export that may be a capture's is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Why {
    /// It could belong to captures of different patients.
    Ambiguous,
    /// It may have been written before the press.
    Unclear,
    /// It came after the window of the press it must belong to.
    Late,
    /// Nobody listened for a while, and a press that was not heard may have made this export.
    Unheard,
    /// Somebody tried to name a patient before it, and it could not be read.
    Unread,
    /// The order that names its patient is one that was heard before, with a newer time.
    Repeated,
}

impl Why {
    /// All of them.
    pub const ALL: [Why; 6] =
        [Why::Ambiguous, Why::Unclear, Why::Late, Why::Unheard, Why::Unread, Why::Repeated];

    /// The finding's code.
    pub const fn code(self) -> &'static str {
        match self {
            Why::Ambiguous => "capture-ambiguous",
            Why::Unclear => "capture-unclear",
            Why::Late => "export-late",
            Why::Unheard => "press-unheard",
            Why::Unread => "name-unread",
            Why::Repeated => "order-repeated",
        }
    }
}

/// Which capture an export belongs to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Judged {
    /// To none: nothing was pressed.
    Unpressed,
    /// To this one.
    Of(Capture),
    /// A person must say.
    Held {
        /// Why.
        why: Why,
        /// The one patient whom every capture in question names, if there is one.
        patient: Option<Named>,
        /// Everybody whom a capture in question names.
        candidates: Vec<Named>,
        /// The capture that is answered by it, if any.
        answered: Option<i64>,
        /// Captures whose exports are in doubt from now on.
        doubtful: Vec<i64>,
    },
}

impl Judged {
    /// The same for an export that begins with a scan that came in before and was one of these patients',
    /// or nobody's: it is that scan, whole, and no other patient's.
    pub fn completing(self, whose: &[Named]) -> Judged {
        let (why, mut candidates) = match self {
            Judged::Of(capture) if capture.is_of_all(whose) => return Judged::Of(capture),
            Judged::Of(capture) => (Why::Ambiguous, capture.named().cloned().collect::<Vec<_>>()),
            // Its own name says whose it is, or nobody does.
            Judged::Unpressed => return Judged::Unpressed,
            Judged::Held { why, candidates, .. } => (why, candidates),
        };
        for named in whose {
            if candidates.iter().all(|known| known.id != named.id) {
                candidates.push(named.clone());
            }
        }
        // The captures go on waiting for exports of their own.
        Judged::Held { why, patient: None, candidates, answered: None, doubtful: Vec::new() }
    }
}

/// What came of naming the next patient.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NamedNext {
    /// The name waits for the next press; whether it replaced another.
    Waits {
        /// Another id was waiting, and is not any more.
        replaced: bool,
        /// It is not certain whose the next press is.
        in_doubt: bool,
    },
    /// The press that is open is this patient's.
    Paired(Capture),
    /// A capture was opened for it; these others, of patients who were named before, were given up.
    Opened(Capture, Vec<i64>),
    /// The capture that is open is this patient's already; its window was prolonged.
    Prolonged(Capture),
}

/// What the passing of time did.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Passed {
    /// Captures whose windows are over without an export.
    pub expired: Vec<i64>,
    /// A patient's name was not used in time.
    pub name_expired: bool,
    /// Captures whose exports nobody waits for any more.
    pub over: Vec<i64>,
}

/// What was given up.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct CalledOff {
    /// Captures whose export is not awaited any more.
    pub captures: Vec<i64>,
    /// A name was waiting.
    pub name: bool,
}
