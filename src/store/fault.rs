//! Why a record was not stored: not now, or never.

use std::io;
use std::path::PathBuf;

use gaiter_flow::cause::Cause;
use gaiter_record::gdt::ResultFault;

use super::server::ServerFault;
use super::sums;

/// Why a record was not stored.
#[derive(Debug, thiserror::Error)]
pub enum StoreFault {
    /// The store cannot take the record now, but may later.
    #[error("{what} failed on {path}")]
    Transient {
        what: &'static str,
        path: PathBuf,
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
    /// What leaves the house of this scan could not be made now.
    #[error("the scan could not be cropped now: {0}")]
    NoCrop(String),
    /// The store will never take this record.
    #[error("the store cannot take this record: {0}")]
    Permanent(Rejection),
}

impl StoreFault {
    /// Why, for people, without a path.
    pub fn cause(&self) -> Cause {
        match self {
            StoreFault::Transient { what, source, .. } => {
                Cause::of_system(source).after(format_args!("{what} failed"))
            }
            StoreFault::NotFetched | StoreFault::NoCrop(_) => Cause::verbatim(self),
            StoreFault::Server(fault) => fault.cause(),
            StoreFault::Permanent(rejection) => rejection.cause(),
        }
    }

    /// The fault of an answer over HTTP that is none of success. What a person must correct waits for one; the rest is
    /// asked again.
    pub(super) fn of_status(status: u16, why: String) -> StoreFault {
        match status {
            400 | 410 | 413 | 415 | 422 => {
                StoreFault::Permanent(Rejection::ServerRefused { status, why })
            }
            401 | 403 | 404 | 405 | 407 => ServerFault::Forbidden { status, why }.into(),
            _ => ServerFault::Busy { status, why }.into(),
        }
    }

    /// The stable code of this fault, for the journal and `reason.json`.
    pub fn code(&self) -> &'static str {
        match self {
            StoreFault::Transient { .. } | StoreFault::Server(_) | StoreFault::NoCrop(_) => {
                "store-unavailable"
            }
            StoreFault::NotFetched => "result-not-fetched",
            StoreFault::Permanent(Rejection::Occupied(_)) => "store-place-occupied",
            StoreFault::Permanent(Rejection::InTheWay { .. }) => "store-place-occupied",
            StoreFault::Permanent(Rejection::OtherObject { .. }) => "store-place-occupied",
            StoreFault::Permanent(Rejection::CropDiffers { .. }) => "crop-differs",
            StoreFault::Permanent(Rejection::FolderIsLink) => "patient-folder-is-a-link",
            StoreFault::Permanent(Rejection::FolderClash) => "patient-folder-clash",
            StoreFault::Permanent(Rejection::HandedOver) => "result-handed-over",
            StoreFault::Permanent(Rejection::NotRegistered) => "patient-not-registered",
            StoreFault::Permanent(Rejection::RegisteredTwice(_)) => "patient-registered-twice",
            StoreFault::Permanent(Rejection::PatientNotInUse) => "patient-not-in-use",
            StoreFault::Permanent(Rejection::TakenBackThere) => "taken-back-there",
            StoreFault::Permanent(Rejection::ServerRefused { .. }) => "server-refused",
            StoreFault::Permanent(Rejection::ReceiverRefused { .. }) => "server-refused",
            StoreFault::Permanent(_) => "store-misfit",
        }
    }
}

