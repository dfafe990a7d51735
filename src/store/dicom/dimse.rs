//! An archive asked over associations: C-ECHO, C-STORE and C-FIND, each call with a connection of its own.

use std::time::Duration;

use gaiter_dicom::dimse::{self, DimseFault, Titles};
use gaiter_dicom::{DicomObject, Listed, Study};

use super::server::DimseServer;
use super::{answers, unwritable};
use crate::store::StoreFault;
use crate::store::connection::{Connection, Peer};
use crate::store::server::ServerFault;

/// An archive with DIMSE.
#[derive(Debug)]
pub(super) struct DimseArchive {
    server: DimseServer,
    limit: Duration,
}

impl DimseArchive {
    pub fn new(server: DimseServer, limit: Duration) -> DimseArchive {
        DimseArchive { server, limit }
    }

    /// Whether it answers and lets the station search. Whether it lets it store, the first record tells.
    pub fn reach(&self) -> Result<(), StoreFault> {
        self.asked(|connection, titles| dimse::reach(connection, titles))
    }

    /// What the server has of a study.
    pub fn listed(&self, study: &Study) -> Result<Vec<Listed>, StoreFault> {
        self.asked(|connection, titles| dimse::listed(connection, titles, study))
    }

    /// Sends objects. Whether the server has them, only a search tells.
    pub fn send(&self, objects: &[DicomObject]) -> Result<(), StoreFault> {
        let failed = self.asked(|connection, titles| dimse::store(connection, titles, objects))?;
        let status = failed.first().map(|of| of.reason).unwrap_or_default();
        // A status has 16 bits.
        answers::judged(&failed, objects.len(), u16::try_from(status).unwrap_or_default())
    }

    /// What the server makes of a question, on a connection for it alone.
    fn asked<T>(
        &self,
        ask: impl FnOnce(&mut Connection, &Titles) -> Result<T, DimseFault>,
    ) -> Result<T, StoreFault> {
        let DimseServer { host, port, titles, tls } = &self.server;
        let peer = Peer { host, port: *port, tls: tls.as_ref(), limit: self.limit };
        let mut connection = peer.connected().map_err(ServerFault::Http)?;
        let answer = ask(&mut connection, titles);
        connection.close();
        answer.map_err(|fault| match fault {
            DimseFault::Connection(source) => ServerFault::Http(peer.fault(source)).into(),
            DimseFault::Encode(fault) => unwritable(fault),
            fault => ServerFault::Dimse(fault).into(),
        })
    }
}
