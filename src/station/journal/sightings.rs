//! Sightings: which state of which export file was already taken in. This is only a cache, so that a
//! restart does not read years of files again; the scan's hash is what counts.

use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use gaiter_flow::{ScanId, Stamp};
use rusqlite::params;

use super::row::{first, if_any, json_cell, json_text, run, scan_id};
use super::{Journal, JournalError};

impl Journal {
    /// Reports whether this state of the file was taken in or refused before.
    pub fn was_sighted(&self, path: &Path, stamp: Stamp) -> Result<bool, JournalError> {
        Ok(self.sighted_as(path)?.is_some_and(|(found, _)| found == stamp))
    }

    /// The scan of the last sighting of a file: outer `None` if there was no sighting, inner `None` if
    /// the file was refused unread.
    pub fn sighting(&self, path: &Path) -> Result<Option<Option<ScanId>>, JournalError> {
        Ok(self.sighted_as(path)?.map(|(_, scan)| scan))
    }

    /// The last sighted state of a file, and the scan that it was or belonged to.
    pub fn sighted_as(&self, path: &Path) -> Result<Option<(Stamp, Option<ScanId>)>, JournalError> {
        let found = "SELECT stamp, sha256 FROM sightings WHERE path = ?1";
        first(&self.connection(), found, [path.as_os_str().as_bytes()], |row| {
            Ok((json_cell(row, 0)?, if_any(row, 1, scan_id)?))
        })
    }

    /// Notes that this state of the file was taken in, or refused unread if there is no scan.
    pub fn sighted(
        &self,
        path: &Path,
        stamp: Stamp,
        scan: Option<&ScanId>,
    ) -> Result<(), JournalError> {
        run(
            &self.connection(),
            "INSERT INTO sightings (path, stamp, sha256) VALUES (?1, ?2, ?3)
             ON CONFLICT (path) DO UPDATE
             SET stamp = excluded.stamp, sha256 = excluded.sha256, same_as = NULL",
            params![path.as_os_str().as_bytes(), json_text(&stamp)?, scan.map(ScanId::as_str)],
        )
    }

    /// Notes that the sighted file has the points and triangles of an earlier scan.
    pub fn sighted_again(&self, path: &Path, same_as: &ScanId) -> Result<(), JournalError> {
        let noted = "UPDATE sightings SET same_as = ?2 WHERE path = ?1";
        run(&self.connection(), noted, params![path.as_os_str().as_bytes(), same_as.as_str()])
    }

    /// The earlier scan whose points and triangles the last sighted state of a file has in other bytes.
    pub fn same_as(&self, path: &Path) -> Result<Option<ScanId>, JournalError> {
        let found = "SELECT same_as FROM sightings WHERE path = ?1";
        let path = [path.as_os_str().as_bytes()];
        Ok(first(&self.connection(), found, path, |row| if_any(row, 0, scan_id))?.flatten())
    }
}
