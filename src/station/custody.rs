//! Custody: which bytes the station keeps, and why. Spool, quarantine and journal change together
//! here and nowhere else, bytes first when they come, journal first when they go, so that a crash
//! between the two leaves bytes too many, never too few.

use std::io;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use jiff::Timestamp;

use super::journal::{Due, Journal, JournalError, ScanRow};
use super::quarantine::{Quarantine, Reason, Stage};
use super::spool::{Companion, Intake, Spool};
use crate::flow::identity::{self, ID_NOT_ALLOWED, SAME_SCAN_OTHER_PATIENT};
use crate::flow::{DeliveryState, NameSays, ScanId, ScanState, Verdict};
use crate::record::Patient;
use crate::scan::Format;

/// Spool, quarantine and journal of one state folder.
#[derive(Debug)]
pub struct Custody {
    journal: Journal,
    spool: Spool,
    quarantine: Quarantine,
    /// The store's name in the journal.
    store: &'static str,
    /// Held over each change of more than one of the three.
    change: Mutex<()>,
}

/// Bytes that have come in.
#[derive(Debug)]
pub struct Arrival<'a> {
    /// Their id.
    pub scan: &'a ScanId,
    /// The bytes.
    pub bytes: &'a [u8],
    /// Their format.
    pub format: Format,
    /// The file's own time.
    pub file_time: Option<Timestamp>,
    /// What the file's name says about the patient.
    pub says: NameSays,
    /// What the scanner wrote beside it.
    pub companions: &'a [Companion],
}

/// Why custody could not change; it is as before, or recovers at the next start or attempt.
#[derive(Debug, thiserror::Error)]
pub enum CustodyFault {
    /// The journal failed.
    #[error("the journal could not be read or written")]
    Journal(#[from] JournalError),
    /// The state folder failed.
    #[error("{what} failed")]
    Io {
        /// What was tried.
        what: &'static str,
        /// How it failed.
        #[source]
        source: io::Error,
    },
}

impl Custody {
    /// Custody over an open journal, spool and quarantine, for the store of this name.
    pub fn new(
        journal: Journal,
        spool: Spool,
        quarantine: Quarantine,
        store: &'static str,
    ) -> Custody {
        Custody { journal, spool, quarantine, store, change: Mutex::new(()) }
    }

    /// The journal, to be asked.
    pub fn journal(&self) -> &Journal {
        &self.journal
    }

    /// The spool, to be read.
    pub fn spool(&self) -> &Spool {
        &self.spool
    }

    /// The store's name in the journal.
    pub fn store(&self) -> &'static str {
        self.store
    }

