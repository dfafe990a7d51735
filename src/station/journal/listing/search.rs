//! The search among all scans. It reads from the newest and ends when there are enough, so it is fast for
//! what people look for; text that no scan has is looked for in all.

use gaiter_flow::account::{Search, SearchState};
use gaiter_flow::{DeliveryState, ScanId, ScanState};
use rusqlite::params;

use super::newest::{is_unassigned, is_undecided};
use crate::station::journal::withdrawal::UNWANTED;
use crate::station::journal::{Journal, JournalError, cell};

impl Journal {
    /// The scans that a search finds, newest first: one more than `limit` if there are more.
    pub fn search(&self, search: &Search) -> Result<Vec<ScanId>, JournalError> {
        let connection = self.viewer();
        let mut query = connection.prepare_cached(&format!(
            "SELECT sha256 FROM scans
             WHERE (?3 = '' OR substr(sha256, 1, length(?3)) = lower(?3)
                    OR sha256 IN (SELECT sha256 FROM deliveries
                                  WHERE patient <> '' AND instr(lower(patient), lower(?3)) > 0))
                   AND (?4 IS NULL OR first_seen >= ?4) AND (?5 IS NULL OR first_seen < ?5)
                   AND (?6 = 0 OR incomplete = 1) AND {}
             ORDER BY first_seen DESC, rowid DESC LIMIT ?7 OFFSET ?8",
            of_state(search.state)
        ))?;
        let time = |at: Option<jiff::Timestamp>| at.map(|at| at.to_string());
        let rows = query.query_map(
            params![
                ScanState::Refused.word(),
                DeliveryState::Held.word(),
                search.text.trim(),
                time(search.from),
                time(search.until),
                search.incomplete,
                search.limit.saturating_add(1),
                search.offset,
            ],
            |row| row.get(0),
        )?;
        rows.map(|row| cell("sha256", row?, |text| ScanId::parse(text).ok())).collect()
    }
}

/// SQL: a scan has this state. `?1` and `?2` are as in [`is_undecided`].
fn of_state(state: Option<SearchState>) -> String {
    match state {
        None => "?1 = ?1 AND ?2 = ?2".to_owned(),
        Some(SearchState::Undecided) => format!("({})", is_undecided()),
        Some(SearchState::Refused) => "(state = ?1 AND ?2 = ?2)".to_owned(),
        Some(SearchState::Unassigned) => format!("(?1 = ?1 AND ?2 = ?2 AND {})", is_unassigned()),
        Some(SearchState::Delivered) => format!(
            "(?1 = ?1 AND ?2 = ?2 AND EXISTS
                 (SELECT 1 FROM deliveries AS theirs
                  WHERE theirs.sha256 = scans.sha256 AND theirs.patient <> ''
                        AND theirs.state = 'delivered' AND coalesce(theirs.code, '') NOT IN {UNWANTED}))"
        ),
    }
}
