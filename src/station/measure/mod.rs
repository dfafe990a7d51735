//! Measures a scan in its own process: whatever a file makes the measurement do, only that one scan is
//! affected and never the station.
//!
//! The station runs its own binary again with the hidden verb `measure`. The job and the bytes go to
//! its standard input, and the record's files come from its standard output. Its arguments hold only
//! the scan's hash. Before the process reads the first byte of the scan, it gives up what it does not
//! need: files, network, new programs, and memory and time beyond its limits.

pub mod child;
mod confine;
mod job;
mod parent;
mod trouble;

pub use confine::{ConfineFault, enough, tried};
pub use job::{Answer, Job, Limits, Subject};
pub use parent::{MeasureFault, Measured, answers, measure, measure_bytes};
pub use trouble::{Blame, Trouble};

/// The hidden verb with which the binary runs again.
pub const VERB: &str = "measure";
