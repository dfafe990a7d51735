//! The records of one patient in the folder store, from an index that is only a cache.
//!
//! `record-index/<hash>.json` in the station's state folder holds what the records of one patient say, and
//! names no patient. See [`crate::flow::patient::index`] for what is kept and when it is read again. An index
//! that is missing, damaged or of another version is made anew; one that cannot be written is done without.

use std::fs;
use std::io;
use std::os::unix::fs::{MetadataExt, chown};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::brief::{Brief, read_most};
use super::folder::FolderStore;
use super::listing::records_in;
use super::{StoreFault, durable, tried};
use crate::flow::patient::index::{Entry, FileState, Plan, Sight, Told, plan};
use crate::flow::patient::naming::{RecordName, patient_folder};
use crate::record::{Acquired, RECORD, sha256};

/// The folder of the indexes within the state folder.
const FOLDER: &str = "record-index";

/// The version of an index file.
const SCHEMA: &str = "gaiter.record-index/1";

/// The longest index that is read, bytes; that of a patient with a thousand records has 400 000.
const INDEX_MOST: u64 = 16_000_000;

/// A record of a patient in the store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordAt {
    /// The folder of its latest revision.
    pub folder: PathBuf,
    /// When the scan was taken; `None` if the record does not say.
    pub acquired: Option<Acquired>,
    /// The hash of the scan's bytes, 64 hexadecimal digits.
    pub scan_sha256: String,
    /// The number of the latest revision, from 1.
    pub revision: u32,
}

/// Why a folder that is named like a record is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeftOut {
    /// It has no `record.json`, or one that cannot be understood.
    Unreadable,
    /// Its `record.json` names another patient, or none, or one in the folder of unassigned scans.
    OfAnother,
}

/// The records of a patient.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct RecordsOf {
    /// The latest revision of each, oldest first; those of unknown time come before all others. Backwards, the
    /// newest comes first.
    pub records: Vec<RecordAt>,
    /// The folders that are left out, and why.
    pub left_out: Vec<(PathBuf, LeftOut)>,
}

/// The index of a store's records by patient.
#[derive(Debug, Clone)]
pub struct RecordIndex {
    store: FolderStore,
    state_dir: PathBuf,
}

/// A patient's index as it is stored.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    schema: String,
    entries: Vec<Entry>,
    /// The hash of the entries as JSON: a changed digit would choose other visits.
    sum: String,
}

impl RecordIndex {
    /// The index of a store, kept in a station's state folder.
    pub fn new(store: FolderStore, state_dir: &Path) -> RecordIndex {
        RecordIndex { store, state_dir: state_dir.to_owned() }
    }

    /// The records of a patient, or of no patient. Reads only records that changed since they were last asked
    /// for.
    ///
    /// # Errors
    /// A transient fault if the store is out of reach; a permanent one if the patient's folder is a link.
    pub fn records_of(&self, patient: Option<&str>) -> Result<RecordsOf, StoreFault> {
        self.store.reach()?;
        let Some(folder) = self.store.own_folder(patient)? else {
            self.forget(patient);
            return Ok(RecordsOf::default());
        };
        let places = latest_of_each(records_in(&folder)?);
        let sights = places.iter().map(|place| sight(place)).collect::<Result<Vec<_>, _>>()?;
        let plan = plan(self.known(patient), sights);
        let is_change = plan.is_change();
        let entries = read_missing(plan, &folder, patient)?;
        if is_change {
            // The answer does not depend on it: without an index the records are read the next time, too.
            let _ = self.keep(patient, &entries);
        }
        Ok(sorted(&folder, entries))
    }

    /// Removes what the index holds of a patient.
    pub fn forget(&self, patient: Option<&str>) {
        // What is left is of no record that exists, and is dropped when the patient is asked for.
        let _ = fs::remove_file(self.folder().join(self.name(patient)));
    }

    fn folder(&self) -> PathBuf {
        self.state_dir.join(FOLDER)
    }

    /// The name of a patient's index, which does not show the id.
    fn name(&self, patient: Option<&str>) -> String {
        let of = format!("{}\0{}", self.store.place(), patient_folder(patient));
        format!("{}.json", &sha256(of.as_bytes())[..32])
    }

    /// What was known; nothing if that cannot be read or was damaged.
    fn known(&self, patient: Option<&str>) -> Vec<Entry> {
        let stored = read_most(&self.folder().join(self.name(patient)), INDEX_MOST);
        let stored = stored.ok().and_then(|bytes| serde_json::from_slice::<Stored>(&bytes).ok());
        let is_sound =
            |stored: &Stored| stored.schema == SCHEMA && sum(&stored.entries) == stored.sum;
        stored.filter(is_sound).map(|stored| stored.entries).unwrap_or_default()
    }

