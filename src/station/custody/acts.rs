//! Operator decisions: retry or give up a refused scan, release a held scan, assign or unassign a scan.
//! The bytes are stored first, then the decision, then the journal changes.

use std::collections::BTreeSet;

use gaiter_flow::decision::{Decided, Ruling};
use gaiter_flow::{DeliveryState, DeliveryStep, ScanId};
use gaiter_record::{ImagingRequest, Patient};
use serde_json::json;

use super::decided::by_operator;
use super::{Custody, CustodyFault, intake_of, io};
use crate::station::custody::spool::Companion;
use crate::station::journal::{Due, Event, ScanRow};
use crate::store::StoredScan;

/// The outcome of an operator's decision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Acted {
    /// The decision was carried out; the value is the number of deliveries to make.
    Done(usize),
    /// The decision does not apply to the present state of the scan.
    Nothing,
    /// The scan may belong to more than one patient, and the decision does not name one.
    Several,
    /// The scan already belongs to a patient.
    HasPatient,
    /// The scan's bytes are needed but are not in the state folder.
    NoBytes,
}

impl Custody {
    /// Makes the refused deliveries of a scan pending again.
    pub fn retry(&self, scan: &ScanId) -> Result<Acted, CustodyFault> {
        let _change = self.changing();
        let refused = self.journal.deliveries_in(scan, DeliveryState::Refused)?;
        if refused.is_empty() {
            return Ok(Acted::Nothing);
        }
        if !self.bytes_to_spool(scan)? {
            return Ok(Acted::NoBytes);
        }
        let decisions = io("reading decisions", self.decisions.of(scan))?;
        match Ruling::from_decisions(&decisions).is_given_up {
            true => self.decide(scan, &[(Decided::Retried, None)], |journal, number| {
                journal.reopened(scan, &refused, DeliveryStep::Retry, Some(number))
            })?,
            false => self.journal.reopened(scan, &refused, DeliveryStep::Retry, None)?,
        }
        Ok(Acted::Done(refused.len()))
    }

    /// Releases a held scan to the patient it is held for, who must be the only candidate. A scan that
    /// came in without a patient is released without one.
    pub fn release(&self, scan: &ScanId) -> Result<Acted, CustodyFault> {
        let _change = self.changing();
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
        self.decide(scan, &[(Decided::Released, patient)], |journal, number| {
            journal.reopened(scan, &theirs, DeliveryStep::Release, Some(number))
        })?;
        Ok(Acted::Done(theirs.len()))
    }

    /// Takes a scan back from a patient, `owner`: it stays with the other patients it belongs to, or is
    /// unassigned again. `stored` is as in [`Custody::assign`].
    pub fn unassign(
        &self,
        row: &ScanRow,
        owner: &str,
        stored: Option<StoredScan>,
    ) -> Result<Acted, CustodyFault> {
        let _change = self.changing();
        let mut others = self.journal.owners(&row.scan)?;
        let Some(place) = others.iter().position(|id| id == owner) else {
            // Another decision was made in the meantime.
            return Ok(Acted::Nothing);
        };
        others.remove(place);
        let stay: Vec<Patient> = others.iter().map(|id| by_operator(id, None)).collect();
        if !self.bring_back(row, stay.first(), stored)? {
            return Ok(Acted::NoBytes);
        }
        let stores = self.stores_for(stay.first());
        let taken = (Decided::Unassigned, Some(owner.to_owned()));
        // Those who keep it are named again: the first decision takes it from all.
        let kept = others.into_iter().map(|id| (Decided::Released, Some(id)));
        let decisions: Vec<_> = [taken].into_iter().chain(kept).collect();
        self.decide(&row.scan, &decisions, |journal, number| {
            let detail = json!({ "patients": [owner], "by": "operator", "decision": number });
            journal.given_to(&row.scan, &stay, &stores, Event::Unassigned, &detail)
        })?;
        Ok(Acted::Done(stores.len()))
    }

    /// Keeps the bytes of a scan that a store returned. Returns whether the state folder has them.
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

    /// Assigns an unassigned or held scan to this patient. `stored` is the scan from a store, needed if
    /// the spool no longer has it.
    pub fn assign(
        &self,
        row: &ScanRow,
        patient: &Patient,
        stored: Option<StoredScan>,
    ) -> Result<Acted, CustodyFault> {
        let _change = self.changing();
        // Two concurrent assignments must not both succeed.
        if !self.journal.owners(&row.scan)?.is_empty() {
            return Ok(Acted::HasPatient);
        }
        let patients = [by_operator(&patient.id, self.request_of(&row.scan, &patient.id)?)];
        if !self.bring_back(row, patients.first(), stored)? {
            return Ok(Acted::NoBytes);
        }
        let stores = self.stores_for(patients.first());
        let decision = (Decided::Assigned, Some(patient.id.clone()));
        self.decide(&row.scan, &[decision], |journal, number| {
            let detail = json!({ "patient": patient.id, "by": "operator", "decision": number });
            journal.given_to(&row.scan, &patients, &stores, Event::Assigned, &detail)
        })?;
        Ok(Acted::Done(stores.len()))
    }

    /// The request that a scan answers for a patient: the one that was chosen with that patient for the press or the
    /// name that the scan may answer. A patient who had the scan keeps the request: its record may be in the study.
    pub(super) fn request_of(
        &self,
        scan: &ScanId,
        patient: &str,
    ) -> Result<Option<ImagingRequest>, CustodyFault> {
        let intake = self.spool.intake(scan).ok();
        match intake.and_then(|intake| intake.judged.request_of(patient).cloned()) {
            Some(request) => Ok(Some(request)),
            None => Ok(self.journal.request_of(scan, patient)?),
        }
    }

    /// Closes a scan that was refused, is held, or is stored without a patient: it needs no further
    /// decision. Its bytes are kept as long as other bytes that are no longer needed.
    pub fn give_up(&self, scan: &ScanId) -> Result<Acted, CustodyFault> {
        let _change = self.changing();
        if !self.journal.is_undecided(scan)? {
            return Ok(Acted::Nothing);
        }
        self.decide(scan, &[(Decided::GivenUp, None)], |journal, number| {
            journal.given_up(scan, number)
        })?;
        Ok(Acted::Done(0))
    }

    /// Reports whether the state folder holds the bytes of a scan.
    pub fn holds(&self, scan: &ScanId) -> bool {
        self.spool.holds(scan) || self.quarantine.holds(scan)
    }

    /// Brings the bytes of a scan back into the spool. Returns whether they are there.
    fn bytes_to_spool(&self, scan: &ScanId) -> Result<bool, CustodyFault> {
        if self.spool.holds(scan) {
            return Ok(true);
        }
        if !self.quarantine.holds_bytes(scan) {
            return Ok(false);
        }
        let moved = self.quarantine.move_to(&self.spool, scan);
        io("taking a scan out of quarantine", moved)?;
        Ok(true)
    }
}
