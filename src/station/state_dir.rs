//! The state folder of a station, which belongs to one process.

use std::fs;
use std::io;
use std::path::Path;

use super::error::StationError;
use super::journal::StateLock;
use crate::store::durable;

/// A state folder that belongs to this process.
#[derive(Debug)]
pub struct OwnStateDir {
    /// No station has run on it before.
    pub first_start: bool,
    _lock: StateLock,
}

/// Takes a state folder for this process, and creates it if needed.
///
/// # Errors
/// If it cannot be created, or if another process has it.
pub fn take_state_dir(path: &Path) -> Result<OwnStateDir, StationError> {
    let state = |source| StationError::State { path: path.to_owned(), source };
    let make = || -> io::Result<()> {
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        durable::make_folder_once(path)
    };
    make().map_err(state)?;
    let lock = StateLock::take(path)?;
    // The spool is made after the first journal is complete. So a first start that was cut off, with the
    // partial journal it left, is not taken for a station that lost its journal.
    let first_start = !fs::exists(path.join("spool")).map_err(state)?;
    Ok(OwnStateDir { first_start, _lock: lock })
}
