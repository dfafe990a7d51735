//! Clears the state folder of a person. Nothing else may run on it meanwhile: it is done between the workers
//! of two generations, or while no station runs.

mod naming;

use std::path::Path;

use gaiter_flow::ScanId;
use gaiter_flow::patient::erasure::{ERASED, ErasedScan, Erasure, Owed};
use gaiter_flow::patient::person::WhoseScan;
use gaiter_flow::round::CaptureMatch;
use jiff::Timestamp;
use serde_json::json;

use super::spool::Intake;
use super::{Custody, CustodyFault, io};
use crate::station::journal::{Erasing, Event, ScanOfPerson};
use crate::store::durable;
pub(in crate::station) use naming::{OLD_JOURNALS, REFUSED_ORDERS, files_naming};

/// The folder of the previews of held scans in the state folder.
const PREVIEWS: &str = "previews";

impl Custody {
    /// Notes that a person is to be erased, durably, before anything is removed. What servers are owed is done
    /// first, or with `leaves_owed` never.
    ///
    /// # Errors
    /// See [`CustodyFault`]; nothing is erased then.
    pub fn ask_for_erasure(
        &self,
        patient: &str,
        by: &str,
        leaves_owed: bool,
    ) -> Result<(), CustodyFault> {
        let _change = self.changing();
        let whose = self.erasures.hash(patient);
        let at = Timestamp::now();
        // From a server nothing is removed.
        let stores = self.stores.iter().filter(|store| !self.servers.contains(store));
        let stores = stores.map(|store| (*store).to_owned()).collect();
        let earlier = self.erasures.of(&whose);
        let known = earlier.as_ref().map_or_else(Vec::new, |earlier| earlier.owed.clone());
        let mut erasure = Erasure::asked(earlier, patient, at, by.to_owned(), stores);
        erasure.leaves_owed = leaves_owed;
        erasure.owes(self.owed_beside(known, patient)?);
        let detail = json!({ "person": whose, "by": by, "left_at_servers": erasure.left.len() });
        self.journal.note_of_person(Event::Erasing, &detail)?;
        io("noting an erasure", self.erasures.keep(&whose, &erasure))
    }

