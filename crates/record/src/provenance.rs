//! Where a record comes from: station, patient, time, scan. The station knows this, the leg does not.

use jiff::civil::Date;
use jiff::tz::{Offset, TimeZone};
use jiff::{Timestamp, Zoned};
use serde::{Deserialize, Serialize};

use super::phantom::LastCheck;
use super::schema::Amendment;

/// The revision of a scan that is measured for the first time. Later results count on from here.
pub const FIRST_REVISION: u32 = 1;

/// What the station knows about a scan before measuring it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The station's id; `None` for a bare `extract`.
    pub station: Option<String>,
    /// The patient; `None` while unknown.
    pub patient: Option<Patient>,
    /// When the scan was taken, as precisely as known.
    pub acquired: Option<Acquired>,
    /// SHA-256 of the scan's bytes, lower-case hexadecimal.
    pub sha256: String,
    /// The last check with a phantom before the scan; `None` if there was none.
    pub phantom_check: Option<LastCheck>,
    /// [`FIRST_REVISION`], or more if the scan is measured again.
    pub revision: u32,
    /// Measures that people set, oldest first; empty for a scan that is measured for the first time.
    pub amendments: Vec<Amendment>,
}

impl Provenance {
    /// The provenance of a scan of which only the bytes are known.
    pub fn of_scan(sha256: String) -> Provenance {
        Provenance {
            station: None,
            patient: None,
            acquired: None,
            sha256,
            phantom_check: None,
            revision: FIRST_REVISION,
            amendments: Vec::new(),
        }
    }
}

/// A patient's id and the sources that named it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Patient {
    /// The id, matching the configured pattern.
    pub id: String,
    /// Every source that named this id.
    pub sources: Vec<Source>,
}

impl Patient {
    /// The request of a hospital system that the scan answers, if one was chosen.
    pub fn request(&self) -> Option<&ImagingRequest> {
        self.sources.iter().find_map(|source| source.request.as_ref())
    }
}

/// One source of a patient id.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Source {
    /// The kind of source.
    pub kind: SourceKind,
    /// How reliable it is; missing for a record that was found in its store.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<Confidence>,
    /// The request of a hospital system's worklist that the scan answers; missing if none is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub request: Option<ImagingRequest>,
}

/// The request of a hospital system that an examination answers, as DICOM names it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ImagingRequest {
    /// The study to which its results belong: Study Instance UID (0020,000D).
    pub study_instance_uid: String,
    /// Its number in the hospital system: Accession Number (0008,0050); missing if it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub accession_number: Option<String>,
}

impl ImagingRequest {
    /// The longest UID, characters (PS3.5, 9.1).
    const UID_MOST: usize = 64;

    /// The longest accession number, characters: DICOM allows 16 (VR SH), and some systems send more.
    const ACCESSION_MOST: usize = 64;

    /// The request of these texts, without the spaces around them; `None` if they are no UID and no number that
    /// DICOM knows.
    pub fn new(study_instance_uid: &str, accession_number: &str) -> Option<ImagingRequest> {
        let (uid, number) = (study_instance_uid.trim(), accession_number.trim());
        let is_part =
            |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
        let is_uid = uid.len() <= ImagingRequest::UID_MOST && uid.split('.').all(is_part);
        let is_number = number.chars().count() <= ImagingRequest::ACCESSION_MOST
            && !number.chars().any(|sign| sign.is_control() || sign == '\\');
        (is_uid && is_number).then(|| ImagingRequest {
            study_instance_uid: uid.to_owned(),
            accession_number: (!number.is_empty()).then(|| number.to_owned()),
        })
    }
}

/// How reliable a source of a patient's id is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Confidence {
    /// A device read or sent it, or it was chosen from a worklist, and it was bound to the press of this scan.
    High,
    /// A person typed it, at the station or at the scanner.
    Medium,
    /// An expression found it next to the scan.
    Low,
}

impl Source {
    /// A source of this kind, with the confidence of the kind.
    pub fn from_kind(kind: SourceKind) -> Source {
        let confidence = match kind {
            SourceKind::Reader | SourceKind::Order => Some(Confidence::High),
            SourceKind::Operator | SourceKind::FileName => Some(Confidence::Medium),
            SourceKind::Sidecar => Some(Confidence::Low),
            SourceKind::Record => None,
        };
        Source { kind, confidence, request: None }
    }

    /// The same source, with the request that was found by it. That says nothing of how reliable the id is: one that
    /// was mistyped may have a request, too.
    pub fn with_request(self, request: Option<ImagingRequest>) -> Source {
        Source { request, ..self }
    }

    /// The same source, by which the patient was chosen from a worklist: no person typed the id.
    pub fn chosen(self) -> Source {
        Source { confidence: Some(Confidence::High), ..self }
    }
}

gaiter_leg::word_enum! {
    /// The kinds of sources of a patient id.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[cfg_attr(test, derive(schemars::JsonSchema))]
    pub enum SourceKind as serde {
        /// The scan's file name, matched by the configured expression.
        FileName => "file_name",
        /// The scanner's own measures (`.ord`) next to the scan.
        Sidecar => "sidecar",
        /// A person at the station.
        Operator => "operator",
        /// A card or barcode read at the booth.
        Reader => "reader",
        /// An order of the practice software (GDT 6302).
        Order => "order",
        /// The record itself, found in its store by a station that had lost its journal.
        Record => "record",
    }
}

/// A time of acquisition and its source.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct Acquired {
    /// UTC.
    pub at: Timestamp,
    /// The source of the time.
    pub from: AcquiredFrom,
    /// How far the clock at the scanner was ahead of UTC then, minutes; absent if it is not known. People
    /// are shown the local time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub utc_offset_min: Option<i16>,
}

impl Acquired {
    /// A time of acquisition in UTC.
    pub fn new(at: Timestamp, from: AcquiredFrom) -> Acquired {
        Acquired { at, from, utc_offset_min: None }
    }

    /// How far the clock at the scanner was ahead of UTC; `None` if that is not known.
    pub(crate) fn offset(&self) -> Option<Offset> {
        Offset::from_seconds(60 * i32::from(self.utc_offset_min?)).ok()
    }

    /// The time on the clock of the scanner; UTC if its zone is not known.
    pub fn local(&self) -> Zoned {
        self.at.to_zoned(self.offset().map_or(TimeZone::UTC, TimeZone::fixed))
    }

    /// How many days before `today` it was, on the calendar of the scanner; negative if it is to come.
    pub fn age_days(&self, today: Date) -> i64 {
        self.local().date().until(today).map_or(0, |span| i64::from(span.get_days()))
    }
}

gaiter_leg::word_enum! {
    /// The source of a time of acquisition.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[cfg_attr(test, derive(schemars::JsonSchema))]
    pub enum AcquiredFrom as serde {
        /// The press of the button.
        Press => "press",
        /// The export's modification time.
        FileTime => "file_time",
        /// No reliable source.
        Unknown => "unknown",
    }
}
