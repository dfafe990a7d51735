//! A receiver of HL7 v2: the way of messages to it.

use std::path::PathBuf;
use std::time::Duration;

use super::{Secret, TlsFiles};

/// The store's name in the journal.
pub const NAME: &str = "hl7";

/// How messages get to their receiver.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Way {
    /// Over a connection, with an answer to each.
    Mllp {
        /// Name or address of the receiver.
        host: String,
        /// Its port.
        port: u16,
        /// What is trusted; `None` for a connection that is not encrypted.
        tls: Option<TlsFiles>,
        /// For a whole exchange.
        limit: Duration,
    },
    /// As files in a folder, which the receiver removes.
    Files(PathBuf),
}

impl Way {
    /// The folder of message files, if that is the way.
    pub fn folder(&self) -> Option<&PathBuf> {
        match self {
            Way::Mllp { .. } => None,
            Way::Files(folder) => Some(folder),
        }
    }

    /// The secret that connections need: the key of the station's own certificate.
    pub fn secret(&self) -> Option<&Secret> {
        match self {
            Way::Mllp { tls, .. } => Some(&tls.as_ref()?.own.as_ref()?.1),
            Way::Files(_) => None,
        }
    }
}
