//! One process per state folder: two would take each other's scans for their own.

use std::fs::{File, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::open_private;
use crate::store::polling::poll;

/// How long another process may take to release the folder. If a station is killed while it starts a
/// measuring process, that process holds the folder until it runs its program.
const GIVEN_BACK: Duration = Duration::from_secs(3);

/// The right to use a state folder, held while this value lives. The kernel releases it when the process
/// ends, however it ends; the file stays.
#[derive(Debug)]
pub struct StateLock {
    _file: File,
}

/// Why the state folder cannot be taken.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// Another process uses it.
    #[error("{path} is in use by the process {pid}")]
    InUse {
        /// The state folder.
        path: PathBuf,
        /// The id of the other process, as it wrote it to the file.
        pid: String,
    },
    /// The lock file failed.
    #[error("locking {path} failed")]
    Io {
        /// The lock file.
        path: PathBuf,
        #[source]
        source: io::Error,
    },
}

impl StateLock {
    /// Takes the folder for this process, as soon as another process that is ending releases it. Blocks.
    ///
    /// # Errors
    /// [`LockError::InUse`] if another process keeps it.
    pub fn take(state_dir: &Path) -> Result<StateLock, LockError> {
        let taken = poll(GIVEN_BACK, || match StateLock::take_now(state_dir) {
            Err(LockError::InUse { .. }) => None,
            taken => Some(taken),
        });
        taken.unwrap_or_else(|| StateLock::take_now(state_dir))
    }

    fn take_now(state_dir: &Path) -> Result<StateLock, LockError> {
        let path = state_dir.join("lock");
        let io = |source| LockError::Io { path: path.clone(), source };
        let mut file = open_private(&path).map_err(io)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut pid = String::new();
                file.read_to_string(&mut pid).map_err(io)?;
                let pid = pid.trim().to_owned();
                return Err(LockError::InUse { path: state_dir.to_owned(), pid });
            }
            Err(TryLockError::Error(source)) => return Err(io(source)),
        }
        file.set_len(0).map_err(io)?;
        file.rewind().map_err(io)?;
        writeln!(file, "{}", std::process::id()).map_err(io)?;
        Ok(StateLock { _file: file })
    }
}
