//! Custody: which bytes the station keeps, and why. Spool, quarantine and journal change together only here.
//! The bytes come first when they are added and the journal first when they are removed, so a crash in
//! between leaves too many bytes, never too few. [`CustodyFault`] states whether the folders or the journal
//! failed.

mod acts;
mod affected;
mod decided;
mod decisions;
mod erase;
pub mod erasures;
mod intake;
mod known;
mod lost;
pub(in crate::station) mod phantom_series;
pub mod quarantine;
mod recover;
mod scan_folder;
pub mod spool;
pub(in crate::station) mod state_folders;

use std::collections::BTreeSet;
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use gaiter_flow::account::Whole;
use gaiter_flow::patient::identity;
use gaiter_flow::round::CaptureMatch;
use gaiter_flow::{DeliveryState, ScanId, ScanState, Verdict, Whose};
use gaiter_record::Patient;
use gaiter_scan::Format;
use jiff::Timestamp;

use self::decisions::Decisions;
use self::erasures::Erasures;
use self::phantom_series::PhantomSeries;
use self::quarantine::{Reason, Stage};
use self::scan_folder::ScanFolder;
use self::spool::{Companion, Intake};
use super::journal::{Due, Entry, Journal, JournalError, ScanRow};
use crate::store::durable;
use crate::store::json_folder::JsonFolder;

/// Spool, quarantine and journal of one state folder.
#[derive(Debug)]
pub struct Custody {
    journal: Journal,
    spool: ScanFolder,
    quarantine: ScanFolder,
    decisions: Decisions,
    erasures: Erasures,
    affected: JsonFolder,
    /// The folders that were removed while the station ran.
    removed: Mutex<BTreeSet<&'static str>>,
    /// The checks with the phantom, if one is configured.
    pub(super) phantom: Option<PhantomSeries>,
    /// The stores' names in the journal.
    stores: Vec<&'static str>,
    /// The stores that take no unassigned record.
    pub(super) named_only: Vec<&'static str>,
    /// The stores that are servers.
    servers: Vec<&'static str>,
    /// How long spooled bytes are kept after they are no longer needed.
    kept: Duration,
    /// Held during each change of more than one of the three.
    change: Mutex<()>,
    /// Something could not be removed when it was due; see [`Custody::tidy`].
    untidy: AtomicBool,
    /// The spool may hold a scan that the journal does not know; see [`Custody::enter_kept`].
    unentered: AtomicBool,
}

/// Bytes that have come in.
#[derive(Debug)]
pub struct Arrival<'a> {
    pub scan: &'a ScanId,
    pub bytes: &'a [u8],
    pub format: Format,
    /// The file's own time.
    pub file_time: Option<Timestamp>,
    /// The patient it belongs to, from all sources.
    pub whose: Whose,
    /// The press it answers.
    pub judged: CaptureMatch,
    /// When the button was pressed for it.
    pub pressed_at: Option<Timestamp>,
    /// What the scanner wrote beside it.
    pub companions: &'a [Companion],
    /// The fingerprint of what was read in it; '' if nothing was.
    pub geometry: &'a str,
    /// The earlier scan with the same bytes or fingerprint, if there is one.
    pub known: Option<ScanId>,
}

/// Why custody could not change. It is unchanged, or recovers at the next start or attempt.
#[derive(Debug, thiserror::Error)]
pub enum CustodyFault {
    #[error("the journal could not be read or written")]
    Journal(#[from] JournalError),
    /// The state folder failed.
    #[error("{what} failed")]
    Io {
        what: &'static str,
        #[source]
        source: io::Error,
    },
}

impl Custody {
    /// Opens what the state folder of an open journal holds, and creates what is missing, for the stores with these
    /// names. `kept` is how long spooled bytes are kept after they are no longer needed.
    ///
    /// # Errors
    /// Any I/O error; `InvalidData` if a file of the erasures cannot be understood.
    pub fn open(
        state_dir: &Path,
        journal: Journal,
        stores: Vec<&'static str>,
        kept: Duration,
    ) -> io::Result<Custody> {
        Ok(Custody {
            journal,
            spool: ScanFolder::open(state_dir, "spool")?,
            quarantine: ScanFolder::open(state_dir, "quarantine")?,
            decisions: Decisions::open(state_dir)?,
            erasures: Erasures::open(state_dir)?,
            affected: JsonFolder::open(state_dir, affected::FOLDER)?,
            removed: Mutex::default(),
            phantom: None,
            stores,
            named_only: Vec::new(),
            servers: Vec::new(),
            kept,
            change: Mutex::new(()),
            untidy: AtomicBool::new(false),
            unentered: AtomicBool::new(false),
        })
    }

