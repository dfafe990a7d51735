//! The search among all scans. It reads from the newest and ends when there are enough, so it is fast for
//! what people look for; text that no scan has is looked for in all.

use gaiter_flow::account::{Search, SearchState};
use gaiter_flow::{Disposition, ScanId, ScanState};
use rusqlite::params;

use crate::station::journal::disposition::is_one_of;
use crate::station::journal::row::{all, scan_id};
use crate::station::journal::withdrawal::UNWANTED;
use crate::station::journal::{Journal, JournalError};

impl Journal {
    /// The scans that a search finds, newest first: one more than `limit` if there are more.
    pub fn search(&self, search: &Search) -> Result<Vec<ScanId>, JournalError> {
        let found = format!(
            "SELECT sha256 FROM scans
             WHERE (?1 = '' OR substr(sha256, 1, length(?1)) = lower(?1)
                    OR sha256 IN (SELECT sha256 FROM deliveries
                                  WHERE patient <> '' AND instr(lower(patient), lower(?1)) > 0))
                   AND (?2 IS NULL OR first_seen >= ?2) AND (?3 IS NULL OR first_seen < ?3)
                   AND (?4 = 0 OR incomplete = 1) AND {}
             ORDER BY first_seen DESC, rowid DESC LIMIT ?5 OFFSET ?6",
            of_state(search.state)
        );
        let time = |at: Option<jiff::Timestamp>| at.map(|at| at.to_string());
        let cells = params![
            search.text.trim(),
            time(search.from),
            time(search.until),
            search.incomplete,
            search.limit.saturating_add(1),
            search.offset,
        ];
        all(&self.viewer(), &found, cells, |row| scan_id(row, 0))
    }
}

/// SQL: a scan has this state. One that has a record of a patient may be held for another.
fn of_state(state: Option<SearchState>) -> String {
    match state {
        None => "TRUE".to_owned(),
        Some(SearchState::Undecided) => is_one_of(Disposition::needs_decision),
        Some(SearchState::Refused) => format!("state = '{}'", ScanState::Refused.word()),
        Some(SearchState::Unassigned) => is_one_of(Disposition::is_unassigned),
        Some(SearchState::Delivered) => has_record(),
    }
}

/// SQL: a patient to whom a scan belongs has its record.
pub(super) fn has_record() -> String {
    format!(
        "EXISTS (SELECT 1 FROM deliveries AS theirs
                 WHERE theirs.sha256 = scans.sha256 AND theirs.patient <> ''
                       AND theirs.state = 'delivered' AND coalesce(theirs.code, '') NOT IN {UNWANTED})"
    )
}
