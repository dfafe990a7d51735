//! Queries that the operator's page and the previews repeat often: few rows, each found by an index or
//! in one pass.

use gaiter_flow::{Disposition, ScanId};
use jiff::Timestamp;
use rusqlite::Row;

use super::count;
use super::search::has_record;
use crate::station::journal::disposition::is_one_of;
use crate::station::journal::{Journal, JournalError, cell};

impl Journal {
    /// A number that differs after each commit: while it stays the same, nothing has changed. `None` if
    /// it cannot be read.
    pub fn edition(&self) -> Option<i64> {
        self.viewer().pragma_query_value(None, "data_version", |row| row.get(0)).ok()
    }

    /// The latest scans, newest first, at most `limit`.
    pub fn newest(&self, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        self.scans_of("TRUE", limit)
    }

    /// The scans that wait for their records, newest first, at most `limit`.
    pub fn spooled(&self, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        self.scans_of(&is_one_of(|found| found == Disposition::Spooled), limit)
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
        let connection = self.viewer();
        let query = format!("SELECT count(*) FROM scans WHERE {}", has_task(since));
        Ok(connection.query_row(&query, [], |row| count(row, 0))?)
    }

    /// The scans that are held, newest first, at most `limit`.
    pub fn held(&self, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        self.scans_of(&is_one_of(|found| found == Disposition::Held), limit)
    }

    /// Reports whether a scan waits for an operator's decision.
    pub fn is_undecided(&self, scan: &ScanId) -> Result<bool, JournalError> {
        let which = is_one_of(Disposition::needs_decision);
        let connection = self.connection();
        let query = format!("SELECT count(*) FROM scans WHERE sha256 = ?1 AND {which}");
        let mut query = connection.prepare_cached(&query)?;
        Ok(query.query_row([scan.as_str()], |row| count(row, 0))? > 0)
    }

    fn scans_of(&self, which: &str, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        self.scans_by(which, "", limit)
    }

    /// `first`: SQL of what counts before the newest.
    fn scans_by(&self, which: &str, first: &str, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        let connection = self.viewer();
        let mut query = connection.prepare(&format!(
            "SELECT sha256 FROM scans WHERE {which} ORDER BY {first}first_seen DESC, rowid DESC LIMIT ?1"
        ))?;
        let rows = query.query_map([limit], |row: &Row<'_>| row.get(0))?;
        rows.map(|row| cell("sha256", row?, ScanId::parse)).collect()
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
