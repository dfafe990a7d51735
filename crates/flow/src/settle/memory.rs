//! What the looks at a folder found, kept across a restart: which files were not taken yet and how they
//! were written. Without it, a file that was there at a start could not answer any capture.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::Settling;
use crate::export::stamp::Stamp;
use crate::export::writing::Writing;

/// The most files to remember. With more, none is remembered: each counts as seen for the first time,
/// with no look before.
const FILES_MOST: usize = 1000;

/// What was known about a folder; times are since the machine's start.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Memory {
    /// When the last look began: a file that it did not find and that is not listed here was not there.
    pub looked: Option<Duration>,
    /// The files that were not taken.
    pub files: Vec<Remembered>,
}

/// A file that was not taken.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Remembered {
    /// Its state at the last look.
    pub stamp: Stamp,
    pub writing: Writing,
}

impl Settling {
    /// Adds what an earlier run knew about the folder.
    pub fn remembering(self, memory: Memory) -> Settling {
        Settling { last_look: memory.looked, remembered: memory.files, ..self }
    }

    /// What to keep across a restart.
    pub fn memory(&self) -> Memory {
        let files = self.untaken().map(|(_, file)| (file.group.stamp, &file.writing));
        let unrelated = self.unrelated.values().map(|file| (file.stamp, &file.writing));
        let all = files.chain(unrelated);
        let remembered = all.map(|(stamp, writing)| Remembered { stamp, writing: writing.clone() });
        let files: Vec<Remembered> = remembered.take(FILES_MOST + 1).collect();
        if files.len() > FILES_MOST {
            return Memory::default();
        }
        Memory { looked: self.last_look, files }
    }
}
