//! Decisions and the journal. Each decision is stored before the journal changes. If the journal does
//! not know it, after a crash in between or after a rebuild, it is carried out later.

use std::collections::BTreeMap;
use std::io::ErrorKind;

use gaiter_flow::decision::{Decided, Decision, Ruling};
use gaiter_flow::{ScanId, ScanState};
use gaiter_record::{AcquiredFrom, ImagingRequest, Patient, Source, SourceKind};
use jiff::Timestamp;
use tracing::{info, warn};

use super::{Custody, CustodyFault, io};
use crate::station::journal::{FoundThere, Journal, JournalError, ScanRow};
use crate::store::{FoundRecord, StoredScan};

/// The operators' decisions about a scan.
struct DecisionsOfScan {
    ruling: Ruling,
    /// The ids of all whom they name, with the requests that the scan answers for them.
    named: BTreeMap<String, Option<ImagingRequest>>,
    number: usize,
}

impl DecisionsOfScan {
    const NOTHING: DecisionsOfScan =
        DecisionsOfScan { ruling: Ruling::OPEN, named: BTreeMap::new(), number: 0 };

    fn new(decisions: Vec<Decision>) -> DecisionsOfScan {
        let (ruling, number) = (Ruling::from_decisions(&decisions), decisions.len());
        let mut named: BTreeMap<String, Option<ImagingRequest>> = BTreeMap::new();
        for Decision { patient, request, .. } in decisions {
            if let Some(id) = patient {
                let known = named.entry(id).or_default();
                *known = request.or_else(|| known.take());
            }
        }
        DecisionsOfScan { ruling, named, number }
    }

    /// The patients the scan belongs to according to the decisions.
    fn patients(&self) -> Vec<Patient> {
        self.named_if(|id| self.ruling.patients.contains(id))
    }

    /// Those who no longer have the scan.
    fn former(&self) -> Vec<Patient> {
        self.named_if(|id| !self.ruling.allows(Some(id)))
    }

    fn named_if(&self, is_meant: impl Fn(&str) -> bool) -> Vec<Patient> {
        let meant = self.named.iter().filter(|(id, _)| is_meant(id));
        meant.map(|(id, request)| by_operator(id, request.clone())).collect()
    }
}

/// The patient of this id, by an operator's decision, with the request that the scan answers.
pub(super) fn by_operator(id: &str, request: Option<ImagingRequest>) -> Patient {
    let source = Source::from_kind(SourceKind::Operator).with_request(request);
    Patient { id: id.to_owned(), sources: vec![source] }
}

impl Custody {
    /// Stores decisions that belong together, then applies them to the journal. If the journal fails, they
    /// are removed again: a failed command has no effect. The caller holds the custody lock.
    pub(super) fn decide(
        &self,
        scan: &ScanId,
        decided: &[(Decided, Option<String>)],
        change: impl FnOnce(&Journal, usize) -> Result<(), JournalError>,
    ) -> Result<(), CustodyFault> {
        let before = io("reading decisions", self.decisions.of(scan))?;
        let mut decisions = before.clone();
        let at = Timestamp::now();
        for (what, patient) in decided {
            let request = match patient {
                Some(id) => self.request_of(scan, id)?,
                None => None,
            };
            decisions.push(Decision { at, what: *what, patient: patient.clone(), request });
        }
        io("keeping a decision", self.decisions.keep(scan, &decisions))?;
        let changed = change(&self.journal, decisions.len());
        if changed.is_err() {
            io("taking a decision back", self.decisions.keep(scan, &before))?;
        }
        Ok(changed?)
    }

    /// Carries out the decisions that the journal does not know. Returns the scans whose decisions
    /// cannot be read.
    pub fn carry_out(&self) -> Result<Vec<ScanId>, CustodyFault> {
        let _change = self.changing();
        let (mut count, mut unreadable) = (0, Vec::new());
        for scan in io("listing decisions", self.decisions.scans())? {
            match self.carry_out_of(&scan)? {
                Some(is_new) => count += usize::from(is_new),
                None => unreadable.push(scan),
            }
        }
        if count > 0 {
            info!(event = "decisions-carried-out", count);
        }
        Ok(unreadable)
    }

    /// Carries out the decisions about one scan if the journal knows the scan but not the decisions.
    /// Returns whether it did, or `None` if they cannot be read. The caller holds the custody lock.
    pub(super) fn carry_out_of(&self, scan: &ScanId) -> Result<Option<bool>, CustodyFault> {
        let Some(known) = self.state_known(scan)? else { return Ok(None) };
        if known.number == 0 || self.journal.scan(scan)?.is_none() || !self.holds(scan) {
            return Ok(Some(false));
        }
        if known.number <= self.journal.last_decision(scan)? {
            return Ok(Some(false));
        }
        let patients = known.patients();
        let stores = self.stores_for(patients.first());
        self.journal.carried_out(scan, &known.ruling, &patients, &stores, known.number)?;
        self.leave_at_servers(scan, &known.former())?;
        Ok(Some(true))
    }

