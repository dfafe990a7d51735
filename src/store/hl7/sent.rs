//! The notes of what a receiver has accepted, one file for each scan of a patient. They name neither.

use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::store::json_folder::JsonFolder;
use crate::store::{StoreFault, tried};

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
    folder: JsonFolder,
}

impl SentMessages {
    pub fn in_state(state_dir: &Path) -> SentMessages {
        SentMessages { folder: JsonFolder::new(state_dir.join("hl7-sent")) }
    }

    /// What the receiver has; `None` if it can have nothing.
    pub fn of(&self, key: &str) -> Result<Option<Sent>, StoreFault> {
        let read = tried("reading", &self.folder.file(key), self.folder.read(key))?;
        Ok(read.map(|Versioned::V1(sent)| sent))
    }

    /// Notes what the receiver has; durable on return.
    pub fn note(&self, key: &str, sent: &Sent) -> Result<(), StoreFault> {
        let write = || -> io::Result<()> {
            self.folder.make()?;
            self.folder.keep(key, &serde_json::to_vec(&Versioned::V1(sent.clone()))?)
        };
        tried("noting what was sent", self.folder.path(), write())
    }

    /// Notes what was known before a message that the receiver did not take; durable on return.
    pub fn restore(&self, key: &str, before: Option<&Sent>) -> Result<(), StoreFault> {
        before.map_or_else(|| self.forget(key), |sent| self.note(key, sent))
    }

    /// Removes a note; durable on return.
    pub fn forget(&self, key: &str) -> Result<(), StoreFault> {
        let removed = self.folder.remove(key);
        tried("forgetting what was sent", &self.folder.file(key), removed)
    }
}
