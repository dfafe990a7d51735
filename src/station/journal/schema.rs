//! The journal's tables, and the migration of older ones.

use std::collections::BTreeMap;

use rusqlite::{Connection, Transaction, TransactionBehavior};

use super::integrity::seal;
use super::{JournalError, captures, disposition, history, meta};

/// The schema this gaiter reads and writes, in `PRAGMA user_version`: one per step of [`STEPS`].
pub(super) const KNOWN: i64 = STEPS.len() as i64;

/// A step from one schema to the next.
type Step = fn(&Transaction<'_>) -> Result<(), JournalError>;

/// From an empty file to the current schema. A released step is never changed.
const STEPS: [Step; 8] = [
    |transaction| Ok(transaction.execute_batch(FIRST)?),
    |transaction| {
        transaction.execute_batch(SECOND)?;
        transaction.execute_batch(history::NOT_CUT)?;
        seal::seal_all(transaction)
    },
    |transaction| Ok(transaction.execute_batch(THIRD)?),
    |transaction| {
        transaction.execute_batch(FOURTH)?;
        captures::upgrade(transaction)
    },
    |transaction| Ok(transaction.execute_batch(FIFTH)?),
    |transaction| Ok(transaction.execute_batch(SIXTH)?),
    |transaction| Ok(transaction.execute_batch(SEVENTH)?),
    |transaction| Ok(transaction.execute_batch(EIGHTH)?),
];

/// `patient` is '' if no patient was named. `sources` is JSON. `next_at` tells operators when the next
/// attempt is due; the station itself uses its monotonic clock.
const FIRST: &str = "
CREATE TABLE scans (
    sha256     TEXT PRIMARY KEY,
    format     TEXT NOT NULL,
    size       INTEGER NOT NULL,
    first_seen TEXT NOT NULL,
    file_time  TEXT,
    state      TEXT NOT NULL,
    code       TEXT,
    message    TEXT
) STRICT;
CREATE INDEX scans_by_state ON scans (state);
CREATE TABLE deliveries (
    sha256   TEXT NOT NULL REFERENCES scans (sha256),
    patient  TEXT NOT NULL,
    store    TEXT NOT NULL,
    sources  TEXT NOT NULL,
    state    TEXT NOT NULL,
    code     TEXT,
    attempts INTEGER NOT NULL DEFAULT 0,
    next_at  TEXT,
    folder   TEXT,
    PRIMARY KEY (sha256, patient, store)
) STRICT;
CREATE INDEX deliveries_by_state ON deliveries (state);
CREATE TABLE sightings (
    path   BLOB PRIMARY KEY,
    stamp  TEXT NOT NULL,
    sha256 TEXT
) STRICT;
";

/// `crashes` counts measurements of the scan that ended without a result. `changed_at` is the time of
/// the last change of state. `seal` protects the cells that say whose scan it is and where its record
/// goes. `meta` holds what the station must remember about itself, one fact per row.
const SECOND: &str = "
ALTER TABLE scans ADD COLUMN crashes INTEGER NOT NULL DEFAULT 0;
ALTER TABLE scans ADD COLUMN changed_at TEXT;
ALTER TABLE scans ADD COLUMN seal TEXT NOT NULL DEFAULT '';
UPDATE scans SET changed_at = first_seen;
ALTER TABLE deliveries ADD COLUMN changed_at TEXT;
ALTER TABLE deliveries ADD COLUMN seal TEXT NOT NULL DEFAULT '';
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
CREATE TRIGGER history_is_not_changed BEFORE UPDATE ON history
BEGIN SELECT RAISE(ABORT, 'the history is append-only'); END;
";

/// `captures` are the presses of the button, and without a button the names that were given. `boot` is
/// the machine start that `opened_ms` and `until_ms` refer to. `patient` and `source` are '' if no
/// patient was named. `seal` protects whose scan it is. `pressed_at` of a scan is the press it answered.
const THIRD: &str = "
ALTER TABLE scans ADD COLUMN pressed_at TEXT;
CREATE TABLE captures (
    number    INTEGER PRIMARY KEY,
    at        TEXT NOT NULL,
    boot      TEXT NOT NULL,
    opened_ms INTEGER NOT NULL,
    until_ms  INTEGER NOT NULL,
    opener    TEXT NOT NULL,
    patient   TEXT NOT NULL,
    source    TEXT NOT NULL,
    state     TEXT NOT NULL,
    shared    INTEGER NOT NULL DEFAULT 0,
    scan      TEXT NOT NULL DEFAULT '',
    seal      TEXT NOT NULL
) STRICT;
CREATE INDEX captures_by_state ON captures (state);
";

/// `geometry` is the fingerprint of a scan's points and triangles, '' if nothing was read. `candidates` are
/// the ids of the patients that a held scan, or the export of a capture, may belong to, as JSON.
/// `closed` says why a refused scan needs no further decision: `given-up`, `superseded` or `let-go`.
/// `refused` of a capture: the export that answered it was refused, and another is awaited. `looks`
/// holds what the looks at each folder know about files that are not taken in yet, as JSON; `boot` and
/// `looked_ms` as in `captures`. `orders` are handled orders that are still in their folder.
const FOURTH: &str = "
ALTER TABLE scans ADD COLUMN geometry TEXT NOT NULL DEFAULT '';
ALTER TABLE scans ADD COLUMN candidates TEXT NOT NULL DEFAULT '[]';
ALTER TABLE scans ADD COLUMN closed TEXT;
CREATE INDEX scans_by_geometry ON scans (geometry);
ALTER TABLE captures ADD COLUMN candidates TEXT NOT NULL DEFAULT '[]';
ALTER TABLE captures ADD COLUMN refused INTEGER NOT NULL DEFAULT 0;
ALTER TABLE captures ADD COLUMN doubt TEXT NOT NULL DEFAULT '';
UPDATE captures SET doubt = 'shared' WHERE shared = 1;
UPDATE captures SET state = 'over' WHERE state = 'called_off';
CREATE TABLE looks (
    folder    BLOB PRIMARY KEY,
    boot      TEXT NOT NULL,
    looked_ms INTEGER,
    files     TEXT NOT NULL
) STRICT;
CREATE TABLE orders (
    path     BLOB PRIMARY KEY,
    size     INTEGER NOT NULL,
    mtime_ns TEXT NOT NULL,
    digest   TEXT NOT NULL
) STRICT;
";

/// `incomplete` of a scan: its record lacks measures that must be taken by hand, or the patient should be
/// scanned again. The indexes serve the search by patient and time, and the list of unassigned records.
const FIFTH: &str = "
ALTER TABLE scans ADD COLUMN incomplete INTEGER NOT NULL DEFAULT 0;
CREATE INDEX scans_by_first_seen ON scans (first_seen);
CREATE INDEX deliveries_by_patient ON deliveries (patient);
";

/// `amended` of a delivery that was made: whether a later revision is to be handed over; '' if not.
const SIXTH: &str = "
ALTER TABLE deliveries ADD COLUMN amended TEXT NOT NULL DEFAULT '';
CREATE INDEX deliveries_amended ON deliveries (amended) WHERE amended <> '';
";

/// `same_as` of a sighting: the earlier scan whose points and triangles the file has in other bytes.
const SEVENTH: &str = "
ALTER TABLE sightings ADD COLUMN same_as TEXT;
";

/// `disposition`: what became of the scan, as flow decides from the scan and its deliveries.
const EIGHTH: &str = "
ALTER TABLE scans ADD COLUMN disposition TEXT NOT NULL DEFAULT 'spooled';
CREATE INDEX scans_by_disposition ON scans (disposition, first_seen);
";

/// The tables of the current schema.
pub(super) const TABLES: [&str; 8] =
    ["scans", "deliveries", "sightings", "meta", "history", "captures", "looks", "orders"];

/// Creates the tables in a new journal, and converts an older one to the current schema.
pub fn establish(connection: &mut Connection, is_anew: bool) -> Result<(), JournalError> {
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let found: i64 = transaction.pragma_query_value(None, "user_version", |row| row.get(0))?;
    let done = steps_of(found)?;
    check(&transaction, found)?;
    for step in &STEPS[done..] {
        step(&transaction)?;
    }
    if done == 0 && is_anew {
        meta::is_new(&transaction)?;
    }
    if done < STEPS.len() {
        transaction.pragma_update(None, "user_version", KNOWN)?;
        let detail = serde_json::json!({ "from": found, "to": KNOWN });
        history::append(&transaction, None, history::Event::Schema, &detail)?;
    }
    disposition::decide_all(&transaction)?;
    Ok(transaction.commit()?)
}

/// How many steps lead to a schema.
fn steps_of(found: i64) -> Result<usize, JournalError> {
    let done = usize::try_from(found).ok().filter(|done| *done <= STEPS.len());
    done.ok_or(JournalError::Schema { found, known: KNOWN })
}

/// Checks that a journal has the tables, indexes and triggers of this schema, as its steps create them.
/// Added objects are no damage, unless a later schema would create them.
pub(super) fn check(connection: &Connection, schema: i64) -> Result<(), JournalError> {
    let (found, wanted, known) = (objects(connection)?, pattern(schema)?, pattern(KNOWN)?);
    for name in known.keys().chain(wanted.keys()) {
        if found.get(name) != wanted.get(name) {
            let found = format!("{name} does not match schema {schema}");
            return Err(JournalError::Damaged { found });
        }
    }
    Ok(())
}

/// The objects of a schema.
fn pattern(schema: i64) -> Result<BTreeMap<String, String>, JournalError> {
    let mut connection = Connection::open_in_memory()?;
    let transaction = connection.transaction()?;
    for step in &STEPS[..steps_of(schema)?] {
        step(&transaction)?;
    }
    objects(&transaction)
}

/// What a schema consists of: the SQL that creates each object, by its name, without blanks.
fn objects(connection: &Connection) -> Result<BTreeMap<String, String>, JournalError> {
    let mut query =
        connection.prepare("SELECT name, sql FROM sqlite_schema WHERE sql IS NOT NULL")?;
    let rows = query.query_map([], |row| {
        let sql: String = row.get(1)?;
        Ok((row.get(0)?, sql.split_whitespace().collect()))
    })?;
    Ok(rows.collect::<rusqlite::Result<_>>()?)
}
