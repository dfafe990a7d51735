//! The journal's tables.

use std::collections::BTreeMap;

use rusqlite::{Connection, TransactionBehavior};

use super::row::all;
use super::{JournalError, disposition, history, meta};

/// The schema this gaiter reads and writes, in `PRAGMA user_version`. An empty file has none: 0.
pub(super) const KNOWN: i64 = 1;

/// The tables, their indexes and triggers, except what [`history`] makes again at times.
///
/// Scans: `changed_at` is the time of the last change of state. `crashes` counts measurements that ended without a
/// result since the last that had one. `pressed_at` is the press that the scan answered. `geometry` is the
/// fingerprint of its points and triangles, '' if nothing was read. `candidates` are the ids of the patients that a
/// held scan, or the export of a capture, may belong to, as JSON. `closed` states why a refused scan needs no
/// further decision: `given-up`, `superseded` or `let-go`. `incomplete`: its record lacks measures that must be
/// taken by hand, or the patient should be scanned again. `disposition`: what became of the scan, as flow decides
/// from the scan and its deliveries.
///
/// Deliveries: `patient` is '' if no patient was named. `sources` is JSON. `next_at` shows operators when the
/// next attempt is due; the station itself uses its monotonic clock. `amended` of a delivery that was made:
/// whether a later revision is to be handed over; '' if not. `places` are those where a server has the record, or
/// may have it, each with its receipt, as JSON.
///
/// Sightings: `stamp` is JSON. `same_as` is the earlier scan whose points and triangles the file has in other bytes.
///
/// `meta` holds what the station must remember about itself, one fact per row.
///
/// Captures are the presses of the button, and without a button the names that were given. `boot` is the
/// machine start that `opened_ms` and `until_ms` refer to. `patient` is '' if no patient was
/// named. `source`, how the patient was named, and `doubt` are JSON. `refused`: the export that answered it was
/// refused, and another is awaited.
///
/// `looks` holds what the looks at each folder know about files that are not taken in yet, as JSON; `boot` as in
/// `captures`. `orders` are handled orders that are still in their folder, each with its size, time and digest as JSON.
///
/// A `seal` protects the cells that hold whose scan it is and where its record goes.
const TABLES_SQL: &str = "
CREATE TABLE scans (
    sha256      TEXT PRIMARY KEY,
    format      TEXT NOT NULL,
    size        INTEGER NOT NULL,
    first_seen  TEXT NOT NULL,
    file_time   TEXT,
    pressed_at  TEXT,
    state       TEXT NOT NULL,
    code        TEXT,
    message     TEXT,
    changed_at  TEXT,
    crashes     INTEGER NOT NULL DEFAULT 0,
    geometry    TEXT NOT NULL DEFAULT '',
    candidates  TEXT NOT NULL DEFAULT '[]',
    closed      TEXT,
    incomplete  INTEGER NOT NULL DEFAULT 0,
    disposition TEXT NOT NULL DEFAULT 'spooled',
    seal        TEXT NOT NULL
) STRICT;
CREATE INDEX scans_by_state ON scans (state);
CREATE INDEX scans_by_geometry ON scans (geometry);
CREATE INDEX scans_by_first_seen ON scans (first_seen);
CREATE INDEX scans_by_disposition ON scans (disposition, first_seen);
CREATE TABLE deliveries (
    sha256     TEXT NOT NULL REFERENCES scans (sha256),
    patient    TEXT NOT NULL,
    store      TEXT NOT NULL,
    sources    TEXT NOT NULL,
    state      TEXT NOT NULL,
    code       TEXT,
    changed_at TEXT,
    attempts   INTEGER NOT NULL DEFAULT 0,
    next_at    TEXT,
    folder     TEXT,
    amended    TEXT NOT NULL DEFAULT '',
    places     TEXT NOT NULL DEFAULT '{}',
    seal       TEXT NOT NULL,
    PRIMARY KEY (sha256, patient, store)
) STRICT;
CREATE INDEX deliveries_by_state ON deliveries (state);
CREATE INDEX deliveries_by_patient ON deliveries (patient);
CREATE INDEX deliveries_amended ON deliveries (amended) WHERE amended <> '';
CREATE TABLE sightings (
    path    BLOB PRIMARY KEY,
    stamp   TEXT NOT NULL,
    sha256  TEXT,
    same_as TEXT
) STRICT;
CREATE TABLE meta (
    name  TEXT PRIMARY KEY,
    value TEXT NOT NULL
) STRICT;
CREATE TABLE history (
    seq    INTEGER PRIMARY KEY,
    at     TEXT NOT NULL,
    scan   TEXT NOT NULL,
    event  TEXT NOT NULL,
    detail TEXT NOT NULL,
    hash   TEXT NOT NULL
) STRICT;
CREATE INDEX history_by_scan ON history (scan);
CREATE TABLE captures (
    number     INTEGER PRIMARY KEY,
    at         TEXT NOT NULL,
    boot       TEXT NOT NULL,
    opened_ms  INTEGER NOT NULL,
    until_ms   INTEGER NOT NULL,
    opener     TEXT NOT NULL,
    patient    TEXT NOT NULL,
    source     TEXT NOT NULL,
    state      TEXT NOT NULL,
    candidates TEXT NOT NULL,
    refused    INTEGER NOT NULL,
    doubt      TEXT NOT NULL,
    scan       TEXT NOT NULL DEFAULT '',
    seal       TEXT NOT NULL
) STRICT;
CREATE INDEX captures_by_state ON captures (state);
CREATE TABLE looks (
    folder BLOB PRIMARY KEY,
    boot   TEXT NOT NULL,
    memory TEXT NOT NULL
) STRICT;
CREATE TABLE orders (
    path  BLOB PRIMARY KEY,
    state TEXT NOT NULL
) STRICT;
";

