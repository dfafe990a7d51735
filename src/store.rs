//! Record stores: where finished records go. Each store's `put` is idempotent: a second call leaves one
//! record and returns a receipt again.

pub mod archive;
pub mod brief;
mod connection;
#[cfg(feature = "dicom")]
pub mod dicom;
pub mod durable;
mod exchange;
mod fault;
pub mod fhir;
pub mod folder;
pub mod gdt;
pub mod hl7;
pub mod json_folder;
pub mod polling;
pub mod revision;
pub mod server;
pub mod sums;
mod web;

use std::ffi::OsStr;
use std::fmt;
use std::fs::{self, DirEntry};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use jiff::{Timestamp, Zoned};

pub use archive::ArchiveStore;
pub use connection::Peer;
#[cfg(feature = "dicom")]
pub use dicom::DicomStore;
pub use fault::{Rejection, StoreFault};
pub use fhir::FhirStore;
pub use folder::{FolderStore, PersonFolder};
use gaiter_flow::ScanId;
use gaiter_flow::patient::naming::RecordName;
use gaiter_flow::patient::person::HandedOver;
use gaiter_flow::worklist::ListedPerson;
use gaiter_record::{Acquired, ImagingRequest, RECORD, Record, RecordFile};
pub use gdt::GdtStore;
pub use hl7::Hl7Store;
pub use server::ServerFault;
pub use web::HttpAccess;

/// The permission bits of everybody but the owner.
pub const OTHERS: u32 = 0o077;

/// Who may read what is written. It holds scans of patients' bodies, so nobody else ever may.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Access {
    /// The owner only, whatever the umask.
    #[default]
    Private,
    /// Also the group of the folder it is made in, if that folder is set-group-id or has a default ACL.
    Group,
}

impl Access {
    /// The access to a folder with this mode.
    pub fn of_folder(mode: u32) -> Access {
        let group = Access::Group.folder_mode() & 0o070;
        if mode & group == group { Access::Group } else { Access::Private }
    }

    /// The permission bits of a file.
    pub fn file_mode(self) -> u32 {
        match self {
            Access::Private => 0o600,
            Access::Group => 0o640,
        }
    }

    /// The permission bits of a folder.
    pub fn folder_mode(self) -> u32 {
        match self {
            Access::Private => 0o700,
            Access::Group => 0o750,
        }
    }
}

/// A step at a store that waits for a disk or for one answer takes no longer. A record has a few megabytes.
const STEP_MOST: Duration = Duration::from_secs(60);

/// A store of records. A new kind is a file here, a section of `station.toml`, a page of the
/// documentation and a line in `station/stores.rs`; everything else asks the store. All calls block.
pub trait RecordStore: fmt::Debug + Send + Sync {
    /// The store's name in the journal.
    fn name(&self) -> &'static str;

    /// Where the store is, as configured.
    fn place(&self) -> String;

    /// Reports whether the store takes records of scans without a patient.
    fn takes_unassigned(&self) -> bool {
        false
    }

    /// Reports whether a record can be withdrawn; practice software keeps what it was handed.
    fn gives_back(&self) -> bool {
        true
    }

    /// Reports whether others act on what is there at once: a withdrawal does not wait for another patient's
    /// record, and an erasure removes nothing there.
    fn is_server(&self) -> bool {
        false
    }

    /// The file of the station's own certificate, which it shows to the server.
    fn own_certificate(&self) -> Option<&Path> {
        None
    }

    /// The longest time that a step here takes while the store still answers, such as one [`RecordStore::put`]. A
    /// step that lasts longer has stalled.
    fn step_most(&self) -> Duration {
        STEP_MOST
    }

    /// Begins a new store: makes its folder if `make_folder` is set, then marks it.
    ///
    /// # Errors
    /// A transient fault if that is not possible now.
    fn begin(&self, _make_folder: bool) -> Result<(), StoreFault> {
        Ok(())
    }

    /// Prepares the store after a start: removes what a crash left half made.
    ///
    /// # Errors
    /// A transient fault if the store is out of reach.
    fn open(&self) -> Result<(), StoreFault> {
        Ok(())
    }

    /// Checks that the store is in reach, so that no scan is measured for a store that is not.
    ///
    /// # Errors
    /// A transient fault if it is not.
    fn reach(&self) -> Result<(), StoreFault>;

    /// Tries the store out for a person who has set it up, as far as that leaves nothing there.
    ///
    /// # Errors
    /// A fault if a record could not be put there.
    fn try_out(&self) -> Result<(), StoreFault> {
        self.reach()
    }

