//! Measures a scan in its own process: whatever a file makes the measurement do, only that one scan is
//! affected and never the station.
//!
//! Nothing else in the station reads what is in a scan: what intake must know of an export comes from such a
//! process, too.
//!
//! The station runs its own binary again with the hidden verb `measure`. The job and the bytes go to its standard
//! input, and the answer comes from its standard output: how an export ends and what identifies it, the record's
//! files, a check with the phantom, or the crop for an archive. Its arguments hold at most the scan's hash. Before the
//! process reads the first byte of the scan, it gives up what it does not need: files, network, new programs, and
//! memory and time beyond its limits.

pub mod child;
pub mod crop;
mod job;
mod parent;

pub use gaiter_confined::{Blame, ConfineFault, Ended, Limits, Trouble, enough, tried};
pub use job::{CheckJob, CropJob, Inspection, Job, JobAnswer, Purpose, RecordJob};
pub use parent::{MeasureFault, answers, measure, measure_bytes};

/// The hidden verb with which the binary runs again.
pub const VERB: &str = "measure";
