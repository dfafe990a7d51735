//! What a method says of a crop: a pure function of both, so it does not matter who measures it, and how often.

use serde::{Deserialize, Serialize};

use super::Document;
use super::key::ObjectKey;
use super::words::MethodId;
use crate::scan_id::ScanId;
use crate::schema::Record;

/// The result of a method for a scan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScanResult {
    /// [`Document::SCHEMA`].
    pub schema: String,
    /// SHA-256 of the crop's PLY.
    pub scan: ScanId,
    /// The method.
    pub method: MethodId,
    /// Its text.
    pub outcome: Outcome,
}

/// What a method says of a scan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The record, without station, patient and time.
    Measured(Box<Record>),
    /// It cannot be measured.
    Refused {
        /// Stable code.
        code: String,
        /// Message for people.
        message: String,
    },
}

impl Document for ScanResult {
    const SCHEMA: &'static str = "gaiter.archive-result/1";

    fn schema(&self) -> &str {
        &self.schema
    }

    fn key(&self) -> ObjectKey {
        ObjectKey::Result { method: self.method.clone(), scan: self.scan.clone() }
    }
}
