//! Queries that the operator's page and the previews repeat often: few rows, each found by an index or
//! in one pass.

use gaiter_flow::{Disposition, ScanId};
use jiff::Timestamp;

use super::search::has_record;
use crate::station::journal::disposition::is_one_of;
use crate::station::journal::row::{all, scan_id, value};
use crate::station::journal::{Journal, JournalError};

impl Journal {
    /// A number that differs after each commit: while it stays the same, nothing has changed. `None` if
    /// it cannot be read.
    pub fn edition(&self) -> Option<i64> {
        self.viewer().pragma_query_value(None, "data_version", |row| row.get(0)).ok()
    }

    /// The latest scans, newest first, at most `limit`.
    pub fn newest(&self, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        self.scans_by("TRUE", "", limit)
    }

    /// The scans that wait for their records, newest first, at most `limit`.
    pub fn spooled(&self, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        self.scans_by(&is_one_of(|found| found == Disposition::Spooled), "", limit)
    }

    /// The scans that wait for an operator's decision, newest first, then those seen since a time whose records
    /// lack measures; at most `limit`.
    pub fn open_tasks(&self, limit: u32, since: Timestamp) -> Result<Vec<ScanId>, JournalError> {
        // A decision that waits is never below what a record lacks.
        let decide = is_one_of(Disposition::needs_decision);
        self.scans_by(&has_task(since), &format!("{decide} DESC, "), limit)
    }

    /// How many scans these are.
    pub fn count_open_tasks(&self, since: Timestamp) -> Result<u64, JournalError> {
        let counted = format!("SELECT count(*) FROM scans WHERE {}", has_task(since));
        value(&self.viewer(), &counted, []).map(i64::cast_unsigned)
    }

    /// The scans that are held, newest first, at most `limit`.
    pub fn held(&self, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        self.scans_by(&is_one_of(|found| found == Disposition::Held), "", limit)
    }

    /// Reports whether a scan waits for an operator's decision.
    pub fn is_undecided(&self, scan: &ScanId) -> Result<bool, JournalError> {
        let which = is_one_of(Disposition::needs_decision);
        let found = format!("SELECT EXISTS (SELECT 1 FROM scans WHERE sha256 = ?1 AND {which})");
        value(&self.connection(), &found, [scan.as_str()])
    }

    /// `first`: SQL of what counts before the newest.
    pub(super) fn scans_by(
        &self,
        which: &str,
        first: &str,
        limit: u32,
    ) -> Result<Vec<ScanId>, JournalError> {
        let found = format!(
            "SELECT sha256 FROM scans WHERE {which} ORDER BY {first}first_seen DESC, rowid DESC LIMIT ?1"
        );
        all(&self.viewer(), &found, [limit], |row| scan_id(row, 0))
    }
}

/// SQL: a person must decide about the scan, or its record lacks measures and it was seen since this time.
fn has_task(since: Timestamp) -> String {
    let decide = is_one_of(Disposition::needs_decision);
    let may_lack = is_one_of(Disposition::may_lack_measures);
    let has_record = has_record();
    format!(
        "({decide} OR incomplete = 1 AND {may_lack} AND first_seen >= '{since}' AND {has_record})"
    )
}
