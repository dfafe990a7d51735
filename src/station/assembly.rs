//! What the workers of one station share, put together at the start.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use jiff::Timestamp;
use jiff::tz::TimeZone;
use rustix::time::{ClockId, clock_gettime};
use tokio::sync::Notify;
use tracing::{error, info, warn};

use super::board::Board;
use super::booth::Booth;
use super::custody::decisions::Decisions;
use super::custody::quarantine::Quarantine;
use super::custody::spool::Spool;
use super::custody::{Custody, CustodyFault};
use super::delivery::measuring::{self, IMPAIRED};
use super::delivery::preview::Previews;
use super::error::{StationError, chain};
use super::event::Observer;
use super::intake::admission::Gate;
use super::journal::JournalError;
use super::journal::integrity::rebuild;
use super::journal::integrity::suspicion::Suspicion;
use super::lasting::Lasting;
use super::operator::page::Desk;
use crate::config::{Config, GdtStoreConfig};
use crate::flow::facts::{Alarm, IntakeState, StoreFacts};
use crate::flow::health::counted;
use crate::flow::{Facts, Identity, OrdersWhen, ScanId};
use crate::store::gdt::Attach;
use crate::store::{FolderStore, GdtStore, RecordStore, StoreFault};

/// The parts of a station that its workers share.
#[derive(Debug)]
pub struct Station {
    /// The configuration.
    pub config: Config,
    /// The rules of patients' ids.
    pub identity: Identity,
    /// Spool, journal and quarantine.
    pub custody: Custody,
    /// Where records go.
    pub stores: Vec<RecordStore>,
    /// What the workers know, for those who ask.
    pub board: Board,
    /// The button, the readers of ids and the light.
    pub booth: Booth,
    /// What outlives this generation.
    pub lasting: Arc<Lasting>,
    /// The operator's page.
    pub page: Desk,
    /// What held scans show of their legs.
    pub previews: Previews,
    gate: Gate,
    /// Who looks on.
    pub observer: Observer,
    /// Tells the delivery that the journal has something new; a hint only.
    pub work: Notify,
    /// Tells the run that the journal is to be rebuilt.
    pub ruin: Notify,
    /// Errors that leave open whether the journal is damaged.
    pub suspicion: Suspicion,
    paused: AtomicBool,
    to_retry_now: Mutex<Vec<ScanId>>,
    ready_stores: Mutex<BTreeSet<String>>,
    began: Duration,
}

impl Station {
    /// Takes the state folder for this process and takes up what the last run left. A journal that
    /// cannot be relied upon is set aside and rebuilt, with an alarm.
    ///
    /// # Errors
    /// See [`StationError`].
    pub fn open(
        config: Config,
        (observer, lasting): (Observer, Arc<Lasting>),
        first_start: bool,
    ) -> Result<Station, StationError> {
        let confined =
            measuring::confined(config.measure.confine).map_err(StationError::Unconfined)?;
        let (scanner, patient) = (&config.scanner, &config.patient);
        let identity = Identity::new(
            scanner.file_name.clone(),
            patient.sidecar.clone(),
            &patient.pattern,
            patient.check_digit,
        )?;
        let state_dir = &config.station.state_dir;
        let state = |source| StationError::State { path: state_dir.clone(), source };
        let stores = stores(&config);
        let names: Vec<&'static str> = stores.iter().map(RecordStore::name).collect();
        let nameless = stores.iter().filter(|store| !store.takes_nobodys());
        let named_only: Vec<&'static str> = nameless.map(RecordStore::name).collect();
        let journal = journal_file(&config);
        let opened = rebuild::open(&journal, &names, first_start)?;
        // After the journal: where there is a spool there was one, and where it is missing it was lost.
        let spool = Spool::open(state_dir).map_err(state)?;
        let quarantine = Quarantine::open(state_dir).map_err(state)?;
        let decisions = Decisions::open(state_dir).map_err(state)?;
        let paused = opened.journal.is_paused().map_err(CustodyFault::from);
        let paused = paused.map_err(StationError::Recovery)?;
        let custody = Custody::new(
            opened.journal,
            (spool, quarantine),
            decisions,
            names,
            config.retention.spool,
        )
        .with_named_only(named_only);
        // Ruin that shows only now: the next start finds no journal and makes it anew.
        let failed = |fault: CustodyFault| match rebuild::is_ruin(&fault) {
            true => rebuild::give_up(&journal, custody.journal())
                .map_or_else(|error| error, |()| StationError::Recovery(fault)),
            false => StationError::Recovery(fault),
        };
        let adopted = custody.recover().map_err(failed)?;
        let mut facts = Facts::new(Timestamp::now(), config.scanner.export_dirs.len());
        match confined {
            Ok(found) => facts.confinement = Some(found),
            Err(why) => _ = facts.alarms.insert(IMPAIRED, why),
        }
        if let Some(why) = opened.rebuilt {
            let quarantined = custody.adopt_quarantined().map_err(StationError::Recovery)?;
            // They were begun by the station that lost its journal, and must be found marked.
            for store in stores.iter().filter(|_| !first_start) {
                let begun = custody.journal().begun(store.name(), &store.place());
                begun.map_err(CustodyFault::from).map_err(StationError::Recovery)?;
            }
            error!(event = "journal-rebuilt", why, adopted, quarantined);
            let message = format!("the journal was rebuilt, for {why}");
            facts.alarms.insert("journal-rebuilt", Alarm { message, since: Timestamp::now() });
        }
        // After the scans that a lost journal must learn of first.
        let unreadable = custody.carry_out().map_err(failed)?;
        if !unreadable.is_empty() {
            facts.alarms.insert("decisions-unreadable", unreadable_decisions(unreadable.len()));
        }
        if paused {
            facts.intake = IntakeState::Paused;
        }
        let (folders, buttons) = (config.scanner.export_dirs.len(), config.buttons());
        let orders = config.patient.orders.as_ref();
        let orders = orders.map_or(OrdersWhen::default(), |orders| orders.when);
        let rules = config.capture.rules(&buttons, orders);
        let booth = Booth::open(custody.journal(), rules, folders, buttons, since_boot());
        let booth = booth.map_err(CustodyFault::from).map_err(failed)?;
        info!(event = "station-open", adopted, first_start);
        let of = &config.station;
        let previews = Previews::of(&of.state_dir);
        let gate = Gate::new(of.state_dir.clone(), of.disk_floor_bytes);
        Ok(Station {
            config,
            identity,
            custody,
            stores,
            board: Board::new(facts),
            booth,
            lasting,
            page: Desk::default(),
            previews,
            gate,
            observer,
            work: Notify::new(),
            ruin: Notify::new(),
            suspicion: Suspicion::default(),
            paused: AtomicBool::new(paused),
            to_retry_now: Mutex::new(Vec::new()),
            ready_stores: Mutex::new(BTreeSet::new()),
            began: since_boot(),
        })
    }

