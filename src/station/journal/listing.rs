//! Queries of operators and monitors: counts, the oldest scan, lists, everything about one scan.

mod newest;
mod search;

use std::collections::BTreeMap;
use std::io;

use gaiter_flow::account::{Delivered, Filter, Listed, Seen, Summary, Whole};
use gaiter_flow::lifecycle::REVISION_REFUSED;
use gaiter_flow::{Closed, DeliveryState, Disposition, ScanId, ScanState};
use jiff::Timestamp;
use rusqlite::{Connection, OptionalExtension, Row, params};

use super::disposition::is_one_of;
use super::withdrawal::UNWANTED;
use super::withdrawal::places::elsewhere;
use super::{Journal, JournalError, cell};

/// The numbers of scans and deliveries, and the two scans asked for most often.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tally {
    /// Scans by the word of their state; every state is present. Refused scans that need no further
    /// decision are not counted.
    pub scans: BTreeMap<&'static str, u64>,
    /// Scans by the word of what became of them; every one is present.
    pub dispositions: BTreeMap<&'static str, u64>,
    /// Scans of which a person must say whose they are, whatever their own state.
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
        // One transaction, so that all counts are of one moment.
        let viewer = self.viewer();
        let connection = viewer.unchecked_transaction()?;
        let mut scans: BTreeMap<&'static str, u64> =
            ScanState::ALL.into_iter().map(|state| (state.word(), 0)).collect();
        let mut query = connection.prepare_cached(
            "SELECT state, count(*) FROM scans
             WHERE closed IS NULL OR state <> 'refused' GROUP BY state",
        )?;
        for row in query.query_map([], |row| Ok((row.get(0)?, count(row, 1)?)))? {
            let (word, count): (String, u64) = row?;
            scans.insert(cell("state", word, ScanState::of_word)?.word(), count);
        }
        let mut query = connection.prepare_cached(
            "SELECT store, state, count(*) FROM deliveries GROUP BY store, state",
        )?;
        let rows = query.query_map([], |row| Ok(((row.get(0)?, row.get(1)?), count(row, 2)?)))?;
        let deliveries = rows.collect::<Result<_, _>>()?;
        let dispositions = dispositions(&connection)?;
        let held = dispositions.get(Disposition::Held.word()).copied().unwrap_or_default();
        let closed = connection.query_row(
            "SELECT count(*) FROM scans WHERE closed IS NOT NULL",
            [],
            |row| count(row, 0),
        )?;
        let withdrawing = connection.query_row(
            &format!("SELECT count(DISTINCT sha256) FROM deliveries WHERE {}", to_be_taken_back()),
            [],
            |row| count(row, 0),
        )?;
        let oldest = "SELECT sha256, min(first_seen), scans.state, store FROM deliveries
                      JOIN scans USING (sha256) WHERE deliveries.state = ?1 GROUP BY store";
        let mut oldest = connection.prepare_cached(oldest)?;
        let pending = [DeliveryState::Pending.word()];
        let oldest = oldest.query_map(pending, |row| Ok((row.get(3)?, seen(row)?)))?;
        let last = "SELECT sha256, first_seen, state FROM scans
                    ORDER BY first_seen DESC, rowid DESC LIMIT 1";
        let last = connection.prepare_cached(last)?.query_row([], seen).optional()?;
        Ok(Tally {
            scans,
            dispositions,
            held,
            closed,
            withdrawing,
            revisions_refused: revisions_refused(&connection)?,
            moved: elsewhere(&connection)?,
            deliveries,
            oldest: oldest.collect::<Result<_, _>>()?,
            last,
        })
    }

    /// The latest scans, newest first, at most `limit`.
    pub fn list(&self, filter: Option<Filter>, limit: u32) -> Result<Vec<Listed>, JournalError> {
        let viewer = self.viewer();
        let connection = viewer.unchecked_transaction()?;
        let mut query = connection.prepare_cached(&format!(
            "SELECT sha256 FROM scans WHERE {} ORDER BY first_seen DESC, rowid DESC LIMIT ?1",
            of_filter(filter)
        ))?;
        let rows = query.query_map([limit], |row| row.get(0))?;
        let mut list = Vec::new();
        for row in rows {
            let scan = cell("sha256", row?, ScanId::parse)?;
            list.extend(whole(&connection, &scan)?.as_ref().map(Listed::of));
        }
        Ok(list)
    }

    /// The scans whose id begins with these digits, at most `limit`.
    pub fn beginning_with(&self, digits: &str, limit: u32) -> Result<Vec<ScanId>, JournalError> {
        let connection = self.viewer();
        // 'g' follows the last hexadecimal digit.
        let mut query = connection.prepare_cached(
            "SELECT sha256 FROM scans WHERE sha256 >= ?1 AND sha256 < ?1 || 'g' LIMIT ?2",
        )?;
        let rows = query.query_map(params![digits, limit], |row| row.get(0))?;
        rows.map(|row| cell("sha256", row?, ScanId::parse)).collect()
    }

    /// Everything known about a scan except its history and preview; `None` if it was never seen.
    pub fn whole(&self, scan: &ScanId) -> Result<Option<Whole>, JournalError> {
        let viewer = self.viewer();
        whole(&*viewer.unchecked_transaction()?, scan)
    }
}

