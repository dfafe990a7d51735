//! What a station says of a scan that it has put into the archive.

use gaiter_leg::WholeBody;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::Document;
use super::key::ObjectKey;
use super::words::{MethodId, Pseudonym, StationId};
use crate::scan_id::ScanId;

/// That a scan and its record are in the archive. It is written after them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// The revision of the record.
    pub revision: u32,
    /// What the record was measured with.
    pub method: MethodId,
    /// When the station first saw the export.
    pub first_seen: Timestamp,
    /// What the scan shows.
    pub shows: Shows,
}

/// What a scan shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shows {
    /// A body of known girths, with which the scanner is checked. It is not measured anew.
    Phantom,
    /// The legs of a person.
    Legs {
        /// What the rest of the body told, with which the crop is measured.
        whole: Box<WholeBody>,
        /// Whose they are; `None` if nobody knows.
        patient: Option<Pseudonym>,
    },
}

impl Document for Announcement {
    const SCHEMA: &'static str = "gaiter.announcement/1";

    fn schema(&self) -> &str {
        &self.schema
    }

    fn key(&self) -> ObjectKey {
        let (station, scan) = (self.station.clone(), self.scan.clone());
        ObjectKey::Announcement { station, scan, revision: self.revision }
    }
}
