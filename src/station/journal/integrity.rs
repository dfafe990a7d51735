//! Seals and checks that show whether the journal is intact: its pages and indexes, its tables, every text cell, the
//! seals of its rows, the chain of its history, and that it is not an older copy of itself.

pub(in crate::station::journal) mod seal;

use rusqlite::Connection;
use rusqlite::types::ValueRef;
use tokio::sync::watch;

use super::history::{self, HeadFile};
use super::row::value;
use super::{JournalError, schema};

/// SQLite's own check of every page, and of each index against its table: a row that an index hides is
/// neither found nor delivered, and the quick check does not notice that.
pub(super) fn pages(connection: &Connection) -> Result<(), JournalError> {
    let found: String = value(connection, "PRAGMA integrity_check(1)", [])?;
    if found == "ok" { Ok(()) } else { Err(JournalError::Damaged { found }) }
}

/// Checks every row: valid text, the seal, and the history's chain.
pub(super) fn rows(connection: &Connection) -> Result<(), JournalError> {
    for table in schema::TABLES {
        texts(connection, table)?;
    }
    seal::check_all(connection)?;
    history::check(connection)
}

/// Checks that texts are valid UTF-8, because SQLite stores any bytes as text.
fn texts(connection: &Connection, table: &'static str) -> Result<(), JournalError> {
    let mut query = connection.prepare(&format!("SELECT * FROM {table}"))?;
    let columns = query.column_count();
    let mut rows = query.query([])?;
    while let Some(row) = rows.next()? {
        for column in 0..columns {
            if let ValueRef::Text(bytes) = row.get_ref(column)?
                && std::str::from_utf8(bytes).is_err()
            {
                let found = format!("table {table} contains invalid UTF-8 text");
                return Err(JournalError::Damaged { found });
            }
        }
    }
    Ok(())
}

/// Checks that the journal holds the last entry that its head file names.
pub(super) fn head(connection: &Connection, head: &HeadFile) -> Result<(), JournalError> {
    history::holds(connection, head.read().map_err(JournalError::Head)?)
}

/// Journal errors that may or may not mean damage; the last one is kept until the journal is checked, which it
/// triggers. An intact journal that refuses a statement is not given up: the cause is a bug in gaiter or a change made
/// by another program.
#[derive(Debug, Default)]
pub struct Suspicion(watch::Sender<Option<String>>);

impl Suspicion {
    /// Reports such an error.
    pub fn raise(&self, error: String) {
        self.0.send_replace(Some(error));
    }

    /// Completes when an error has been reported since the last check.
    pub async fn raised(&self) {
        let mut news = self.0.subscribe();
        _ = news.wait_for(Option::is_some).await;
    }

    /// Takes the last error.
    pub fn taken(&self) -> Option<String> {
        self.0.send_replace(None)
    }
}
