//! Practice software as a store: each record is a result (GDT 6310) in an exchange folder. The practice
//! software fetches it from there and deletes it.
//!
//! A missing file has been fetched, so the folder does not show what was handed over; a register in the
//! station's state folder does. A result is staged beside the exchange folder's files and synced, then
//! registered, then given its name. So each point at which a crash can interrupt this has one meaning:
//!
//! | staged file | register | what it means |
//! |---|---|---|
//! | there or not | nothing | not begun: it is made again |
//! | there | registered | it has no name yet: it gets one |
//! | gone | registered | it had its name: it was handed over, and is never handed over again |

mod attach;
mod register;
#[cfg(test)]
mod tests;

use std::fs;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use jiff::Timestamp;
use jiff::tz::TimeZone;
use sha2::{Digest, Sha256};

use super::exchange::ExchangeFolder;
use super::{
    Delivery, FoundRecord, Receipt, RecordStore, Rejection, StoreFault, TakeBack, durable, tried,
};
pub use attach::{Attach, Attached};
use gaiter_flow::ScanId;
use gaiter_flow::patient::person::HandedOver;
use gaiter_record::gdt::rules::{COUNTER_MOST, FileName};
use gaiter_record::gdt::{self, GdtRules};
use gaiter_record::{FIRST_REVISION, hex};
use gaiter_sizes::Garment;
use register::{Entry, Register};

/// Results for a practice's software.
#[derive(Debug, Clone)]
pub struct GdtStore {
    rules: GdtRules,
    garment: Garment,
    attach: Attach,
    place: ExchangeFolder,
    names: FileName,
    register: Register,
    zone: TimeZone,
    /// Ensures that one result at a time is given a name.
    naming: Arc<Mutex<()>>,
}

impl GdtStore {
    /// Its name in the journal.
    pub const NAME: &str = "gdt";

    /// Results for orders of this garment in the exchange folder `folder` under names like `names`, written by
    /// the station `station` with its register in `state_dir`. Times are in the time zone `zone`.
    pub fn new(
        folder: PathBuf,
        names: FileName,
        (rules, garment, attach): (GdtRules, Garment, Attach),
        (station, state_dir): (&str, PathBuf),
        zone: TimeZone,
    ) -> GdtStore {
        let register = Register::new(state_dir.join("handed-over"));
        let place = ExchangeFolder::new(folder, station);
        GdtStore { rules, garment, attach, place, names, register, zone, naming: Arc::default() }
    }

    /// Writes attachments and message, synced; the message goes to the staging folder.
    fn stage(&self, key: &str, delivery: &Delivery<'_>) -> Result<(), StoreFault> {
        let rejection = |rejection| StoreFault::Permanent(rejection);
        let (record, _) = delivery.named_record().map_err(rejection)?;
        let acquired = record.acquired.as_ref().map_or(delivery.first_seen, |acquired| acquired.at);
        let taken = self.zone.to_datetime(acquired);
        let attachments = self.attach.attachments(key, delivery.files, self.place.folder());
        let message = gdt::result(&record, &self.garment, &self.rules, taken, &attachments);
        let message = message.map_err(|fault| rejection(Rejection::Gdt(fault)))?;
        self.attach.write(key, delivery.files, &self.place)?;
        self.place.stage(&staged_name(key), &message)
    }

    /// Registers a staged result under a free name, then renames it to this name.
    fn name(
        &self,
        key: &str,
        delivery: &Delivery<'_>,
        patient: &str,
    ) -> Result<PathBuf, StoreFault> {
        let (number, name) = self.free_name(self.register.last_number())?;
        let entry = Entry {
            scan: delivery.scan.to_string(),
            patient: patient.to_owned(),
            first_seen: delivery.first_seen,
            format: delivery.ending.to_owned(),
            size: fs::metadata(delivery.scan_file).map_or(0, |metadata| metadata.len()),
            name: name.clone(),
            number,
            at: Timestamp::now(),
        };
        self.register.enter(key, &entry)?;
        let file = self.place.folder().join(name);
        self.place.publish_new(&staged_name(key), &file)?;
        Ok(file)
    }

    /// The next free name and its number; `last` is the number used last.
    fn free_name(&self, last: u16) -> Result<(u16, String), StoreFault> {
        let tries = if self.names.counts() { COUNTER_MOST } else { 1 };
        for step in 0..tries {
            let number = (last + step) % COUNTER_MOST + 1;
            let name = self.names.of(number);
            let path = self.place.folder().join(&name);
            let found = durable::if_there(fs::symlink_metadata(&path));
            if tried("looking for", &path, found)?.is_none() {
                return Ok((number, name));
            }
        }
        Err(StoreFault::NotFetched)
    }
}

