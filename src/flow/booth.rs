//! What is said between the booth and the station: what its ports hear, and what its light shows.

use super::capture::Doubt;
use crate::record::SourceKind;

/// What a port has heard.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Heard {
    /// The button was pressed and is up again, or has been down for as long as a long press takes.
    Press(Press),
    /// Somebody named the patient of the next scan: a card or barcode was read, an order came in, or
    /// a person said so. The id is as it was read; whether it may be one is for the station to judge.
    Named {
        /// The id.
        id: String,
        /// Who named it.
        by: SourceKind,
    },
    /// An order names its patient, and whether that one is next is a question: it has the words of one
    /// that was heard before and a newer time, or it could not be kept when it came.
    Doubtful {
        /// The id.
        id: String,
        /// Why it is a question.
        doubt: Doubt,
    },
    /// Somebody tried to name the patient of the next scan, and it could not be understood: an order
    /// was refused, a card misread, a line cut off, a check digit wrong.
    Unread {
        /// Who tried.
        by: SourceKind,
    },
}

/// How long the button was held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Press {
    /// A scan is about to begin.
    Short,
    /// It is called off: the presses that still wait for their export, and the patient's name.
    Long,
}

/// What the light at the booth shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Signal {
    /// The next press will be heard.
    Ready,
    /// A press was heard; its export is awaited.
    Armed,
    /// Its export is coming in, or is being measured.
    Receiving,
    /// Its record lies in every store.
    Done,
    /// A person must look: a scan is held or refused, or the station is not ready.
    Attention,
    /// No export came after a press.
    NoExport,
}

impl Signal {
    /// All of them, in the order in which they are documented.
    pub const ALL: [Signal; 6] = [
        Signal::Ready,
        Signal::Armed,
        Signal::Receiving,
        Signal::Done,
        Signal::Attention,
        Signal::NoExport,
    ];

    /// Its stable word, in the configuration and in `status --json`.
    pub const fn word(self) -> &'static str {
        match self {
            Signal::Ready => "ready",
            Signal::Armed => "armed",
            Signal::Receiving => "receiving",
            Signal::Done => "done",
            Signal::Attention => "attention",
            Signal::NoExport => "no_export",
        }
    }
}
