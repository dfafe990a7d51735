//! An archive asked over associations: C-ECHO, C-STORE and C-FIND, each call with a connection of its own.

use gaiter_dicom::dimse::{self, DimseFault, Titles};
use gaiter_dicom::{DicomObject, Listed, Study};

use super::answers::Failed;
use super::server::DimseServer;
use super::unwritable;
use crate::store::StoreFault;
use crate::store::connection::Connection;
use crate::store::server::ServerFault;

impl DimseServer {
    /// Whether it answers and lets the station search. Whether it lets it store, the first record tells.
    pub(super) fn reach(&self) -> Result<(), StoreFault> {
        self.answer(|connection, titles| dimse::reach(connection, titles))
    }

    /// What the server has of a record in its first `turns` turns.
    pub(super) fn listed(&self, study: &Study, turns: u32) -> Result<Vec<Listed>, StoreFault> {
        self.answer(|connection, titles| dimse::listed(connection, titles, study, turns))
    }

    /// Sends an object. Whether the server has it, only a search tells.
    pub(super) fn store(&self, object: &DicomObject) -> Result<Option<Failed>, StoreFault> {
        let why = self.answer(|connection, titles| dimse::store(connection, titles, object))?;
        // A status has 16 bits.
        Ok(why.map(|why| Failed { status: u16::try_from(why.reason).unwrap_or_default(), why }))
    }

    /// As [`DimseServer::asked`]. What cannot be written is a matter of the record.
    fn answer<T>(
        &self,
        ask: impl FnOnce(&mut Connection, &Titles) -> Result<T, DimseFault>,
    ) -> Result<T, StoreFault> {
        self.asked(ask).map_err(|fault| match fault {
            ServerFault::Dimse(DimseFault::Encode(fault)) => unwritable(fault),
            fault => fault.into(),
        })
    }
}
