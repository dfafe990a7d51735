//! Reports → [`Record`].
//!
#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

pub mod archive;
mod cells;
pub mod change;
pub mod chart;
mod check;
pub mod completeness;
mod compose;
pub mod export;
pub mod fhir;
mod file;
mod files;
pub mod gdt;
pub mod hl7;
pub mod measure;
pub mod order;
pub mod phantom;
pub mod picture;
mod provenance;
pub mod report;
mod report_files;
pub mod rounding;
pub mod same_numbers;
pub mod scan_id;
pub mod schema;
pub mod shape;
pub mod shown;
pub mod sizing;
pub mod statement;
mod summary;
pub mod surface;

pub use check::RecordFault;
pub use compose::record;
pub use file::{RecordFile, json};
pub use files::{
    ORD, RECORD, SUMS, ScanFile, add_scan, amended_files, files_beside_scan, hex, record_files,
    sha256,
};
pub use gaiter_leg::word_enum;
pub use provenance::{
    Acquired, AcquiredFrom, Confidence, FIRST_REVISION, ImagingRequest, Patient, Provenance,
    Source, SourceKind,
};
pub use report_files::{FilesFault, ReportChoice, report_files};
pub use scan_id::ScanId;
pub use schema::Record;
pub use summary::{RecordSummary, SheetLine, SummaryFigures, SummaryLevel, sheet};