/// The tables' names.
pub(super) const TABLES: [&str; 8] =
    ["scans", "deliveries", "sightings", "meta", "history", "captures", "looks", "orders"];

/// Creates the tables in a new journal.
///
/// # Errors
/// [`JournalError::Schema`] for a journal of another version, which is left as it is;
/// [`JournalError::Damaged`] if what is there does not match its schema.
pub fn establish(connection: &mut Connection, is_anew: bool) -> Result<(), JournalError> {
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let found: i64 = transaction.pragma_query_value(None, "user_version", |row| row.get(0))?;
    match found {
        KNOWN => check(&transaction)?,
        0 => {
            if !objects(&transaction)?.is_empty() {
                let found = "it has tables and no schema".to_owned();
                return Err(JournalError::Damaged { found });
            }
            create(&transaction)?;
            if is_anew {
                meta::note_fact(&transaction, meta::TO_FILL)?;
            }
            transaction.pragma_update(None, "user_version", KNOWN)?;
            let detail = serde_json::json!({ "schema": KNOWN });
            history::append(&transaction, None, history::Event::Schema, &detail)?;
        }
        found => return Err(JournalError::Schema { found, known: KNOWN }),
    }
    disposition::decide_all(&transaction)?;
    Ok(transaction.commit()?)
}

fn create(connection: &Connection) -> Result<(), JournalError> {
    for sql in [TABLES_SQL, history::NOT_CHANGED, history::NOT_CUT] {
        connection.execute_batch(sql)?;
    }
    Ok(())
}

/// Checks that a journal has the tables, indexes and triggers as they were created. Added ones are no damage.
pub(super) fn check(connection: &Connection) -> Result<(), JournalError> {
    let found = objects(connection)?;
    let pattern = Connection::open_in_memory()?;
    create(&pattern)?;
    for (name, wanted) in objects(&pattern)? {
        if found.get(&name) != Some(&wanted) {
            let found = format!("{name} does not match schema {KNOWN}");
            return Err(JournalError::Damaged { found });
        }
    }
    Ok(())
}

/// What a schema consists of: the SQL that creates each object, by its name, without blanks.
fn objects(connection: &Connection) -> Result<BTreeMap<String, String>, JournalError> {
    let objects = "SELECT name, sql FROM sqlite_schema WHERE sql IS NOT NULL";
    let objects: Vec<(String, String)> = all(connection, objects, [], |row| {
        let sql: String = row.get(1)?;
        Ok((row.get(0)?, sql.split_whitespace().collect()))
    })?;
    Ok(objects.into_iter().collect())
}
