//! Queries of operators and monitors: counts, the oldest scan, lists, everything about one scan.

mod newest;
mod search;

use std::collections::BTreeMap;

use gaiter_flow::account::{Delivered, Filter, Listed, Seen, Summary, Whole};
use gaiter_flow::lifecycle::REVISION_REFUSED;
use gaiter_flow::{Closed, DeliveryState, Disposition, ScanId, ScanState};
use rusqlite::{Connection, Row, params};

use super::disposition::is_one_of;
use super::row::{all, cell, count, first, if_any, json_cell, patient_id, scan_id, time, value};
use super::withdrawal::UNWANTED;
use super::withdrawal::places::elsewhere;
use super::{Journal, JournalError};

/// The numbers of scans and deliveries, and the two scans asked for most often.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Tally {
    /// Scans by the word of their state; every state is present. Refused scans that need no further
    /// decision are not counted.
    pub scans: BTreeMap<&'static str, u64>,
    /// Scans by the word of what became of them; every one is present.
    pub dispositions: BTreeMap<&'static str, u64>,
    /// Scans for which a person must decide whose they are, whatever their own state.
    pub held: u64,
    /// Refused or held scans that need no further decision.
    pub closed: u64,
    /// Scans with a record that is, or may be, in a place from which it must be withdrawn.
    pub withdrawing: u64,
    /// Scans of whose record a store takes no later revision.
    pub revisions_refused: u64,
    /// By store, records that are to be withdrawn, and are at an earlier address of it.
    pub moved: BTreeMap<String, u64>,
    /// Deliveries by store and the word of their state; only combinations that occur.
    pub deliveries: BTreeMap<(String, String), u64>,
    /// Of each store, the oldest scan whose record it waits for.
    pub oldest: BTreeMap<String, Seen>,
    /// The latest scan.
    pub last: Option<Seen>,
}

impl Journal {
    /// Counts of everything, the oldest waiting scan, and the latest scan.
    pub fn tally(&self) -> Result<Tally, JournalError> {
        // One transaction, so that all counts belong to one moment.
        let viewer = self.viewer();
        let connection = viewer.unchecked_transaction()?;
        let mut scans: BTreeMap<&'static str, u64> =
            ScanState::ALL.into_iter().map(|state| (state.word(), 0)).collect();
        scans.extend(all(
            &connection,
            "SELECT state, count(*) FROM scans
             WHERE closed IS NULL OR state <> 'refused' GROUP BY state",
            [],
            |row| Ok((cell(row, 0, ScanState::of_word)?.word(), count(row, 1)?)),
        )?);
        let deliveries = all(
            &connection,
            "SELECT store, state, count(*) FROM deliveries GROUP BY store, state",
            [],
            |row| Ok(((row.get(0)?, row.get(1)?), count(row, 2)?)),
        )?;
        let dispositions = dispositions(&connection)?;
        let held = dispositions.get(Disposition::Held.word()).copied().unwrap_or_default();
        let count_of = |sql: &str| value(&connection, sql, []).map(i64::cast_unsigned);
        let withdrawing =
            format!("SELECT count(DISTINCT sha256) FROM deliveries WHERE {}", to_be_taken_back());
        // The index holds the few that were amended.
        let revisions_refused = format!(
            "SELECT count(DISTINCT sha256) FROM deliveries INDEXED BY deliveries_amended
             WHERE amended <> '' AND state = 'delivered' AND code = '{REVISION_REFUSED}'"
        );
        let oldest = "SELECT sha256, min(first_seen), scans.state, store FROM deliveries
                      JOIN scans USING (sha256) WHERE deliveries.state = ?1 GROUP BY store";
        let pending = [DeliveryState::Pending.word()];
        let oldest = all(&connection, oldest, pending, |row| Ok((row.get(3)?, seen(row)?)))?;
        let last = "SELECT sha256, first_seen, state FROM scans
                    ORDER BY first_seen DESC, rowid DESC LIMIT 1";
        Ok(Tally {
            scans,
            dispositions,
            held,
            closed: count_of("SELECT count(*) FROM scans WHERE closed IS NOT NULL")?,
            withdrawing: count_of(&withdrawing)?,
            revisions_refused: count_of(&revisions_refused)?,
            moved: elsewhere(&connection)?,
            deliveries: deliveries.into_iter().collect(),
            oldest: oldest.into_iter().collect(),
            last: first(&connection, last, [], seen)?,
        })
    }

    /// The latest scans, newest first, at most `limit`.
    pub fn list(&self, filter: Option<Filter>, limit: u32) -> Result<Vec<Listed>, JournalError> {
        let latest = self.scans_by(&of_filter(filter), "", limit)?;
        let found = latest.iter().map(|scan| self.whole(scan)).collect::<Result<Vec<_>, _>>()?;
        Ok(found.iter().flatten().map(Listed::from_whole).collect())
    }

