//! Finds records that are already in the store, and withdraws them.

use std::ffi::OsStr;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use gaiter_flow::ScanId;
use gaiter_flow::patient::naming::{self, RecordName};
use gaiter_record::{ORD, RECORD};

use super::FolderStore;
use crate::store::listing::{folders, records_in};
use crate::store::sums::{self, SUMS};
use crate::store::{FoundRecord, Misfit, StoreFault, StoredScan, durable, tried};

/// The beginning of the name of a file with measures that people set in a record that was withdrawn.
const SET_BY_HAND: &str = "set-by-hand";

/// The complete record of a scan in a patient's folder, with any time: the first complete one of several
/// revisions.
pub(super) fn find(patient: &Path, scan: &ScanId) -> Result<Option<PathBuf>, StoreFault> {
    for place in candidates(patient, scan)? {
        if tried("checking", &place, sums::check(&place, scan))?.is_ok() {
            return Ok(Some(place));
        }
    }
    Ok(None)
}

/// The record folders named as the scan's would be, first revision first.
fn candidates(patient: &Path, scan: &ScanId) -> Result<Vec<PathBuf>, StoreFault> {
    let named = records_in(patient)?.into_iter();
    Ok(named.filter(|(name, _)| name.scan == scan.short()).map(|(_, place)| place).collect())
}

impl FolderStore {
    /// Every record in the store; of a scan's revisions, the first. Folders that are not named like our
    /// records do not count.
    ///
    /// # Errors
    /// A transient fault if a folder cannot be listed or read.
    pub fn records(&self) -> Result<Vec<FoundRecord>, StoreFault> {
        let mut found = Vec::new();
        for patient in folders(&self.root)? {
            let name = patient.file_name().and_then(OsStr::to_str);
            let Some(id) = name.and_then(naming::patient_of_folder) else { continue };
            let mut last = None;
            for (name, folder) in records_in(&patient)? {
                let scan = Some((name.first_seen, name.scan.clone()));
                if scan != last
                    && let Some(record) = record(&name, folder, id.as_deref())?
                {
                    found.push(record);
                    last = scan;
                }
            }
        }
        Ok(found)
    }

    /// A scan from its complete record for this patient; `None` if there is none.
    ///
    /// # Errors
    /// A transient fault if the store cannot be read.
    pub fn stored_scan(
        &self,
        scan: &ScanId,
        patient: Option<&str>,
    ) -> Result<Option<StoredScan>, StoreFault> {
        let Some(folder) = self.own_folder(patient)? else { return Ok(None) };
        let Some(place) = find(&folder, scan)? else { return Ok(None) };
        let Some(name) = tried("reading", &place, sums::scan_name(&place, scan))? else {
            return Ok(None);
        };
        let read = |name: &str| {
            let path = place.join(name);
            tried("reading", &path, fs::read(&path))
        };
        let has_ord =
            tried("reading", &place, sums::listed(&place))?.iter().any(|name| name == ORD);
        let ord = has_ord.then(|| read(ORD)).transpose()?;
        Ok(Some(StoredScan { bytes: read(&name)?, ord }))
    }

