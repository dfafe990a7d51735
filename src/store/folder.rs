//! The default store: `RECORDS/<patient>/<first seen>_<scan>/`.
//!
//! A record is staged beside its place under a dot name. All its files are written, `SHA256SUMS` last;
//! then every file is synced, then the staged folder. Then the folder is renamed, never over another, and the patient's folder is
//! synced. So a folder under its final name is complete, and a receipt survives a power cut. Stations
//! that share the store take turns in this last step, so a scan that two of them saw has one record.

mod lock;
mod owner;
mod person;
mod search;

use std::ffi::OsStr;
use std::fs::{self, OpenOptions};
use std::io::ErrorKind;
use std::os::unix::fs::{FileExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use gaiter_flow::ScanId;
use gaiter_flow::patient::naming;
use gaiter_record::{FIRST_REVISION, RecordFile};
use jiff::Timestamp;

use self::lock::StoreLock;
use self::search::{KEEPS_IT, find};
use super::revision::{self, Added};
use super::sums::{self, SUMS};
use super::{
    Delivery, FoundRecord, Receipt, RecordStore, Rejection, StoreFault, StoredScan, TakeBack,
    durable, folders, tried,
};
use crate::store::Access;
pub use person::PersonFolder;

/// The file that marks a store's folder.
const MARK: &str = ".gaiter-store";

/// Its content, for people who find it.
const MARK_TEXT: &str = "This folder holds the records of gaiter stations. A station that does not \
find this file assumes that the share is not mounted.\n";

/// Suffix of a staged folder that is complete and waits for its place.
const WHOLE: &str = ".whole";

/// Errors that mean that something else is where a record or its folder belongs.
const TAKEN: [ErrorKind; 4] = [
    ErrorKind::AlreadyExists,
    ErrorKind::InvalidFilename,
    ErrorKind::IsADirectory,
    ErrorKind::NotADirectory,
];

/// Records as folders on a disk or share.
#[derive(Debug, Clone)]
pub struct FolderStore {
    root: PathBuf,
    /// Prefix of this station's staged folders. Several stations may share the store, and none may
    /// remove what another is writing. A station id contains no dot, so no prefix is the beginning of
    /// another.
    staging: String,
    /// The name of the file with the head of this station's history. A station whose journal does not hold it works
    /// on an older copy of its state folder, and does not know which records were made since.
    head: String,
    /// Its name in the journal.
    name: &'static str,
    /// Who may read its records.
    access: Access,
}

impl FolderStore {
    /// The name in the journal of the store whose records people open and amend.
    pub const FIRST: &str = "folder";

    /// The store with this name in the journal, at `root`, used by the station `station`, with records
    /// for `access`.
    pub fn new(name: &'static str, root: PathBuf, station: &str, access: Access) -> FolderStore {
        let (staging, head) = (format!(".staging.{station}."), format!(".gaiter-head.{station}"));
        FolderStore { root, staging, head, name, access }
    }

    fn put_in_reach(&self, delivery: &Delivery<'_>) -> Result<Receipt, StoreFault> {
        let patient = self.patient_folder(delivery.patient)?;
        if delivery.revision > FIRST_REVISION {
            return put_revision(&patient, delivery);
        }
        let name = naming::record_folder(delivery.first_seen, delivery.scan);
        let place = patient.join(&name);
        let found = match place.symlink_metadata() {
            Ok(_) => Some(place.clone()),
            Err(_) => find(&patient, delivery.scan)?,
        };
        let (place, already_there) = match found {
            Some(found) => (found, true),
            None => {
                let staged = patient.join(format!("{}{name}", self.staging));
                stage(&staged, delivery, self.access)?;
                self.publish(&staged, &patient, place, delivery.scan)?
            }
        };
        if already_there {
            let checked = sums::check(&place, delivery.scan);
            tried("checking", &place, checked)?
                .map_err(|fault| StoreFault::Permanent(Rejection::Occupied(fault)))?;
        }
        // Synced even if it was already there: the run that made it may have crashed before this.
        tried("syncing", &patient, durable::sync_folder(&patient))?;
        Ok(Receipt { folder: place, already_there })
    }

    /// Distinguishes a fault of one record from one of the store: an error of one of these kinds, met in a
    /// patient's folder, keeps no other record from the store.
    fn of_record(&self, fault: StoreFault, kinds: &[ErrorKind]) -> StoreFault {
        match fault {
            StoreFault::Transient { what, path, source }
                if kinds.contains(&source.kind()) && self.is_patients(&path) =>
            {
                StoreFault::Permanent(Rejection::InTheWay { what, error: source.kind() })
            }
            fault => fault,
        }
    }

    /// Whether a path is a patient's folder or lies in one.
    fn is_patients(&self, path: &Path) -> bool {
        let within = path.strip_prefix(&self.root).ok().and_then(|within| within.iter().next());
        within.and_then(OsStr::to_str).and_then(naming::patient_of_folder).is_some()
    }

    /// Gives the staged record its place, unless another station has stored the scan meanwhile. Returns
    /// where the record is, and whether it was already there.
    fn publish(
        &self,
        staged: &Path,
        patient: &Path,
        place: PathBuf,
        scan: &ScanId,
    ) -> Result<(PathBuf, bool), StoreFault> {
        let whole = whole(staged);
        let _lock = StoreLock::take(&self.root.join(MARK))?;
        // After a change of its own a machine drops what it knows about a share's folder, which may be
        // half a minute old. So the search sees what others did before this turn.
        tried("renaming", &whole, durable::rename_new(staged, &whole))?;
        if let Some(found) = find(patient, scan)? {
            tried("clearing", &whole, durable::remove_folder(&whole))?;
            return Ok((found, true));
        }
        match durable::rename_new(&whole, &place) {
            Ok(()) => Ok((place, false)),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                tried("clearing", &whole, durable::remove_folder(&whole))?;
                Ok((place, true))
            }
            Err(source) => Err(StoreFault::Transient { what: "renaming", path: place, source }),
        }
    }
}

