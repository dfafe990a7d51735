//! Why the journal cannot be used, and whether that means it is corrupt.

use std::io;
use std::path::PathBuf;

use gaiter_flow::IllegalStep;

/// Why the journal cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// SQLite failed.
    #[error("the journal failed")]
    Sqlite(#[from] rusqlite::Error),
    /// The journal's folder could not be synced.
    #[error("syncing the folder of the journal {path} failed")]
    Folder {
        path: PathBuf,
        #[source]
        source: std::io::Error,
    },
    /// Another process reads the journal, so its log cannot be emptied.
    #[error("another process reads the journal: end it (fuser -v journal.db)")]
    Read,
    /// A setting that durability needs was not accepted.
    #[error("the journal has {setting} = {found}; it must be {wanted}")]
    Setting {
        /// The pragma.
        setting: &'static str,
        /// What was read back.
        found: String,
        /// What was set.
        wanted: &'static str,
    },
    /// The journal was written by another version of gaiter.
    #[error(
        "the journal has schema {found}, this gaiter knows {known}: install the version that wrote it"
    )]
    Schema {
        /// Schema of the file.
        found: i64,
        /// The schema this version knows.
        known: i64,
    },
    /// A cell holds what gaiter never writes.
    #[error("the journal's column {column} holds {found:?}")]
    Cell {
        column: String,
        /// Its content.
        found: String,
    },
    /// Pages of the file contradict each other.
    #[error("the journal is damaged: {found}")]
    Damaged {
        /// What SQLite found.
        found: String,
    },
    /// A row differs from the one that was written.
    #[error("a row of the journal's table {table} does not match its seal")]
    Seal { table: &'static str },
    /// The history has been changed or damaged.
    #[error("the journal's history is broken at its row {seq}")]
    Chain {
        /// The row.
        seq: i64,
    },
    /// The journal lacks rows that were committed to it.
    #[error("the journal is an older copy: its history ends before row {head}")]
    Behind {
        /// The newest row that was committed.
        head: i64,
    },
    /// The journal's name no longer leads to the open file.
    #[error("the journal was removed or replaced while it was in use")]
    Gone,
    /// The head of the history could not be read or written.
    #[error("reading or writing history.head failed")]
    Head(#[source] io::Error),
    /// A step that a state does not allow.
    #[error(transparent)]
    Step(#[from] IllegalStep),
    /// A required row is missing.
    #[error("the journal has no such {what}")]
    Unknown {
        /// What kind of row.
        what: &'static str,
    },
}

impl JournalError {
    /// The first journal error among an error and its causes.
    pub fn among_causes<'a>(
        error: &'a (dyn std::error::Error + 'static),
    ) -> Option<&'a JournalError> {
        let mut cause = Some(error);
        while let Some(error) = cause {
            if let Some(found) = error.downcast_ref::<JournalError>() {
                return Some(found);
            }
            cause = error.source();
        }
        None
    }

    /// Reports whether the journal is corrupt and must be rebuilt: SQLite or one of our own checks found
    /// damage. Faults that may pass, such as a full disk or a file locked by another process, and a
    /// journal of another version of gaiter do not count.
    pub fn is_ruin(&self) -> bool {
        match self {
            JournalError::Sqlite(error) => is_damage(error),
            JournalError::Cell { .. }
            | JournalError::Damaged { .. }
            | JournalError::Seal { .. }
            | JournalError::Chain { .. }
            | JournalError::Behind { .. }
            | JournalError::Gone => true,
            JournalError::Folder { .. }
            | JournalError::Setting { .. }
            | JournalError::Schema { .. }
            | JournalError::Head(_)
            | JournalError::Step(_)
            | JournalError::Read
            | JournalError::Unknown { .. } => false,
        }
    }

    /// Reports whether the error may come from a damaged journal or from a bug in gaiter: an index that hides
    /// a row, a missing table, or a wrong statement. [`super::Journal::check`] finds out which.
    pub fn is_suspicious(&self) -> bool {
        use rusqlite::Error::{InvalidColumnType, SqlInputError};
        use rusqlite::ErrorCode::{ConstraintViolation, Unknown};
        let JournalError::Sqlite(error) = self else { return false };
        let is_wrong = matches!(error, InvalidColumnType(..) | SqlInputError { .. });
        is_wrong || matches!(error.sqlite_error_code(), Some(ConstraintViolation | Unknown))
    }
}

/// Reports whether the file is damaged, or a cell holds what gaiter never writes.
fn is_damage(error: &rusqlite::Error) -> bool {
    use rusqlite::Error::{FromSqlConversionFailure, IntegralValueOutOfRange, Utf8Error};
    use rusqlite::ErrorCode::{DatabaseCorrupt, NotADatabase};
    let is_cell =
        matches!(error, FromSqlConversionFailure(..) | IntegralValueOutOfRange(..) | Utf8Error(..));
    is_cell || matches!(error.sqlite_error_code(), Some(DatabaseCorrupt | NotADatabase))
}
