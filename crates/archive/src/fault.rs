//! Why the archive does not continue.

use std::error::Error;
use std::io;

use gaiter_confined::RunFault;
use gaiter_https::tls::TlsFault;
use gaiter_https::{BucketFault, SecretFault};
use parquet::errors::ParquetError;

use crate::config::ConfigFault;

/// The machine or a server is at fault.
pub const EXIT_IO: u8 = 74;

/// The configuration has faults.
const EXIT_CONFIG: u8 = 78;

/// Why the archive does not continue.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveFault {
    /// The configuration has faults.
    #[error(transparent)]
    Config(#[from] ConfigFault),
    /// The database does not do what was asked.
    #[error("the database")]
    Database(#[from] postgres::Error),
    /// The database has another schema.
    #[error("the database has schema {found}, and this version has {own}")]
    OtherSchema {
        found: i32,
        /// That of this version.
        own: i32,
    },
    /// The database has none.
    #[error("the database has no tables yet; gaiter-archive index makes them")]
    NoSchema,
    /// The store of objects does not do what was asked.
    #[error(transparent)]
    Objects(#[from] BucketFault),
    /// There is no safe connection.
    #[error(transparent)]
    Tls(#[from] TlsFault),
    /// A password cannot be read.
    #[error(transparent)]
    Secret(#[from] SecretFault),
    /// No measuring process runs.
    #[error(transparent)]
    NotMeasuring(#[from] RunFault),
    /// SIGTERM has come, to the worker or to its process alone.
    #[error("asked to end; what is claimed and not measured is handed back")]
    AskedToEnd,
    /// A document cannot be written.
    #[error("a document cannot be written")]
    NotWritten(#[from] serde_json::Error),
    /// A file of an export cannot be written.
    #[error("the export")]
    Export(#[from] ParquetError),
    /// Input or output fails.
    #[error(transparent)]
    Io(#[from] io::Error),
}

impl ArchiveFault {
    /// The exit code of the process, after `sysexits.h`.
    pub fn exit_code(&self) -> u8 {
        match self {
            ArchiveFault::Config(_) => EXIT_CONFIG,
            _ => EXIT_IO,
        }
    }
}

/// An error with its causes, in a line.
pub fn chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let said = error.to_string();
        // What is handed on says the same again.
        if !text.ends_with(&said) {
            text = format!("{text}: {said}");
        }
        cause = error.source();
    }
    text
}
