//! Letting go what the configuration lets go: only of scans whose records all reached their stores,
//! or that were refused, and never from the end of the history.

use std::collections::BTreeSet;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use jiff::Timestamp;
use serde_json::json;

use super::{Event, Journal, JournalError, cell, history};
use crate::flow::{ScanId, ScanState};

/// Scans in a state since before a time, of which nothing is to be done.
const RESTING: &str = "
    SELECT sha256 FROM scans WHERE state = ?1 AND changed_at < ?2 AND NOT EXISTS (
        SELECT 1 FROM deliveries WHERE deliveries.sha256 = scans.sha256
        AND deliveries.state IN ('pending', 'held', 'withdrawing'))";

impl Journal {
    /// The scans that have been delivered, or refused, since before a time.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn resting(
        &self,
        state: ScanState,
        before: Timestamp,
    ) -> Result<Vec<ScanId>, JournalError> {
        let connection = self.connection();
        let mut query = connection.prepare_cached(RESTING)?;
        let rows = query.query_map([state.word(), &before.to_string()], |row| row.get(0))?;
        rows.map(|row| cell("sha256", row?, |text| ScanId::parse(text).ok())).collect()
    }

    /// Forgets scans that have been delivered since before a time, with the beginning of the
    /// history up to the oldest row that still matters; says how many scans.
    ///
    /// # Errors
    /// See [`JournalError`]; nothing is forgotten then.
    pub fn forget(&self, before: Timestamp) -> Result<usize, JournalError> {
        let before = before.to_string();
        let delivered = ScanState::Delivered.word();
        self.change(|transaction| {
            let count = |transaction: &rusqlite::Transaction<'_>| {
                transaction.execute(
                    &format!("DELETE FROM deliveries WHERE sha256 IN ({RESTING})"),
                    [delivered, &before],
                )?;
                transaction.execute(
                    "DELETE FROM scans WHERE state = ?1 AND changed_at < ?2 AND NOT EXISTS (
                         SELECT 1 FROM deliveries WHERE deliveries.sha256 = scans.sha256)",
                    [delivered, &before],
                )
            };
            let scans = count(transaction)?;
            if scans == 0 {
                return Ok(0);
            }
            let oldest: Option<i64> = transaction.query_row(
                "SELECT min(seq) FROM history WHERE scan IN (SELECT sha256 FROM scans)
                                                 OR at >= ?1",
                [&before],
                |row| row.get(0),
            )?;
            let detail = json!({ "scans": scans, "history_before": oldest });
            history::append(transaction, None, Event::Pruned, &detail)?;
            if let Some(oldest) = oldest {
                history::cut(transaction, oldest)?;
            }
            Ok(scans)
        })
    }

    /// Forgets sightings in a folder of files that are not there any more.
    ///
    /// # Errors
    /// See [`JournalError`].
    pub fn forget_sightings(
        &self,
        folder: &Path,
        present: &BTreeSet<PathBuf>,
    ) -> Result<usize, JournalError> {
        let gone: Vec<Vec<u8>> = {
            let connection = self.connection();
            let mut query = connection.prepare_cached("SELECT path FROM sightings")?;
            let paths = query.query_map([], |row| row.get(0))?;
            let paths: Vec<Vec<u8>> = paths.collect::<rusqlite::Result<_>>()?;
            let gone = |path: &Vec<u8>| {
                let path = Path::new(std::ffi::OsStr::from_bytes(path));
                path.starts_with(folder) && !present.contains(path)
            };
            paths.into_iter().filter(gone).collect()
        };
        self.change(|transaction| {
            for path in &gone {
                transaction.execute("DELETE FROM sightings WHERE path = ?1", [path])?;
            }
            Ok(gone.len())
        })
    }
}
