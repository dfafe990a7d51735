//! What the tests, benches and examples of gaiter share.

pub mod booth;
pub mod chance;
pub mod day;
pub mod faults;
pub mod gdt_check;
pub mod geometry;
pub mod invariants;
pub mod page;
pub mod process;
pub mod pty;
pub mod refusal;
pub mod scans;
pub mod station;
pub mod stored;
pub mod verb;
pub mod web;
pub mod whole;
pub mod writers;

use std::path::{Path, PathBuf};

pub use scans::*;
pub use station::*;

/// The folder of the project.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}