    /// The same, with the names of the stores that are servers, for the journal, too.
    ///
    /// # Errors
    /// If the journal fails.
    pub fn with_servers(self, servers: Vec<&'static str>) -> Result<Custody, CustodyFault> {
        Ok(Custody { journal: self.journal.with_servers(&servers)?, servers, ..self })
    }

    /// The checks with the phantom, if one is configured.
    pub fn phantom_series(&self) -> Option<&PhantomSeries> {
        self.phantom.as_ref()
    }

    /// The stores that take a record for this patient.
    fn stores_for(&self, patient: Option<&Patient>) -> Vec<&'static str> {
        let takes = |store: &&&'static str| patient.is_some() || !self.named_only.contains(store);
        self.stores.iter().filter(takes).copied().collect()
    }

    /// The names of its folders that are missing.
    pub fn missing_folders(&self) -> Vec<&'static str> {
        self.folders().into_iter().filter(|(_, at)| !at.is_dir()).map(|(name, _)| name).collect()
    }

    /// Creates missing folders again, durably; what was in them is lost.
    pub fn make_folders_anew(&self) -> io::Result<()> {
        self.folders().into_iter().try_for_each(|(_, at)| {
            durable::make_folder_once(at)?;
            at.parent().map_or(Ok(()), durable::sync_folder)
        })
    }

    fn folders(&self) -> [(&'static str, &Path); 5] {
        [
            ("spool", self.spool.path()),
            ("quarantine", self.quarantine.path()),
            ("decisions", self.decisions.0.path()),
            ("erasures", self.erasures.folder.path()),
            ("affected", self.affected.path()),
        ]
    }

    /// The journal, for queries.
    pub fn journal(&self) -> &Journal {
        &self.journal
    }

    /// The erasures of persons.
    pub fn erasures(&self) -> &Erasures {
        &self.erasures
    }

    /// The spool, for reading.
    pub fn spool(&self) -> &ScanFolder {
        &self.spool
    }

    /// Held while spool, quarantine and journal change together.
    fn changing(&self) -> MutexGuard<'_, ()> {
        self.change.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes bytes in if they add anything new. Durable on return. If the journal fails after the bytes
    /// are kept, [`Custody::enter_kept`] continues.
    pub fn admit(&self, arrival: &Arrival<'_>) -> Result<Verdict, CustodyFault> {
        let _change = self.changing();
        let scan = arrival.scan;
        let named = arrival.whose.patient.as_ref().map(|patient| patient.id.as_str());
        if self.erasures.refuse(scan, named) {
            return Ok(Verdict::Already);
        }
        if self.is_lost(scan)? {
            self.take_in_again(arrival)?;
        }
        let row_known = self.journal.scan(scan)?;
        let patients = match &arrival.known {
            Some(known) => self.journal.patients(known)?,
            None => Vec::new(),
        };
        let verdict = match identity::verdict(patients.iter().map(Option::as_deref), named) {
            Verdict::Already => return Ok(Verdict::Already),
            Verdict::New => arrival.whose.held.map_or(Verdict::New, Verdict::Held),
            held @ Verdict::Held(_) => held,
        };
        let held = match verdict {
            Verdict::Held(code) => Some(code),
            Verdict::New | Verdict::Already => None,
        };
        let intake = intake(arrival, row_known.as_ref(), held);
        // A held scan that was refused before has its bytes in quarantine already.
        let was_unentered = self.unentered.swap(true, Ordering::Relaxed);
        let kept = self.spool.holds(scan) || (held.is_some() && self.quarantine.holds(scan));
        if !kept {
            let (bytes, beside) = (arrival.bytes, arrival.companions);
            let kept = self.spool.keep(scan, intake.clone(), bytes, beside);
            self.untidy.fetch_or(kept.is_err(), Ordering::Relaxed);
            io("keeping a scan", kept)?;
        }
        self.enter(&intake, held, &arrival.whose.claims, &row(&intake, scan))?;
        self.unentered.store(was_unentered, Ordering::Relaxed);
        // A lost journal may not know earlier decisions about these bytes.
        self.carry_out_of(scan)?;
        Ok(verdict)
    }

    /// Enters a scan into the journal, with the capture that it answers. `claims` are the patients of its sources,
    /// if they differ.
    fn enter(
        &self,
        intake: &Intake,
        held: Option<&'static str>,
        claims: &[Patient],
        row: &ScanRow,
    ) -> Result<(), CustodyFault> {
        let patient = intake.patient.as_ref();
        let Intake { geometry, judged, candidates, .. } = intake;
        let entry = Entry { row, patient, held, claims, judged, geometry, candidates };
        Ok(self.journal.enter(&entry, &self.stores_for(patient))?)
    }

    /// Notes a file that was refused before it was read.
    pub fn refuse_unread(&self, name: &str, reason: &Reason) -> Result<(), CustodyFault> {
        let _change = self.changing();
        io("noting a refusal", self.quarantine.note(name, reason))
    }

    /// Records a delivery's receipt. Bytes that are no longer needed are removed, now or by
    /// [`Custody::tidy`].
    ///
    /// # Errors
    /// See [`CustodyFault`]; the delivery is then still to be made.
    pub fn delivered(&self, due: &Due, folder: &Path) -> Result<(), CustodyFault> {
        let _change = self.changing();
        self.journal.delivered(due, folder)?;
        let given_up = self.give_up_served(&due.scan);
        self.untidy.fetch_or(given_up.is_err(), Ordering::Relaxed);
        self.quarantine_refused(&due.scan)
    }

    /// Moves the bytes of a scan to quarantine if it is refused: a store refused it for good, and the others have it
    /// now. After a crash the next start does it.
    fn quarantine_refused(&self, scan: &ScanId) -> Result<(), CustodyFault> {
        // If no store has it, it is about to be taken in again.
        if self.journal.scan(scan)?.is_none_or(|row| row.state != ScanState::Refused)
            || self.journal.deliveries_in(scan, DeliveryState::Delivered)?.is_empty()
            || self.quarantine.holds(scan)
            || !self.spool.holds(scan)
        {
            return Ok(());
        }
        let Some(Whole { summary, .. }) = self.journal.whole(scan)? else { return Ok(()) };
        let (code, message) =
            (summary.code.unwrap_or_default(), summary.message.unwrap_or_default());
        let reason = Reason::new(&code, message, Stage::Store, summary.first_seen);
        self.quarantined(scan, &reason)
    }

    /// Removes what could not be removed when it was due, if there is anything.
    ///
    /// # Errors
    /// See [`CustodyFault`]; the next call tries again.
    pub fn tidy(&self) -> Result<(), CustodyFault> {
        if !self.untidy.load(Ordering::Relaxed) {
            return Ok(());
        }
        let _change = self.changing();
        io("clearing the spool", self.spool.clear())?;
        io("clearing the quarantine", self.quarantine.clear())?;
        for scan in io("listing the spool", self.spool.entries())? {
            self.give_up_served(&scan)?;
        }
        self.untidy.store(false, Ordering::Relaxed);
        Ok(())
    }

    /// Removes the spooled bytes of scans that were finished before a time. Returns how many.
    pub fn let_go_spooled(&self, before: Timestamp) -> Result<usize, CustodyFault> {
        let _change = self.changing();
        self.let_go_of_spool(before, true)
    }

    /// Removes the spooled bytes of scans that were finished before a time and have served; or those of scans that
    /// were given up before they had a record, which have not. Returns how many.
    fn let_go_of_spool(&self, before: Timestamp, served: bool) -> Result<usize, CustodyFault> {
        let mut gone = 0;
        // The spool is small; what the journal knows grows over the years.
        for scan in io("listing the spool", self.spool.entries())? {
            let rests = self.journal.rests_since(&scan, ScanState::Delivered, before)?;
            if rests && self.journal.has_served(&scan)? == served {
                if !served {
                    self.journal.let_go_of(&scan)?;
                }
                io("giving up spooled bytes", self.spool.remove(&scan))?;
                gone += 1;
            }
        }
        Ok(gone)
    }

    /// Removes scans that were refused, or given up without a record, before a time. Returns how many. The
    /// journal still knows them, so that their exports are not taken in again.
    pub fn let_go_quarantined(&self, before: Timestamp) -> Result<usize, CustodyFault> {
        let _change = self.changing();
        let mut gone = io("giving up refused files", self.quarantine.remove_notes(before))?;
        for scan in io("listing the quarantine", self.quarantine.entries())? {
            if self.journal.rests_since(&scan, ScanState::Refused, before)? {
                if self.quarantine.holds_bytes(&scan) {
                    self.journal.let_go_of(&scan)?;
                }
                let removed = io("giving up a refused scan", self.quarantine.remove(&scan))?;
                gone += usize::from(removed);
            }
        }
        Ok(gone + self.let_go_of_spool(before, false)?)
    }

    /// Refuses a delivery for good. If only its store will never take the record and other deliveries of
    /// the scan are pending, the bytes stay for them; otherwise the scan is refused. Returns the reason
    /// that applies; `None` if a decision has changed the delivery meanwhile.
    pub fn refuse_delivery(
        &self,
        due: &Due,
        reason: Reason,
    ) -> Result<Option<Reason>, CustodyFault> {
        let _change = self.changing();
        if !self.journal.is_to_be_made(due)? {
            return Ok(None);
        }
        let of_store = reason.stage == Stage::Store;
        if of_store && self.journal.refused_at_store(due, &reason.code, &reason.message)? {
            return Ok(Some(reason));
        }
        self.refused(&due.scan, reason).map(Some)
    }

    /// Refuses a scan for good; its bytes go to quarantine. Returns the reason that applies.
    pub fn refuse(&self, scan: &ScanId, reason: Reason) -> Result<Reason, CustodyFault> {
        let _change = self.changing();
        self.refused(scan, reason)
    }

    fn refused(&self, scan: &ScanId, reason: Reason) -> Result<Reason, CustodyFault> {
        // An attempt that failed at the journal left its reason in quarantine: that reason applies.
        let earlier = io("reading a reason", self.quarantine.reason(scan))?;
        self.quarantined(scan, &reason)?;
        let reason = earlier.unwrap_or(reason);
        self.journal.refused(scan, &reason.code, &reason.message)?;
        Ok(reason)
    }

    /// Moves the bytes of a scan to quarantine; without bytes, notes the reason there.
    fn quarantined(&self, scan: &ScanId, reason: &Reason) -> Result<(), CustodyFault> {
        let quarantined = if self.quarantine.holds(scan) {
            // An earlier attempt may have failed to sync its name.
            self.quarantine.sync().and_then(|()| self.spool.remove(scan).map(drop))
        } else if self.spool.holds(scan) {
            self.spool.refuse(&self.quarantine, scan, reason)
        } else {
            self.quarantine.note(scan.as_str(), reason)
        };
        self.untidy.fetch_or(quarantined.is_err(), Ordering::Relaxed);
        io("quarantining a scan", quarantined)
    }
}

fn io<T>(what: &'static str, result: io::Result<T>) -> Result<T, CustodyFault> {
    result.map_err(|source| CustodyFault::Io { what, source })
}

pub use acts::Acted;
pub(in crate::station) use erase::{OLD_JOURNALS, REFUSED_ORDERS, files_naming, whole_scans};
use intake::{held_code, intake, intake_of, row};

#[cfg(test)]
mod tests;
