//! The part of a `record.json` with whose it is and when it was made.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use gaiter_record::{Acquired, Patient};
use jiff::Timestamp;
use serde::Deserialize;

use super::{StoreFault, sums, tried};

/// The longest `record.json` that is read, bytes; one with shapes has under one million.
const RECORD_MOST: u64 = 16_000_000;

/// What is read.
#[derive(Debug, Clone, Deserialize)]
pub struct Brief {
    pub revision: u32,
    /// Its patient; `None` if none was named.
    pub patient: Option<Patient>,
    /// When the scan was taken.
    pub acquired: Option<Acquired>,
    #[serde(default)]
    pub amendments: Vec<BriefAmendment>,
}

/// A measure that a person set.
#[derive(Debug, Clone, Deserialize)]
pub struct BriefAmendment {
    pub leg: String,
    pub measure: String,
    pub reason: String,
    pub by: String,
    pub at: Timestamp,
}

impl Brief {
    /// The patient's id; `None` if none was named.
    pub fn patient_id(&self) -> Option<&str> {
        self.patient.as_ref().map(|patient| patient.id.as_str())
    }

    /// Reads a `record.json`; `None` if there is none, or if it cannot be understood.
    ///
    /// # Errors
    /// A transient fault if it cannot be read now.
    pub fn read(path: &Path) -> Result<Option<Brief>, StoreFault> {
        let mut bytes = Vec::new();
        let read = File::open(path).and_then(|file| file.take(RECORD_MOST).read_to_end(&mut bytes));
        let there = tried("reading", path, sums::readable(read))?;
        Ok(there.and_then(|_| serde_json::from_slice(&bytes).ok()))
    }
}
