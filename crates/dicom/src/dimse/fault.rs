//! Why messages over a connection fail. No fault holds what is about a patient.

use std::io;

use dicom_core::Tag;
use dicom_ul::pdu::AssociationRJSource;

use crate::EncodeFault;

/// A text that is no title of an application.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a title has 1 to 16 characters of ASCII, no backslash, and no space at an end")]
pub struct TitleFault;

/// Why a server could not be asked.
#[derive(Debug, thiserror::Error)]
pub enum DimseFault {
    /// The connection broke.
    #[error("the connection broke: {0}")]
    Connection(#[from] io::Error),
    /// The server takes no association with the station. Whether it says that this will last changes nothing: the
    /// titles may be registered there at any time.
    #[error("the server rejects the association: {why}")]
    Rejected {
        /// Its reason.
        why: AssociationRJSource,
    },
    /// The server takes no association with the station, for a reason that the standard does not know.
    #[error(
        "the server rejects the association for the unknown reason {reason} of the source {source_code}"
    )]
    RejectedFor {
        /// Where it comes from (PS3.8, 9.3.4).
        source_code: u8,
        /// Its number.
        reason: u8,
    },
    /// The server ended the association.
    #[error("the server aborts the association")]
    Aborted,
    /// The server does not offer a service to the station.
    #[error("the server does not accept the service {class} (result {result})")]
    NotAccepted {
        /// The UID of the service, or of a kind of object.
        class: &'static str,
        /// Why (PS3.8, 9.3.3.2).
        result: u8,
    },
    /// The server could not do what was asked.
    #[error("the server answers with the status {status:04X}")]
    Status {
        /// The status (0000,0900).
        status: u16,
    },
    /// The server sends more than is asked for.
    #[error("the server sends {bytes} bytes or more where at most {most} are read")]
    TooLong {
        /// Bytes that it has sent or announced.
        bytes: usize,
        /// The most that are read.
        most: usize,
    },
    /// There are more answers than were asked for.
    #[error("the server has more than {most} answers")]
    TooMany {
        /// The most that are read.
        most: usize,
    },
    /// Sequences of an answer lie within each other too deeply.
    #[error("the answer has sequences within each other more than {most} deep")]
    TooDeep {
        /// The deepest that are read.
        most: usize,
    },
    /// An element of an answer is longer than the answer, or is malformed.
    #[error("an element of the answer does not fit into it")]
    Cut,
    /// An answer lacks an element.
    #[error("the answer lacks the element {0}")]
    Missing(Tag),
    /// An answer is of another kind than the request.
    #[error("the answer does not belong to the request")]
    Unexpected,
    /// An answer cannot be read.
    #[error("the answer cannot be read")]
    Unreadable,
    /// What is to be sent cannot be written.
    #[error(transparent)]
    Encode(#[from] EncodeFault),
}

impl DimseFault {
    /// Whether it is about one answer, so that another question may be answered.
    pub fn is_of_an_answer(&self) -> bool {
        let is_of_all = matches!(self, DimseFault::Connection(_) | DimseFault::NotAccepted { .. });
        !is_of_all && !self.is_an_end()
    }

    /// Whether the server has ended the association, or made none.
    pub fn is_an_end(&self) -> bool {
        matches!(
            self,
            DimseFault::Rejected { .. } | DimseFault::RejectedFor { .. } | DimseFault::Aborted
        )
    }
}
