//! An archive of images: where it is, and how the station authenticates.

use std::time::Duration;

use gaiter_dicom::dimse::{DimseFault, Titles, abort, release};
use gaiter_https::{Endpoint, Secret, TlsFiles};

use crate::store::connection::{Connection, Peer};
use crate::store::server::ServerFault;

/// How long the end of an association may take. What was asked is answered by then, or will not be.
pub(crate) const END_MOST: Duration = Duration::from_secs(1);

/// Where an archive of images is and how it is asked.
#[derive(Debug, Clone)]
pub struct DicomServer {
    /// How it is asked, and where.
    pub way: DicomWay,
    /// For a whole exchange.
    pub limit: Duration,
}

/// How an archive of images is asked.
#[derive(Debug, Clone)]
pub enum DicomWay {
    /// Over DICOMweb.
    Web {
        /// The base address of its services, without a slash at its end.
        base: String,
        /// How the station authenticates.
        access: DicomAccess,
        /// What connections trust.
        tls: TlsFiles,
    },
    /// Over associations (DIMSE).
    Dimse(DimseServer),
}

/// A server that takes associations.
#[derive(Debug, Clone)]
pub struct DimseServer {
    /// Name or address; an address of IPv6 in brackets.
    pub host: String,
    pub port: u16,
    /// Who asks whom.
    pub titles: Titles,
    /// What is trusted; `None` for a connection that is not encrypted.
    pub tls: Option<TlsFiles>,
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

impl DimseServer {
    /// Its address, for people.
    pub fn place(&self) -> String {
        format!("dicom://{}@{}:{}", self.titles.called.as_str(), self.host, self.port)
    }

    /// The host without the brackets of an IPv6 address.
    pub fn name(&self) -> &str {
        self.host.trim_matches(['[', ']'])
    }

    /// The secret that connections with it need.
    pub fn secret(&self) -> Option<&Secret> {
        self.tls.as_ref()?.own.as_ref().map(|(_, key)| key)
    }

    /// What the server makes of a question, on a connection for it alone. `limit` is for the whole exchange, and
    /// [`END_MOST`] for the end of the association.
    pub(crate) fn asked<T>(
        &self,
        limit: Duration,
        ask: impl FnOnce(&mut Connection, &Titles) -> Result<T, DimseFault>,
    ) -> Result<T, ServerFault> {
        let peer = Peer { host: &self.host, port: self.port, tls: self.tls.as_ref(), limit };
        let mut connection = peer.connected()?;
        let answer = ask(&mut connection, &self.titles);
        connection.waits_at_most(END_MOST);
        match &answer {
            Ok(_) => release(&mut connection),
            Err(fault) if fault.is_an_end() => {}
            Err(_) => abort(&mut connection),
        }
        connection.close();
        answer.map_err(|fault| match fault {
            DimseFault::Connection(source) => peer.fault(source).into(),
            fault => ServerFault::Dimse(fault),
        })
    }
}

impl DicomServer {
    /// Every secret that connections with it need.
    pub fn secrets(&self) -> Vec<&Secret> {
        let of_access = match &self.way {
            DicomWay::Web { access: DicomAccess::Basic { password, .. }, .. } => Some(password),
            DicomWay::Web { access: DicomAccess::Bearer { token }, .. } => Some(token),
            DicomWay::Web { access: DicomAccess::Open, .. } | DicomWay::Dimse(_) => None,
        };
        let own = self.tls().and_then(|tls| tls.own.as_ref()).map(|(_, key)| key);
        of_access.into_iter().chain(own).collect()
    }

    /// What connections trust; `None` for one that is not encrypted.
    pub fn tls(&self) -> Option<&TlsFiles> {
        match &self.way {
            DicomWay::Web { tls, .. } => Some(tls),
            DicomWay::Dimse(server) => server.tls.as_ref(),
        }
    }

    /// Its address, for people.
    pub fn place(&self) -> String {
        match &self.way {
            DicomWay::Web { base, .. } => base.clone(),
            DicomWay::Dimse(server) => server.place(),
        }
    }

    /// The host that the station connects to.
    pub fn host(&self) -> Option<String> {
        match &self.way {
            DicomWay::Web { base, .. } => {
                Some(Endpoint::from_uri(&base.parse().ok()?).ok()?.name().to_owned())
            }
            DicomWay::Dimse(server) => Some(server.name().to_owned()),
        }
    }
}