    fn keep(&self, patient: Option<&str>, entries: &[Entry]) -> io::Result<()> {
        let (folder, name) = (self.folder(), self.name(patient));
        // Not made by one who only asks: without a state folder no station has run here.
        let owner = fs::metadata(&self.state_dir)?;
        durable::make_folder_once(&folder)?;
        let stored =
            Stored { schema: SCHEMA.to_owned(), entries: entries.to_vec(), sum: sum(entries) };
        durable::replace_file(&folder, &name, &serde_json::to_vec(&stored)?)?;
        for path in [folder.clone(), folder.join(name)] {
            let ours = fs::metadata(&path)?;
            if (ours.uid(), ours.gid()) != (owner.uid(), owner.gid()) {
                chown(&path, Some(owner.uid()), Some(owner.gid()))?;
            }
        }
        Ok(())
    }
}

/// The latest revision of each record, in the order of their names.
fn latest_of_each(records: Vec<(RecordName, PathBuf)>) -> Vec<PathBuf> {
    let mut latest: Vec<(RecordName, PathBuf)> = Vec::with_capacity(records.len());
    for (name, place) in records {
        let is_later = latest.last().is_some_and(|(before, _)| {
            (before.first_seen, &before.scan) == (name.first_seen, &name.scan)
        });
        if is_later {
            latest.pop();
        }
        latest.push((name, place));
    }
    latest.into_iter().map(|(_, place)| place).collect()
}

fn sight(place: &Path) -> Result<Sight, StoreFault> {
    let folder = place.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let path = place.join(RECORD);
    let state = match fs::symlink_metadata(&path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        found => Some(state_of(&tried("looking at", &path, found)?)),
    };
    Ok(Sight { folder, state })
}

fn state_of(found: &fs::Metadata) -> FileState {
    let time = |seconds: i64, ns: i64| i128::from(seconds) * 1_000_000_000 + i128::from(ns);
    FileState {
        size: found.size(),
        mtime_ns: time(found.mtime(), found.mtime_nsec()),
        ctime_ns: time(found.ctime(), found.ctime_nsec()),
    }
}

/// The entries of a plan, with those that had to be read. A folder without `record.json` has an entry that
/// never holds, so that it is looked at again.
fn read_missing(
    plan: Plan,
    folder: &Path,
    patient: Option<&str>,
) -> Result<Vec<Entry>, StoreFault> {
    let mut entries = plan.kept;
    for Sight { folder: name, state } in plan.to_read {
        let told = match state {
            None => None,
            Some(_) => told(&folder.join(&name).join(RECORD), patient)?,
        };
        let state = state.unwrap_or(FileState { size: 0, mtime_ns: 0, ctime_ns: 0 });
        entries.push(Entry { folder: name, state, told });
    }
    entries.sort_by(|one, other| one.folder.cmp(&other.folder));
    Ok(entries)
}

/// What a `record.json` says; `None` if it cannot be understood.
fn told(path: &Path, patient: Option<&str>) -> Result<Option<Told>, StoreFault> {
    let Some(brief) = Brief::read(path)? else { return Ok(None) };
    let is_own = brief.patient_id() == patient;
    let Brief { revision, acquired, scan, .. } = brief;
    Ok(Some(Told { scan_sha256: scan.sha256, acquired, revision, is_own }))
}

fn sorted(folder: &Path, entries: Vec<Entry>) -> RecordsOf {
    let mut of = RecordsOf::default();
    for Entry { folder: name, told, .. } in entries {
        let place = folder.join(name);
        match told {
            None => of.left_out.push((place, LeftOut::Unreadable)),
            Some(told) if !told.is_own => of.left_out.push((place, LeftOut::OfAnother)),
            Some(Told { scan_sha256, acquired, revision, .. }) => {
                of.records.push(RecordAt { folder: place, acquired, scan_sha256, revision });
            }
        }
    }
    of.records.sort_by_key(|record| record.acquired.as_ref().map(|acquired| acquired.at));
    of
}

/// The hash of entries as they are stored.
fn sum(entries: &[Entry]) -> String {
    serde_json::to_vec(entries).map(|bytes| sha256(&bytes)).unwrap_or_default()
}

#[cfg(test)]
mod tests;