    /// The daemon's own monotonic clock: the machine's since its start, so that a time that stands in
    /// the journal means the same to the next run. It goes on while the machine sleeps: a name that was
    /// said in the evening is not the next morning's.
    pub fn now(&self) -> Duration {
        since_boot()
    }

    /// How long the station has been running.
    pub fn running(&self) -> Duration {
        self.now().saturating_sub(self.began)
    }

    /// The store of this name in the journal, if the configuration has it.
    pub fn store(&self, name: &str) -> Option<&RecordStore> {
        self.stores.iter().find(|store| store.name() == name)
    }

    /// Whether `size_bytes` may be taken in now; notes it on the board. Blocks.
    pub fn intake_gate(&self, size_bytes: u64) -> IntakeState {
        self.gate.judge(size_bytes, self.is_paused(), &self.board)
    }

    /// Whether a person has paused the station.
    pub fn is_paused(&self) -> bool {
        self.paused.load(Ordering::Relaxed)
    }

    /// Notes that a person has paused or resumed the station.
    pub fn set_paused(&self, paused: bool) {
        self.paused.store(paused, Ordering::Relaxed);
    }

    /// Requests that the deliveries of a scan are tried now.
    pub fn retry_now(&self, scan: &ScanId) {
        self.to_retry_now.lock().unwrap_or_else(PoisonError::into_inner).push(scan.clone());
    }

