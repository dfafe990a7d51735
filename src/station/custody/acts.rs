//! What a person decides: a refused scan tried again or given up, a held one released, one for nobody
//! assigned, one taken back. The bytes come first, then the decision itself, then the journal.

use std::collections::BTreeSet;
use std::sync::PoisonError;

use super::{Custody, CustodyFault, intake_of, io};
use crate::flow::decision::{Decided, Ruling};
use crate::flow::{DeliveryState, ScanId};
use crate::record::Patient;
use crate::station::custody::spool::Companion;
use crate::station::journal::{Due, ScanRow};
use crate::store::StoredScan;

/// What became of a person's decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acted {
    /// It is done, and this many deliveries are to be made.
    Done(usize),
    /// There was nothing to do it with.
    Nothing,
    /// It could be more than one patient's, and the decision says not which.
    Several,
    /// It is a patient's already.
    Somebodys,
    /// The scan's bytes are needed and are nowhere in the state folder.
    NoBytes,
}

impl Custody {
    /// Deliveries that were refused are to be tried again.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn retry(&self, scan: &ScanId) -> Result<Acted, CustodyFault> {
        let _change = self.change.lock().unwrap_or_else(PoisonError::into_inner);
        let refused = self.journal.deliveries_in(scan, DeliveryState::Refused)?;
        if refused.is_empty() {
            return Ok(Acted::Nothing);
        }
        if !self.bytes_to_spool(scan)? {
            return Ok(Acted::NoBytes);
        }
        let decisions = io("reading decisions", self.decisions.of(scan))?;
        match Ruling::of(&decisions).is_given_up() {
            true => self.decide(scan, Decided::Retried, None, |journal, number| {
                journal.retried(scan, &refused, Some(number))
            })?,
            false => self.journal.retried(scan, &refused, None)?,
        }
        Ok(Acted::Done(refused.len()))
    }

    /// A held scan is the patient's for whom it is held, who must be the only one. What came in for
    /// nobody is not held for anybody.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn release(&self, scan: &ScanId) -> Result<Acted, CustodyFault> {
        let _change = self.change.lock().unwrap_or_else(PoisonError::into_inner);
        let held = self.journal.deliveries_in(scan, DeliveryState::Held)?;
        if held.is_empty() {
            return Ok(Acted::Nothing);
        }
        let named: BTreeSet<&str> =
            held.iter().map(Due::patient_cell).filter(|id| !id.is_empty()).collect();
        let mut people: BTreeSet<String> = named.iter().map(|id| (*id).to_owned()).collect();
        people.extend(self.journal.candidates(scan)?);
        if people.len() > 1 {
            return Ok(Acted::Several);
        }
        let patient = named.first().map(|id| (*id).to_owned());
        let whose = patient.as_deref().unwrap_or_default();
        let theirs: Vec<Due> =
            held.iter().filter(|due| due.patient_cell() == whose).cloned().collect();
        if !self.bytes_to_spool(scan)? {
            return Ok(Acted::NoBytes);
        }
        self.decide(scan, Decided::Released, patient.clone(), |journal, number| {
            journal.released(scan, &theirs, number)
        })?;
        Ok(Acted::Done(theirs.len()))
    }

    /// A scan is taken back from its patient, `owner`, and is nobody's again. `stored` as in
    /// [`Custody::assign`].
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn unassign(
        &self,
        row: &ScanRow,
        owner: &str,
        stored: Option<StoredScan>,
    ) -> Result<Acted, CustodyFault> {
        let _change = self.change.lock().unwrap_or_else(PoisonError::into_inner);
        if self.journal.owners(&row.scan)? != [owner] {
            // Somebody else decided meanwhile.
            return Ok(Acted::Nothing);
        }
        if !self.bring_back(row, None, stored)? {
            return Ok(Acted::NoBytes);
        }
        let stores = self.stores_for(None);
        self.decide(&row.scan, Decided::Unassigned, Some(owner.to_owned()), |journal, number| {
            journal.unassigned(&row.scan, &stores, number)
        })?;
        Ok(Acted::Done(stores.len()))
    }

    /// Keeps the bytes of a scan that a store gave back; says whether they are here.
    pub(super) fn bring_back(
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

    /// A scan that is no patient's, or is held, is this patient's. `stored` is the scan as it lies in a
    /// store, where the spool has given it up.
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
        // Two who assign it at once must not both have it.
        if !self.journal.owners(&row.scan)?.is_empty() {
            return Ok(Acted::Somebodys);
        }
        if !self.bring_back(row, Some(patient), stored)? {
            return Ok(Acted::NoBytes);
        }
        let stores = self.stores_for(Some(patient));
        let id = Some(patient.id.clone());
        self.decide(&row.scan, Decided::Assigned, id, |journal, number| {
            journal.assigned(&row.scan, patient, &stores, number)
        })?;
        Ok(Acted::Done(stores.len()))
    }

    /// A refused scan, or one that is held although it is somebody's already, needs no decision any
    /// more. Its bytes stay as long as others that have served.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn give_up(&self, scan: &ScanId) -> Result<Acted, CustodyFault> {
        let _change = self.change.lock().unwrap_or_else(PoisonError::into_inner);
        if !self.journal.may_be_given_up(scan)? {
            return Ok(Acted::Nothing);
        }
        self.decide(scan, Decided::GivenUp, None, |journal, number| {
            journal.given_up(scan, number)
        })?;
        Ok(Acted::Done(0))
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
