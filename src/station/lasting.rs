//! What belongs to the process and outlives a reload: its state folder, its export folders, and the
//! addresses at which it listens. Nobody else gets them while workers change.

use std::fs;
use std::io;
use std::path::Path;

use super::error::StationError;
use super::intake::export_locks::ExportLocks;
use super::journal::StateLock;
use super::operator::http::Listeners;
use crate::store::durable;

/// What the generations of one process share.
#[derive(Debug, Default)]
pub struct Lasting {
    /// The addresses of the page's endpoints.
    pub listeners: Listeners,
    /// The export folders.
    pub export_locks: ExportLocks,
}

/// A state folder that belongs to this process.
#[derive(Debug)]
pub struct OwnStateDir {
    /// No station ever ran on it.
    pub first_start: bool,
    _lock: StateLock,
}

/// Takes a state folder for this process, made if there is none.
///
/// # Errors
/// Where it cannot be made, or where another process has it.
pub fn take_state_dir(path: &Path) -> Result<OwnStateDir, StationError> {
    let state = |source| StationError::State { path: path.to_owned(), source };
    let make = || -> io::Result<()> {
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        durable::make_folder_once(path)
    };
    make().map_err(state)?;
    let lock = StateLock::take(path)?;
    // The spool is made after the first journal is whole: a first start that was cut off before, and
    // what it left of a journal, is no station that lost its own.
    let first_start = !fs::exists(path.join("spool")).map_err(state)?;
    Ok(OwnStateDir { first_start, _lock: lock })
}