fn whole(connection: &Connection, scan: &ScanId) -> Result<Option<Whole>, JournalError> {
    let mut query = connection.prepare_cached(
        "SELECT state, first_seen, file_time, format, size, code, message, closed, candidates, incomplete
         FROM scans WHERE sha256 = ?1",
    )?;
    let found = query.query_row([scan.as_str()], |row| {
        let closed: Option<String> = row.get(7)?;
        let summary = Summary {
            state: word(row, 0, ScanState::of_word)?,
            first_seen: time(row, 1)?,
            file_time: time_or_none(row, 2)?,
            format: row.get(3)?,
            size: count(row, 4)?,
            code: row.get(5)?,
            message: row.get(6)?,
            closed: closed.map(|_| word(row, 7, Closed::of_word)).transpose()?,
            incomplete: row.get(9)?,
        };
        Ok((summary, ids(row, 8)?))
    });
    let Some((summary, candidates)) = found.optional()? else { return Ok(None) };
    let mut query = connection.prepare_cached(
        "SELECT patient, store, state, code, attempts, next_at, folder
         FROM deliveries WHERE sha256 = ?1 ORDER BY patient, store",
    )?;
    let rows = query.query_map([scan.as_str()], |row| {
        Ok(Delivered {
            patient: Some(row.get(0)?).filter(|id: &String| !id.is_empty()),
            store: row.get(1)?,
            state: word(row, 2, DeliveryState::of_word)?,
            code: row.get(3)?,
            attempts: count(row, 4)?,
            next_at: time_or_none(row, 5)?,
            folder: row.get(6)?,
        })
    })?;
    let deliveries = rows.collect::<Result<_, _>>()?;
    Ok(Some(Whole {
        scan: scan.to_string(),
        summary,
        deliveries,
        candidates,
        preview: None,
        history: Vec::new(),
    }))
}

/// How many scans became what, each of all dispositions.
fn dispositions(connection: &Connection) -> Result<BTreeMap<&'static str, u64>, JournalError> {
    let mut found: BTreeMap<&'static str, u64> =
        Disposition::ALL.into_iter().map(|is| (is.word(), 0)).collect();
    let mut query = connection
        .prepare_cached("SELECT disposition, count(*) FROM scans GROUP BY disposition")?;
    for row in query.query_map([], |row| Ok((row.get(0)?, count(row, 1)?)))? {
        let (word, count): (String, u64) = row?;
        found.insert(cell("disposition", word, Disposition::of_word)?.word(), count);
    }
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

/// Scans of whose record a store takes no later revision. The index holds the few that were amended.
fn revisions_refused(connection: &Connection) -> rusqlite::Result<u64> {
    let counted = "SELECT count(DISTINCT sha256) FROM deliveries INDEXED BY deliveries_amended
                   WHERE amended <> '' AND state = 'delivered' AND code = ?1";
    connection.prepare_cached(counted)?.query_row([REVISION_REFUSED], |row| count(row, 0))
}

/// What a word stands for that gaiter wrote.
fn word<T>(
    row: &Row<'_>,
    column: usize,
    read: impl FnOnce(&str) -> Option<T>,
) -> rusqlite::Result<T> {
    let word: String = row.get(column)?;
    let unknown = || wrong(column, io::Error::other(format!("the word {word:?} is not known")));
    read(&word).ok_or_else(unknown)
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
fn seen(row: &Row<'_>) -> rusqlite::Result<Seen> {
    let state = word(row, 2, ScanState::of_word)?;
    Ok(Seen { scan: short(row, 0)?, first_seen: time(row, 1)?, state })
}

fn count(row: &Row<'_>, column: usize) -> rusqlite::Result<u64> {
    row.get::<_, i64>(column).map(i64::cast_unsigned)
}

fn short(row: &Row<'_>, column: usize) -> rusqlite::Result<String> {
    let digits: String = row.get(column)?;
    let scan = cell("sha256", digits, ScanId::parse).map_err(|fault| wrong(column, fault))?;
    Ok(scan.short().to_owned())
}

fn time(row: &Row<'_>, column: usize) -> rusqlite::Result<Timestamp> {
    row.get::<_, String>(column)?.parse().map_err(|fault| wrong(column, fault))
}

fn time_or_none(row: &Row<'_>, column: usize) -> rusqlite::Result<Option<Timestamp>> {
    let text: Option<String> = row.get(column)?;
    text.map(|text| text.parse().map_err(|fault| wrong(column, fault))).transpose()
}

/// Patients' ids, stored as JSON.
fn ids(row: &Row<'_>, column: usize) -> rusqlite::Result<Vec<String>> {
    let text: String = row.get(column)?;
    serde_json::from_slice(text.as_bytes()).map_err(|fault| wrong(column, fault))
}

/// The error for a cell that holds what gaiter never writes.
fn wrong(column: usize, fault: impl std::error::Error + Send + Sync + 'static) -> rusqlite::Error {
    rusqlite::Error::FromSqlConversionFailure(column, rusqlite::types::Type::Text, Box::new(fault))
}

#[cfg(test)]
mod tests;
