//! Why the journal cannot be used, and what that says of it.

use std::io;
use std::path::PathBuf;

use crate::flow::IllegalStep;

/// Why the journal cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// SQLite failed.
    #[error("the journal failed")]
    Sqlite(#[from] rusqlite::Error),
    /// The journal's folder could not be synced.
    #[error("syncing the folder of the journal {path} failed")]
    Folder {
        /// The journal.
        path: PathBuf,
        /// How it failed.
        #[source]
        source: std::io::Error,
    },
    /// A setting that durability needs was not taken.
    #[error("the journal keeps {setting} = {found}, it must be {wanted}")]
    Setting {
        /// The pragma.
        setting: &'static str,
        /// What was read back.
        found: String,
        /// What was set.
        wanted: &'static str,
    },
    /// The journal was written by another version of gaiter.
    #[error("the journal has schema {found}, this gaiter knows {known}")]
    Schema {
        /// Schema of the file.
        found: i64,
        /// Ours.
        known: i64,
    },
    /// A cell holds what we never write.
    #[error("the journal's column {column} holds {found:?}")]
    Cell {
        /// Column.
        column: &'static str,
        /// Its content.
        found: String,
    },
    /// Pages of the file contradict each other.
    #[error("the journal is damaged: {found}")]
    Damaged {
        /// What SQLite found.
        found: String,
    },
    /// A row is not the one that was written.
    #[error("a row of the journal's table {table} does not match its seal")]
    Seal {
        /// The table.
        table: &'static str,
    },
    /// The history has been changed or damaged.
    #[error("the journal's history is broken at its row {seq}")]
    Chain {
        /// The row.
        seq: i64,
    },
    /// The journal lacks what was committed to it.
    #[error("the journal is an older copy: its history ends before row {head}")]
    Behind {
        /// The newest row that was committed.
        head: i64,
    },
    /// The file is not under its name any more.
    #[error("the journal was removed or replaced while it was in use")]
    Gone,
    /// The head of the history could not be read or written.
    #[error("the file beside the journal that repeats the head of its history failed")]
    Head(#[source] io::Error),
    /// A step that a state does not allow.
    #[error(transparent)]
    Step(#[from] IllegalStep),
    /// A row that must be there is not.
    #[error("the journal does not know this {what}")]
    Unknown {
        /// What kind of row.
        what: &'static str,
    },
}

impl JournalError {
    /// Whether the journal is not to be relied upon any more and must be rebuilt: SQLite says that the
    /// file is damaged, or one of our own checks does. What may pass, such as a full disk, a file that
    /// somebody else holds, or another version of gaiter, is no ruin.
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
            | JournalError::Unknown { .. } => false,
        }
    }

    /// Whether it may come of a damaged journal or of a defect of gaiter: an index that hides a row, a
    /// table that is not there, or a statement that is wrong. [`super::Journal::check`] tells which.
    pub fn is_suspicious(&self) -> bool {
        use rusqlite::Error::{InvalidColumnType, SqlInputError};
        use rusqlite::ErrorCode::{ConstraintViolation, Unknown};
        let JournalError::Sqlite(error) = self else { return false };
        let is_wrong = matches!(error, InvalidColumnType(..) | SqlInputError { .. });
        is_wrong || matches!(error.sqlite_error_code(), Some(ConstraintViolation | Unknown))
    }
}

/// The file is damaged, or a cell holds what we never write.
fn is_damage(error: &rusqlite::Error) -> bool {
    use rusqlite::Error::{FromSqlConversionFailure, IntegralValueOutOfRange, Utf8Error};
    use rusqlite::ErrorCode::{DatabaseCorrupt, NotADatabase};
    let is_cell =
        matches!(error, FromSqlConversionFailure(..) | IntegralValueOutOfRange(..) | Utf8Error(..));
    is_cell || matches!(error.sqlite_error_code(), Some(DatabaseCorrupt | NotADatabase))
}
