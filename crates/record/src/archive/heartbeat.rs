//! What a station says of itself every minute.

use std::collections::BTreeMap;

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::Document;
use super::key::ObjectKey;
use super::words::StationId;

/// How a station is. It holds nothing of patients.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Heartbeat {
    /// [`Document::SCHEMA`].
    pub schema: String,
    /// The station.
    pub station: StationId,
    /// When it says so, by its own clock.
    pub at: Timestamp,
    /// gaiter's version.
    pub gaiter: String,
    /// Whether it takes scans.
    pub is_ready: bool,
    /// Scans by what became of them, by the words of the station's metrics, since it has its journal.
    pub scans: BTreeMap<String, u64>,
    /// When the scan was first seen that waits longest for the archive; `None` if none waits.
    pub oldest_undelivered: Option<Timestamp>,
    /// How far the last check with the phantom was off on average; `None` if there was none.
    pub phantom_bias_mm: Option<f64>,
}

impl Document for Heartbeat {
    const SCHEMA: &'static str = "gaiter.heartbeat/1";

    fn schema(&self) -> &str {
        &self.schema
    }

    fn key(&self) -> ObjectKey {
        ObjectKey::Heartbeat(self.station.clone())
    }
}
