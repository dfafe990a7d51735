//! The journal's tables.

use rusqlite::{Connection, TransactionBehavior};

use super::JournalError;

/// The schema this gaiter reads and writes, in `PRAGMA user_version`.
const KNOWN: i64 = 1;

/// `patient` is '' while nobody named the patient. `sources` is JSON. `next_at` tells people when
/// the next attempt is due; the station itself goes by its monotonic clock.
const TABLES: &str = "
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

/// Makes the tables in a new journal; accepts an old one of our schema.
pub fn establish(connection: &mut Connection) -> Result<(), JournalError> {
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let found = transaction.pragma_query_value(None, "user_version", |row| row.get(0))?;
    match found {
        0 => {
            transaction.execute_batch(TABLES)?;
            transaction.pragma_update(None, "user_version", KNOWN)?;
        }
        KNOWN => {}
        other => return Err(JournalError::Schema { found: other, known: KNOWN }),
    }
    Ok(transaction.commit()?)
}