    /// Every record in the store. A server has no list of what one station sent: a record that is sent again is found
    /// there, or in the notes of what was sent.
    ///
    /// # Errors
    /// A transient fault if the store is out of reach or only part of it could be read.
    fn records(&self) -> Result<Vec<FoundRecord>, StoreFault> {
        Ok(Vec::new())
    }

    /// Stores a record, or finds that it is already there.
    ///
    /// # Errors
    /// See [`StoreFault`]; after any of them the same `put` may be tried again.
    fn put(&self, delivery: &Delivery<'_>) -> Result<Receipt, StoreFault>;

    /// Removes what the store has of a person and gives back: records of scans that came before a time,
    /// those of these scans from the unassigned ones, results that have no name yet. A repeated call
    /// does nothing. From a server nothing is removed: what it was given is the house's own, and is listed for the
    /// person who erases.
    ///
    /// # Errors
    /// See [`StoreFault`]; what was removed stays removed.
    fn erase(
        &self,
        _patient: &str,
        _before: Timestamp,
        _scans: &[ScanId],
    ) -> Result<(), StoreFault> {
        Ok(())
    }

    /// Withdraws the record of a scan from a patient, or from the folder of unassigned scans. Files that a person
    /// added to it move to the keeper's record. A repeated call does nothing.
    ///
    /// # Errors
    /// See [`StoreFault`]; a permanent one if the store gives nothing back, or if the record was changed
    /// by hand and is therefore left alone; [`ServerFault::NotShown`] if the server does not show all that it has
    /// confirmed or may still take in: what it shows is withdrawn.
    fn withdraw(&self, record: &TakeBack<'_>) -> Result<(), StoreFault>;

    /// The head of the station's history, as [`RecordStore::keep_head`] left it; `None` if there is none.
    ///
    /// # Errors
    /// A transient fault if the store is out of reach.
    fn kept_head(&self) -> Result<Option<String>, StoreFault> {
        Ok(None)
    }

    /// Keeps the head of the station's history beside its records, where the store has a place for it: a
    /// state folder that was put back from a backup is older than that.
    ///
    /// # Errors
    /// A transient fault if the store is out of reach.
    fn keep_head(&self, _line: &str) -> Result<(), StoreFault> {
        Ok(())
    }

    /// Makes the head that was kept last durable: after an erasure an older one would be of another
    /// history.
    ///
    /// # Errors
    /// A transient fault if it cannot be synced.
    fn settle_head(&self) -> Result<(), StoreFault> {
        Ok(())
    }

    /// The bytes of a scan, from its record for this patient; `None` if there is no such record.
    ///
    /// # Errors
    /// A transient fault if the store is out of reach.
    fn stored_scan(
        &self,
        _scan: &ScanId,
        _patient: Option<&str>,
    ) -> Result<Option<StoredScan>, StoreFault> {
        Ok(None)
    }

    /// What lies in a person's folder; `None` if the store keeps no folders.
    ///
    /// # Errors
    /// A transient fault if the store is out of reach; a permanent one if the folder is a link.
    fn of_person(&self, _patient: &str) -> Result<Option<PersonFolder>, StoreFault> {
        Ok(None)
    }

    /// The file of a message with this reference, while the receiver has not fetched it.
    fn unfetched(&self, _reference: &str) -> Option<PathBuf> {
        None
    }

    /// What was handed over of a person, by a store that people do not read as folders.
    ///
    /// # Errors
    /// A transient fault if that cannot be read.
    fn given(&self, _patient: &str) -> Result<Vec<HandedOver>, StoreFault> {
        Ok(Vec::new())
    }
}

/// A record that is withdrawn, and what is known of its delivery, for servers.
#[derive(Debug, Clone, Copy)]
pub struct TakeBack<'a> {
    pub scan: &'a ScanId,
    /// The patient whose record it was; `None` if it was no patient's.
    pub from: Option<&'a str>,
    /// The patient who has it now; `None` if it is no patient's.
    pub keeper: Option<&'a str>,
    /// What the server has confirmed the record by, '' if it was sent and not confirmed; `None` if it is not known
    /// whether it was sent.
    pub receipt: Option<&'a str>,
    /// The request that the record answers.
    pub request: Option<&'a ImagingRequest>,
    /// The turn in which it was delivered last.
    pub turn: u32,
    /// When the scan was taken, by the clock at the scanner; `None` if it is not known.
    pub taken: Option<&'a Zoned>,
}

impl<'a> TakeBack<'a> {
    /// A record of whose delivery nothing is known.
    pub fn new(scan: &'a ScanId, from: Option<&'a str>) -> TakeBack<'a> {
        TakeBack { scan, from, keeper: None, receipt: None, request: None, turn: 0, taken: None }
    }
}

