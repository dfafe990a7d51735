//! The erasure of a person from the journal: their id is in no row, no free page and no log of it afterwards.
//!
//! Rows of the history are never removed for this: the id in them gives way to a word. As each row's hash
//! covers its text, all hashes from the first changed row on are made anew, and so is the head that the state
//! folder and the stores keep of the history. Until such a head is written and durable, a note in the journal
//! says that the one which is found there is of the history as it was.

mod person;
mod redact;
#[cfg(test)]
mod tests;

use rusqlite::{Connection, Transaction, params};
use serde_json::{Value, json};

use super::deliveries::finish_if_done;
use super::integrity::seal;
use super::{Event, Journal, JournalError, captures, cell, history, json_cell, withdrawal};
use gaiter_flow::ScanId;
use gaiter_flow::patient::erasure::{ERASED, names};
use gaiter_flow::round::Named;
pub use person::Theirs;
use redact::redact;

/// Prefix for places whose head of the history is older than the last erasure: a store, or the state folder.
const OLD_HEAD: &str = "old-head:";

/// The state folder, as a place of a head.
const OWN: &str = "";

/// What is to be erased.
#[derive(Debug, Clone, Copy)]
pub struct Erasing<'a> {
    /// The patient's id.
    pub patient: &'a str,
    /// The scans that belong to no one else.
    pub whole: &'a [ScanId],
    /// The stores that keep a head of the history.
    pub stores: &'a [&'a str],
    /// The entry for the history.
    pub detail: &'a Value,
}

impl Journal {
    /// Notes what concerns a person, whom the details must not name.
    pub fn note_of_person(&self, event: Event, detail: &Value) -> Result<(), JournalError> {
        self.change(|transaction| history::append(transaction, None, event, detail))
    }

    /// Removes a person from all tables. A repeated call changes nothing but the history's last entry.
    ///
    /// # Errors
    /// See [`JournalError`]; nothing is changed then.
    pub fn erase(&self, erasing: &Erasing<'_>) -> Result<(), JournalError> {
        let Erasing { patient, whole, stores, detail } = *erasing;
        self.change(|transaction| {
            for scan in whole {
                for table in ["deliveries", "scans", "sightings"] {
                    let gone = format!("DELETE FROM {table} WHERE sha256 = ?1");
                    transaction.execute(&gone, [scan.as_str()])?;
                }
                let over = "UPDATE captures SET state = 'over' WHERE scan = ?1";
                transaction.execute(over, [scan.as_str()])?;
            }
            leave_shared(transaction, patient)?;
            forget_paths(transaction, patient)?;
            leave_captures(transaction, patient)?;
            if rewrite(transaction, patient)? {
                for place in stores.iter().chain(&[OWN]) {
                    transaction.execute(
                        "INSERT INTO meta (name, value) VALUES (?1, '') ON CONFLICT DO NOTHING",
                        [format!("{OLD_HEAD}{place}")],
                    )?;
                }
            }
            history::append(transaction, None, Event::Erased, detail)
        })?;
        self.renew_own_head()
    }

    /// Writes the whole journal anew and empties its log: what was removed is in neither. No other process
    /// must read it meanwhile.
    ///
    /// # Errors
    /// See [`JournalError`]; [`JournalError::Read`] if another process reads it.
    pub fn shred(&self) -> Result<(), JournalError> {
        let connection = self.connection();
        connection.execute_batch("VACUUM")?;
        let is_busy: i64 =
            connection.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |row| row.get(0))?;
        if is_busy == 0 { Ok(()) } else { Err(JournalError::Read) }
    }

    /// Whether the head that a store keeps is of the history as it was before an erasure.
    pub fn has_old_head(&self, store: &str) -> Result<bool, JournalError> {
        Ok(self.fact(&format!("{OLD_HEAD}{store}"))?.is_some())
    }

    /// Notes that a store keeps a new head, durably.
    pub fn head_renewed(&self, store: &str) -> Result<(), JournalError> {
        forget_old_head(&self.connection(), store)
    }

    /// Writes the head in the state folder if it is of the history as it was.
    fn renew_own_head(&self) -> Result<(), JournalError> {
        let connection = self.connection();
        if is_old_head(&connection)? {
            if let Some(head) = history::newest(&connection)? {
                self.head.write_durably(&head).map_err(JournalError::Head)?;
            }
            forget_old_head(&connection, OWN)?;
        }
        Ok(())
    }
}