    /// The scans that are to be tried now, told once.
    pub fn to_retry_now(&self) -> Vec<ScanId> {
        std::mem::take(&mut *self.to_retry_now.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Requests a rebuild of the journal if the error means corruption, and a check if it leaves that
    /// open.
    pub fn check_corruption(&self, error: &(dyn std::error::Error + 'static)) {
        if rebuild::is_ruin(error) {
            self.ruin.notify_one();
        } else if rebuild::is_suspicious(error) {
            self.suspicion.tell(chain(error));
        }
    }

    /// Sets the journal aside, whose ruin has shown in its use: opened again it may look sound.
    ///
    /// # Errors
    /// Where its files cannot be renamed.
    pub fn give_up_journal(&self) -> Result<(), StationError> {
        rebuild::give_up(&journal_file(&self.config), self.custody.journal())
    }

    /// The text of an error that was checked_text.
    fn checked_text(&self, error: &(dyn std::error::Error + 'static)) -> String {
        self.check_corruption(error);
        chain(error)
    }

    /// Whether a store is in reach. One that a rebuilt journal has not searched yet is searched
    /// first, for what it holds must not be delivered again. Blocks.
    pub fn ask_store(&self, name: &str) -> bool {
        let Some(store) = self.store(name) else {
            self.note_store(name, Some("the configuration does not name it any more".to_owned()));
            return false;
        };
        let reached = self.begin_store(store).and_then(|()| {
            store.reach().and_then(|()| self.make_ready(store)).map_err(|fault| of_store(&fault))
        });
        let asked = reached.and_then(|()| {
            let to_be_searched = self.custody.journal().is_to_be_searched(name);
            if !to_be_searched.map_err(|error| self.checked_text(&error))? {
                return Ok(());
            }
            rebuild::search(&self.custody, store).map_err(|fault| self.checked_text(&fault))
        });
        let in_reach = asked.is_ok();
        self.note_store(name, asked.err());
        in_reach
    }

    /// Begins a store that the journal does not know at its place; one that it knows must be found
    /// marked, lest the empty place of a share be taken for it.
    fn begin_store(&self, store: &RecordStore) -> Result<(), String> {
        let (journal, place) = (self.custody.journal(), store.place());
        let of_journal = |error: JournalError| self.checked_text(&error);
        let begun = journal.begun_at(store.name()).map_err(of_journal)?;
        if begun.as_ref() == Some(&place) {
            return Ok(());
        }
        // Made only where this station never had the store: elsewhere a missing folder is a share.
        store.begin(begun.is_none()).map_err(|fault| of_store(&fault))?;
        journal.begun(store.name(), &place).map_err(of_journal)
    }

    /// Clears what a crash left half made in a store, once.
    fn make_ready(&self, store: &RecordStore) -> Result<(), StoreFault> {
        let ready = || self.ready_stores.lock().unwrap_or_else(PoisonError::into_inner);
        if !ready().contains(store.name()) {
            store.open()?;
            ready().insert(store.name().to_owned());
        }
        Ok(())
    }

    /// Notes how a store is; no fault is well. A change is told.
    pub fn note_store(&self, name: &str, fault: Option<String>) {
        let Some(store) = self.store(name).map(RecordStore::name) else { return };
        let mut before = None;
        self.board.note(|facts| {
            let known = facts.stores.get(store);
            before = known.and_then(|known| known.fault.clone());
            if known.is_none_or(|known| known.fault.is_some() != fault.is_some()) {
                let since = Timestamp::now();
                facts.stores.insert(store, StoreFacts { fault: fault.clone(), since });
            } else if let Some(known) = facts.stores.get_mut(store) {
                known.fault.clone_from(&fault);
            }
        });
        match (before, fault) {
            (None, Some(fault)) => warn!(event = "store-unavailable", store, fault),
            (Some(_), None) => info!(event = "store-in-reach", store),
            _ => {}
        }
    }

    /// Notes that a step at a store does not come back; says whether that is new.
    pub fn note_stalled(&self, name: &str) -> bool {
        const STALLED: &str = "it does not answer";
        let mut known = false;
        self.board.note(|facts| {
            let fault = facts.stores.get(name).and_then(|facts| facts.fault.as_deref());
            known = fault == Some(STALLED);
        });
        if known {
            return false;
        }
        self.note_store(name, Some(STALLED.to_owned()));
        true
    }
}

/// The machine's clock since its start, its sleeps included.
fn since_boot() -> Duration {
    let time = clock_gettime(ClockId::Boottime);
    let nanoseconds = u32::try_from(time.tv_nsec).unwrap_or(0);
    Duration::new(time.tv_sec.unsigned_abs(), nanoseconds)
}

/// What people decided about some scans cannot be read any more.
fn unreadable_decisions(count: usize) -> Alarm {
    let message = format!(
        "what was decided about {} cannot be read: where the journal is lost, too, a record may lie \
         where it was taken back from",
        counted(count, "scan")
    );
    Alarm { message, since: Timestamp::now() }
}

fn journal_file(config: &Config) -> PathBuf {
    config.station.state_dir.join("journal.db")
}

/// The stores of a configuration, each with its name in the journal.
fn stores(config: &Config) -> Vec<RecordStore> {
    let station = &config.station.id;
    let first = FolderStore::new("folder", config.store.folder.path.clone(), station);
    let copy = config.store.copy.as_ref();
    let copy = copy.map(|copy| FolderStore::new("copy", copy.path.clone(), station));
    let folders = [Some(first), copy].into_iter().flatten().map(RecordStore::Folder);
    folders.chain(config.store.gdt.as_ref().map(|gdt| gdt_store(config, gdt))).collect()
}

/// The store of practice software.
fn gdt_store(config: &Config, gdt: &GdtStoreConfig) -> RecordStore {
    let attach = Attach {
        files: gdt.attach.clone(),
        folder: gdt.attach_folder.clone(),
        reference: gdt.attach_as,
        root: gdt.attach_root.clone(),
    };
    let rules = (gdt.rules.clone(), attach);
    let station = (config.station.id.as_str(), config.station.state_dir.clone());
    let zone = if gdt.utc { TimeZone::UTC } else { TimeZone::system() };
    let names = gdt.file_name.clone();
    let store = GdtStore::new(gdt.path.clone(), names, rules, station, zone);
    RecordStore::Gdt(Box::new(store))
}

/// A store's fault without its path.
fn of_store(fault: &StoreFault) -> String {
    match fault {
        StoreFault::Transient { what, source, .. } => format!("{what} failed: {source}"),
        StoreFault::NotFetched => fault.to_string(),
        StoreFault::Permanent(misfit) => misfit.to_string(),
    }
}