/// One record on its way to a store.
#[derive(Debug, Clone, Copy)]
pub struct Delivery<'a> {
    pub scan: &'a ScanId,
    /// The patient's id; `None` if no patient was named.
    pub patient: Option<&'a str>,
    /// Who that is according to the day's worklist. It is for the store to which the configuration lets it go, and
    /// for nothing that lasts at the station.
    pub person: Option<&'a ListedPerson>,
    /// When the station first saw the scan.
    pub first_seen: Timestamp,
    /// The revision of the record.
    pub revision: u32,
    /// How often the scan was taken from this patient and given back; counted for servers.
    pub turn: u32,
    /// The record's files except the scan's own bytes, in the order in which they are to be written,
    /// `SHA256SUMS` last.
    pub files: &'a [RecordFile],
    /// The scan's own bytes, spooled; they become `scan.<ending>`.
    pub scan_file: &'a Path,
    /// The ending of their format.
    pub ending: &'a str,
}

impl<'a> Delivery<'a> {
    /// A file of the record, by its name.
    pub fn file(&self, name: &str) -> Option<&'a RecordFile> {
        self.files.iter().find(|file| file.name == name)
    }

    /// The record, and the patient whom it names: another one's figures must never go out under this id.
    ///
    /// # Errors
    /// [`Rejection::Unassigned`], [`Rejection::NoRecord`], [`Rejection::OtherPatient`].
    pub fn named_record(&self) -> Result<(Record, &'a str), Rejection> {
        let patient = self.patient.ok_or(Rejection::Unassigned)?;
        let json = self.file(RECORD).ok_or(Rejection::NoRecord)?;
        let record: Record =
            serde_json::from_slice(&json.bytes).map_err(|_| Rejection::NoRecord)?;
        match record.patient.as_ref().is_some_and(|named| named.id == patient) {
            true => Ok((record, patient)),
            false => Err(Rejection::OtherPatient),
        }
    }
}

/// A record in a store, as far as its place and a first look into it show it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FoundRecord {
    pub scan: ScanId,
    /// The patient's id; `None` if no patient was named.
    pub patient: Option<String>,
    /// The request that it answers for this patient; `None` if the store does not keep that.
    pub request: Option<ImagingRequest>,
    /// When the scan was taken; `None` if the store does not keep that.
    pub acquired: Option<Acquired>,
    /// When the station first saw the scan.
    pub first_seen: Timestamp,
    /// The ending of the scan's format.
    pub format: String,
    /// Size of the scan, bytes.
    pub size: u64,
    pub folder: PathBuf,
}

/// A scan as stored in its record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredScan {
    pub bytes: Vec<u8>,
    /// The scanner's own measures that came with it, if any.
    pub ord: Option<Vec<u8>>,
}

/// A store's confirmation that a record is complete and durable.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Receipt {
    /// The folder of the record.
    pub folder: PathBuf,
    /// The record was already there; nothing was written.
    pub already_there: bool,
}

/// Treats an I/O error of a store as transient: disks fill and empty, shares go and come back. What is in the
/// way of one record is distinguished where the record is known.
fn tried<T>(what: &'static str, path: &Path, result: io::Result<T>) -> Result<T, StoreFault> {
    result.map_err(|source| StoreFault::Transient { what, path: path.to_owned(), source })
}

/// The folders in a patient's folder that are named like records, sorted by the meaning of their names:
/// a scan's revisions follow one another.
fn records_in(patient: &Path) -> Result<Vec<(RecordName, PathBuf)>, StoreFault> {
    let named = |place: PathBuf| {
        let name = place.file_name().and_then(OsStr::to_str).and_then(RecordName::read)?;
        Some((name, place))
    };
    let mut records: Vec<_> = folders(patient)?.into_iter().filter_map(named).collect();
    records.sort();
    Ok(records)
}

/// The folders in a folder; links are not followed.
fn folders(within: &Path) -> Result<Vec<PathBuf>, StoreFault> {
    let mut folders = Vec::new();
    for entry in listed(within)? {
        if tried("listing", within, entry.file_type())?.is_dir() {
            folders.push(entry.path());
        }
    }
    Ok(folders)
}

/// What is in a folder.
fn listed(within: &Path) -> Result<Vec<DirEntry>, StoreFault> {
    tried("listing", within, fs::read_dir(within).and_then(Iterator::collect))
}
