//! Reports → [`Record`]: the result for one scan and patient, serialised and versioned, as bytes.

#![deny(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod files;
pub mod provenance;

pub use files::{RecordFile, record_files};
pub use provenance::{Acquired, AcquiredFrom, Patient, Provenance, Source, SourceKind};
