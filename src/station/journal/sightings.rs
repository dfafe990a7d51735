//! Sightings: which state of which export file was already taken in. This is only a cache, so that a
//! restart does not read years of files again; the scan's hash is what counts.

use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use gaiter_flow::{ScanId, Stamp};
use rusqlite::{OptionalExtension, params};

use super::{Journal, JournalError, cell};

impl Journal {
    /// Reports whether this state of the file was taken in or refused before.
    pub fn was_sighted(&self, path: &Path, stamp: Stamp) -> Result<bool, JournalError> {
        let found: Option<String> = self
            .connection()
            .prepare_cached("SELECT stamp FROM sightings WHERE path = ?1")?
            .query_row([path.as_os_str().as_bytes()], |row| row.get(0))
            .optional()?;
        Ok(found.is_some_and(|found| found == text(stamp)))
    }

    /// The scan of the last sighting of a file: outer `None` if there was no sighting, inner `None` if
    /// the file was refused unread.
    pub fn sighting(&self, path: &Path) -> Result<Option<Option<ScanId>>, JournalError> {
        let found: Option<Option<String>> = self
            .connection()
            .prepare_cached("SELECT sha256 FROM sightings WHERE path = ?1")?
            .query_row([path.as_os_str().as_bytes()], |row| row.get(0))
            .optional()?;
        let scan = |text: String| cell("sha256", text, ScanId::parse);
        found.map(|found| found.map(scan).transpose()).transpose()
    }

    /// The last sighted state of a file, and the scan that it was or belonged to.
    pub fn sighted_as(&self, path: &Path) -> Result<Option<(Stamp, Option<ScanId>)>, JournalError> {
        let found: Option<(String, Option<String>)> = self
            .connection()
            .prepare_cached("SELECT stamp, sha256 FROM sightings WHERE path = ?1")?
            .query_row([path.as_os_str().as_bytes()], |row| Ok((row.get(0)?, row.get(1)?)))
            .optional()?;
        let Some((stamp, scan)) = found else { return Ok(None) };
        let parsed = |text: String| cell("sha256", text, ScanId::parse);
        Ok(Some((cell("stamp", stamp, of_text)?, scan.map(parsed).transpose()?)))
    }

    /// Notes that this state of the file was taken in, or refused unread if there is no scan.
    pub fn sighted(
        &self,
        path: &Path,
        stamp: Stamp,
        scan: Option<&ScanId>,
    ) -> Result<(), JournalError> {
        self.connection()
            .prepare_cached(
                "INSERT INTO sightings (path, stamp, sha256) VALUES (?1, ?2, ?3)
                 ON CONFLICT (path) DO UPDATE
                 SET stamp = excluded.stamp, sha256 = excluded.sha256, same_as = NULL",
            )?
            .execute(params![path.as_os_str().as_bytes(), text(stamp), scan.map(ScanId::as_str)])?;
        Ok(())
    }

    /// Notes that the sighted file has the points and triangles of an earlier scan.
    pub fn sighted_again(&self, path: &Path, same_as: &ScanId) -> Result<(), JournalError> {
        self.connection()
            .prepare_cached("UPDATE sightings SET same_as = ?2 WHERE path = ?1")?
            .execute(params![path.as_os_str().as_bytes(), same_as.as_str()])?;
        Ok(())
    }

    /// The earlier scan whose points and triangles the last sighted state of a file has in other bytes.
    pub fn same_as(&self, path: &Path) -> Result<Option<ScanId>, JournalError> {
        let found: Option<Option<String>> = self
            .connection()
            .prepare_cached("SELECT same_as FROM sightings WHERE path = ?1")?
            .query_row([path.as_os_str().as_bytes()], |row| row.get(0))
            .optional()?;
        let parsed = |text: String| cell("same_as", text, ScanId::parse);
        found.flatten().map(parsed).transpose()
    }
}

fn text(stamp: Stamp) -> String {
    let Stamp { dev, ino, size, mtime_ns, ctime_ns } = stamp;
    format!("{dev}:{ino}:{size}:{mtime_ns}:{ctime_ns}")
}

fn of_text(text: &str) -> Option<Stamp> {
    let mut parts = text.split(':');
    let stamp = Stamp {
        dev: parts.next()?.parse().ok()?,
        ino: parts.next()?.parse().ok()?,
        size: parts.next()?.parse().ok()?,
        mtime_ns: parts.next()?.parse().ok()?,
        ctime_ns: parts.next()?.parse().ok()?,
    };
    parts.next().is_none().then_some(stamp)
}
