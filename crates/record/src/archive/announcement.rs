//! What a station says of a scan that it has put into the archive, or has taken back.

use gaiter_leg::WholeBody;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::Document;
use super::key::ObjectKey;
use super::words::{MethodId, Pseudonym, RecordHash, StationId};
use crate::scan_id::ScanId;

/// That a scan and its record are in the archive. It is written after them.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Announcement {
    /// [`Document::SCHEMA`].
    pub schema: String,
    /// The station.
    pub station: StationId,
    /// SHA-256 of the crop's PLY, before it is packed.
    pub scan: ScanId,
    /// SHA-256 of the scanner's export, which stays at the station.
    pub export: ScanId,
    /// Length of the crop's PLY, before it is packed.
    pub bytes: u64,
    /// The record.
    pub record: RecordHash,
    /// Its revision.
    pub revision: u32,
    /// When the station says so: later than whatever it said before. The same may be announced again if an answer was
    /// lost.
    pub at: Timestamp,
    /// With this the station has measured the crop, and found what it has measured on the whole body.
    pub method: MethodId,
    /// When the station first saw the export.
    pub first_seen: Timestamp,
    /// What the rest of the body has shown, with which the crop is measured.
    pub whole: WholeBody,
    /// The patient; `None` while unknown.
    pub patient: Option<Pseudonym>,
}

impl Document for Announcement {
    const SCHEMA: &'static str = "gaiter.announcement/1";

    fn schema(&self) -> &str {
        &self.schema
    }

    fn key(&self) -> ObjectKey {
        let (station, scan) = (self.station.clone(), self.scan.clone());
        let at_ms = self.at.as_millisecond();
        ObjectKey::Announcement { station, scan, revision: self.revision, at_ms }
    }
}

/// That a scan is this patient's no longer: announcements of it that are older do not count.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Withdrawal {
    /// [`Document::SCHEMA`].
    pub schema: String,
    /// The station.
    pub station: StationId,
    /// SHA-256 of the scanner's export: whatever was announced of it is meant.
    pub export: ScanId,
    /// Whose it is no longer; `None` for one of which nobody knew.
    pub patient: Option<Pseudonym>,
    /// When the station says so: later than whatever it said before.
    pub at: Timestamp,
}

impl Document for Withdrawal {
    const SCHEMA: &'static str = "gaiter.withdrawal/1";

    fn schema(&self) -> &str {
        &self.schema
    }

    fn key(&self) -> ObjectKey {
        let (station, export) = (self.station.clone(), self.export.clone());
        ObjectKey::Withdrawal { station, export, at_ms: self.at.as_millisecond() }
    }
}
