//! One station at a time gives records their places: between the search for a scan's record and the
//! rename no other station of the store comes.
//!
//! The store's mark is locked, not a file made for it: the kernel, or the share's server, gives it back
//! when a station ends, however it ends. NFS 4 and SMB share such locks among machines.

use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use rustix::io::Errno;

use crate::store::{StoreFault, tried};

/// How long another station may take: it lists one folder and renames another.
const WAIT: Duration = Duration::from_secs(3);

/// How often the lock is asked for meanwhile.
const ASKED: Duration = Duration::from_millis(10);

/// A station's turn, which ends when this is dropped.
#[derive(Debug)]
pub(super) struct Turn {
    /// None where the file system knows no locks: then the rename alone keeps two records apart.
    _mark: Option<File>,
}

impl Turn {
    /// Waits for the turn in the store that `mark` marks. Blocks.
    ///
    /// # Errors
    /// A transient fault where another station keeps it for [`WAIT`], or where the mark cannot be asked.
    pub(super) fn take(mark: &Path) -> Result<Turn, StoreFault> {
        // Over NFS a lock that excludes others needs a file that is open for writing.
        let file = tried("opening", mark, OpenOptions::new().write(true).open(mark))?;
        let began = Instant::now();
        loop {
            match file.try_lock() {
                Ok(()) => return Ok(Turn { _mark: Some(file) }),
                Err(TryLockError::Error(error)) if knows_no_locks(&error) => {
                    return Ok(Turn { _mark: None });
                }
                Err(TryLockError::WouldBlock) if began.elapsed() < WAIT => sleep(ASKED),
                Err(TryLockError::WouldBlock) => {
                    let what = "waiting for another station, which keeps a lock on";
                    return tried(what, mark, Err(io::ErrorKind::TimedOut.into()));
                }
                Err(TryLockError::Error(error)) => return tried("locking", mark, Err(error)),
            }
        }
    }
}

fn knows_no_locks(error: &io::Error) -> bool {
    let errno = error.raw_os_error().map(Errno::from_raw_os_error);
    matches!(errno, Some(Errno::NOLCK | Errno::NOSYS | Errno::OPNOTSUPP | Errno::INVAL))
}