    /// The scans whose id begins with these digits, at most `limit`.
    pub fn beginning_with(&self, digits: &str, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        // 'g' follows the last hexadecimal digit.
        let found = "SELECT sha256 FROM scans WHERE sha256 >= ?1 AND sha256 < ?1 || 'g' LIMIT ?2";
        all(&self.viewer(), found, params![digits, limit], |row| scan_id(row, 0))
    }

    /// Everything known about a scan except its history and preview; `None` if it was never seen.
    pub fn whole(&self, scan: &ScanId) -> Result<Option<Whole>, JournalError> {
        let viewer = self.viewer();
        whole(&*viewer.unchecked_transaction()?, scan)
    }
}

fn whole(connection: &Connection, scan: &ScanId) -> Result<Option<Whole>, JournalError> {
    let found = first(
        connection,
        "SELECT state, first_seen, file_time, format, size, code, message, closed, candidates, incomplete
         FROM scans WHERE sha256 = ?1",
        [scan.as_str()],
        |row| {
            let summary = Summary {
                state: cell(row, 0, ScanState::of_word)?,
                first_seen: time(row, 1)?,
                file_time: if_any(row, 2, time)?,
                format: row.get(3)?,
                size: count(row, 4)?,
                code: row.get(5)?,
                message: row.get(6)?,
                closed: if_any(row, 7, |row, column| cell(row, column, Closed::of_word))?,
                incomplete: row.get(9)?,
            };
            Ok((summary, json_cell(row, 8)?))
        },
    )?;
    let Some((summary, candidates)) = found else { return Ok(None) };
    let deliveries = all(
        connection,
        "SELECT patient, store, state, code, attempts, next_at, folder
         FROM deliveries WHERE sha256 = ?1 ORDER BY patient, store",
        [scan.as_str()],
        |row| {
            Ok(Delivered {
                patient: patient_id(row, 0)?,
                store: row.get(1)?,
                state: cell(row, 2, DeliveryState::of_word)?,
                code: row.get(3)?,
                attempts: count(row, 4)?,
                next_at: if_any(row, 5, time)?,
                folder: row.get(6)?,
            })
        },
    )?;
    let (scan, history) = (scan.to_string(), Vec::new());
    Ok(Some(Whole { scan, summary, deliveries, candidates, preview: None, history }))
}

/// How many scans became what, each of all dispositions.
fn dispositions(connection: &Connection) -> Result<BTreeMap<&'static str, u64>, JournalError> {
    let mut found: BTreeMap<&'static str, u64> =
        Disposition::ALL.into_iter().map(|is| (is.word(), 0)).collect();
    let counted = "SELECT disposition, count(*) FROM scans GROUP BY disposition";
    found.extend(all(connection, counted, [], |row| {
        Ok((cell(row, 0, Disposition::of_word)?.word(), count(row, 1)?))
    })?);
    Ok(found)
}

/// SQL: a scan passes this filter.
fn of_filter(filter: Option<Filter>) -> String {
    let in_state = |state: ScanState| format!("state = '{}'", state.word());
    match filter {
        None => "TRUE".to_owned(),
        Some(Filter::Spooled) => in_state(ScanState::Spooled),
        Some(Filter::Delivered) => in_state(ScanState::Delivered),
        Some(Filter::Refused) => in_state(ScanState::Refused),
        Some(Filter::Held) => is_one_of(|found| found == Disposition::Held),
        Some(Filter::Unassigned) => is_one_of(Disposition::is_unassigned),
    }
}

/// SQL: a delivery whose record is to be withdrawn from a store that has, or is to have, the right
/// record. An unwanted record in a store that gets no replacement is left to the operator.
fn to_be_taken_back() -> String {
    format!(
        "(deliveries.state = 'withdrawing' OR deliveries.state = 'delivered'
              AND deliveries.code IN {UNWANTED}
              AND EXISTS (SELECT 1 FROM deliveries AS coming
                          WHERE coming.sha256 = deliveries.sha256
                                AND coming.store = deliveries.store
                                AND coming.state IN ('pending', 'refused')))"
    )
}

/// The first scan of a query on pending deliveries, or on all scans.
fn seen(row: &Row<'_>) -> Result<Seen, JournalError> {
    let (scan, state) = (scan_id(row, 0)?.short().to_owned(), cell(row, 2, ScanState::of_word)?);
    Ok(Seen { scan, first_seen: time(row, 1)?, state })
}

#[cfg(test)]
mod tests;
