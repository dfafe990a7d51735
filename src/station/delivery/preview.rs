//! Previews: what a held scan shows of its legs before a person has said whose it is.
//!
//! `STATE/previews/<sha256>/` holds those files of a record that the operator's page shows, measured
//! for nobody. It is a cache: empty at each start, so that what lies there is by this program and this
//! configuration and was never cut short by a power cut; made again where it is missing; gone as soon
//! as the scan is held no more.

mod shelf;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use tokio::task::{JoinError, JoinHandle, spawn_blocking};
use tokio::time::sleep;
use tracing::{info, warn};

use super::measuring::{self, Outcome};
use crate::flow::ScanId;
use crate::flow::facts::IntakeState;
use crate::station::assembly::Station;
use crate::station::beat::Beat;
use crate::station::error::chain;
use crate::station::event::short;
use crate::station::journal::{JournalError, ScanRow};
use crate::station::stop::Stop;
pub use shelf::{Preview, Previews};

/// At most so many previews are kept, of the scans held last; the page shows fewer.
const MOST: u32 = 50;

/// How often it is looked whether the journal has changed: a decision is seen to end a preview.
const LOOK: Duration = Duration::from_secs(1);

/// How often it is looked all the same: a folder may be missing, a store be in reach again.
const RECHECK: Duration = Duration::from_secs(5);

/// How long a preview that could not be made is left alone.
const AGAIN: Duration = Duration::from_secs(60);

/// How often the worker shows that it turns while a scan is measured.
const BREATH: Duration = Duration::from_secs(5);

/// On so many threads a preview is measured: nobody at the booth waits for it.
const THREADS: usize = 1;

/// What the worker knows from one look to the next.
#[derive(Debug, Default)]
struct Round {
    /// The journal's changes at the last look that left nothing to do.
    changes: Option<u64>,
    /// When it is looked in any case.
    next: Duration,
    trials: BTreeMap<ScanId, Trial>,
    /// The last fault of the folder, told once.
    said: Option<String>,
}

/// A preview that could not be made.
#[derive(Debug, Default, Clone, Copy)]
struct Trial {
    crashes: u32,
    again: Duration,
}

/// Makes previews one at a time, after everything that is to be delivered, until it is asked to stop;
/// the one in hand is finished.
///
/// # Errors
/// Where a step panicked.
pub async fn worker(station: Arc<Station>, beat: Beat, mut stop: Stop) -> Result<(), JoinError> {
    let mut round = Round::default();
    while !stop.is_requested() {
        let looked = Arc::clone(&station);
        let step = spawn_blocking(move || {
            let has_made = round.step(&looked);
            (round, has_made)
        });
        let (back, has_made) = with_beats(step, &beat).await?;
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

/// Awaits a step; the worker beats meanwhile, for a measurement may take its time.
async fn with_beats<T>(mut step: JoinHandle<T>, beat: &Beat) -> Result<T, JoinError> {
    loop {
        beat.beat();
        tokio::select! {
            done = &mut step => return done,
            () = sleep(BREATH) => {}
        }
    }
}

impl Round {
    /// Looks where there may be something to do; says whether a scan was measured, and more may be
    /// waiting.
    fn step(&mut self, station: &Station) -> bool {
        let (changes, now) = (station.custody.journal().changes(), station.now());
        if self.changes == Some(changes) && now < self.next {
            return false;
        }
        let looked = self.look(station);
        let looked = looked.inspect_err(|error| {
            station.check_corruption(error);
            warn!(event = "journal-failed", error = chain(error));
        });
        let has_made = looked.unwrap_or(false);
        if !has_made {
            (self.changes, self.next) = (Some(changes), now + RECHECK);
        }
        has_made
    }

    fn look(&mut self, station: &Station) -> Result<bool, JournalError> {
        let journal = station.custody.journal();
        let held = journal.held(MOST)?;
        let kept = station.previews.keep_only(&held).map_err(|error| error.to_string());
        self.tell(kept.err());
        self.trials.retain(|scan, _| held.contains(scan));
        let now = station.now();
        let is_due = |scan: &&ScanId| {
            let waits = self.trials.get(*scan).is_some_and(|trial| now < trial.again);
            !waits && !station.previews.has(scan) && station.custody.spool().holds(scan)
        };
        let Some(scan) = held.iter().find(is_due) else { return Ok(false) };
        if station.board.facts().intake != IntakeState::Open || something_is_due(station)? {
            return Ok(false);
        }
        let Some(row) = journal.scan(scan)? else { return Ok(false) };
        self.make(station, &row);
        Ok(true)
    }

    /// Measures a held scan for nobody and keeps what it shows, or why it cannot be measured.
    fn make(&mut self, station: &Station, row: &ScanRow) {
        let scan = short(&row.scan);
        let trials = &mut self.trials;
        let count_try = || {
            let trial = trials.entry(row.scan.clone()).or_default();
            trial.crashes += 1;
            Ok(trial.crashes)
        };
        let outcome = match measuring::measured(station, row, None, THREADS, count_try) {
            Ok(outcome) => outcome,
            Err(error) => return self.put_off(station, row, &chain(&error)),
        };
        let code = match outcome {
            Outcome::Files(files) => {
                return match station.previews.keep(&row.scan, &files) {
                    Ok(()) => {
                        info!(event = "preview-made", scan);
                        note(station, station.scan_measured(&row.scan));
                        station.page.refresh();
                    }
                    Err(error) => self.put_off(station, row, &error.to_string()),
                };
            }
            Outcome::Refused { code, .. } => code,
            Outcome::Lost => return self.put_off(station, row, "its bytes are not in the spool"),
            Outcome::Waits { error, .. } => return self.put_off(station, row, &error),
        };
        info!(event = "preview-impossible", scan, code);
        station.previews.cannot_be(&row.scan, code);
        // Another export of the same scan is to come.
        note(station, station.reopen_capture(&row.scan));
        station.page.refresh();
    }

    fn put_off(&mut self, station: &Station, row: &ScanRow, error: &str) {
        warn!(event = "preview-failed", scan = short(&row.scan), error);
        self.trials.entry(row.scan.clone()).or_default().again = station.now() + AGAIN;
    }

    /// Tells a fault of the folder once.
    fn tell(&mut self, fault: Option<String>) {
        if let Some(error) = fault.as_ref().filter(|fault| self.said.as_ref() != Some(fault)) {
            warn!(event = "preview-failed", error);
        }
        self.said = fault;
    }
}

/// The captures could not learn of a preview: it counts as not made for a while.
fn note(station: &Station, noted: Result<(), JournalError>) {
    if let Err(error) = noted {
        station.check_corruption(&error);
        warn!(event = "journal-failed", error = chain(&error));
    }
}

/// Whether a record is to be delivered to, or taken back from, a store that takes records.
fn something_is_due(station: &Station) -> Result<bool, JournalError> {
    let pending = station.custody.journal().pending()?;
    let facts = station.board.facts();
    let is_in_reach = |store: &str| {
        let fault = facts.stores.get(store).and_then(|facts| facts.fault.as_ref());
        station.store(store).is_some() && fault.is_none()
    };
    Ok(pending.iter().any(|due| is_in_reach(&due.store)))
}