    /// Takes bytes in, if they say anything new. Durable when this returns.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn admit(&self, arrival: &Arrival<'_>) -> Result<Verdict, CustodyFault> {
        let _change = self.change.lock().unwrap_or_else(PoisonError::into_inner);
        let scan = arrival.scan;
        if self.journal.scan(scan)?.is_none() && self.spool.holds(scan) {
            // An earlier attempt kept the bytes and failed at the journal.
            self.adopt(scan)?;
        }
        let known = self.journal.scan(scan)?;
        let patient = match &arrival.says {
            NameSays::Patient(patient) => Some(patient),
            NameSays::Nothing | NameSays::NotAnId => None,
        };
        let patients = self.journal.patients(scan)?;
        let sighted = patient.map(|patient| patient.id.as_str());
        let verdict = identity::judge(patients.iter().map(Option::as_deref), sighted);
        let held = match verdict {
            Verdict::Already => return Ok(verdict),
            Verdict::New => false,
            Verdict::Held => true,
        };
        let intake = intake(arrival, known.as_ref(), patient, held);
        let row = row(&intake, scan);
        // A held scan that was refused before has its bytes in quarantine already.
        let kept = self.spool.holds(scan) || (held && self.quarantine.holds(scan));
        if !kept {
            let (bytes, beside) = (arrival.bytes, arrival.companions);
            io("keeping a scan", self.spool.keep(scan, intake, bytes, beside))?;
        }
        self.enter(&row, patient, held)?;
        Ok(verdict)
    }

    /// A file was refused before it was read.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn refuse_unread(&self, name: &str, reason: &Reason) -> Result<(), CustodyFault> {
        io("noting a refusal", self.quarantine.note(name, reason))
    }

    /// A delivery has its receipt; bytes that have served are given up.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn delivered(&self, due: &Due, folder: &Path) -> Result<(), CustodyFault> {
        let _change = self.change.lock().unwrap_or_else(PoisonError::into_inner);
        if self.journal.delivered(due, self.store, folder)? {
            io("giving up spooled bytes", self.spool.remove(&due.scan))?;
        }
        Ok(())
    }

    /// A scan is refused for good; its bytes go to quarantine.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn refuse(&self, scan: &ScanId, reason: &Reason) -> Result<(), CustodyFault> {
        let _change = self.change.lock().unwrap_or_else(PoisonError::into_inner);
        io("quarantining a scan", self.quarantined(scan, reason))?;
        Ok(self.journal.refused(scan, &reason.code, &reason.message)?)
    }

    fn quarantined(&self, scan: &ScanId, reason: &Reason) -> io::Result<()> {
        if self.quarantine.holds(scan) {
            return self.spool.remove(scan);
        }
        if !self.spool.holds(scan) {
            return self.quarantine.note(scan.as_str(), reason);
        }
        self.quarantine.take(&self.spool.entry(scan), scan, reason)?;
        self.spool.sync()
    }

    /// Makes spool, quarantine and journal agree after whatever ended the last run; returns how
    /// many scans of the spool the journal did not know.
    ///
    /// # Errors
    /// See [`CustodyFault`].
    pub fn recover(&self) -> Result<usize, CustodyFault> {
        let _change = self.change.lock().unwrap_or_else(PoisonError::into_inner);
        let mut adopted = 0;
        for scan in io("listing the spool", self.spool.entries())? {
            match self.journal.scan(&scan)?.map(|row| row.state) {
                None => {
                    self.adopt_or_refuse(&scan)?;
                    adopted += 1;
                }
                Some(ScanState::Spooled) => {}
                Some(ScanState::Delivered) if self.journal.is_held(&scan)? => {}
                Some(ScanState::Refused) if !self.quarantine.holds(&scan) => {}
                Some(ScanState::Delivered | ScanState::Refused) => {
                    io("giving up spooled bytes", self.spool.remove(&scan))?;
                }
            }
        }
        for scan in self.journal.scans_in(ScanState::Spooled)? {
            if !self.spool.holds(&scan) {
                self.settle_missing(&scan)?;
            }
        }
        Ok(adopted)
    }

    /// A scan to be delivered whose bytes are not in the spool: they are in quarantine already, or
    /// somebody removed them.
    fn settle_missing(&self, scan: &ScanId) -> Result<(), CustodyFault> {
        let known = io("reading a reason", self.quarantine.reason(scan))?;
        let reason = match (known, self.journal.scan(scan)?) {
            (Some(reason), _) => reason,
            (None, Some(row)) => {
                let message = "its bytes were removed from the spool from outside".to_owned();
                let reason = Reason::new("spool-lost", message, Stage::Intake, row.first_seen);
                io("noting a refusal", self.quarantine.note(scan.as_str(), &reason))?;
                reason
            }
            (None, None) => return Ok(()),
        };
        Ok(self.journal.refused(scan, &reason.code, &reason.message)?)
    }

    /// Enters a scan of the spool that the journal does not know.
    fn adopt(&self, scan: &ScanId) -> Result<(), CustodyFault> {
        let intake = io("reading an intake", self.spool.intake(scan))?;
        self.enter(&row(&intake, scan), intake.patient.as_ref(), intake.held)
    }

    /// As [`Custody::adopt`]; an entry whose intake cannot be read must not stop every start.
    fn adopt_or_refuse(&self, scan: &ScanId) -> Result<(), CustodyFault> {
        let unreadable = match self.spool.intake(scan) {
            Ok(_) => return self.adopt(scan),
            Err(error) => error,
        };
        if !matches!(unreadable.kind(), io::ErrorKind::InvalidData | io::ErrorKind::NotFound) {
            return io("reading an intake", Err(unreadable));
        }
        let message = format!("its intake.json cannot be read: {unreadable}");
        let reason = Reason::new("spool-damaged", message, Stage::Intake, Timestamp::now());
        io("quarantining a scan", self.quarantined(scan, &reason))
    }

    fn enter(
        &self,
        row: &ScanRow,
        patient: Option<&Patient>,
        held: bool,
    ) -> Result<(), CustodyFault> {
        let (state, code) = match held {
            true => (DeliveryState::Held, Some(SAME_SCAN_OTHER_PATIENT)),
            false => (DeliveryState::Pending, None),
        };
        Ok(self.journal.enter(row, patient, self.store, state, code)?)
    }
}

/// What is known of bytes that have come in. The time of first sight is fixed once.
fn intake(
    arrival: &Arrival<'_>,
    known: Option<&ScanRow>,
    patient: Option<&Patient>,
    held: bool,
) -> Intake {
    let now = Timestamp::now();
    let now = Timestamp::from_second(now.as_second()).unwrap_or(now);
    let findings = match (&arrival.says, held) {
        (_, true) => vec![SAME_SCAN_OTHER_PATIENT.to_owned()],
        (NameSays::NotAnId, false) => vec![ID_NOT_ALLOWED.to_owned()],
        (_, false) => Vec::new(),
    };
    Intake {
        sha256: arrival.scan.to_string(),
        format: arrival.format.ending().to_owned(),
        size: u64::try_from(arrival.bytes.len()).unwrap_or(u64::MAX),
        first_seen: known.map_or(now, |row| row.first_seen),
        file_time: known.map_or(arrival.file_time, |row| row.file_time),
        patient: patient.cloned(),
        held,
        findings,
    }
}

/// The journal's row of an intake. Held bytes have nothing to be delivered by itself.
fn row(intake: &Intake, scan: &ScanId) -> ScanRow {
    ScanRow {
        scan: scan.clone(),
        format: intake.format.clone(),
        size: intake.size,
        first_seen: intake.first_seen,
        file_time: intake.file_time,
        state: if intake.held { ScanState::Delivered } else { ScanState::Spooled },
    }
}

fn io<T>(what: &'static str, result: io::Result<T>) -> Result<T, CustodyFault> {
    result.map_err(|source| CustodyFault::Io { what, source })
}

#[cfg(test)]
mod tests;
