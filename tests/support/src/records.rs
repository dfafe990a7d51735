//! Records of recorded bodies.

#![allow(clippy::unwrap_used)]

use gaiter_leg::{Extraction, Method, extract};
use gaiter_record::{Provenance, Record, record, sha256};
use gaiter_scan::Format;

/// The record of an export that nobody says more about.
pub fn record_of(bytes: &[u8], method: &Method) -> (Extraction, Record) {
    let extraction = extract(bytes, Format::Obj, method).unwrap();
    let provenance = Provenance::of_scan(sha256(bytes));
    let record = record(&extraction, &provenance, method);
    (extraction, record)
}
