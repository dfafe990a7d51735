//! The notes of what a receiver has accepted, one file for each scan of a patient. They name neither.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::store::{StoreFault, durable, tried};

/// What a receiver has of a scan of a patient, or may have.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sent {
    /// The revision of the record in the last message.
    pub revision: u32,
    /// The number of the last message: that revision, or more if a result was sent again after its withdrawal.
    pub number: u32,
    /// The control id of the last message.
    pub control: String,
    /// Where it was sent: another receiver has none of it.
    pub place: String,
    /// Whether the result holds; not if it was withdrawn.
    pub holds: bool,
    /// Whether the receiver has accepted the last message. If not, it may have it all the same.
    pub is_answered: bool,
    /// The codes of all observations that it was ever sent of the scan.
    pub codes: Vec<String>,
}

/// The versions of a note.
#[derive(Serialize, Deserialize)]
#[serde(tag = "schema")]
enum Versioned {
    #[serde(rename = "gaiter.hl7-sent/1")]
    V1(Sent),
}

/// The notes of a station.
#[derive(Debug, Clone)]
pub(super) struct SentMessages {
    folder: PathBuf,
}

impl SentMessages {
    pub fn in_state(state_dir: &Path) -> SentMessages {
        SentMessages { folder: state_dir.join("hl7-sent") }
    }

    /// What the receiver has; `None` if it can have nothing.
    pub fn of(&self, key: &str) -> Result<Option<Sent>, StoreFault> {
        let path = self.path(key);
        let read = || -> io::Result<Option<Sent>> {
            let Some(bytes) = durable::if_there(fs::read(&path))? else { return Ok(None) };
            let Versioned::V1(sent) = serde_json::from_slice(&bytes)?;
            Ok(Some(sent))
        };
        tried("reading", &path, read())
    }

    /// Notes what the receiver has; durable on return.
    pub fn note(&self, key: &str, sent: &Sent) -> Result<(), StoreFault> {
        let within = self.folder.parent().unwrap_or(Path::new("/"));
        let write = || -> io::Result<()> {
            durable::make_folder_once(&self.folder)?;
            durable::sync_folder(within)?;
            let bytes = serde_json::to_vec(&Versioned::V1(sent.clone()))?;
            durable::replace_file(&self.folder, &file_name(key), &bytes)
        };
        tried("noting what was sent", &self.folder, write())
    }

    /// Notes what was known before a message that the receiver did not take; durable on return.
    pub fn restore(&self, key: &str, before: Option<&Sent>) -> Result<(), StoreFault> {
        before.map_or_else(|| self.forget(key), |sent| self.note(key, sent))
    }

    /// Removes a note; durable on return.
    pub fn forget(&self, key: &str) -> Result<(), StoreFault> {
        let path = self.path(key);
        let removed = durable::if_there(fs::remove_file(&path));
        match tried("forgetting what was sent", &path, removed)? {
            Some(()) => tried("syncing", &self.folder, durable::sync_folder(&self.folder)),
            None => Ok(()),
        }
    }

    fn path(&self, key: &str) -> PathBuf {
        self.folder.join(file_name(key))
    }
}

fn file_name(key: &str) -> String {
    format!("{key}.json")
}
