//! The way of messages to their receiver.

use std::path::PathBuf;
use std::time::Duration;

use crate::store::endpoint::{Secret, TlsFiles};

/// How messages get to their receiver.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Hl7Way {
    /// Over a connection, with an answer to each.
    Mllp {
        /// Name or address of the receiver; an address of IPv6 in brackets.
        host: String,
        /// Its port.
        port: u16,
        /// What is trusted; `None` for a connection that is not encrypted.
        tls: Option<TlsFiles>,
        /// For a whole exchange, from the search for the address to the last byte of the answer.
        limit: Duration,
    },
    /// As files in a folder, which the receiver removes.
    Files(PathBuf),
}

impl Hl7Way {
    /// The folder of message files, if that is the way.
    pub fn folder(&self) -> Option<&PathBuf> {
        match self {
            Hl7Way::Mllp { .. } => None,
            Hl7Way::Files(folder) => Some(folder),
        }
    }

    /// The station's own certificate that connections show, and its key.
    pub fn own(&self) -> Option<&(PathBuf, Secret)> {
        match self {
            Hl7Way::Mllp { tls, .. } => tls.as_ref()?.own.as_ref(),
            Hl7Way::Files(_) => None,
        }
    }

    /// The secret that connections need: the key of that certificate.
    pub fn secret(&self) -> Option<&Secret> {
        self.own().map(|(_, key)| key)
    }
}