    /// How often a scan was taken from a patient and given back, by the decisions about it.
    pub fn turn(&self, scan: &ScanId, patient: &str) -> Result<u32, CustodyFault> {
        Ok(Ruling::turn(&io("reading decisions", self.decisions.of(scan))?, patient))
    }

    /// The decisions about a scan; `None` if they cannot be read.
    fn state_known(&self, scan: &ScanId) -> Result<Option<DecisionsOfScan>, CustodyFault> {
        let decisions = match self.decisions.of(scan) {
            Err(error) if error.kind() == ErrorKind::InvalidData => {
                warn!(event = "decisions-unreadable", scan = scan.short(), %error);
                return Ok(None);
            }
            decisions => io("reading decisions", decisions)?,
        };
        Ok(Some(DecisionsOfScan::new(decisions)))
    }

    /// Reports whether a decision forbids a record that a store holds.
    pub fn contradicts(&self, record: &FoundRecord) -> Result<bool, CustodyFault> {
        let known = self.state_known(&record.scan)?;
        Ok(known.is_some_and(|known| !known.ruling.allows(record.patient.as_deref())))
    }

    /// Enters a record that a store holds, and removes spooled bytes that are no longer needed.
    pub fn found(&self, record: &FoundRecord, store: &str) -> Result<(), CustodyFault> {
        let _change = self.changing();
        let known = self.state_known(&record.scan)?.unwrap_or(DecisionsOfScan::NOTHING);
        let (row, patient, folder) = parts(record, &known);
        let found = FoundThere { row: &row, patient: patient.as_ref(), store, folder: &folder };
        let number = (known.number > 0).then_some(known.number);
        self.journal.found(&found, &known.ruling.patients, number)?;
        if let Some(patient) = patient.as_ref().filter(|_| !self.servers.is_empty()) {
            self.journal.may_be_at_servers(&record.scan, patient, true)?;
        }
        self.leave_at_servers(&record.scan, &known.former())?;
        self.give_up_served(&record.scan)
    }

    /// Enters a record that a store holds against a decision: the scan goes to the patient of the
    /// decision, and the record is withdrawn. `stored` is the scan from this store, needed if the state
    /// folder no longer has it.
    pub fn found_against(
        &self,
        record: &FoundRecord,
        store: &str,
        stored: Option<StoredScan>,
    ) -> Result<(), CustodyFault> {
        let _change = self.changing();
        let known = self.state_known(&record.scan)?.unwrap_or(DecisionsOfScan::NOTHING);
        let (row, patient, folder) = parts(record, &known);
        let found = FoundThere { row: &row, patient: patient.as_ref(), store, folder: &folder };
        let patients = known.patients();
        let has_bytes = self.bring_back(&row, patients.first(), stored)?;
        let number = has_bytes.then_some(known.number);
        let takers = self.stores_for(patients.first());
        self.journal.found_against(&found, &patients, &takers, number)?;
        let former: Vec<Patient> = patient.into_iter().chain(known.former()).collect();
        self.leave_at_servers(&record.scan, &former)?;
        warn!(event = "record-against-decision", scan = record.scan.short(), store, has_bytes);
        Ok(())
    }

    /// Has the record of a scan withdrawn from the servers that may have it for these former patients.
    fn leave_at_servers(&self, scan: &ScanId, former: &[Patient]) -> Result<(), CustodyFault> {
        if self.servers.is_empty() {
            return Ok(());
        }
        for patient in former {
            self.journal.may_be_at_servers(scan, patient, false)?;
        }
        Ok(())
    }

    /// Forgets scans that were finished before a time, and the decisions about them. Returns the number
    /// of scans.
    pub fn forget(&self, before: Timestamp) -> Result<usize, CustodyFault> {
        let _change = self.changing();
        let forgotten = self.journal.forget(before)?;
        for store in &self.stores {
            if self.journal.is_to_be_searched(store)? {
                // A rebuilt journal does not yet know what the store holds and will need the decisions.
                return Ok(forgotten);
            }
        }
        for scan in io("listing decisions", self.decisions.scans())? {
            if self.journal.scan(&scan)?.is_none() {
                io("forgetting decisions", self.decisions.keep(&scan, &[]))?;
            }
        }
        Ok(forgotten)
    }
}

/// The journal row of a record found in a store, its patient, and its folder.
fn parts(record: &FoundRecord, decided: &DecisionsOfScan) -> (ScanRow, Option<Patient>, String) {
    let taken_by =
        |from: AcquiredFrom| record.acquired.as_ref().filter(|of| of.from == from).map(|of| of.at);
    let row = ScanRow {
        scan: record.scan.clone(),
        format: record.format.clone(),
        size: record.size,
        first_seen: record.first_seen,
        file_time: taken_by(AcquiredFrom::FileTime),
        pressed_at: taken_by(AcquiredFrom::Press),
        state: ScanState::Delivered,
    };
    let patient = record.patient.clone().map(|id| {
        let request = record.request.as_ref().or_else(|| decided.named.get(&id)?.as_ref());
        let source = Source::from_kind(SourceKind::Record).with_request(request.cloned());
        Patient { id, sources: vec![source] }
    });
    (row, patient, record.folder.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests;
