//! The erasure of a person from the journal: their id is in no row, no free page and no log of it afterwards.
//!
//! Rows of the history are never removed for this: the id in them gives way to a word. As each row's hash
//! covers its text, all hashes from the first changed row on are made again, and so is the head that the
//! state folder and the stores keep of the history. Until such a head is written and durable, a note in the
//! journal states that the head found there is of the earlier history.

mod person;
#[cfg(test)]
mod tests;

use rusqlite::{Connection, Transaction, params};
use serde_json::{Value, json};

use super::deliveries::finish_if_done;
use super::history::HeadFile;
use super::integrity::seal;
use super::meta::{fact, forget_fact, note_fact};
use super::row::{all, json_cell, run, scan_id, value};
use super::{Event, Journal, JournalError, captures, history, withdrawal};
use gaiter_flow::ScanId;
use gaiter_flow::patient::erasure::{ERASED, names};
use gaiter_flow::round::Named;
pub use person::ScanOfPerson;

/// Prefix for places whose head of the history is older than the last erasure: a store, or the state folder.
const OLD_HEAD: &str = "old-head:";

/// The state folder, as a place of a head.
const OWN: &str = "";

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
                    run(transaction, &gone, [scan.as_str()])?;
                }
                let over = "UPDATE captures SET state = 'over' WHERE scan = ?1";
                run(transaction, over, [scan.as_str()])?;
            }
            leave_shared(transaction, patient)?;
            forget_paths(transaction, patient)?;
            leave_captures(transaction, patient)?;
            if rewrite(transaction, patient)? {
                for place in stores.iter().chain(&[OWN]) {
                    note_fact(transaction, &format!("{OLD_HEAD}{place}"))?;
                }
            }
            history::append(transaction, None, Event::Erased, detail)
        })?;
        renew_own_head(&self.connection(), &self.head)
    }

    /// Writes the whole journal again and empties its log: what was removed is in neither. No other process
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

    /// Whether the head that a store keeps belongs to the history before an erasure.
    pub fn has_old_head(&self, store: &str) -> Result<bool, JournalError> {
        Ok(self.fact(&format!("{OLD_HEAD}{store}"))?.is_some())
    }

    /// Notes that a store keeps a new head, durably.
    pub fn head_renewed(&self, store: &str) -> Result<(), JournalError> {
        forget_fact(&self.connection(), &format!("{OLD_HEAD}{store}")).map(drop)
    }
}

/// Writes the head in the state folder if it belongs to the history before an erasure.
pub(super) fn renew_own_head(connection: &Connection, head: &HeadFile) -> Result<(), JournalError> {
    let own = format!("{OLD_HEAD}{OWN}");
    if fact(connection, &own, |_| Some(()))?.is_some() {
        if let Some(newest) = history::newest(connection)? {
            head.write_durably(&newest).map_err(JournalError::Head)?;
        }
        forget_fact(connection, &own)?;
    }
    Ok(())
}

/// Takes the person from scans that belong to others, too, or may. Beside other candidates of a held scan a word
/// stays: that it may be an erased person's.
fn leave_shared(transaction: &Transaction<'_>, patient: &str) -> Result<(), JournalError> {
    hold_for_others(transaction, patient)?;
    let gone = "DELETE FROM deliveries WHERE patient = ?1 RETURNING sha256";
    let mut shared = all(transaction, gone, [patient], |row| scan_id(row, 0))?;
    let named = format!(
        "UPDATE scans SET candidates = CASE
           WHEN EXISTS (SELECT 1 FROM json_each(candidates) WHERE value NOT IN (?1, '{ERASED}'))
           THEN json_insert((SELECT json_group_array(value) FROM json_each(candidates)
                             WHERE value NOT IN (?1, '{ERASED}')), '$[#]', '{ERASED}')
           ELSE '[]' END
         WHERE EXISTS (SELECT 1 FROM json_each(candidates) WHERE value = ?1) RETURNING sha256"
    );
    shared.extend(all(transaction, &named, [patient], |row| scan_id(row, 0))?);
    shared.sort();
    shared.dedup();
    for scan in shared {
        withdrawal::apply(transaction, &scan)?;
        finish_if_done(transaction, &scan)?;
    }
    Ok(())
}

/// A scan that is held for the person and may be another's stays held, for no one by name.
fn hold_for_others(transaction: &Transaction<'_>, patient: &str) -> Result<(), JournalError> {
    let held: Vec<(String, String)> = all(
        transaction,
        "SELECT sha256, store FROM deliveries JOIN scans USING (sha256)
         WHERE patient = ?1 AND deliveries.state = 'held'
               AND EXISTS (SELECT 1 FROM json_each(candidates) WHERE value <> ?1)
               AND NOT EXISTS (SELECT 1 FROM deliveries AS others
                               WHERE others.sha256 = scans.sha256 AND others.patient <> ?1
                                     AND others.state = 'held')",
        [patient],
        |row| Ok((row.get(0)?, row.get(1)?)),
    )?;
    for (scan, store) in held {
        let seal = seal::of_cells(&[scan.as_str(), "", &store, "[]"]);
        transaction.execute(
            "UPDATE OR IGNORE deliveries SET patient = '', sources = '[]', seal = ?4
             WHERE sha256 = ?1 AND patient = ?2 AND store = ?3",
            [&scan, patient, &store, &seal],
        )?;
    }
    Ok(())
}

