//! Later results for scans that have a record: each in a folder of its own beside the earlier ones.
//!
//! A revision is written as the folder store writes a record: staged under a dot name, every file
//! synced, `SHA256SUMS` last, then renamed, never over another. The stations that use the store need
//! not stand still meanwhile. One of them may take the record back from its patient at any moment:
//! it removes every revision it finds until it finds none, and a revision that got its name later
//! finds the record gone and is taken back here. So none is left with a patient whose scan it is not.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::{MetadataExt, chown};
use std::path::{Path, PathBuf};

use rustix::fs::{FlockOperation, flock};

use super::folder::records_in;
use super::{StoreFault, durable};
use crate::flow::naming::{self, RecordName};
use crate::record::RecordFile;

/// How the names of staged revisions begin; no station's staged records begin so.
const STAGING: &str = ".reextract.";

/// The record of one scan for one patient with all its revisions, as they lie in a folder store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Family {
    /// The folder they lie in.
    pub patient_folder: PathBuf,
    /// The revisions, the latest last; at least one.
    revisions: Vec<(RecordName, PathBuf)>,
}

/// What became of a new revision.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Added {
    /// It lies whole and durable in this folder.
    There(PathBuf),
    /// The record was taken back from its patient meanwhile: there is none to add to.
    Withdrawn,
}

impl Family {
    /// The revisions among these records of one patient's folder, in their order.
    fn of(patient_folder: &Path, records: Vec<(RecordName, PathBuf)>) -> Vec<Family> {
        let mut families: Vec<Family> = Vec::new();
        for record in records {
            match families.last_mut() {
                Some(family) if family.is_of(&record.0) => family.revisions.push(record),
                _ => families.push(Family {
                    patient_folder: patient_folder.to_owned(),
                    revisions: vec![record],
                }),
            }
        }
        families
    }

    fn is_of(&self, name: &RecordName) -> bool {
        let own = &self.latest().0;
        (own.first_seen, &own.scan) == (name.first_seen, &name.scan)
    }

    /// The latest revision: its name and folder.
    pub fn latest(&self) -> &(RecordName, PathBuf) {
        &self.revisions[self.revisions.len() - 1]
    }

    /// Whose folder it lies in: none where no patient's folder is called so, the inner value none
    /// for the scans of nobody.
    pub fn patient(&self) -> Option<Option<String>> {
        let name = self.patient_folder.file_name().and_then(OsStr::to_str)?;
        naming::patient_of_folder(name)
    }

    /// Adds a revision: writes its files into a folder of its own beside the others, `SHA256SUMS` last.
    /// They belong to whom the record belongs.
    ///
    /// # Errors
    /// Any I/O error, `AlreadyExists` where there is such a revision by now. Nothing is left then
    /// that a record could be taken for.
    pub fn add(&self, revision: u32, files: &[RecordFile]) -> io::Result<Added> {
        let (latest, beside) = self.latest();
        let name = RecordName { revision, ..latest.clone() }.folder();
        let staged = self.patient_folder.join(format!("{STAGING}{}.{name}", std::process::id()));
        let place = self.patient_folder.join(name);
        let added = write(&staged, files, beside).and_then(|()| self.publish(&staged, place));
        // What a failure left, or a record that is nobody's any more.
        durable::remove_folder(&staged)?;
        added
    }

    /// Gives a staged revision its name, and takes it back where the record is gone meanwhile.
    fn publish(&self, staged: &Path, place: PathBuf) -> io::Result<Added> {
        let (_, beside) = self.latest();
        durable::rename_new(staged, &place)?;
        durable::sync_folder(&self.patient_folder)?;
        if fs::exists(beside)? {
            return Ok(Added::There(place));
        }
        durable::rename_new(&place, staged)?;
        durable::sync_folder(&self.patient_folder)?;
        Ok(Added::Withdrawn)
    }
}

/// The records at a path: a store of patients' folders, one patient's folder, or one record's. The
/// order is that of names.
///
/// # Errors
/// Where a folder cannot be listed.
pub fn families(at: &Path) -> Result<Vec<Family>, StoreFault> {
    let own_name = at.file_name().and_then(OsStr::to_str).and_then(RecordName::read);
    if let (Some(name), Some(patient)) = (own_name, at.parent()) {
        let mut families = Family::of(patient, records_in(patient)?);
        families.retain(|family| family.is_of(&name));
        return Ok(families);
    }
    let mut found = Family::of(at, records_in(at)?);
    let mut patients = super::folder::folders(at)?;
    patients.sort();
    for patient in patients {
        let name = patient.file_name().and_then(OsStr::to_str);
        if name.and_then(naming::patient_of_folder).is_some() {
            found.extend(Family::of(&patient, records_in(&patient)?));
        }
    }
    Ok(found)
}

/// The folder of the latest revision of the record in this folder: itself where there is no later one,
/// or where that cannot be told now.
pub fn latest(folder: &Path) -> PathBuf {
    let family = families(folder).ok().and_then(|mut families| families.pop());
    family.map_or_else(|| folder.to_owned(), |family| family.latest().1.clone())
}

/// Removes what a run that was killed left staged in a patient's folder. What a run holds that still
/// works, here or elsewhere, stays.
///
/// # Errors
/// Any I/O error.
pub fn clear_staging(patient_folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(patient_folder)? {
        let entry = entry?;
        if !entry.file_name().to_string_lossy().starts_with(STAGING) {
            continue;
        }
        // A file system that knows no locks keeps what nobody can tell to be abandoned.
        let held = File::open(entry.path());
        if held.is_ok_and(|held| flock(&held, FlockOperation::NonBlockingLockExclusive).is_ok()) {
            durable::remove_folder(&entry.path())?;
        }
    }
    Ok(())
}

/// Writes a whole folder, synced, of the same owner as the one it shall lie beside.
fn write(staged: &Path, files: &[RecordFile], beside: &Path) -> io::Result<()> {
    durable::make_folder(staged)?;
    let held = File::open(staged)?;
    // See `clear_staging`; without locks nobody clears anything.
    let _ = flock(&held, FlockOperation::NonBlockingLockExclusive);
    let (owner, ours) = (fs::metadata(beside)?, held.metadata()?);
    let gives = (owner.uid(), owner.gid()) != (ours.uid(), ours.gid());
    let give = |path: &Path| match gives {
        true => chown(path, Some(owner.uid()), Some(owner.gid())),
        false => Ok(()),
    };
    for file in files {
        let path = staged.join(&file.name);
        durable::write_new(&path, &file.bytes)?;
        give(&path)?;
    }
    give(staged)?;
    durable::sync_folder(staged)
}

#[cfg(test)]
mod tests;