    /// Withdraws the record of a scan, with all its revisions, from one patient or from the folder of
    /// unassigned scans. The keeper's folder must hold a complete record. What people set goes into a file
    /// there, without effect.
    ///
    /// # Errors
    /// See [`StoreFault`]: a permanent one if a revision was changed by hand; then all stay.
    pub fn withdraw(
        &self,
        scan: &ScanId,
        from: Option<&str>,
        keeper: Option<&str>,
    ) -> Result<(), StoreFault> {
        self.reach()?;
        let Some(from) = self.own_folder(from)? else { return Ok(()) };
        let nowhere = StoreFault::Permanent(Misfit::Occupied(sums::SumsFault::NoSums));
        let theirs = self.own_folder(keeper)?;
        let gone = from.join(format!("{}withdrawn_{}", self.staging, scan.short()));
        if tried("looking for", &gone, fs::exists(&gone))? {
            tried("removing", &gone, durable::remove_folder(&gone))?;
        }
        // Repeated until none is found: a re-extraction may add a revision meanwhile. A later one finds
        // the record gone and removes its revision itself.
        loop {
            let places = whole_records(&from, scan)?;
            if places.is_empty() {
                return Ok(());
            }
            let kept = theirs.as_ref().map(|theirs| find(theirs, scan)).transpose()?.flatten();
            let Some(kept) = kept else { return Err(nowhere) };
            if let Some(latest) = places.last() {
                tried("keeping what people set in", latest, keep_amendments(latest, &kept))?;
            }
            for place in places {
                tried("moving notes from", &place, move_unlisted(&place, &kept))?;
                tried("renaming", &place, durable::rename_new(&place, &gone))?;
                tried("syncing", &from, durable::sync_folder(&from))?;
                tried("removing", &gone, durable::remove_folder(&gone))?;
            }
        }
    }
}

/// The folders that hold complete records of a scan.
fn whole_records(patient: &Path, scan: &ScanId) -> Result<Vec<PathBuf>, StoreFault> {
    let mut whole = Vec::new();
    for place in candidates(patient, scan)? {
        match tried("checking", &place, sums::check(&place, scan))? {
            Ok(()) => whole.push(place),
            Err(sums::SumsFault::OtherScan) => {}
            Err(fault) => return Err(StoreFault::Permanent(Misfit::Occupied(fault))),
        }
    }
    Ok(whole)
}

/// Writes what people set in a record into a file beside the keeper's record. It does not count there:
/// whose leg they measured is not certain.
fn keep_amendments(from: &Path, to: &Path) -> std::io::Result<()> {
    /// The part of a record that is kept.
    #[derive(serde::Serialize, serde::Deserialize)]
    struct SetByHand {
        #[serde(default)]
        amendments: Vec<serde_json::Value>,
    }
    let bytes = fs::read(from.join(RECORD))?;
    let Ok(set) = serde_json::from_slice::<SetByHand>(&bytes) else { return Ok(()) };
    if set.amendments.is_empty() {
        return Ok(());
    }
    let name = from.file_name().unwrap_or_default().to_string_lossy();
    let text = serde_json::to_vec_pretty(&set)?;
    match durable::write_new(&to.join(format!("{SET_BY_HAND}.{name}.json")), &text) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => Ok(()),
        written => written,
    }
}

/// Moves files that `SHA256SUMS` does not list, such as a person's notes, to another record.
fn move_unlisted(from: &Path, to: &Path) -> std::io::Result<()> {
    let listed = sums::listed(from)?;
    for entry in fs::read_dir(from)? {
        let name = entry?.file_name();
        let ours = name == SUMS || listed.iter().any(|listed| name == OsStr::new(listed));
        if ours {
            continue;
        }
        match durable::rename_new(&from.join(&name), &to.join(&name)) {
            // Another revision already moved a note of this name: this one's name says where it is from.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                let mut named = from.file_name().unwrap_or_default().to_owned();
                named.push(".");
                named.push(&name);
                durable::rename_new(&from.join(&name), &to.join(named))?;
            }
            other => other?,
        }
    }
    durable::sync_folder(to)
}

/// The record in a folder of this name; `None` if the folder lists no such scan.
fn record(
    name: &RecordName,
    folder: PathBuf,
    patient: Option<&str>,
) -> Result<Option<FoundRecord>, StoreFault> {
    let Some((scan, file)) = tried("reading", &folder, sums::scan_of(&folder))? else {
        return Ok(None);
    };
    if scan.short() != name.scan {
        return Ok(None);
    }
    let size = fs::metadata(folder.join(&file)).map_or(0, |metadata| metadata.len());
    let format = file.rsplit('.').next().unwrap_or_default().to_owned();
    let (patient, first_seen) = (patient.map(str::to_owned), name.first_seen);
    Ok(Some(FoundRecord { scan, patient, first_seen, format, size, folder }))
}
