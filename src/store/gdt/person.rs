//! What practice software was given of one person, and what the station forgets of it. What was handed over is
//! the practice's own: it stays.

use std::path::PathBuf;

use jiff::Timestamp;

use super::GdtStore;
use crate::store::StoreFault;

/// A result of a person.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Given {
    /// The scan, 64 hexadecimal digits.
    pub sha256: String,
    /// The file under which it was handed over.
    pub file: PathBuf,
    /// When.
    pub at: Timestamp,
    /// The file is there: it was not fetched, or another result has its name by now.
    pub is_there: bool,
    /// The files that belong to it and are there.
    pub attachments: Vec<PathBuf>,
}

impl GdtStore {
    /// What was handed over of a person.
    ///
    /// # Errors
    /// A transient fault if the register cannot be read. A folder that is out of reach is no fault: nothing is
    /// there then.
    pub(super) fn given_of_person(&self, patient: &str) -> Result<Vec<Given>, StoreFault> {
        let mut given = Vec::new();
        for (key, entry) in self.register.entries()? {
            if entry.patient != patient || self.place.is_staged(&key).unwrap_or(false) {
                continue;
            }
            let file = self.place.folder().join(&entry.name);
            given.push(Given {
                sha256: entry.scan,
                is_there: file.exists(),
                file,
                at: entry.at,
                attachments: self.attach.there(&key, self.place.folder()),
            });
        }
        given.sort_by_key(|of| of.at);
        Ok(given)
    }

    /// Removes results of a person that have no name yet, and forgets those that were handed over.
    ///
    /// # Errors
    /// A transient fault if the exchange folder is out of reach.
    pub(super) fn erase_person(&self, patient: &str) -> Result<(), StoreFault> {
        self.place.reach()?;
        for (key, entry) in self.register.entries()? {
            if entry.patient == patient {
                self.place.unstage_all(&key)?;
                self.register.forget(&key)?;
            }
        }
        self.place.sync()
    }
}
