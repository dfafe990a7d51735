//! Previews: what a held scan shows of its legs before an operator has decided whose it is.
//!
//! `STATE/previews/<sha256>/` holds the files of a record that the operator's page shows, measured
//! without a patient. It is a cache. It is emptied at each start, so everything in it comes from this
//! program and this configuration and was never truncated by a power cut. A missing preview is made
//! again. A preview is removed as soon as its scan is no longer held.

mod shelf;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use gaiter_flow::ScanId;
use gaiter_flow::facts::IntakeState;
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;
use tracing::{info, warn};

use super::measuring::{self, MeasureOutcome};
use crate::station::booth::Booth;
use crate::station::core::Core;
use crate::station::event::short;
use crate::station::journal::{JournalError, ScanRow};
use crate::station::runtime::{Heartbeat, Stop, chain};
pub use shelf::{Preview, Previews};

/// The largest number of previews kept, of the scans held last; the page shows fewer.
const MOST: u32 = 50;

/// How often to check the journal for changes: a decision ends a preview.
const LOOK: Duration = Duration::from_secs(1);

/// How often to look even without a change: a folder may be missing, or a store may be in reach again.
const RECHECK: Duration = Duration::from_secs(5);

/// How long to wait before a failed preview is tried again.
const AGAIN: Duration = Duration::from_secs(60);

/// The number of threads that measure a preview: nobody at the booth waits for it.
const THREADS: usize = 1;

/// The worker's state from one look to the next.
#[derive(Debug)]
struct Round {
    booth: Arc<Booth>,
    previews: Arc<Previews>,
    /// The journal's change count at the last look that left nothing to do.
    edition: Option<i64>,
    /// The time of the next look, even without a change.
    next: Duration,
    trials: BTreeMap<ScanId, Trial>,
    /// The last fault of the folder, logged once.
    reported: Option<String>,
}

/// A preview that could not be made.
#[derive(Debug, Default, Clone, Copy)]
struct Trial {
    crashes: u32,
    again: Duration,
}

/// Makes previews one at a time, after everything that is to be delivered, until asked to stop. The
/// current preview is finished.
///
/// # Errors
/// If a step panicked.
pub async fn worker(
    booth: Arc<Booth>,
    previews: Arc<Previews>,
    beat: Heartbeat,
    mut stop: Stop,
) -> Result<(), JoinError> {
    let (trials, next) = (BTreeMap::new(), Duration::ZERO);
    let mut round = Round { booth, previews, edition: None, next, trials, reported: None };
    while !stop.is_requested() {
        let step = spawn_blocking(move || {
            let has_made = round.step();
            (round, has_made)
        });
        let (back, has_made) = beat.during(step).await?;
        round = back;
        if has_made {
            continue;
        }
        tokio::select! {
            () = stop.requested() => break,
            () = sleep(LOOK) => {}
        }
    }
    Ok(())
}

impl Round {
    fn core(&self) -> &Core {
        self.booth.core()
    }

    /// Looks if there may be something to do. Returns whether a scan was measured; then more may be
    /// waiting.
    fn step(&mut self) -> bool {
        let (edition, now) = (self.core().custody.journal().edition(), self.core().now());
        if self.edition == edition && now < self.next {
            return false;
        }
        let looked = self.look();
        let has_made = self.core().logged(looked).unwrap_or(false);
        if !has_made {
            (self.edition, self.next) = (edition, now + RECHECK);
        }
        has_made
    }

    fn look(&mut self) -> Result<bool, JournalError> {
        let core = Arc::clone(self.booth.core());
        let journal = core.custody.journal();
        let held = journal.held(MOST)?;
        let kept = self.previews.keep_only(&held).map_err(|error| error.to_string());
        self.report(kept.err());
        self.trials.retain(|scan, _| held.contains(scan));
        let now = core.now();
        let is_due = |scan: &&ScanId| {
            let waits = self.trials.get(*scan).is_some_and(|trial| now < trial.again);
            !waits && !self.previews.has(scan) && core.custody.spool().holds(scan)
        };
        let Some(scan) = held.iter().find(is_due) else { return Ok(false) };
        if core.board.facts().intake != IntakeState::Open || something_is_due(&core)? {
            return Ok(false);
        }
        let Some(row) = journal.scan(scan)? else { return Ok(false) };
        self.make(&row);
        Ok(true)
    }

    /// Measures a held scan without a patient. Keeps what it shows, or why it cannot be measured.
    fn make(&mut self, row: &ScanRow) {
        let scan = short(&row.scan);
        let (booth, trials) = (Arc::clone(&self.booth), &mut self.trials);
        let count_try = || {
            let trial = trials.entry(row.scan.clone()).or_default();
            trial.crashes += 1;
            Ok(trial.crashes)
        };
        let outcome = match measuring::measured(booth.core(), row, None, THREADS, count_try) {
            Ok(outcome) => outcome,
            Err(error) => return self.put_off(row, &chain(&error)),
        };
        let code = match outcome {
            MeasureOutcome::Files { files, .. } => {
                return match self.previews.keep(&row.scan, &files) {
                    Ok(()) => {
                        info!(event = "preview-made", scan);
                        booth.core().logged(booth.scan_measured(&row.scan));
                    }
                    Err(error) => self.put_off(row, &error.to_string()),
                };
            }
            MeasureOutcome::Refused { code, .. } => code,
            MeasureOutcome::Lost => return self.put_off(row, "its bytes are not in the spool"),
            MeasureOutcome::Waits { error, .. } => return self.put_off(row, &error),
        };
        info!(event = "preview-impossible", scan, code);
        self.previews.note(&row.scan, Preview::Impossible(code));
        // Another export of the same scan is expected.
        booth.core().logged(booth.reopen_capture(&row.scan));
    }

    fn put_off(&mut self, row: &ScanRow, error: &str) {
        warn!(event = "preview-failed", scan = short(&row.scan), error);
        let again = self.core().now() + AGAIN;
        self.trials.entry(row.scan.clone()).or_default().again = again;
    }

    /// Logs a fault of the folder once.
    fn report(&mut self, fault: Option<String>) {
        if let Some(error) = fault.as_ref().filter(|fault| self.reported.as_ref() != Some(fault)) {
            warn!(event = "preview-failed", error);
        }
        self.reported = fault;
    }
}

/// Whether a record waits for delivery to, or withdrawal from, a store that is in reach.
fn something_is_due(core: &Core) -> Result<bool, JournalError> {
    let pending = core.custody.journal().pending()?;
    let facts = core.board.facts();
    let is_in_reach = |store: &str| {
        let refusal = facts.stores.get(store).and_then(|facts| facts.refusal.as_ref());
        core.stores.named(store).is_some() && refusal.is_none()
    };
    Ok(pending.iter().any(|due| is_in_reach(&due.store)))
}
