//! What all workers of a station share: configuration, custody, stores, board, clock. It does not depend
//! on workers, booth or page.

use std::path::PathBuf;
use std::sync::Mutex;
use std::time::Duration;

use gaiter_flow::cause::Cause;
use gaiter_flow::facts::IntakeState;
use gaiter_flow::phantom::is_phantom;
use gaiter_flow::{Identity, ScanId, Space};
use tokio::sync::Notify;
use tracing::{info, warn};

use super::board::Board;
use super::custody::Custody;
use super::event::Observer;
use super::journal::JournalError;
use super::journal::integrity::Suspicion;
use super::runtime::{Clock, chain, locked};
use super::share::file_system;
use super::stores::Stores;
use crate::config::{Config, PhantomConfig};

/// What the workers of a station share.
#[derive(Debug)]
pub struct Core {
    pub config: Config,
    /// The rules for patients' ids.
    pub identity: Identity,
    /// Spool, journal and quarantine.
    pub custody: Custody,
    /// Where records go.
    pub stores: Stores,
    /// What the workers know, for others to read.
    pub board: Board,
    /// Receives the station's events.
    pub observer: Observer,
    /// Notifies the delivery that the journal has something new; only a hint.
    pub work: Notify,
    /// Requests a rebuild of the journal.
    pub ruin: Notify,
    /// Requests a new generation of workers with the same configuration.
    pub anew: Notify,
    /// Errors that may or may not mean that the journal is damaged.
    pub suspicion: Suspicion,
    pub clock: Clock,
    space: Mutex<Space>,
    to_retry_now: Mutex<Vec<ScanId>>,
}

impl Core {
    /// The core of a station that starts now, with what the last run left and the board of what is known so far.
    pub fn new(
        config: Config,
        identity: Identity,
        custody: Custody,
        stores: Stores,
        board: Board,
        observer: Observer,
    ) -> Core {
        let space = Mutex::new(Space::new(config.station.disk_floor_bytes));
        Core {
            config,
            identity,
            custody,
            stores,
            board,
            observer,
            work: Notify::new(),
            ruin: Notify::new(),
            anew: Notify::new(),
            suspicion: Suspicion::default(),
            clock: Clock::start(),
            space,
            to_retry_now: Mutex::default(),
        }
    }

    /// The current time of the station's own clock.
    pub fn now(&self) -> Duration {
        self.clock.now()
    }

    /// The phantom, if an export with this name is a scan of it.
    pub fn phantom_of(&self, file_name: &str) -> Option<&PhantomConfig> {
        self.config.phantom.as_ref().filter(|phantom| is_phantom(file_name, &phantom.name))
    }

    /// Decides whether `size_bytes` may be taken in now, and notes it on the board. What is not admitted
    /// stays where it is and is tried again. Blocks.
    pub fn intake_gate(&self, size_bytes: u64) -> IntakeState {
        // A disk that cannot be queried reports its fault elsewhere.
        let free = file_system::free_bytes(&self.config.station.state_dir).unwrap_or(u64::MAX);
        let mut space = locked(&self.space);
        let has_room = space.admits(free, size_bytes);
        let (before, state) = self.board.note(|facts| {
            let before = facts.intake;
            facts.intake = match before {
                IntakeState::Paused => IntakeState::Paused,
                _ if has_room => IntakeState::Open,
                _ => IntakeState::DiskLow { free, floor: space.floor_bytes() },
            };
            (before, facts.intake)
        });
        match (before, state) {
            (IntakeState::DiskLow { .. }, IntakeState::DiskLow { .. }) => {}
            (_, IntakeState::DiskLow { free, floor }) => {
                warn!(event = "disk-low", free_bytes = free, floor_bytes = floor);
            }
            (IntakeState::DiskLow { .. }, _) => info!(event = "disk-free-again", free_bytes = free),
            _ => {}
        }
        state
    }

    /// Whether an operator has paused the station.
    pub fn is_paused(&self) -> bool {
        self.board.note(|facts| facts.intake == IntakeState::Paused)
    }

    /// Notes that an operator has paused or resumed the station, and what is taken in from now on. Blocks.
    pub fn set_paused(&self, paused: bool) {
        let state = if paused { IntakeState::Paused } else { IntakeState::Open };
        self.board.note(|facts| facts.intake = state);
        self.intake_gate(0);
    }

    /// Requests that the deliveries of a scan are tried now.
    pub fn retry_now(&self, scan: &ScanId) {
        locked(&self.to_retry_now).push(scan.clone());
    }

    /// Takes the scans that are to be tried now.
    pub fn to_retry_now(&self) -> Vec<ScanId> {
        std::mem::take(&mut *locked(&self.to_retry_now))
    }

    /// Requests a rebuild of the journal if the error means corruption, and a check if it leaves that
    /// open.
    pub fn check_corruption(&self, error: &(dyn std::error::Error + 'static)) {
        match JournalError::among_causes(error) {
            Some(fault) if fault.is_ruin() => self.ruin.notify_one(),
            Some(fault) if fault.is_suspicious() => self.suspicion.raise(chain(error)),
            _ => {}
        }
    }

    /// What was read in the journal for somebody who sees that it fails; `None` then. That is checked for corruption.
    pub fn read<T>(&self, given: Result<T, JournalError>) -> Option<T> {
        given.inspect_err(|error| self.check_corruption(error)).ok()
    }

    /// What the journal gave; `None` if it failed. That is logged, and checked for corruption.
    pub fn logged<T>(&self, given: Result<T, JournalError>) -> Option<T> {
        let failed = |error: &JournalError| {
            self.check_corruption(error);
            warn!(event = "journal-failed", error = chain(error));
        };
        given.inspect_err(failed).ok()
    }

    /// Checks an error for corruption, and returns it with its causes, in English.
    pub fn checked(&self, error: &(dyn std::error::Error + 'static)) -> Cause {
        self.check_corruption(error);
        chain(error).into()
    }
}

/// The path of the journal for this configuration.
pub fn journal_file(config: &Config) -> PathBuf {
    config.station.state_dir.join("journal.db")
}
