//! Sightings: which state of which export file was taken already. Only a cache, so that a restart
//! does not read a folder of years again; what counts is the scan's hash.

use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use rusqlite::{OptionalExtension, params};

use super::{Journal, JournalError};
use crate::flow::{ScanId, Stamp};

impl Journal {
    /// Whether this state of the file was taken or refused before.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn was_sighted(&self, path: &Path, stamp: Stamp) -> Result<bool, JournalError> {
        let found: Option<String> = self
            .connection()
            .prepare_cached("SELECT stamp FROM sightings WHERE path = ?1")?
            .query_row([path.as_os_str().as_bytes()], |row| row.get(0))
            .optional()?;
        Ok(found.is_some_and(|found| found == text(stamp)))
    }

    /// Notes that this state of the file was taken, or refused unread where there is no scan.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn sighted(
        &self,
        path: &Path,
        stamp: Stamp,
        scan: Option<&ScanId>,
    ) -> Result<(), JournalError> {
        self.connection()
            .prepare_cached(
                "INSERT INTO sightings (path, stamp, sha256) VALUES (?1, ?2, ?3)
                 ON CONFLICT (path) DO UPDATE SET stamp = excluded.stamp, sha256 = excluded.sha256",
            )?
            .execute(params![path.as_os_str().as_bytes(), text(stamp), scan.map(ScanId::as_str)])?;
        Ok(())
    }
}

fn text(stamp: Stamp) -> String {
    let Stamp { dev, ino, size, mtime_ns, ctime_ns } = stamp;
    format!("{dev}:{ino}:{size}:{mtime_ns}:{ctime_ns}")
}
