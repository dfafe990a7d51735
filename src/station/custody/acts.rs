//! What a person decides: a refused scan tried again, a held one released, one for nobody assigned.

use std::sync::PoisonError;

use super::{Custody, CustodyFault, intake_of, io};
use crate::flow::{DeliveryState, DeliveryStep, ScanId};
use crate::record::Patient;
use crate::station::journal::{Due, Event, ScanRow};
use crate::station::spool::Companion;
use crate::store::StoredScan;

/// What became of a person's decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acted {
    /// It is done, and this many deliveries are to be made.
    Done(usize),
    /// There was nothing to do it with.
    Nothing,
    /// The scan's bytes are needed and are nowhere in the state folder.
    NoBytes,
}

impl Custody {
    /// Deliveries that were refused are to be tried again.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn retry(&self, scan: &ScanId) -> Result<Acted, CustodyFault> {
        self.reopen(scan, DeliveryState::Refused, DeliveryStep::Retry, Event::Retried)
    }

    /// Deliveries that were held are to be made: the scan is this patient's.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn release(&self, scan: &ScanId) -> Result<Acted, CustodyFault> {
        self.reopen(scan, DeliveryState::Held, DeliveryStep::Release, Event::Released)
    }

    fn reopen(
        &self,
        scan: &ScanId,
        state: DeliveryState,
        step: DeliveryStep,
        event: Event,
    ) -> Result<Acted, CustodyFault> {
        let _change = self.change.lock().unwrap_or_else(PoisonError::into_inner);
        let deliveries: Vec<Due> = self.journal.deliveries_in(scan, state)?;
        if deliveries.is_empty() {
            return Ok(Acted::Nothing);
        }
        if !self.bytes_to_spool(scan)? {
            return Ok(Acted::NoBytes);
        }
        self.journal.reopened(scan, &deliveries, step, event)?;
        Ok(Acted::Done(deliveries.len()))
    }

    /// A scan is taken back from its patient and is nobody's again. `stored` as in
    /// [`Custody::assign`].
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn unassign(
        &self,
        row: &ScanRow,
        stored: Option<StoredScan>,
    ) -> Result<Acted, CustodyFault> {
        let _change = self.change.lock().unwrap_or_else(PoisonError::into_inner);
        if !self.bring_back(row, None, stored)? {
            return Ok(Acted::NoBytes);
        }
        let stores = self.stores_for(None);
        self.journal.unassigned(&row.scan, &stores)?;
        Ok(Acted::Done(stores.len()))
    }

    /// Keeps the bytes of a scan that a store gave back; says whether they are here.
    fn bring_back(
        &self,
        row: &ScanRow,
        patient: Option<&Patient>,
        stored: Option<StoredScan>,
    ) -> Result<bool, CustodyFault> {
        let scan = &row.scan;
        if self.spool.holds(scan) || self.quarantine.holds(scan) {
            return Ok(true);
        }
        let Some(StoredScan { bytes, ord }) = stored else { return Ok(false) };
        let intake = intake_of(row, patient);
        let ord = ord.map(|bytes| Companion { name_ending: "ord".to_owned(), bytes });
        let companions: Vec<Companion> = ord.into_iter().collect();
        io("keeping a scan", self.spool.keep(scan, intake, &bytes, &companions))?;
        Ok(true)
    }

    /// A scan that came in for nobody, or is held, is this patient's. `stored` is the scan as it lies in a store,
    /// where the spool has given it up.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn assign(
        &self,
        row: &ScanRow,
        patient: &Patient,
        stored: Option<StoredScan>,
    ) -> Result<Acted, CustodyFault> {
        let _change = self.change.lock().unwrap_or_else(PoisonError::into_inner);
        if !self.bring_back(row, Some(patient), stored)? {
            return Ok(Acted::NoBytes);
        }
        let stores = self.stores_for(Some(patient));
        self.journal.assigned(&row.scan, patient, &stores)?;
        Ok(Acted::Done(stores.len()))
    }

    /// Whether the state folder holds the bytes of a scan.
    pub fn holds(&self, scan: &ScanId) -> bool {
        self.spool.holds(scan) || self.quarantine.holds(scan)
    }

    /// Brings the bytes of a scan back into the spool; says whether they are there.
    fn bytes_to_spool(&self, scan: &ScanId) -> Result<bool, CustodyFault> {
        if self.spool.holds(scan) {
            return Ok(true);
        }
        if !self.quarantine.holds_bytes(scan) {
            return Ok(false);
        }
        io(
            "taking a scan out of quarantine",
            self.quarantine.give_back(scan, &self.spool.entry(scan)),
        )?;
        io("syncing the spool", self.spool.sync())?;
        Ok(true)
    }
}
