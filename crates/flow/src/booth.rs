//! Messages between the booth and the station: what the ports receive, and what the light shows.

use std::time::Duration;

use gaiter_record::SourceKind;

use super::round::Doubt;

/// What a port has received.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PortEvent {
    /// The button was pressed and released, or was held for the time of a long press.
    Press(Press),
    /// The patient of the next scan was named: a card or barcode was read, or the operator entered the id.
    /// The id is as it was read; the station decides whether it is valid.
    Named { id: String, by: SourceKind },
    /// The file of an order names the patient of the next scan.
    Ordered {
        /// The id, as it was read.
        id: String,
        /// Why it is in doubt whether that patient is next: the order repeats the words of an earlier one
        /// with a newer time, or it could not be kept when it arrived.
        doubt: Option<Doubt>,
        /// The file was not there at this time of the station's clock, and may have been soon after it;
        /// `None` if there was no look before.
        absent: Option<Duration>,
    },
    /// An attempt to name the patient of the next scan could not be understood: a card was misread, a line
    /// cut off, a check digit wrong.
    Unread,
    /// An order cannot be read, or was refused.
    UnreadOrder {
        /// The file was not there at this time; `None` if there was no look before.
        absent: Option<Duration>,
    },
}

/// How long the button was held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Press {
    /// A scan is about to begin.
    Short,
    /// The scan is called off: the presses that still wait for their export, and the patient's name.
    Long,
}

gaiter_record::word_enum! {
    /// What the light at the booth shows.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Signal {
        /// The next press will be registered.
        Ready => "ready",
        /// A press was registered; the station waits for its export.
        Armed => "armed",
        /// Its export is arriving, or is being measured.
        Receiving => "receiving",
        /// Its record is in every store.
        Done => "done",
        /// Operator action is needed: a scan is held or refused, or the station is not ready.
        Attention => "attention",
        /// No export arrived after a press.
        NoExport => "no_export",
        /// The operator has paused the station: exports stay where they are.
        Paused => "paused",
    }
}