impl RecordStore for FolderStore {
    fn name(&self) -> &'static str {
        self.name
    }

    fn place(&self) -> String {
        self.root.to_string_lossy().into_owned()
    }

    fn takes_unassigned(&self) -> bool {
        true
    }

    /// The folder is made for a station's first start only: later a missing one means a share that is not mounted,
    /// and nothing may be written in its place. Its mark distinguishes it from the empty folder that remains then.
    fn begin(&self, make_folder: bool) -> Result<(), StoreFault> {
        if make_folder {
            tried("making the store's folder", &self.root, fs::create_dir_all(&self.root))?;
        }
        let mark = self.root.join(MARK);
        tried("marking", &mark, durable::write_once(&mark, MARK_TEXT.as_bytes()))?;
        tried("syncing", &self.root, durable::sync_folder(&self.root))
    }

    /// Removes staged folders that crashed deliveries of this station left.
    fn open(&self) -> Result<(), StoreFault> {
        for patient in folders(&self.root)? {
            for staged in folders(&patient)? {
                let name = staged.file_name().unwrap_or_default().to_string_lossy();
                if name.starts_with(&self.staging) {
                    tried("clearing", &staged, durable::remove_folder(&staged))?;
                }
            }
        }
        Ok(())
    }

    /// Also checks that the folder is the one that was marked.
    fn reach(&self) -> Result<(), StoreFault> {
        tried("opening", &self.root, fs::read_dir(&self.root))?;
        let mark = self.root.join(MARK);
        let what = "looking for .gaiter-store (missing if a share is not mounted)";
        tried(what, &mark, fs::symlink_metadata(&mark)).map(drop)
    }

    fn records(&self) -> Result<Vec<FoundRecord>, StoreFault> {
        self.all_records()
    }

    /// A record with any time counts as there, because a station that lost its journal sees an old scan
    /// for the first time.
    fn put(&self, delivery: &Delivery<'_>) -> Result<Receipt, StoreFault> {
        fit(delivery)?;
        // Checked each time: the share may have gone since, and its empty mount point accepts anything.
        self.reach()?;
        self.put_in_reach(delivery).map_err(|fault| self.of_record(fault, &TAKEN))
    }

    fn erase(&self, patient: &str, before: Timestamp, scans: &[ScanId]) -> Result<(), StoreFault> {
        self.reach()?;
        let erased = self.erase_in_reach(patient, before, scans);
        erased.map_err(|fault| self.of_record(fault, &KEEPS_IT))
    }

    fn withdraw(&self, record: &TakeBack<'_>) -> Result<(), StoreFault> {
        self.reach()?;
        let withdrawn = self.withdraw_in_reach(record);
        withdrawn.map_err(|fault| self.of_record(fault, &KEEPS_IT))
    }

    fn kept_head(&self) -> Result<Option<String>, StoreFault> {
        let path = self.root.join(&self.head);
        let bytes = tried("reading", &path, durable::if_there(fs::read(&path)))?;
        Ok(bytes.map(|bytes| String::from_utf8_lossy(&bytes).into_owned()))
    }

    /// The head is not synced: a power cut may leave an older one, which only makes the check a little weaker.
    /// Written in place, because each line is as long as the last.
    fn keep_head(&self, line: &str) -> Result<(), StoreFault> {
        self.reach()?;
        let path = self.root.join(&self.head);
        let mut options = OpenOptions::new();
        options.write(true).create(true).truncate(false).mode(self.access.file_mode());
        let written = options.open(&path).and_then(|file| file.write_all_at(line.as_bytes(), 0));
        tried("writing", &path, written)
    }

    fn settle_head(&self) -> Result<(), StoreFault> {
        let path = self.root.join(&self.head);
        let synced = OpenOptions::new().write(true).open(&path).and_then(|file| file.sync_all());
        tried("syncing", &path, synced)
    }

    fn stored_scan(
        &self,
        scan: &ScanId,
        patient: Option<&str>,
    ) -> Result<Option<StoredScan>, StoreFault> {
        self.scan_in_record(scan, patient)
    }

    fn of_person(&self, patient: &str) -> Result<Option<PersonFolder>, StoreFault> {
        self.person_folder(patient).map(Some)
    }
}

