//! Record stores: where finished records go. Each store's `put` is idempotent: made twice, it
//! leaves one record and gives a receipt both times.

pub mod durable;
pub mod folder;
pub mod gdt;
pub mod revision;
pub mod sums;

use std::io;
use std::path::{Path, PathBuf};

use jiff::Timestamp;

use crate::flow::ScanId;
use crate::record::RecordFile;
use crate::record::gdt::ResultFault;
pub use folder::FolderStore;
pub use gdt::GdtStore;

/// A store of records, one of the kinds that gaiter knows.
#[derive(Debug, Clone)]
pub enum RecordStore {
    /// A folder per patient, a folder per record.
    Folder(FolderStore),
    /// Results for a practice's software.
    Gdt(Box<GdtStore>),
}

/// One record on its way to a store.
#[derive(Debug, Clone, Copy)]
pub struct Delivery<'a> {
    /// The scan.
    pub scan: &'a ScanId,
    /// The patient's id; none while nobody named the patient.
    pub patient: Option<&'a str>,
    /// When the station first saw the scan.
    pub first_seen: Timestamp,
    /// The record's files but the scan's own bytes, in the order in which they are to be written,
    /// `SHA256SUMS` last.
    pub files: &'a [RecordFile],
    /// The scan's own bytes, spooled; they become `scan.<ending>`.
    pub scan_file: &'a Path,
    /// The ending of their format.
    pub ending: &'a str,
}

/// A record that lies in a store, as far as its place tells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FoundRecord {
    /// Its scan.
    pub scan: ScanId,
    /// The patient's id; none for one that nobody named.
    pub patient: Option<String>,
    /// When the station first saw the scan.
    pub first_seen: Timestamp,
    /// The ending of the scan's format.
    pub format: String,
    /// Size of the scan, bytes.
    pub size: u64,
    /// Where it lies.
    pub folder: PathBuf,
}

/// A scan as it lies in its record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredScan {
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// The scanner's own measures that came with it, if any.
    pub ord: Option<Vec<u8>>,
}

/// A store's word that a record is whole and durable.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Receipt {
    /// Where the record lies.
    pub folder: PathBuf,
    /// It had been delivered before; nothing was written.
    pub already_there: bool,
}

/// Why a record was not stored.
#[derive(Debug, thiserror::Error)]
pub enum StoreFault {
    /// The store is not in a state to take it now; it may be later.
    #[error("{what} failed on {path}")]
    Transient {
        /// What was tried.
        what: &'static str,
        /// On what.
        path: PathBuf,
        /// How it failed.
        #[source]
        source: io::Error,
    },
    /// The practice software has not fetched what was handed over before.
    #[error(
        "the practice software has not fetched the last result; the next one waits, for none is \
         ever overwritten"
    )]
    NotFetched,
    /// The store will never take this record.
    #[error("the store cannot take this record: {0}")]
    Permanent(Misfit),
}

/// Why a store will never take a record.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Misfit {
    /// The record's last file is not `SHA256SUMS`.
    #[error("its last file is not SHA256SUMS")]
    NoSums,
    /// The spooled bytes are not the scan's.
    #[error("the spooled bytes are not those of the scan")]
    OtherBytes,
    /// A file name that could leave the record's folder or hide.
    #[error("a file of the record is called {name:?}")]
    FileName {
        /// The name.
        name: String,
    },
    /// The record's place is taken by something that is not this scan's whole record.
    #[error("its folder exists and is not this scan's whole record: {0}")]
    Occupied(sums::SumsFault),
    /// The patient's folder is a link, which may lead into another patient's.
    #[error("the patient's folder is a symbolic link")]
    FolderIsLink,
    /// The patient's folder cannot be told from another's.
    #[error(
        "the store has a folder whose name is this patient's but for upper and lower case: it may be \
         another patient's"
    )]
    FolderClash,
    /// A record for nobody, and practice software takes none.
    #[error("it names no patient, and practice software takes none without")]
    Nobodys,
    /// It holds no `record.json` that can be read.
    #[error("it holds no readable record.json")]
    NoRecord,
    /// Its `record.json` is another patient's.
    #[error("its record.json names another patient than the delivery")]
    OtherPatient,
    /// There is no GDT message of it.
    #[error("it cannot be written as GDT: {0}")]
    Gdt(ResultFault),
    /// It was handed over to people who keep their own records.
    #[error(
        "it was handed over to the practice software and cannot be taken back from there: a person \
         must delete it in the practice"
    )]
    HandedOver,
}

