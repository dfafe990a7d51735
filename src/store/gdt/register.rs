//! The register: which results were handed over or are about to be, one file each in the station's state
//! folder. It outlasts the journal.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU16, Ordering};

use gaiter_flow::ScanId;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::super::json_folder::JsonFolder;
use super::super::{FoundRecord, StoreFault, durable, tried};

/// The versions of an entry's schema.
#[derive(Serialize, Deserialize)]
#[serde(tag = "schema")]
enum Versioned {
    #[serde(rename = "gaiter.handed-over/1")]
    V1(Entry),
}

/// What is known about a result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Entry {
    /// The scan's hash.
    pub scan: String,
    /// The patient's id.
    pub patient: String,
    /// When the station first saw the scan.
    pub first_seen: Timestamp,
    /// The ending of the scan's format.
    pub format: String,
    /// Size of the scan, bytes.
    pub size: u64,
    /// The name of the file that was handed over.
    pub name: String,
    pub number: u16,
    /// When it was registered.
    pub at: Timestamp,
}

impl Entry {
    /// The entry as a record in the store; `None` if the entry names no scan.
    pub fn found(self, folder: &Path) -> Option<FoundRecord> {
        Some(FoundRecord {
            scan: ScanId::parse(&self.scan)?,
            patient: Some(self.patient),
            request: None,
            acquired: None,
            first_seen: self.first_seen,
            format: self.format,
            size: self.size,
            folder: folder.join(self.name),
        })
    }
}

/// The entries of a station.
#[derive(Debug, Clone)]
pub(super) struct Register {
    folder: JsonFolder,
    /// The number used last; needed only so that files are fetched in their order.
    last_number: Arc<AtomicU16>,
}

impl Register {
    /// The register in a folder.
    pub fn new(folder: PathBuf) -> Register {
        Register { folder: JsonFolder::new(folder), last_number: Arc::default() }
    }

    /// Makes the folder if there is none, and finds the number used last.
    pub fn open(&self) -> Result<(), StoreFault> {
        if self.folder.path().is_dir() && self.last_number() != 0 {
            return Ok(());
        }
        tried("making", self.folder.path(), self.folder.make())?;
        let last = self.entries()?.into_iter().max_by_key(|(_, entry)| entry.at);
        let number = last.map_or(0, |(_, entry)| entry.number);
        self.last_number.store(number, Ordering::Relaxed);
        Ok(())
    }

    /// The number used last, 0 for none.
    pub fn last_number(&self) -> u16 {
        self.last_number.load(Ordering::Relaxed)
    }

    /// An entry; `None` if the result was never registered.
    pub fn entry(&self, key: &str) -> Result<Option<Entry>, StoreFault> {
        let read = tried("reading", &self.folder.file(key), self.folder.read(key))?;
        Ok(read.map(|Versioned::V1(entry)| entry))
    }

    /// All entries by key.
    pub fn entries(&self) -> Result<Vec<(String, Entry)>, StoreFault> {
        let keys = durable::if_there(self.folder.names());
        let keys = tried("listing", self.folder.path(), keys)?;
        let mut entries = Vec::new();
        for key in keys.unwrap_or_default() {
            entries.extend(self.entry(&key)?.map(|entry| (key, entry)));
        }
        Ok(entries)
    }

    /// Enters a result; durable on return. Replaces an earlier entry of the result, which never got that
    /// entry's name.
    pub fn enter(&self, key: &str, entry: &Entry) -> Result<(), StoreFault> {
        let write = || -> io::Result<()> {
            self.folder.keep(key, &serde_json::to_vec_pretty(&Versioned::V1(entry.clone()))?)
        };
        tried("registering", &self.folder.file(key), write())?;
        self.last_number.store(entry.number, Ordering::Relaxed);
        Ok(())
    }

    /// Removes the entry of a result, if there is one; durable on return.
    pub fn forget(&self, key: &str) -> Result<(), StoreFault> {
        tried("forgetting", &self.folder.file(key), self.folder.remove(key))
    }
}
