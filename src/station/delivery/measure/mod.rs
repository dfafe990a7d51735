//! The measurement of a scan in a process of its own: whatever a file makes the measurement do, it
//! costs that one scan and never the station.
//!
//! The station runs its own binary again with the hidden verb `measure`. The job and the bytes go
//! to its standard input, the record's files come from its standard output; its arguments hold the
//! scan's hash and nothing else. Before it reads the first byte of the scan the process gives up
//! what it does not need: files, network, new programs, and memory and time beyond its limits.

pub mod child;
mod confine;
mod job;
mod parent;
mod trouble;

pub use confine::{ConfineFault, enough, tried};
pub use job::{Answer, Job, Limits};
pub use parent::{MeasureFault, Measured, answers, measure};
pub use trouble::{Blame, Trouble};

/// The hidden verb under which the binary is run again.
pub const VERB: &str = "measure";
