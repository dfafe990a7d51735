//! Queries that the operator's page and the previews repeat often: few rows, each found by an index or
//! in one pass.

use rusqlite::{Row, params};

use crate::flow::{DeliveryState, ScanId, ScanState};
use crate::station::journal::{Journal, JournalError, cell};

impl Journal {
    /// A number that differs after each commit: while it stays the same, nothing has changed. `None` if
    /// it cannot be read.
    pub fn edition(&self) -> Option<i64> {
        self.viewer().pragma_query_value(None, "data_version", |row| row.get(0)).ok()
    }

    /// The latest scans, newest first, at most `limit`.
    pub fn newest(&self, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        let query = "SELECT sha256 FROM scans WHERE ?1 = ?1 AND ?2 = ?2
                     ORDER BY first_seen DESC, rowid DESC LIMIT ?3";
        self.scans_of(query, limit)
    }

    /// The scans that wait for an operator's decision, refused or held and not closed, newest first, at
    /// most `limit`.
    pub fn undecided(&self, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        let query = "SELECT sha256 FROM scans WHERE closed IS NULL AND (state = ?1
                     OR sha256 IN (SELECT sha256 FROM deliveries WHERE state = ?2))
                     ORDER BY first_seen DESC, rowid DESC LIMIT ?3";
        self.scans_of(query, limit)
    }

    /// The scans that are held, newest first, at most `limit`.
    pub fn held(&self, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        let query = "SELECT sha256 FROM scans WHERE state <> ?1
                     AND sha256 IN (SELECT sha256 FROM deliveries WHERE state = ?2)
                     ORDER BY first_seen DESC, rowid DESC LIMIT ?3";
        self.scans_of(query, limit)
    }

    fn scans_of(&self, query: &str, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        let connection = self.viewer();
        let mut query = connection.prepare_cached(query)?;
        let words = params![ScanState::Refused.word(), DeliveryState::Held.word(), limit];
        let rows = query.query_map(words, |row: &Row<'_>| row.get(0))?;
        rows.map(|row| cell("sha256", row?, |text| ScanId::parse(text).ok())).collect()
    }
}