impl RecordStore for GdtStore {
    fn name(&self) -> &'static str {
        GdtStore::NAME
    }

    fn place(&self) -> String {
        self.place.folder().to_string_lossy().into_owned()
    }

    fn gives_back(&self) -> bool {
        false
    }

    /// Makes the folder for staged results, which also identifies the exchange folder.
    fn begin(&self, make_folder: bool) -> Result<(), StoreFault> {
        self.place.begin(make_folder)
    }

    /// Removes results that crashed deliveries left staged and not registered.
    fn open(&self) -> Result<(), StoreFault> {
        self.register.open()?;
        for name in self.place.staged()? {
            if let Some(key) = name.strip_suffix(STAGED_ENDING)
                && self.register.entry(key)?.is_none()
            {
                self.place.unstage(&name)?;
            }
        }
        Ok(())
    }

    /// Also [`StoreFault::NotFetched`] while the last result under a fixed name, or 999 numbered results,
    /// have not been fetched.
    fn reach(&self) -> Result<(), StoreFault> {
        self.place.reach()?;
        self.free_name(self.register.last_number()).map(drop)
    }

    fn records(&self) -> Result<Vec<FoundRecord>, StoreFault> {
        self.place.reach()?;
        let mut found = Vec::new();
        for (key, entry) in self.register.entries()? {
            if !self.place.is_staged(&staged_name(&key))? {
                found.extend(entry.found(self.place.folder()));
            }
        }
        Ok(found)
    }

    fn put(&self, delivery: &Delivery<'_>) -> Result<Receipt, StoreFault> {
        let Some(patient) = delivery.patient else {
            return Err(StoreFault::Permanent(Rejection::Unassigned));
        };
        let _naming = self.naming.lock().unwrap_or_else(PoisonError::into_inner);
        // Checked each time: the share may have gone since.
        self.place.reach()?;
        self.register.open()?;
        let key = key(delivery.scan, patient, delivery.revision);
        if let Some(entry) = self.register.entry(&key)? {
            if !self.place.is_staged(&staged_name(&key))? {
                // The run that gave it its name may have ended before this sync.
                self.place.sync()?;
                let folder = self.place.folder().join(entry.name);
                return Ok(Receipt { folder, already_there: true });
            }
        } else {
            // Checked before anything is written: it may have to wait for long.
            self.free_name(self.register.last_number())?;
            self.stage(&key, delivery)?;
        }
        let folder = self.name(&key, delivery, patient)?;
        Ok(Receipt { folder, already_there: false })
    }

    /// Removes results that have no name yet, and forgets those that were handed over: these are the practice's own.
    fn erase(
        &self,
        patient: &str,
        _before: Timestamp,
        _scans: &[ScanId],
    ) -> Result<(), StoreFault> {
        self.place.reach()?;
        let staged = self.place.staged()?;
        for (key, entry) in self.register.entries()? {
            if entry.patient == patient {
                // Also an attachment that a crash left.
                let (result, attachment) = (staged_name(&key), format!("{key}_"));
                let is_its = |name: &&String| **name == result || name.starts_with(&attachment);
                staged.iter().filter(is_its).try_for_each(|name| self.place.unstage(name))?;
                self.register.forget(&key)?;
            }
        }
        self.place.sync()
    }

    fn withdraw(&self, _record: &TakeBack<'_>) -> Result<(), StoreFault> {
        Err(StoreFault::Permanent(Rejection::HandedOver))
    }

    /// A folder that is out of reach is no fault: nothing is there then.
    fn given(&self, patient: &str) -> Result<Vec<HandedOver>, StoreFault> {
        let mut given = Vec::new();
        for (key, entry) in self.register.entries()? {
            if entry.patient != patient || self.place.is_staged(&staged_name(&key)).unwrap_or(false)
            {
                continue;
            }
            let file = self.place.folder().join(&entry.name);
            given.push(HandedOver {
                sha256: entry.scan,
                waits: file.exists(),
                file,
                at: entry.at,
                attachments: self.attach.there(&key, self.place.folder()),
            });
        }
        given.sort_by_key(|of| of.at);
        Ok(given)
    }
}

/// The ending of staged results; no practice software looks for it.
const STAGED_ENDING: &str = ".staged";

fn staged_name(key: &str) -> String {
    format!("{key}{STAGED_ENDING}")
}

/// The key of a result, made from the scan, the patient and a later revision, without showing the patient's
/// id.
fn key(scan: &ScanId, patient: &str, revision: u32) -> String {
    let digest = Sha256::digest(format!("{scan}\0{patient}"));
    let key = format!("{}-{}", scan.short(), hex(&digest[..4]));
    if revision > FIRST_REVISION { format!("{key}-r{revision}") } else { key }
}
