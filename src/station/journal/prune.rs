//! Deletes what is past its retention: only scans whose records all reached their stores, or that were
//! refused, and never the end of the history.

use std::collections::BTreeSet;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use gaiter_flow::{ScanId, ScanState};
use jiff::Timestamp;
use serde_json::json;

use super::deliveries::IS_NEEDED;
use super::row::{all, run, value};
use super::{Event, Journal, JournalError, history};

impl Journal {
    /// Reports whether a scan has been in a state since before a time and nothing is left to do for it.
    pub fn rests_since(
        &self,
        scan: &ScanId,
        state: ScanState,
        before: Timestamp,
    ) -> Result<bool, JournalError> {
        let rests = "SELECT EXISTS (SELECT 1 FROM scans
                 WHERE sha256 = ?1 AND state = ?2 AND changed_at < ?3 AND NOT EXISTS (
                     SELECT 1 FROM deliveries WHERE deliveries.sha256 = scans.sha256
                     AND (deliveries.state IN ('pending', 'withdrawing')
                          OR deliveries.state = 'held' AND scans.closed IS NULL)))";
        let before = before.to_string();
        value(&self.connection(), rests, [scan.as_str(), state.word(), &before])
    }

    /// Forgets scans that were delivered before a time, and the beginning of the history up to the
    /// oldest row that still matters. Returns the number of scans.
    ///
    /// # Errors
    /// See [`JournalError`]; nothing is forgotten then.
    pub fn forget(&self, before: Timestamp) -> Result<usize, JournalError> {
        let before = before.to_string();
        let delivered = ScanState::Delivered.word();
        self.change(|transaction| {
            transaction.execute(
                &format!(
                    "DELETE FROM deliveries WHERE sha256 IN (
                     SELECT sha256 FROM scans
                     WHERE state = ?1 AND changed_at < ?2 AND NOT EXISTS (
                         SELECT 1 FROM deliveries AS open WHERE open.sha256 = scans.sha256
                         AND (open.state IN ('pending', 'withdrawing')
                              OR open.state = 'held' AND {IS_NEEDED})))"
                ),
                [delivered, &before],
            )?;
            let scans = transaction.execute(
                "DELETE FROM scans WHERE state = ?1 AND changed_at < ?2 AND NOT EXISTS (
                     SELECT 1 FROM deliveries WHERE deliveries.sha256 = scans.sha256)",
                [delivered, &before],
            )?;
            if scans == 0 {
                return Ok(0);
            }
            let oldest = "SELECT min(seq) FROM history
                          WHERE scan IN (SELECT sha256 FROM scans) OR at >= ?1";
            let oldest: Option<i64> = value(transaction, oldest, [&before])?;
            let detail = json!({ "scans": scans, "history_before": oldest });
            history::append(transaction, None, Event::Pruned, &detail)?;
            if let Some(oldest) = oldest {
                history::cut(transaction, oldest)?;
            }
            Ok(scans)
        })
    }

    /// Forgets the sightings of files in a folder whose scans are forgotten or were never read. Returns
    /// how many. Files that are still present stay, as do files in one of the other folders.
    pub fn forget_sightings(
        &self,
        folder: &Path,
        others: &[PathBuf],
        present: &BTreeSet<PathBuf>,
    ) -> Result<usize, JournalError> {
        let unneeded = "SELECT path FROM sightings
                        WHERE sha256 IS NULL OR sha256 NOT IN (SELECT sha256 FROM scans)";
        let mut gone: Vec<Vec<u8>> = all(&self.connection(), unneeded, [], |row| Ok(row.get(0)?))?;
        gone.retain(|path| {
            let path = Path::new(std::ffi::OsStr::from_bytes(path));
            path.starts_with(folder)
                && !others.iter().any(|other| path.starts_with(other))
                && !present.contains(path)
        });
        if gone.is_empty() {
            return Ok(0);
        }
        self.change(|transaction| {
            for path in &gone {
                run(transaction, "DELETE FROM sightings WHERE path = ?1", [path])?;
            }
            Ok(gone.len())
        })
    }
}