/// Why a store will never take a record.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Rejection {
    /// The record's last file is not `SHA256SUMS`.
    #[error("its last file is not SHA256SUMS")]
    NoSums,
    /// The spooled bytes are not the scan's.
    #[error("the spooled bytes are not those of the scan")]
    OtherBytes,
    /// A file name that could leave the record's folder or hide.
    #[error("a file of the record has the invalid name {name:?}")]
    FileName { name: String },
    /// The record's place is taken by something that is not this scan's complete record.
    #[error("its folder exists but is not this scan's complete record: {0}")]
    Occupied(sums::SumsFault),
    /// Something is in the way of this record alone.
    #[error("something is in its way: {what} failed ({error})")]
    InTheWay { what: &'static str, error: io::ErrorKind },
    /// The patient's folder is a link, which may lead to another patient's.
    #[error("the patient's folder is a symbolic link")]
    FolderIsLink,
    /// The patient's folder cannot be distinguished from another patient's.
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
    /// Its patient's id cannot be written as DICOM.
    #[cfg(feature = "dicom")]
    #[error("it cannot be written as DICOM: {0}")]
    DicomPatientId(gaiter_dicom::PatientIdFault),
    /// An object of it cannot be written as DICOM.
    #[cfg(feature = "dicom")]
    #[error("it cannot be written as DICOM: {0}")]
    DicomObject(gaiter_dicom::EncodeFault),
    /// The server knows no patient of this id.
    #[error(
        "the server knows no patient of this id: have the patient registered there, then try again"
    )]
    NotRegistered,
    /// The server has several patients of one id.
    #[error("the server has {0} patients of this id: have them merged there, then try again")]
    RegisteredTwice(usize),
    /// The server's patient is closed, was merged into another, or has another id by now.
    #[error(
        "the server's patient of this id is closed, or was merged into another: have it clarified \
         there whose the id is, then try again"
    )]
    PatientNotInUse,
    /// The record is entered in error on the server, and not by this station.
    #[error(
        "on the server the record is marked as entered in error, and not by this station: have it \
         clarified whose it is; if it is this patient's, take the scan back and assign it again"
    )]
    TakenBackThere,
    /// The server does not take what was sent. The words are without the patient's id.
    #[error("the server does not take the record ({status}): {why}")]
    ServerRefused {
        status: u16,
        /// Its text.
        why: String,
    },
    /// The receiver does not take the message. The words are without the patient's id.
    #[error("the receiver does not take the message ({code}): {why}")]
    ReceiverRefused {
        /// The code of its answer.
        code: String,
        /// Its text.
        why: String,
    },
    /// Nothing of the scan can leave the house.
    #[error(
        "nothing of the scan goes to the archive, because its crop is not measured as the whole \
         body is: {why}"
    )]
    CropDiffers {
        /// The first number that differs, or why there is none.
        why: String,
    },
    /// The archive has another object in the scan's place.
    #[error("the archive has another object in the scan's place: {there} bytes, not {own}")]
    OtherObject {
        /// Its length, bytes.
        there: u64,
        /// The length of the scan, packed, bytes.
        own: u64,
    },
    /// It was handed over to practice software, which keeps its own records.
    #[error(
        "it was handed over to the practice software and cannot be withdrawn: delete it in the \
         practice software"
    )]
    HandedOver,
}

impl Rejection {
    /// Why, for people. What only an expert can mend is in English.
    pub fn cause(&self) -> Cause {
        match self {
            Rejection::NotRegistered => Cause::known("patient-not-registered", []),
            Rejection::RegisteredTwice(count) => {
                Cause::known("patient-registered-twice", [("count", count.to_string())])
            }
            Rejection::PatientNotInUse => Cause::known("patient-not-in-use", []),
            Rejection::TakenBackThere => Cause::known("taken-back-there", []),
            Rejection::ServerRefused { status, why } => {
                let names = [("status", status.to_string()), ("why", why.clone())];
                Cause::known("server-refuses", names)
            }
            Rejection::CropDiffers { why } => Cause::known("crop-differs", [("why", why.clone())]),
            Rejection::ReceiverRefused { code, why } => {
                let names = [("code", code.clone()), ("why", why.clone())];
                Cause::known("receiver-refuses", names)
            }
            other => Cause::verbatim(other),
        }
    }
}

#[cfg(test)]
mod tests {
    use gaiter_language::Language;

    use super::*;

    #[test]
    fn what_a_person_can_settle_is_told_in_each_language() {
        let why = "no such code".to_owned();
        for rejection in [
            Rejection::NotRegistered,
            Rejection::RegisteredTwice(2),
            Rejection::PatientNotInUse,
            Rejection::TakenBackThere,
            Rejection::ServerRefused { status: 422, why: why.clone() },
            Rejection::CropDiffers { why: why.clone() },
            Rejection::ReceiverRefused { code: "AR".to_owned(), why },
        ] {
            let cause = rejection.cause();
            assert_eq!(cause.to_string(), rejection.to_string());
            assert_ne!(cause.in_words(Language::De), cause.to_string(), "{rejection:?}");
        }
        let cause = StoreFault::Permanent(Rejection::RegisteredTwice(2)).cause();
        assert_eq!(
            cause.in_words(Language::De),
            "der Server hat 2 Patienten mit dieser ID: dort zusammenführen lassen, dann noch einmal versuchen"
        );
    }
}
