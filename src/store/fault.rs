//! Why a record was not stored: not now, or never.

use std::io;
use std::path::PathBuf;

use super::server::ServerFault;
use super::sums;
use crate::record::gdt::ResultFault;

/// Why a record was not stored.
#[derive(Debug, thiserror::Error)]
pub enum StoreFault {
    /// The store cannot take the record now, but may later.
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
        "the practice software has not fetched the last result; the next one waits, because \
         results are never overwritten"
    )]
    NotFetched,
    /// A server does not take the record now, but may later.
    #[error(transparent)]
    Server(#[from] ServerFault),
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
    #[error("a file of the record has the invalid name {name:?}")]
    FileName {
        /// The name.
        name: String,
    },
    /// The record's place is taken by something that is not this scan's complete record.
    #[error("its folder exists but is not this scan's complete record: {0}")]
    Occupied(sums::SumsFault),
    /// The patient's folder is a link, which may lead to another patient's.
    #[error("the patient's folder is a symbolic link")]
    FolderIsLink,
    /// The patient's folder cannot be told apart from another patient's.
    #[error(
        "the store has a folder whose name differs from this patient's only in letter case: it may \
         be another patient's"
    )]
    FolderClash,
    /// The record is unassigned, and practice software takes none of those.
    #[error("it names no patient, which practice software requires")]
    Unassigned,
    /// It holds no readable `record.json`.
    #[error("it holds no readable record.json")]
    NoRecord,
    /// Its `record.json` is another patient's.
    #[error("its record.json names a different patient")]
    OtherPatient,
    /// It cannot be written as a GDT message.
    #[error("it cannot be written as GDT: {0}")]
    Gdt(ResultFault),
    /// The server knows no patient of this id.
    #[error(
        "the server knows no patient of this id: have the patient registered there, then try again"
    )]
    NotRegistered,
    /// The server has several patients of one id.
    #[error("the server has {0} patients of this id: have them merged there, then try again")]
    RegisteredTwice(usize),
    /// The server's patient is closed or was merged into another.
    #[error("the server's patient of this id is closed or was merged into another")]
    PatientNotInUse,
    /// The server does not take what was sent.
    #[error("the server does not take the record ({status}): {why}")]
    ServerRefused {
        /// The status of its answer.
        status: u16,
        /// What it says.
        why: String,
    },
    /// The receiver does not take the message.
    #[error("the receiver does not take the message ({code}): {why}")]
    ReceiverRefused {
        /// The code of its answer.
        code: String,
        /// What it says.
        why: String,
    },
    /// It was handed over to practice software, which keeps its own records.
    #[error(
        "it was handed over to the practice software and cannot be withdrawn: delete it in the \
         practice software"
    )]
    HandedOver,
}

impl StoreFault {
    /// The stable code of this fault, for the journal and `reason.json`.
    pub fn code(&self) -> &'static str {
        match self {
            StoreFault::Transient { .. } | StoreFault::Server(_) => "store-unavailable",
            StoreFault::NotFetched => "result-not-fetched",
            StoreFault::Permanent(Misfit::Occupied(_)) => "store-place-occupied",
            StoreFault::Permanent(Misfit::FolderIsLink) => "patient-folder-is-a-link",
            StoreFault::Permanent(Misfit::FolderClash) => "patient-folder-clash",
            StoreFault::Permanent(Misfit::HandedOver) => "result-handed-over",
            StoreFault::Permanent(Misfit::NotRegistered) => "patient-not-registered",
            StoreFault::Permanent(Misfit::RegisteredTwice(_)) => "patient-registered-twice",
            StoreFault::Permanent(Misfit::PatientNotInUse) => "patient-not-in-use",
            StoreFault::Permanent(
                Misfit::ServerRefused { .. } | Misfit::ReceiverRefused { .. },
            ) => "server-refused",
            StoreFault::Permanent(_) => "store-misfit",
        }
    }
}