    /// Notes what servers are owed of a person who is to be erased. Returns whether the erasure waits for it.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn waits_for_servers(
        &self,
        whose: &str,
        erasure: &mut Erasure,
        patient: &str,
    ) -> Result<bool, CustodyFault> {
        let _change = self.changing();
        if erasure.owes(self.owed_beside(erasure.owed.clone(), patient)?) {
            io("noting an erasure", self.erasures.keep(whose, erasure))?;
        }
        Ok(!erasure.owed.is_empty())
    }

    /// What servers are owed of a person; until a journal that was lost knows it again, also what was `known` before.
    fn owed_beside(&self, known: Vec<Owed>, patient: &str) -> Result<Vec<Owed>, CustodyFault> {
        let mut owed = self.owed_to_servers(patient)?;
        if self.journal.to_fill()?.is_some() {
            for of in known {
                if !owed.contains(&of) {
                    owed.push(of);
                }
            }
        }
        Ok(owed)
    }

    /// Takes from the erasures what servers are no longer owed. Returns whether there was any.
    ///
    /// # Errors
    /// See [`CustodyFault`]; the next call tries again.
    pub fn strike_owed(&self) -> Result<bool, CustodyFault> {
        let waits = |(_, erasure): &(String, Erasure)| !erasure.owed.is_empty();
        if !self.erasures.pending().iter().any(waits) {
            return Ok(false);
        }
        let _change = self.changing();
        let owed = self.journal.owed_to_servers()?;
        let mut is_struck = false;
        for (whose, mut erasure) in self.erasures.pending().into_iter().filter(waits) {
            let is_owed = |of: &&Owed| owed.iter().any(|(_, now)| now == *of);
            let still = erasure.owed.iter().filter(is_owed).cloned().collect();
            if erasure.owes(still) {
                io("noting an erasure", self.erasures.keep(&whose, &erasure))?;
                is_struck = true;
            }
        }
        Ok(is_struck)
    }

    /// What servers are owed of a person's records, and of others' whose scan is erased with them.
    ///
    /// # Errors
    /// If the journal cannot be read.
    pub fn owed_to_servers(&self, patient: &str) -> Result<Vec<Owed>, CustodyFault> {
        let mut whole = Vec::new();
        for of in self.journal.scans_of_person(patient)? {
            if self.goes_whole(&of, patient)? {
                whole.push(of.scan);
            }
        }
        let mut owed = self.journal.owed_to_servers()?;
        owed.retain(|(id, of)| {
            id == patient || whole.iter().any(|scan| scan.as_str() == of.sha256)
        });
        Ok(owed.into_iter().map(|(_, of)| of).collect())
    }

    /// Clears the state folder of a person. A repeated call continues what a crash cut off.
    ///
    /// # Errors
    /// See [`CustodyFault`]; what was removed stays removed.
    pub fn clear_own(
        &self,
        whose: &str,
        mut erasure: Erasure,
        patient: &str,
        state_dir: &Path,
    ) -> Result<(), CustodyFault> {
        let _change = self.changing();
        let scans = self.scans_to_erase(patient)?;
        // Before they are removed: afterwards only this shows which they were.
        erasure.add(scans);
        io("noting an erasure", self.erasures.keep(whose, &erasure))?;
        let whole = whole_scans(&erasure);
        for scan in &whole {
            io("erasing spooled bytes", self.spool.remove(scan))?;
            io("erasing quarantined bytes", self.quarantine.remove(scan))?;
            io("erasing decisions", self.decisions.keep(scan, &[]))?;
        }
        io("erasing the affected leg", self.affected.remove(whose))?;
        self.leave_shared(patient)?;
        let previews = state_dir.join(PREVIEWS);
        // The next generation makes those again that it needs.
        io("erasing previews", durable::remove_folder(&previews))?;
        io("erasing orders", naming::remove(state_dir, REFUSED_ORDERS, patient))?;
        let erasing = Erasing {
            patient,
            whole: &whole,
            stores: &self.stores,
            detail: &json!({ "person": whose, "scans": erasure.scans.len() }),
        };
        self.journal.erase(&erasing)?;
        self.journal.shred()?;
        io("erasing set-aside journals", naming::remove(state_dir, OLD_JOURNALS, patient))?;
        erasure.own_cleared(Timestamp::now(), &self.stores);
        self.keep_erasure(whose, &erasure)
    }

    /// Notes that a store is cleared of a person.
    ///
    /// # Errors
    /// See [`CustodyFault`]; the store is then cleared again.
    pub fn store_cleared(&self, whose: &str, store: &str) -> Result<(), CustodyFault> {
        let _change = self.changing();
        let Some(mut erasure) = self.erasures.of(whose) else { return Ok(()) };
        erasure.store_cleared(store, Timestamp::now());
        self.keep_erasure(whose, &erasure)
    }

    fn keep_erasure(&self, whose: &str, erasure: &Erasure) -> Result<(), CustodyFault> {
        if erasure.ended.is_some() {
            let detail = json!({ "person": whose });
            self.journal.note_of_person(Event::ErasureEnded, &detail)?;
        }
        io("noting an erasure", self.erasures.keep(whose, erasure))
    }

    /// The scans of a person in the journal, and those of the spool and the quarantine that a lost journal
    /// does not know.
    fn scans_to_erase(&self, patient: &str) -> Result<Vec<ErasedScan>, CustodyFault> {
        let mut scans = Vec::new();
        for of in self.journal.scans_of_person(patient)? {
            if of.whose != WhoseScan::TakenBack {
                let is_whole = self.goes_whole(&of, patient)?;
                scans.push(ErasedScan { sha256: of.scan.to_string(), is_whole });
            }
        }
        let mut kept = io("listing the spool", self.spool.entries())?;
        kept.extend(io("listing the quarantine", self.quarantine.entries())?);
        for scan in kept {
            if self.journal.scan(&scan)?.is_some() {
                continue;
            }
            let intake = self.spool.intake(&scan).or_else(|_| self.quarantine.intake(&scan));
            let Ok(mut intake) = intake else { continue };
            if intake_names(&intake, patient) {
                leave(&mut intake, patient);
                let is_whole = intake.patient.is_none() && intake.candidates.is_empty();
                scans.push(ErasedScan { sha256: scan.to_string(), is_whole });
            }
        }
        Ok(scans)
    }

    /// Whether the erasure of a person removes a scan whole, and not only their part of it.
    ///
    /// # Errors
    /// If the journal cannot be read.
    pub fn goes_whole(&self, of: &ScanOfPerson, patient: &str) -> Result<bool, CustodyFault> {
        match of.whose {
            WhoseScan::Theirs => Ok(true),
            // It can belong to this person and to those who were erased before, and to no one else.
            WhoseScan::Uncertain => {
                let held_for = self.journal.patients(&of.scan)?.into_iter().flatten();
                let mut all = held_for.chain(self.journal.candidates(&of.scan)?);
                Ok(all.all(|id| id == patient || id == ERASED))
            }
            WhoseScan::Shared | WhoseScan::TakenBack => Ok(false),
        }
    }

    /// Takes a person from what is kept of scans that others have, too, or may have.
    fn leave_shared(&self, patient: &str) -> Result<(), CustodyFault> {
        for folder in [&self.spool, &self.quarantine] {
            for scan in io("listing kept scans", folder.entries())? {
                let Ok(mut intake) = folder.intake(&scan) else { continue };
                if intake_names(&intake, patient) {
                    leave(&mut intake, patient);
                    io("erasing an id", folder.replace_intake(&scan, intake))?;
                }
            }
        }
        for scan in io("listing decisions", self.decisions.scans())? {
            let Ok(mut decisions) = self.decisions.of(&scan) else { continue };
            if decisions.iter().any(|decision| decision.patient.as_deref() == Some(patient)) {
                // Their number stays: the journal knows how many of them it has carried out.
                for decision in &mut decisions {
                    if decision.patient.as_deref() == Some(patient) {
                        (decision.patient, decision.request) = (None, None);
                    }
                }
                io("erasing an id", self.decisions.keep(&scan, &decisions))?;
            }
        }
        Ok(())
    }
}

/// The scans of an erased person that no one else has.
pub(in crate::station) fn whole_scans(erasure: &Erasure) -> Vec<ScanId> {
    let whole = erasure.scans.iter().filter(|scan| scan.is_whole);
    whole.filter_map(|scan| ScanId::parse(&scan.sha256)).collect()
}

/// Whether an intake names a person anywhere.
fn intake_names(intake: &Intake, patient: &str) -> bool {
    serde_json::to_string(intake).is_ok_and(|text| text.contains(&json!(patient).to_string()))
}

/// Takes a person from an intake. Beside others to whom the scan may belong stays that it may be an erased
/// person's.
fn leave(intake: &mut Intake, patient: &str) {
    intake.patient = intake.patient.take().filter(|named| named.id != patient);
    if intake.candidates.iter().any(|id| id == patient) {
        intake.candidates.retain(|id| id != patient && id != ERASED);
        if !intake.candidates.is_empty() {
            intake.candidates.push(ERASED.to_owned());
        }
    }
    intake.judged = CaptureMatch::Unpressed;
}