impl StoreFault {
    /// The stable code of this fault, for the journal and `reason.json`.
    pub fn code(&self) -> &'static str {
        match self {
            StoreFault::Transient { .. } => "store-unavailable",
            StoreFault::NotFetched => "result-not-fetched",
            StoreFault::Permanent(Misfit::Occupied(_)) => "store-place-occupied",
            StoreFault::Permanent(Misfit::FolderIsLink) => "patient-folder-is-a-link",
            StoreFault::Permanent(Misfit::FolderClash) => "patient-folder-clash",
            StoreFault::Permanent(Misfit::HandedOver) => "result-handed-over",
            StoreFault::Permanent(_) => "store-misfit",
        }
    }
}

impl RecordStore {
    /// The store's name in the journal.
    pub fn name(&self) -> &'static str {
        match self {
            RecordStore::Folder(store) => store.name(),
            RecordStore::Gdt(_) => GdtStore::NAME,
        }
    }

    /// Whether it takes records for nobody.
    pub fn takes_nobodys(&self) -> bool {
        match self {
            RecordStore::Folder(_) => true,
            RecordStore::Gdt(_) => false,
        }
    }

    /// Begins a new store: marks it, and makes its folder before where that is wanted.
    ///
    /// # Errors
    /// A transient fault where that is not possible now.
    pub fn begin(&self, make_folder: bool) -> Result<(), StoreFault> {
        match self {
            RecordStore::Folder(store) => {
                if make_folder {
                    store.make_root()?;
                }
                store.mark()
            }
            RecordStore::Gdt(store) => store.begin(make_folder),
        }
    }

    /// Whether a record can be taken back; what practice software was handed is its own.
    pub fn gives_back(&self) -> bool {
        match self {
            RecordStore::Folder(_) => true,
            RecordStore::Gdt(_) => false,
        }
    }

    /// Where the store is, as the configuration says.
    pub fn place(&self) -> String {
        match self {
            RecordStore::Folder(store) => store.place(),
            RecordStore::Gdt(store) => store.place(),
        }
    }

    /// Makes the store ready after a start: clears what a crash left half made.
    ///
    /// # Errors
    /// A transient fault where the store is out of reach.
    pub fn open(&self) -> Result<(), StoreFault> {
        match self {
            RecordStore::Folder(store) => store.clear_staging(),
            RecordStore::Gdt(store) => store.open(),
        }
    }

    /// Whether the store is in reach, so that no scan is measured for a store that is not.
    ///
    /// # Errors
    /// A transient fault where it is not.
    pub fn reach(&self) -> Result<(), StoreFault> {
        match self {
            RecordStore::Folder(store) => store.reach(),
            RecordStore::Gdt(store) => store.reach(),
        }
    }

    /// Every record in the store.
    ///
    /// # Errors
    /// A transient fault where the store is out of reach or only half of it could be read.
    pub fn records(&self) -> Result<Vec<FoundRecord>, StoreFault> {
        match self {
            RecordStore::Folder(store) => store.records(),
            RecordStore::Gdt(store) => store.records(),
        }
    }

    /// The bytes of a scan, from its record for this patient; none where there is no such record.
    ///
    /// # Errors
    /// A transient fault where the store is out of reach.
    pub fn stored_scan(
        &self,
        scan: &ScanId,
        patient: Option<&str>,
    ) -> Result<Option<StoredScan>, StoreFault> {
        match self {
            RecordStore::Folder(store) => store.stored_scan(scan, patient),
            RecordStore::Gdt(_) => Ok(None),
        }
    }

    /// Takes back the record of a scan from a patient, or from nobody's folder, now that `keeper` has
    /// it. What a person added to it goes to the keeper's record. Done again, this does nothing.
    ///
    /// # Errors
    /// See [`StoreFault`]; a permanent one where the record was changed and so is left as it is.
    pub fn withdraw(
        &self,
        scan: &ScanId,
        from: Option<&str>,
        keeper: Option<&str>,
    ) -> Result<(), StoreFault> {
        match self {
            RecordStore::Folder(store) => store.withdraw(scan, from, keeper),
            RecordStore::Gdt(_) => Err(StoreFault::Permanent(Misfit::HandedOver)),
        }
    }

    /// Stores a record, or finds that it is there already.
    ///
    /// # Errors
    /// See [`StoreFault`]; after any of them the same `put` may be tried again.
    pub fn put(&self, delivery: &Delivery<'_>) -> Result<Receipt, StoreFault> {
        match self {
            RecordStore::Folder(store) => store.put(delivery),
            RecordStore::Gdt(store) => store.put(delivery),
        }
    }
}

/// Every I/O error of a store may pass: disks fill and empty, shares go and come back.
fn tried<T>(what: &'static str, path: &Path, result: io::Result<T>) -> Result<T, StoreFault> {
    result.map_err(|source| StoreFault::Transient { what, path: path.to_owned(), source })
}
