//! Later results for scans that have a record: each in its own folder beside the earlier ones.
//!
//! A revision is written as the folder store writes a record: staged under a dot name, every file
//! synced, `SHA256SUMS` last, then renamed, never over another. The stations that use the store need not
//! stop meanwhile. One of them may withdraw the record from its patient at any moment: it removes
//! revisions until it finds none. A revision that gets its name later finds the record gone and is
//! withdrawn here. So none is left with a patient it does not belong to.

pub mod amend;
pub mod stored;
pub mod visits;

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::{MetadataExt, chown};
use std::path::{Path, PathBuf};

use gaiter_flow::patient::naming::{self, RecordName};
use gaiter_record::RecordFile;
use rustix::fs::{FlockOperation, flock};

use super::{StoreFault, durable, folders, records_in};
use crate::store::Access;

/// Prefix of staged revisions; no station's staged records have it.
const STAGING: &str = ".reextract.";

/// The record of one scan for one patient with all its revisions in a folder store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Family {
    pub patient_folder: PathBuf,
    /// The revisions, the latest last; at least one.
    revisions: Vec<(RecordName, PathBuf)>,
}

/// The outcome of adding a revision.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Added {
    /// It is complete and durable in this folder.
    There(PathBuf),
    /// The record was withdrawn from its patient meanwhile: there is nothing to add to.
    Withdrawn,
}

impl Family {
    /// The revisions among these records of one patient's folder, in their order.
    fn group(patient_folder: &Path, records: Vec<(RecordName, PathBuf)>) -> Vec<Family> {
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

    /// The patient whose folder it is in: outer `None` if this is no patient's folder, inner `None` for
    /// unassigned scans.
    pub fn patient(&self) -> Option<Option<String>> {
        let name = self.patient_folder.file_name().and_then(OsStr::to_str)?;
        naming::patient_of_folder(name)
    }

    /// Adds a revision: writes its files into a folder of its own beside the others, `SHA256SUMS` last.
    /// The files get the same owner as the record.
    ///
    /// # Errors
    /// Any I/O error, `AlreadyExists` if there is such a revision by now. Nothing that looks like a
    /// record is left then.
    pub fn add(&self, revision: u32, files: &[RecordFile]) -> io::Result<Added> {
        let (latest, beside) = self.latest();
        let name = RecordName { revision, ..latest.clone() }.folder();
        add(&self.patient_folder, beside, &name, files)
    }
}

/// Adds a revision of this name beside another one, in the same folder. Withdraws it if the other one is
/// gone meanwhile.
fn add(within: &Path, beside: &Path, name: &str, files: &[RecordFile]) -> io::Result<Added> {
    let staged = within.join(format!("{STAGING}{}.{name}", std::process::id()));
    let place = within.join(name);
    let added =
        write(&staged, files, beside).and_then(|()| publish(&staged, place, beside, within));
    // The remains of a failure, or of a record that is withdrawn now.
    durable::remove_folder(&staged)?;
    added
}

/// Gives a staged revision its name, and withdraws it if the record beside it is gone meanwhile.
fn publish(staged: &Path, place: PathBuf, beside: &Path, within: &Path) -> io::Result<Added> {
    durable::rename_new(staged, &place)?;
    durable::sync_folder(within)?;
    if fs::exists(beside)? {
        return Ok(Added::There(place));
    }
    durable::rename_new(&place, staged)?;
    durable::sync_folder(within)?;
    Ok(Added::Withdrawn)
}

/// The records at a path: a store of patients' folders, one patient's folder, or one record's. They are
/// sorted by name.
///
/// # Errors
/// If a folder cannot be listed.
pub fn families(at: &Path) -> Result<Vec<Family>, StoreFault> {
    let own_name = at.file_name().and_then(OsStr::to_str).and_then(RecordName::read);
    if let (Some(name), Some(patient)) = (own_name, at.parent()) {
        let mut families = Family::group(patient, records_in(patient)?);
        families.retain(|family| family.is_of(&name));
        return Ok(families);
    }
    let mut found = Family::group(at, records_in(at)?);
    let mut patients = folders(at)?;
    patients.sort();
    for patient in patients {
        let name = patient.file_name().and_then(OsStr::to_str);
        if name.and_then(naming::patient_of_folder).is_some() {
            found.extend(Family::group(&patient, records_in(&patient)?));
        }
    }
    Ok(found)
}

/// The folder of the latest revision of the record in this folder: the folder itself if there is no
/// later one or if that cannot be determined now.
pub fn latest(folder: &Path) -> PathBuf {
    let family = families(folder).ok().and_then(|mut families| families.pop());
    family.map_or_else(|| folder.to_owned(), |family| family.latest().1.clone())
}

/// Removes staged folders that a killed run left in a patient's folder. Those of a run that still works,
/// here or elsewhere, stay.
pub fn clear_staging(patient_folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(patient_folder)? {
        let entry = entry?;
        if !entry.file_name().to_string_lossy().starts_with(STAGING) {
            continue;
        }
        // Without locks in the file system, folders that may still be in use are kept.
        let held = File::open(entry.path());
        if held.is_ok_and(|held| flock(&held, FlockOperation::NonBlockingLockExclusive).is_ok()) {
            durable::remove_folder(&entry.path())?;
        }
    }
    Ok(())
}

/// Writes a complete folder, synced, with the same owner and for the same readers as the one it goes
/// beside.
fn write(staged: &Path, files: &[RecordFile], beside: &Path) -> io::Result<()> {
    let owner = fs::metadata(beside)?;
    let access = Access::of_folder(owner.mode());
    access.make_folder(staged)?;
    let held = File::open(staged)?;
    // See `clear_staging`; without locks nothing is removed.
    let _ = flock(&held, FlockOperation::NonBlockingLockExclusive);
    let ours = held.metadata()?;
    let gives = (owner.uid(), owner.gid()) != (ours.uid(), ours.gid());
    let give = |path: &Path| match gives {
        true => chown(path, Some(owner.uid()), Some(owner.gid())),
        false => Ok(()),
    };
    for file in files {
        let path = staged.join(&file.name);
        access.write_new(&path, &file.bytes)?;
        give(&path)?;
    }
    give(staged)?;
    durable::sync_folder(staged)
}

#[cfg(test)]
mod tests;
