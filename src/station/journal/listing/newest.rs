//! Queries that the operator's page and the previews repeat often: few rows, each found by an index or
//! in one pass.

use gaiter_flow::{DeliveryState, ScanId, ScanState};
use rusqlite::{Row, params};

use super::count;

use crate::station::journal::withdrawal::UNWANTED;
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

    /// The scans that wait for an operator's decision, newest first, at most `limit`: refused, held, or
    /// stored without a patient, and not closed.
    pub fn undecided(&self, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        let query = format!(
            "SELECT sha256 FROM scans WHERE {}
             ORDER BY first_seen DESC, rowid DESC LIMIT ?3",
            is_undecided()
        );
        self.scans_of(&query, limit)
    }

    /// How many scans wait for an operator's decision.
    pub fn count_undecided(&self) -> Result<u64, JournalError> {
        let connection = self.viewer();
        let query = format!("SELECT count(*) FROM scans WHERE {}", is_undecided());
        let mut query = connection.prepare_cached(&query)?;
        let words = [ScanState::Refused.word(), DeliveryState::Held.word()];
        Ok(query.query_row(words, |row| count(row, 0))?)
    }

    /// The scans that are held, newest first, at most `limit`.
    pub fn held(&self, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        let query = "SELECT sha256 FROM scans WHERE state <> ?1
                     AND sha256 IN (SELECT sha256 FROM deliveries WHERE state = ?2)
                     ORDER BY first_seen DESC, rowid DESC LIMIT ?3";
        self.scans_of(query, limit)
    }

    /// Reports whether a scan waits for an operator's decision.
    pub fn is_undecided(&self, scan: &ScanId) -> Result<bool, JournalError> {
        let connection = self.connection();
        let query = format!("SELECT count(*) FROM scans WHERE sha256 = ?3 AND {}", is_undecided());
        let mut query = connection.prepare_cached(&query)?;
        let words = [ScanState::Refused.word(), DeliveryState::Held.word(), scan.as_str()];
        Ok(query.query_row(words, |row| count(row, 0))? > 0)
    }

    fn scans_of(&self, query: &str, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        let connection = self.viewer();
        let mut query = connection.prepare_cached(query)?;
        let words = params![ScanState::Refused.word(), DeliveryState::Held.word(), limit];
        let rows = query.query_map(words, |row: &Row<'_>| row.get(0))?;
        rows.map(|row| cell("sha256", row?, |text| ScanId::parse(text).ok())).collect()
    }
}

/// SQL: a scan waits for a decision. `?1` is the word for a refused scan, `?2` that for a held delivery.
pub(super) fn is_undecided() -> String {
    format!(
        "closed IS NULL AND (state = ?1
             OR sha256 IN (SELECT sha256 FROM deliveries WHERE state = ?2)
             OR {})",
        is_unassigned()
    )
}

/// SQL: the record of a scan is stored without a patient, and no patient is to have it.
pub(super) fn is_unassigned() -> String {
    format!(
        "sha256 IN (SELECT sha256 FROM deliveries WHERE patient = '' AND state = 'delivered'
                    AND coalesce(code, '') NOT IN {UNWANTED})
         AND NOT EXISTS (SELECT 1 FROM deliveries AS other WHERE other.sha256 = scans.sha256
                         AND (other.state IN ('pending', 'withdrawing', 'held') OR other.patient <> ''
                              AND other.state = 'delivered'
                              AND coalesce(other.code, '') NOT IN {UNWANTED}))"
    )
}
