//! Where a record comes from: station, patient, time, scan. Known to the station, not to the leg.

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

/// A scan measured for the first time; later results for it count on from here.
pub const FIRST_REVISION: u32 = 1;

/// What the station knows about a scan before it is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The station's id; none for a bare `extract`.
    pub station: Option<String>,
    /// Whose legs these are; none while nobody said so.
    pub patient: Option<Patient>,
    /// When the scan was taken, as well as it is known.
    pub acquired: Option<Acquired>,
    /// SHA-256 of the scan's bytes, lower-case hexadecimal.
    pub sha256: String,
    /// [`FIRST_REVISION`], or more where the scan is measured again.
    pub revision: u32,
}

impl Provenance {
    /// Of a scan of which nothing is known but its bytes.
    pub fn of_scan(sha256: String) -> Provenance {
        let revision = FIRST_REVISION;
        Provenance { station: None, patient: None, acquired: None, sha256, revision }
    }
}

/// A patient's id and who named it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Patient {
    /// The id, matching the configured pattern.
    pub id: String,
    /// Every source that named this id.
    pub sources: Vec<Source>,
}

/// One source of a patient id.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Source {
    /// What kind of source.
    pub kind: SourceKind,
    /// How far it is to be relied upon; older records do not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<Confidence>,
}

/// How far a source of a patient's id is to be relied upon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Confidence {
    /// A machine read or sent it, and it was bound to the press of this scan.
    High,
    /// A person typed it, here or at the scanner.
    Medium,
    /// It was found beside the scan, by an expression.
    Low,
}

impl Source {
    /// A source of this kind, with the confidence that the kind has.
    pub fn of(kind: SourceKind) -> Source {
        let confidence = match kind {
            SourceKind::Reader | SourceKind::Order => Some(Confidence::High),
            SourceKind::Operator | SourceKind::FileName => Some(Confidence::Medium),
            SourceKind::Sidecar => Some(Confidence::Low),
            SourceKind::Record => None,
        };
        Source { kind, confidence }
    }
}

/// The kinds of sources of a patient id.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SourceKind {
    /// The scan's file name, by the configured expression.
    FileName,
    /// The scanner's own measures (`.ord`) beside the scan.
    Sidecar,
    /// A person at the station.
    Operator,
    /// A card or barcode that was read at the booth.
    Reader,
    /// An order of the practice software (GDT 6302).
    Order,
    /// The record itself, found in its store by a station that had lost its journal.
    Record,
}

/// A time of acquisition and where it is from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Acquired {
    /// UTC.
    pub at: Timestamp,
    /// What the time was taken from.
    pub from: AcquiredFrom,
}

/// What a time of acquisition was taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AcquiredFrom {
    /// The button.
    Press,
    /// The export's modification time.
    FileTime,
    /// Nothing reliable.
    Unknown,
}
