//! What the tests of every crate share: bodies, solids and strips, noise, writers of scan files, readers of
//! what gaiter writes.

pub mod cases;
pub mod chance;
pub mod gdt_check;
pub mod http_server;
pub mod mesh;
pub mod metric;
pub mod noise;
pub mod page;
pub mod recorded;
#[cfg(feature = "record")]
pub mod records;
pub mod solids;
pub mod stance;
pub mod stow;
pub mod strip;
pub mod test_leg;
pub mod tubes;
pub mod writers;

use std::path::{Path, PathBuf};

pub use recorded::{body, coarse_body};

/// The folder of the project.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}