/// Forgets files whose paths name the person. If one is still there it is read again: then its hash
/// identifies it.
fn forget_paths(transaction: &Transaction<'_>, patient: &str) -> Result<(), JournalError> {
    for table in ["sightings", "orders"] {
        let paths = format!("SELECT path FROM {table}");
        let paths: Vec<Vec<u8>> = all(transaction, &paths, [], |row| Ok(row.get(0)?))?;
        for path in paths.iter().filter(|path| names(path, patient)) {
            run(transaction, &format!("DELETE FROM {table} WHERE path = ?1"), [path])?;
        }
    }
    Ok(())
}

/// Ends the waits for the person's scans, and takes the person from those that are over.
fn leave_captures(transaction: &Transaction<'_>, patient: &str) -> Result<(), JournalError> {
    if captures::names_patient(transaction, patient)? {
        captures::clear_names(transaction)?;
    }
    type Row = (i64, String, String, Vec<Named>);
    let rows: Vec<Row> = all(
        transaction,
        "SELECT number, iif(patient = ?1, '', patient), iif(patient = ?1, 'null', source), candidates
         FROM captures
         WHERE patient = ?1 OR EXISTS (SELECT 1 FROM json_each(candidates)
                                       WHERE json_extract(value, '$.id') = ?1)",
        [patient],
        |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?, json_cell(row, 3)?)),
    )?;
    for (number, id, source, mut named) in rows {
        named.retain(|named| named.id != patient);
        let others = json!(named).to_string();
        let seal = seal::of_cells(&["capture", &number.to_string(), &id, &source, &others]);
        transaction.execute(
            "UPDATE captures SET patient = ?2, source = ?3, candidates = ?4, seal = ?5,
                    state = CASE state WHEN 'open' THEN 'over' WHEN 'expired' THEN 'over' ELSE state END
             WHERE number = ?1",
            params![number, id, source, others, seal],
        )?;
    }
    Ok(())
}

/// A row of the history: number, time, scan, event, details as text and as values, hash.
type Row = (i64, String, String, String, String, Value, String);

/// Takes the person from the details of the history, and makes the hashes again from there on. Returns
/// whether a row changed.
fn rewrite(transaction: &Transaction<'_>, patient: &str) -> Result<bool, JournalError> {
    let written = json!(patient).to_string();
    let first = "SELECT min(seq) FROM history WHERE instr(detail, ?1) > 0";
    let first: Option<i64> = value(transaction, first, [written.trim_matches('"')])?;
    let Some(first) = first else { return Ok(false) };
    let rows: Vec<Row> = all(
        transaction,
        "SELECT seq, at, scan, event, detail, hash FROM history WHERE seq >= ?1 ORDER BY seq",
        [first],
        |row| {
            let text = |at| row.get::<_, String>(at);
            let details = json_cell(row, 4)?;
            Ok((row.get(0)?, text(1)?, text(2)?, text(3)?, text(4)?, details, text(5)?))
        },
    )?;
    let mut before = history::hash_of(transaction, first - 1)?.unwrap_or_default();
    let mut has_changed = false;
    transaction.execute_batch("DROP TRIGGER history_is_not_changed")?;
    for (seq, at, scan, event, detail, mut details, hash) in rows {
        let is_named = redact(&mut details, patient);
        has_changed |= is_named;
        if !has_changed {
            before = hash;
            continue;
        }
        let detail = if is_named { details.to_string() } else { detail };
        let hash = history::hash([&before, &seq.to_string(), &at, &scan, &event, &detail]);
        let written = "UPDATE history SET detail = ?2, hash = ?3 WHERE seq = ?1";
        run(transaction, written, params![seq, detail, hash])?;
        before = hash;
    }
    transaction.execute_batch(history::NOT_CHANGED)?;
    Ok(has_changed)
}

/// Puts a word in the place of an id wherever it is a whole text, and drops it from lists. Returns whether
/// there was one.
fn redact(value: &mut Value, id: &str) -> bool {
    match value {
        Value::String(text) if text == id => {
            ERASED.clone_into(text);
            true
        }
        Value::Array(values) => {
            let before = values.len();
            values.retain(|value| !is_of(value, id));
            let is_shorter = values.len() != before;
            values.iter_mut().fold(is_shorter, |found, value| redact(value, id) | found)
        }
        Value::Object(fields) => {
            fields.values_mut().fold(false, |found, value| redact(value, id) | found)
        }
        _ => false,
    }
}

/// Whether an element of a list is the id, or a patient with it.
fn is_of(value: &Value, id: &str) -> bool {
    value.as_str() == Some(id) || value.get("id").and_then(Value::as_str) == Some(id)
}