/// Puts a later revision beside the record in a patient's folder, or finds that it is already there.
fn put_revision(patient: &Path, delivery: &Delivery<'_>) -> Result<Receipt, StoreFault> {
    let families = revision::families(patient)?;
    let family =
        families.into_iter().find(|family| family.latest().0.scan == delivery.scan.short());
    // It was withdrawn, or the store was changed by hand.
    let family =
        family.ok_or(StoreFault::Permanent(Rejection::Occupied(sums::SumsFault::NoSums)))?;
    let (name, latest) = family.latest();
    if name.revision >= delivery.revision {
        return Ok(Receipt { folder: latest.clone(), already_there: true });
    }
    let scan = tried("reading", delivery.scan_file, fs::read(delivery.scan_file))?;
    let mut files = delivery.files.to_vec();
    let name = format!("scan.{}", delivery.ending);
    files.insert(files.len().saturating_sub(1), RecordFile { name, bytes: scan });
    match tried("adding a revision", patient, family.add(delivery.revision, &files))? {
        Added::There(folder) => Ok(Receipt { folder, already_there: false }),
        Added::Withdrawn => Ok(Receipt { folder: patient.to_owned(), already_there: true }),
    }
}

/// The name of a staged folder that is complete and waits for its place.
fn whole(staged: &Path) -> PathBuf {
    let mut name = staged.as_os_str().to_owned();
    name.push(WHOLE);
    PathBuf::from(name)
}

/// Checks whether the record can be stored at all.
fn fit(delivery: &Delivery<'_>) -> Result<(), StoreFault> {
    if delivery.files.last().is_none_or(|file| file.name != SUMS) {
        return Err(StoreFault::Permanent(Rejection::NoSums));
    }
    match delivery.files.iter().find(|file| !sums::plain(&file.name)) {
        Some(file) => Err(StoreFault::Permanent(Rejection::FileName { name: file.name.clone() })),
        None => Ok(()),
    }
}

/// Writes the complete record under its staging name, synced.
fn stage(staged: &Path, delivery: &Delivery<'_>, access: Access) -> Result<(), StoreFault> {
    // A failed attempt may have left part of the folder, or all of it.
    for left in [staged, &whole(staged)] {
        tried("clearing", left, durable::remove_folder(left))?;
    }
    tried("making the folder", staged, access.make_folder(staged))?;
    let (sums, files) = delivery.files.split_last().unzip();
    let write = |file: &RecordFile| {
        let path = staged.join(&file.name);
        let written = access.write_unsynced(&path, &file.bytes);
        tried("writing", &path, written).map(|written| (path, written))
    };
    let mut written = files.into_iter().flatten().map(write).collect::<Result<Vec<_>, _>>()?;
    let scan = staged.join(format!("{}{}", sums::SCAN, delivery.ending));
    let copied = access.copy_unsynced(delivery.scan_file, &scan);
    let (copy, digest) = tried("copying the scan", &scan, copied)?;
    if ScanId::of_digest(digest) != *delivery.scan {
        tried("clearing", staged, durable::remove_folder(staged))?;
        return Err(StoreFault::Permanent(Rejection::OtherBytes));
    }
    written.push((scan, copy));
    written.extend(sums.map(write).transpose()?);
    // Only now: the disk writes down many new files at once sooner than one after the other.
    for (path, file) in &written {
        tried("syncing", path, file.sync_all())?;
    }
    tried("syncing", staged, durable::sync_folder(staged))
}

#[cfg(test)]
mod tests;
