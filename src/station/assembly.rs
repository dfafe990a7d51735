//! What the workers of one station share, put together at the start.

use std::path::Path;
use std::time::{Duration, Instant};

use jiff::Timestamp;
use tokio::sync::Notify;
use tracing::{info, warn};

use super::board::Board;
use super::custody::Custody;
use super::error::{StationError, chain};
use super::event::Observer;
use super::gate::Gate;
use super::journal::{Journal, StateLock};
use super::quarantine::Quarantine;
use super::spool::Spool;
use crate::config::Config;
use crate::flow::{Facts, Identity};
use crate::store::{FolderStore, RecordStore, durable};

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
    pub store: RecordStore,
    /// What the workers know, for those who ask.
    pub board: Board,
    /// Whether scans are taken in.
    pub gate: Gate,
    /// Who looks on.
    pub observer: Observer,
    /// Tells the delivery that the journal has something new; a hint only.
    pub work: Notify,
    started: Instant,
    _lock: StateLock,
}

impl Station {
    /// Takes the state folder for this process and takes up what the last run left.
    ///
    /// # Errors
    /// See [`StationError`].
    pub fn open(config: Config, observer: Observer) -> Result<Station, StationError> {
        let identity = Identity::new(config.scanner.file_name.clone(), &config.patient.pattern)?;
        let state_dir = &config.station.state_dir;
        let state = |source| StationError::State { path: state_dir.clone(), source };
        make_state_dir(state_dir).map_err(state)?;
        let lock = StateLock::take(state_dir)?;

        let path = state_dir.join("journal.db");
        let first_start = !path.exists();
        let journal = Journal::open(&path)
            .map_err(|source| StationError::Journal { path: path.clone(), source })?;
        let spool = Spool::open(state_dir).map_err(state)?;
        let quarantine = Quarantine::open(state_dir).map_err(state)?;

        let folder = config.store.folder.path.clone();
        let store = FolderStore::new(folder, &config.station.id);
        if first_start && let Err(fault) = store.make_root() {
            warn!(event = "store-unavailable", error = chain(&fault));
        }
        let store = RecordStore::Folder(store);
        let custody = Custody::new(journal, spool, quarantine, store.name());
        let adopted = custody.recover().map_err(StationError::Recovery)?;
        if let Err(fault) = store.open() {
            // Deliveries will meet the same fault and be put off.
            warn!(event = "store-unavailable", code = fault.code());
        }
        info!(event = "station-open", adopted, first_start);
        let gate = Gate::new(config.station.disk_floor_bytes);
        let board = Board::new(Facts::new(Timestamp::now(), config.scanner.export_dirs.len()));
        Ok(Station {
            config,
            identity,
            custody,
            store,
            board,
            gate,
            observer,
            work: Notify::new(),
            started: Instant::now(),
            _lock: lock,
        })
    }

    /// The daemon's own monotonic clock.
    pub fn now(&self) -> Duration {
        self.started.elapsed()
    }
}

fn make_state_dir(path: &Path) -> std::io::Result<()> {
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent)?;
    }
    durable::make_folder_once(path)
}
