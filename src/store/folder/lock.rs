//! One station at a time gives records their places: no other station of the store acts between the
//! search for a scan's record and the rename.
//!
//! The store's mark is locked, not a separate file. The kernel, or the share's server, releases the lock
//! when a station ends, however it ends. NFS 4 and SMB share such locks among machines.

use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;
use std::time::Duration;

use rustix::io::Errno;

use crate::store::polling::poll;
use crate::store::{StoreFault, tried};

/// How long another station may take: it lists one folder and renames another.
const WAIT: Duration = Duration::from_secs(3);

/// The store's lock, released on drop.
#[derive(Debug)]
pub(super) struct StoreLock {
    /// `None` if the file system has no locks: then only the rename prevents a second record.
    _mark: Option<File>,
}

impl StoreLock {
    /// Waits for the lock of the store that `mark` marks. Blocks.
    ///
    /// # Errors
    /// A transient fault if another station keeps it for [`WAIT`], or if the mark cannot be locked.
    pub(super) fn take(mark: &Path) -> Result<StoreLock, StoreFault> {
        // Over NFS an exclusive lock needs a file that is open for writing.
        let file = tried("opening", mark, OpenOptions::new().write(true).open(mark))?;
        let locked = poll(WAIT, || match file.try_lock() {
            Err(TryLockError::WouldBlock) => None,
            locked => Some(locked),
        });
        match locked {
            Some(Ok(())) => Ok(StoreLock { _mark: Some(file) }),
            Some(Err(TryLockError::Error(error))) if knows_no_locks(&error) => {
                Ok(StoreLock { _mark: None })
            }
            Some(Err(TryLockError::Error(error))) => tried("locking", mark, Err(error)),
            Some(Err(TryLockError::WouldBlock)) | None => {
                let what = "waiting for another station's lock";
                tried(what, mark, Err(io::ErrorKind::TimedOut.into()))
            }
        }
    }
}

fn knows_no_locks(error: &io::Error) -> bool {
    let errno = error.raw_os_error().map(Errno::from_raw_os_error);
    matches!(errno, Some(Errno::NOLCK | Errno::NOSYS | Errno::OPNOTSUPP | Errno::INVAL))
}
