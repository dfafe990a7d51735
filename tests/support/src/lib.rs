//! What the tests, benches and examples of gaiter share.

pub mod bodies;
pub mod booth;
pub mod chance;
pub mod cloud;
pub mod day;
pub mod disk;
pub mod gdt_check;
pub mod invariants;
pub mod matrix;
pub mod mesh;
pub mod metric;
pub mod noise;
pub mod page;
pub mod player;
pub mod process;
pub mod pty;
pub mod refusal;
pub mod share;
pub mod solids;
pub mod station;
pub mod stored;
pub mod test_leg;
pub mod tracer;
pub mod tubes;
pub mod verb;
pub mod wavefront;
pub mod web;
pub mod whole;
pub mod writers;

use std::path::{Path, PathBuf};

pub use station::*;

/// The folder of the project.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}
