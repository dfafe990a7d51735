//! An archive of images: where it is, and how the station authenticates.

use std::time::Duration;

use gaiter_dicom::dimse::{DimseFault, Titles, abort, release};
use gaiter_https::{Secret, TlsFiles};

use crate::store::connection::Connection;
use crate::store::server::ServerFault;
use crate::store::{HttpAccess, Peer};

/// How long the end of an association may take. What was asked is answered by then, or will not be.
pub(crate) const END_MOST: Duration = Duration::from_secs(1);

/// Where an archive of images is and how it is asked.
#[derive(Debug, Clone)]
pub enum DicomServer {
    /// Over DICOMweb.
    Web {
        /// The base address of its services, without a slash at its end.
        base: String,
        /// How the station authenticates.
        access: HttpAccess,
        /// What connections trust.
        tls: TlsFiles,
        /// For a whole exchange.
        limit: Duration,
    },
    /// Over associations (DIMSE).
    Dimse(DimseServer),
}

/// A server that takes associations.
#[derive(Debug, Clone)]
pub struct DimseServer {
    /// Where it is, and how it is reached.
    pub peer: Peer,
    /// Who asks whom.
    pub titles: Titles,
}

impl DimseServer {
    /// Its address, for people.
    pub fn place(&self) -> String {
        format!("dicom://{}@{}:{}", self.titles.called.as_str(), self.peer.host, self.peer.port)
    }

    /// What the server makes of a question, on a connection for it alone. The end of the association has
    /// [`END_MOST`] besides.
    pub(crate) fn asked<T>(
        &self,
        ask: impl FnOnce(&mut Connection, &Titles) -> Result<T, DimseFault>,
    ) -> Result<T, ServerFault> {
        let mut connection = self.peer.connected()?;
        let answer = ask(&mut connection, &self.titles);
        connection.waits_at_most(END_MOST);
        match &answer {
            Ok(_) => release(&mut connection),
            Err(fault) if fault.is_an_end() => {}
            Err(_) => abort(&mut connection),
        }
        connection.close();
        answer.map_err(|fault| match fault {
            DimseFault::Connection(source) => self.peer.fault(source).into(),
            fault => ServerFault::Dimse(fault),
        })
    }
}

impl DicomServer {
    /// Every secret that connections with it need.
    pub fn secrets(&self) -> Vec<&Secret> {
        let of_access = match self {
            DicomServer::Web { access, .. } => access.secret(),
            DicomServer::Dimse(_) => None,
        };
        of_access.into_iter().chain(self.tls().and_then(TlsFiles::key)).collect()
    }

    /// What connections trust; `None` for one that is not encrypted.
    pub fn tls(&self) -> Option<&TlsFiles> {
        match self {
            DicomServer::Web { tls, .. } => Some(tls),
            DicomServer::Dimse(server) => server.peer.tls.as_ref(),
        }
    }

    /// The longest that a whole exchange takes.
    pub fn limit(&self) -> Duration {
        match self {
            DicomServer::Web { limit, .. } => *limit,
            DicomServer::Dimse(server) => server.peer.limit,
        }
    }

    /// Its address, for people.
    pub fn place(&self) -> String {
        match self {
            DicomServer::Web { base, .. } => base.clone(),
            DicomServer::Dimse(server) => server.place(),
        }
    }
}
