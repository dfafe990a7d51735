//! Finding records that lie in the store already, and taking one back.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use super::{FolderStore, folders};
use crate::flow::{ScanId, naming};
use crate::record::ORD;
use crate::store::sums::{self, SUMS};
use crate::store::{FoundRecord, Misfit, StoreFault, StoredScan, durable, tried};

/// The whole record of a scan in a patient's folder, under whatever time.
pub(super) fn find(patient: &Path, scan: &ScanId) -> Result<Option<PathBuf>, StoreFault> {
    for place in candidates(patient, scan)? {
        if tried("checking", &place, sums::check(&place, scan))?.is_ok() {
            return Ok(Some(place));
        }
    }
    Ok(None)
}

/// The record folders whose names begin and end as the scan's would.
fn candidates(patient: &Path, scan: &ScanId) -> Result<Vec<PathBuf>, StoreFault> {
    let named = |place: &PathBuf| {
        let name = place.file_name().and_then(OsStr::to_str).and_then(naming::read_record_folder);
        name.is_some_and(|(_, short)| short == scan.short())
    };
    Ok(folders(patient)?.into_iter().filter(named).collect())
}

impl FolderStore {
    /// Every record in the store. Folders that no record of ours is called do not count.
    ///
    /// # Errors
    /// A transient fault where a folder cannot be listed or read.
    pub fn records(&self) -> Result<Vec<FoundRecord>, StoreFault> {
        let mut found = Vec::new();
        for patient in folders(&self.root)? {
            let name = patient.file_name().and_then(OsStr::to_str);
            let Some(id) = name.and_then(naming::patient_of_folder) else { continue };
            for folder in folders(&patient)? {
                found.extend(record(folder, id.as_deref())?);
            }
        }
        Ok(found)
    }

    /// A scan from its whole record for this patient; none where there is none.
    ///
    /// # Errors
    /// A transient fault where the store cannot be read.
    pub fn stored_scan(
        &self,
        scan: &ScanId,
        patient: Option<&str>,
    ) -> Result<Option<StoredScan>, StoreFault> {
        let folder = self.root.join(naming::patient_folder(patient));
        if tried("looking for", &folder, fs::exists(&folder)).is_ok_and(|there| !there) {
            return Ok(None);
        }
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

    /// Takes back the record of a scan from one patient, or from the folder of scans for nobody; it
    /// must lie whole in the other's folder.
    ///
    /// # Errors
    /// See [`StoreFault`]: a permanent one where the record was changed by hand.
    pub fn withdraw(
        &self,
        scan: &ScanId,
        from: Option<&str>,
        keeper: Option<&str>,
    ) -> Result<(), StoreFault> {
        self.reach()?;
        let theirs = self.root.join(naming::patient_folder(keeper));
        let from = self.root.join(naming::patient_folder(from));
        if tried("looking for", &from, fs::exists(&from)).is_ok_and(|there| !there) {
            return Ok(());
        }
        let gone = from.join(format!("{}withdrawn_{}", self.staging, scan.short()));
        if tried("looking for", &gone, fs::exists(&gone))? {
            tried("removing", &gone, durable::remove_folder(&gone))?;
        }
        for place in candidates(&from, scan)? {
            let whole = tried("checking", &place, sums::check(&place, scan))?;
            match whole {
                Ok(()) => {}
                Err(sums::SumsFault::OtherScan) => continue,
                Err(fault) => return Err(StoreFault::Permanent(Misfit::Occupied(fault))),
            }
            let kept = find(&theirs, scan)?;
            let Some(kept) = kept else {
                return Err(StoreFault::Permanent(Misfit::Occupied(sums::SumsFault::NoSums)));
            };
            tried("moving notes from", &place, move_unlisted(&place, &kept))?;
            tried("renaming", &place, durable::rename_new(&place, &gone))?;
            tried("syncing", &from, durable::sync_folder(&from))?;
            tried("removing", &gone, durable::remove_folder(&gone))?;
        }
        Ok(())
    }
}

/// Moves what `SHA256SUMS` does not list, a person's notes, from one record to another.
fn move_unlisted(from: &Path, to: &Path) -> std::io::Result<()> {
    let listed = sums::listed(from)?;
    for entry in fs::read_dir(from)? {
        let name = entry?.file_name();
        let ours = name == SUMS || listed.iter().any(|listed| name == OsStr::new(listed));
        if !ours {
            durable::rename_new(&from.join(&name), &to.join(&name))?;
        }
    }
    durable::sync_folder(to)
}

/// The record in a folder; none where the folder is not called like one or lists no scan.
fn record(folder: PathBuf, patient: Option<&str>) -> Result<Option<FoundRecord>, StoreFault> {
    let name = folder.file_name().and_then(OsStr::to_str).and_then(naming::read_record_folder);
    let Some((first_seen, short)) = name else { return Ok(None) };
    let Some((scan, name)) = tried("reading", &folder, sums::scan_of(&folder))? else {
        return Ok(None);
    };
    if scan.short() != short {
        return Ok(None);
    }
    let size = fs::metadata(folder.join(&name)).map_or(0, |metadata| metadata.len());
    let format = name.rsplit('.').next().unwrap_or_default().to_owned();
    let patient = patient.map(str::to_owned);
    Ok(Some(FoundRecord { scan, patient, first_seen, format, size, folder }))
}