/// Whether the head in the state folder is of the history as it was before an erasure: a crash came between.
pub(super) fn is_old_head(connection: &Connection) -> Result<bool, JournalError> {
    let mut query =
        connection.prepare_cached("SELECT EXISTS (SELECT 1 FROM meta WHERE name = ?1)")?;
    Ok(query.query_row([format!("{OLD_HEAD}{OWN}")], |row| row.get(0))?)
}

/// Notes that the head of a place is of the history as it is.
pub(super) fn forget_old_head(connection: &Connection, place: &str) -> Result<(), JournalError> {
    let gone = "DELETE FROM meta WHERE name = ?1";
    connection.execute(gone, [format!("{OLD_HEAD}{place}")])?;
    Ok(())
}

/// Takes the person from scans that belong to others, too, or may. Beside other candidates of a held scan a word
/// stays: that it may be an erased person's.
fn leave_shared(transaction: &Transaction<'_>, patient: &str) -> Result<(), JournalError> {
    hold_for_others(transaction, patient)?;
    let mut shared: Vec<String> =
        texts(transaction, "DELETE FROM deliveries WHERE patient = ?1 RETURNING sha256", patient)?;
    let named = format!(
        "UPDATE scans SET candidates = CASE
           WHEN EXISTS (SELECT 1 FROM json_each(candidates) WHERE value NOT IN (?1, '{ERASED}'))
           THEN json_insert((SELECT json_group_array(value) FROM json_each(candidates)
                             WHERE value NOT IN (?1, '{ERASED}')), '$[#]', '{ERASED}')
           ELSE '[]' END
         WHERE EXISTS (SELECT 1 FROM json_each(candidates) WHERE value = ?1) RETURNING sha256"
    );
    shared.extend(texts(transaction, &named, patient)?);
    shared.sort();
    shared.dedup();
    for scan in shared {
        let scan = cell("sha256", scan, ScanId::parse)?;
        withdrawal::apply(transaction, &scan)?;
        finish_if_done(transaction, &scan)?;
    }
    Ok(())
}

/// A scan that is held for the person and may be another's stays held, for no one by name.
fn hold_for_others(transaction: &Transaction<'_>, patient: &str) -> Result<(), JournalError> {
    let held: Vec<(String, String)> = {
        let mut query = transaction.prepare(
            "SELECT sha256, store FROM deliveries JOIN scans USING (sha256)
             WHERE patient = ?1 AND deliveries.state = 'held'
                   AND EXISTS (SELECT 1 FROM json_each(candidates) WHERE value <> ?1)
                   AND NOT EXISTS (SELECT 1 FROM deliveries AS others
                                   WHERE others.sha256 = scans.sha256 AND others.patient <> ?1
                                         AND others.state = 'held')",
        )?;
        let rows = query.query_map([patient], |row| Ok((row.get(0)?, row.get(1)?)))?;
        rows.collect::<rusqlite::Result<_>>()?
    };
    for (scan, store) in held {
        let seal = seal::of_delivery(&scan, "", &store, "[]");
        transaction.execute(
            "UPDATE OR IGNORE deliveries SET patient = '', sources = '[]', seal = ?4
             WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
            [&scan, patient, &store, &seal],
        )?;
    }
    Ok(())
}

fn texts(
    transaction: &Transaction<'_>,
    statement: &str,
    patient: &str,
) -> Result<Vec<String>, JournalError> {
    let mut query = transaction.prepare(statement)?;
    let rows = query.query_map([patient], |row| row.get(0))?;
    Ok(rows.collect::<rusqlite::Result<_>>()?)
}

