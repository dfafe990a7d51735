//! A stored record, read back and checked against its `SHA256SUMS`.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use gaiter_record::{RECORD, Record, RecordFault};
use serde_json::Value;

use super::Family;
use crate::store::sums::{self, SumsFault};

/// Why a stored record cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoredFault {
    /// Its folder changed after it was written.
    #[error("its record is damaged: {0}")]
    Damaged(#[from] SumsFault),
    /// Its `record.json` cannot be parsed.
    #[error("its record.json cannot be read: {0}")]
    Unreadable(serde_json::Error),
    /// Its figures are impossible for a leg.
    #[error("its record.json is not of a leg: {0}")]
    Impossible(RecordFault),
    /// Its `record.json` names another scan or patient than its folder does.
    #[error("its record.json names another {0} than its folder")]
    Other(&'static str),
    /// A folder or file cannot be read at the moment.
    #[error("reading failed: {0}")]
    Io(#[from] io::Error),
}

impl StoredFault {
    /// The stable code.
    pub fn code(&self) -> &'static str {
        match self {
            StoredFault::Damaged(_) => "record-damaged",
            StoredFault::Unreadable(_) => "record-unreadable",
            StoredFault::Impossible(_) => "record-impossible",
            StoredFault::Other(_) => "record-of-another",
            StoredFault::Io(_) => "record-io",
        }
    }
}

/// A record folder whose files are all as they were written.
#[derive(Debug)]
pub struct Stored {
    pub record: Record,
    /// The record with all keys, also those that this version does not know.
    pub json: Value,
    /// The name of the file with the scan's own bytes.
    pub scan_file: String,
    /// The names of all files that `SHA256SUMS` lists, in its order.
    pub listed: Vec<String>,
    folder: PathBuf,
}

impl Stored {
    /// Reads the latest revision of a record in a store.
    ///
    /// # Errors
    /// See [`StoredFault`]; also if it names another scan or patient than its place does.
    pub fn read(family: &Family) -> Result<Stored, StoredFault> {
        let (name, folder) = family.latest();
        let stored = Stored::in_folder(folder)?;
        if !stored.record.scan.sha256.starts_with(&name.scan) {
            return Err(SumsFault::OtherScan.into());
        }
        let whose = stored.record.patient.as_ref().map(|patient| patient.id.clone());
        if family.patient() != Some(whose) {
            return Err(StoredFault::Other("patient"));
        }
        Ok(stored)
    }

    /// Reads the record in a folder.
    ///
    /// # Errors
    /// See [`StoredFault`].
    pub fn in_folder(folder: &Path) -> Result<Stored, StoredFault> {
        let (id, scan_file) = sums::scan_of(folder)?.ok_or(SumsFault::NoSums)?;
        sums::check(folder, &id)??;
        let listed = sums::listed(folder)?;
        if !listed.iter().any(|name| name == RECORD) {
            return Err(SumsFault::Missing { name: RECORD.to_owned() }.into());
        }
        let bytes = fs::read(folder.join(RECORD))?;
        let json: Value = serde_json::from_slice(&bytes).map_err(StoredFault::Unreadable)?;
        let record: Record = serde_json::from_slice(&bytes).map_err(StoredFault::Unreadable)?;
        if record.scan.sha256 != id.as_str() {
            return Err(StoredFault::Other("scan"));
        }
        Ok(Stored { record, json, scan_file, listed, folder: folder.to_owned() })
    }

    /// The bytes of a listed file.
    ///
    /// # Errors
    /// Any I/O error.
    pub fn listed_file(&self, name: &str) -> io::Result<Vec<u8>> {
        fs::read(self.folder.join(name))
    }

    /// The bytes of a file that not every record has; `None` if it is not listed.
    ///
    /// # Errors
    /// Any I/O error.
    pub fn optional_file(&self, name: &str) -> io::Result<Option<Vec<u8>>> {
        let is_listed = self.listed.iter().any(|listed| listed == name);
        is_listed.then(|| self.listed_file(name)).transpose()
    }
}
