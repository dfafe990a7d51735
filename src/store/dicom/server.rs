//! An archive of images: where it is, and how the station authenticates.

use std::time::Duration;

use gaiter_https::{Secret, TlsFiles};

/// Where an archive of images is and how it is asked.
#[derive(Debug, Clone)]
pub struct DicomServer {
    /// The base address of its DICOMweb services, without a slash at its end.
    pub base: String,
    /// How the station authenticates.
    pub access: DicomAccess,
    /// What connections trust.
    pub tls: TlsFiles,
    /// For a whole exchange.
    pub limit: Duration,
}

/// How the station authenticates. A certificate of its own is part of the connection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DicomAccess {
    /// It does not.
    Open,
    /// By user and password.
    Basic { user: String, password: Secret },
    /// By a token that does not change.
    Bearer { token: Secret },
}

impl DicomServer {
    /// Every secret that connections with it need.
    pub fn secrets(&self) -> Vec<&Secret> {
        let of_access = match &self.access {
            DicomAccess::Open => None,
            DicomAccess::Basic { password, .. } => Some(password),
            DicomAccess::Bearer { token } => Some(token),
        };
        let own = self.tls.own.as_ref().map(|(_, key)| key);
        of_access.into_iter().chain(own).collect()
    }
}
