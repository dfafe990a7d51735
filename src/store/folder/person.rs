//! What the store holds of one person, and its removal.

use std::ffi::OsStr;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use gaiter_flow::ScanId;
use gaiter_flow::patient::naming::RecordName;
use gaiter_record::RECORD;
use jiff::Timestamp;

use super::FolderStore;
use crate::store::brief::Brief;
use crate::store::{RecordStore, StoreFault, durable, listed, records_in, sums, tried};

/// What lies in a person's folder.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct PersonFolder {
    /// The folder; `None` if there is none.
    pub folder: Option<PathBuf>,
    /// Their records, every revision, in the order of their names.
    pub records: Vec<PathBuf>,
    /// What else people put there.
    pub others: Vec<PathBuf>,
    /// Records that name another patient, or none: a person put them there.
    pub of_another: Vec<PathBuf>,
}

impl FolderStore {
    /// What lies in a person's folder; what a station is about to store there does not count.
    ///
    /// # Errors
    /// A transient fault if the store is out of reach; a permanent one if the folder is a link.
    pub(super) fn person_folder(&self, patient: &str) -> Result<PersonFolder, StoreFault> {
        self.reach()?;
        let Some(folder) = self.own_folder(Some(patient))? else {
            return Ok(PersonFolder::default());
        };
        let mut found = PersonFolder { folder: Some(folder.clone()), ..PersonFolder::default() };
        for (_, place) in records_in(&folder)? {
            match is_of(&place, patient)? {
                true => found.records.push(place),
                false => found.of_another.push(place),
            }
        }
        for place in entries(&folder)? {
            let is_known = found.records.contains(&place) || found.of_another.contains(&place);
            if !is_known && !is_hidden(&place) {
                found.others.push(place);
            }
        }
        found.others.sort();
        Ok(found)
    }

    /// Removes a person's records whose scans came before a time, what else lies in their folder since before
    /// then, and the unassigned records of these scans.
    ///
    /// # Errors
    /// A transient fault if the store is out of reach; a permanent one if the folder is a link.
    pub(super) fn erase_in_reach(
        &self,
        patient: &str,
        before: Timestamp,
        scans: &[ScanId],
    ) -> Result<(), StoreFault> {
        let own = self.erase_own(patient, before);
        let unassigned = match self.own_folder(None)? {
            Some(unassigned) => self.erase_unassigned(&unassigned, scans),
            None => Ok(()),
        };
        own.and(unassigned)
    }

    fn erase_own(&self, patient: &str, before: Timestamp) -> Result<(), StoreFault> {
        let Some(folder) = self.own_folder(Some(patient))? else { return Ok(()) };
        self.erase_in(&folder, patient, before)?;
        match fs::remove_dir(&folder) {
            // Newer records are in it, or those of another.
            Err(error) if error.kind() == ErrorKind::DirectoryNotEmpty => {}
            removed => tried("removing", &folder, removed)?,
        }
        tried("syncing", &self.root, durable::sync_folder(&self.root))
    }

    fn erase_in(&self, folder: &Path, patient: &str, before: Timestamp) -> Result<(), StoreFault> {
        // What was being removed when the station ended: its own time is that of the removal.
        let gone = self.being_removed(folder);
        tried("removing", &gone, durable::remove_folder(&gone))?;
        // Repeated until none is found: a re-extraction may add a revision meanwhile. A later one finds the
        // record gone and removes its revision itself.
        loop {
            let mut gone = false;
            for (name, place) in records_in(folder)? {
                if name.first_seen <= before && is_of(&place, patient)? {
                    self.remove(folder, &place)?;
                    gone = true;
                }
            }
            if !gone {
                break;
            }
        }
        for place in entries(folder)? {
            let is_record = place.file_name().and_then(OsStr::to_str).and_then(RecordName::read);
            if is_record.is_some() || self.is_of_another_station(&place) {
                continue;
            }
            let changed = fs::symlink_metadata(&place).and_then(|found| found.modified());
            let changed = tried("examining", &place, changed)?;
            if changed <= SystemTime::from(before) {
                self.remove(folder, &place)?;
            }
        }
        Ok(())
    }

    fn erase_unassigned(&self, unassigned: &Path, scans: &[ScanId]) -> Result<(), StoreFault> {
        for (name, place) in records_in(unassigned)? {
            let scan = scans.iter().find(|scan| scan.short() == name.scan);
            let Some(scan) = scan else { continue };
            let is_its = tried("reading", &place, sums::scan_name(&place, scan))?.is_some();
            if is_its {
                self.remove(unassigned, &place)?;
            }
        }
        Ok(())
    }

    /// Removes a file or folder; a folder first gets a name under which the next start would remove it.
    fn remove(&self, within: &Path, place: &Path) -> Result<(), StoreFault> {
        let found = tried("examining", place, fs::symlink_metadata(place))?;
        if !found.is_dir() {
            tried("removing", place, fs::remove_file(place))?;
            return tried("syncing", within, durable::sync_folder(within));
        }
        let gone = self.being_removed(within);
        if place != gone {
            tried("removing", &gone, durable::remove_folder(&gone))?;
            tried("renaming", place, durable::rename_new(place, &gone))?;
            tried("syncing", within, durable::sync_folder(within))?;
        }
        tried("removing", &gone, durable::remove_folder(&gone))?;
        tried("syncing", within, durable::sync_folder(within))
    }

    /// The place from which something in a folder is removed.
    fn being_removed(&self, within: &Path) -> PathBuf {
        within.join(format!("{}erasing", self.staging))
    }

    /// Whether a hidden folder is one that another station prepares: it is that station's to remove.
    fn is_of_another_station(&self, place: &Path) -> bool {
        let name = place.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with(".staging.") && !name.starts_with(&self.staging)
    }
}

/// Whether a record in a person's folder is theirs; one that cannot be understood is taken for it.
fn is_of(place: &Path, patient: &str) -> Result<bool, StoreFault> {
    let brief = Brief::read(&place.join(RECORD))?;
    Ok(brief.is_none_or(|brief| brief.patient_id() == Some(patient)))
}

fn is_hidden(place: &Path) -> bool {
    place.file_name().unwrap_or_default().to_string_lossy().starts_with('.')
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, StoreFault> {
    Ok(listed(folder)?.into_iter().map(|entry| entry.path()).collect())
}
