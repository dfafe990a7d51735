//! What came of an export, of a name, of the passing of time, and of calling off.

use super::{Capture, Named};

/// Which capture an export belongs to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Judged {
    /// To none: nothing was pressed.
    Unpressed,
    /// To this one.
    Of(Capture),
    /// A person must say.
    Held {
        /// Why.
        code: &'static str,
        /// The one patient whom every capture in question names, if there is one.
        patient: Option<Named>,
        /// The capture that is answered by it, if any.
        answered: Option<i64>,
        /// Captures whose exports are in doubt from now on.
        doubtful: Vec<i64>,
    },
}

/// What came of naming the next patient.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NamedNext {
    /// The name waits for the next press; whether it replaced another.
    Waits {
        /// Another id was waiting.
        replaced: bool,
    },
    /// A capture was opened for it.
    Opened(Capture),
    /// The capture that is open is this patient's already; its window was prolonged.
    Prolonged(Capture),
}

/// What the passing of time did.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Passed {
    /// Captures whose windows are over without an export.
    pub expired: Vec<i64>,
    /// The patient's name was not used in time.
    pub name_expired: bool,
    /// Captures whose exports nobody waits for any more.
    pub over: Vec<i64>,
}

/// What was called off.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct CalledOff {
    /// Captures whose export is not awaited any more.
    pub captures: Vec<i64>,
    /// A name was waiting.
    pub name: bool,
}