/// Forgets files whose paths name the person. If one is still there it is read again: then its hash tells.
fn forget_paths(transaction: &Transaction<'_>, patient: &str) -> Result<(), JournalError> {
    for table in ["sightings", "orders"] {
        let named: Vec<Vec<u8>> = {
            let mut query = transaction.prepare(&format!("SELECT path FROM {table}"))?;
            let paths = query.query_map([], |row| row.get(0))?;
            let paths: Vec<Vec<u8>> = paths.collect::<rusqlite::Result<_>>()?;
            paths.into_iter().filter(|path| names(path, patient)).collect()
        };
        for path in named {
            transaction.execute(&format!("DELETE FROM {table} WHERE path = ?1"), [path])?;
        }
    }
    Ok(())
}

/// Ends the waits for the person's scans, and takes the person from those that are over.
fn leave_captures(transaction: &Transaction<'_>, patient: &str) -> Result<(), JournalError> {
    if captures::names_patient(transaction, patient)? {
        captures::clear_names(transaction)?;
    }
    type Row = (i64, String, String, String);
    let rows: Vec<Row> = {
        let mut query = transaction.prepare(
            "SELECT number, patient, source, candidates FROM captures
             WHERE patient = ?1 OR instr(candidates, ?1) > 0",
        )?;
        let rows = query
            .query_map([patient], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?)))?;
        rows.collect::<rusqlite::Result<_>>()?
    };
    for (number, id, source, others) in rows {
        let mut named: Vec<Named> = json_cell("candidates", others)?;
        let is_theirs = id == patient || named.iter().any(|named| named.id == patient);
        if !is_theirs {
            continue;
        }
        named.retain(|named| named.id != patient);
        let (id, source) =
            if id == patient { (String::new(), String::new()) } else { (id, source) };
        let others = json!(named).to_string();
        transaction.execute(
            "UPDATE captures SET patient = ?2, source = ?3, candidates = ?4, seal = ?5,
                    state = CASE state WHEN 'open' THEN 'over' WHEN 'expired' THEN 'over' ELSE state END
             WHERE number = ?1",
            params![number, id, source, others, seal::of_capture(number, &id, &source, &others)],
        )?;
    }
    Ok(())
}

/// A row of the history: number, time, scan, event, details.
type Row = (i64, String, String, String, String);

/// Takes the person from the details of the history, and makes the hashes anew from there on. Returns whether
/// a row changed.
fn rewrite(transaction: &Transaction<'_>, patient: &str) -> Result<bool, JournalError> {
    let written = json!(patient).to_string();
    let first: Option<i64> = transaction.query_row(
        "SELECT min(seq) FROM history WHERE instr(detail, ?1) > 0",
        [written.trim_matches('"')],
        |row| row.get(0),
    )?;
    let Some(first) = first else { return Ok(false) };
    let rows: Vec<Row> = {
        let mut query = transaction.prepare(
            "SELECT seq, at, scan, event, detail FROM history WHERE seq >= ?1 ORDER BY seq",
        )?;
        let rows = query.query_map([first], |row| {
            Ok((row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?, row.get(4)?))
        })?;
        rows.collect::<rusqlite::Result<_>>()?
    };
    let mut before = history::hash_of(transaction, first - 1)?.unwrap_or_default();
    let mut has_changed = false;
    transaction.execute_batch("DROP TRIGGER history_is_not_changed")?;
    for (seq, at, scan, event, detail) in rows {
        let mut details: Value = json_cell("detail", detail.clone())?;
        let is_named = redact(&mut details, patient);
        has_changed |= is_named;
        if !has_changed {
            before = history::hash_of(transaction, seq)?.unwrap_or_default();
            continue;
        }
        let detail = if is_named { details.to_string() } else { detail };
        let hash = history::hash(&before, seq, &at, &scan, &event, &detail);
        transaction
            .prepare_cached("UPDATE history SET detail = ?2, hash = ?3 WHERE seq = ?1")?
            .execute(params![seq, detail, hash])?;
        before = hash;
    }
    transaction.execute_batch(history::NOT_CHANGED)?;
    Ok(has_changed)
}
