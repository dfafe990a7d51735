//! Records of recorded bodies.

#![allow(clippy::unwrap_used)]

use std::sync::OnceLock;

use gaiter_leg::{Extraction, Method, extract};
use gaiter_record::{Provenance, Record, record, sha256};
use gaiter_scan::Format;

use crate::recorded::export;

const BODIES: [&str; 3] = ["f_average_clean", "f_average_tc2", "m_average_clean"];

/// What the default method measures on a recorded body, and the record of it; measured once.
pub fn measured(body: &str) -> &'static (Extraction, Record) {
    static MEASURED: [OnceLock<(Extraction, Record)>; BODIES.len()] =
        [const { OnceLock::new() }; BODIES.len()];
    let index = BODIES.iter().position(|name| *name == body).unwrap();
    MEASURED[index].get_or_init(|| record_of(&export(body), &Method::default()))
}

/// The recorded bodies by name, as [`measured`].
pub fn bodies() -> impl Iterator<Item = (&'static str, &'static Extraction, &'static Record)> {
    BODIES.into_iter().map(|body| {
        let (extraction, record) = measured(body);
        (body, extraction, record)
    })
}

/// The record of an export that nobody says more about.
pub fn record_of(bytes: &[u8], method: &Method) -> (Extraction, Record) {
    let extraction = extract(bytes, Format::Obj, method).unwrap();
    let provenance = Provenance::of_scan(sha256(bytes));
    let record = record(&extraction, &provenance, method);
    (extraction, record)
}
