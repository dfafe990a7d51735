//! Processes that read what nobody vouches for.
//!
#![doc = include_str!("../README.md")]

mod confine;
mod line;
mod run;
mod trouble;

use std::time::Duration;

use serde::{Deserialize, Serialize};

pub use confine::{ConfineFault, confine, enough, tried};
pub use line::{read_line, write_line};
pub use run::{Ended, RunFault, run};
pub use trouble::{Blame, Trouble};

/// The limits of a confined process.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limits {
    /// Address space, bytes.
    pub memory_bytes: u64,
    /// Time from its start to its answer.
    pub wall: Duration,
}
