//! Deletes what is past its retention, once an hour, but nothing that is still to be delivered; and soon after,
//! what could not be removed when it was due. It also lets erasures that waited for servers continue, reports the
//! station's state to the service manager and checks the journal after errors.

use std::sync::Arc;
use std::time::Duration;

use gaiter_flow::cause::Cause;
use gaiter_flow::complaint::ComplaintFigures;
use gaiter_flow::retention::{WallClock, before};
use jiff::Timestamp;
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;
use tracing::{error, info, warn};

use super::core::Core;
use super::custody::CustodyFault;
use super::overview::Overview;
use super::persons::erase;
use super::runtime::{Heartbeat, Stop, chain};
use super::service::{notify_status, status_line};

/// Interval between deletions.
const ROUND: Duration = Duration::from_secs(3600);

/// Interval at which the service manager gets the station's state, if it has changed.
const STATUS: Duration = Duration::from_secs(30);

/// Interval of the worker's heartbeat and of its looks at the wall clock.
const HEARTBEAT_INTERVAL: Duration = Duration::from_secs(1);

/// Least time between checks of the journal: each reads the whole journal.
const CHECK_PAUSE: Duration = Duration::from_secs(60);

/// Alarm: an intact journal refuses a statement of the station.
const REFUSES: &str = "journal-refuses";

/// Deletes what is past its retention until asked to stop.
///
/// # Errors
/// If a round panicked.
pub async fn worker(core: Arc<Core>, beat: Heartbeat, mut stop: Stop) -> Result<(), JoinError> {
    let mut next = core.now();
    let (mut next_status, mut last_status) = (core.now(), String::new());
    let (mut next_check, mut wall_clock) = (Duration::ZERO, WallClock::default());
    while !stop.is_requested() {
        beat.beat();
        let round_is_due = core.now() >= next;
        if round_is_due {
            next = core.now() + ROUND;
        }
        let by_age = wall_clock.is_steady(Timestamp::now(), core.now());
        let round = Arc::clone(&core);
        let kept = spawn_blocking(move || keep(&round, round_is_due, by_age));
        if let Err(fault) = kept.await? {
            core.check_corruption(&fault);
            warn!(event = "housekeeping-failed", error = chain(&fault));
        }
        if core.now() >= next_status {
            next_status = core.now() + STATUS;
            let core = Arc::clone(&core);
            let line = spawn_blocking(move || status_line(&Overview::take(&core))).await?;
            if line != last_status {
                notify_status(&line);
                last_status = line;
            }
        }
        tokio::select! {
            () = stop.requested() => break,
            () = sleep(HEARTBEAT_INTERVAL) => {}
            () = core.suspicion.raised(), if core.now() >= next_check => {
                next_check = core.now() + CHECK_PAUSE;
                let core = Arc::clone(&core);
                spawn_blocking(move || check_journal(&core)).await?;
            }
        }
    }
    Ok(())
}

fn keep(core: &Core, round_is_due: bool, by_age: bool) -> Result<(), CustodyFault> {
    let tidied = core.custody.tidy();
    erase::go_on(core)?;
    tidied?;
    if round_is_due { let_go(core, by_age) } else { Ok(()) }
}

/// Deletes what is past its retention; without `by_age` only what is not kept at all.
fn let_go(core: &Core, by_age: bool) -> Result<(), CustodyFault> {
    let (custody, kept) = (&core.custody, core.config.retention);
    let mut gone = [0; 3];
    let now = Timestamp::now();
    let before = |kept: Option<Duration>| before(kept.filter(|kept| by_age || kept.is_zero()), now);
    if let Some(before) = before(Some(kept.spool)) {
        gone[0] = custody.let_go_spooled(before)?;
    }
    if let Some(before) = before(kept.quarantine) {
        gone[1] = custody.let_go_quarantined(before)?;
    }
    if let Some(before) = before(kept.journal) {
        gone[2] = custody.forget(before)?;
    }
    if gone != [0; 3] {
        let [spooled, quarantined, scans] = gone;
        info!(event = "let-go", spooled, quarantined, scans);
    }
    Ok(())
}

/// Checks the journal after an error that may or may not mean damage. Blocks.
fn check_journal(core: &Core) {
    let Some(why) = core.suspicion.taken() else { return };
    match core.custody.journal().check() {
        Ok(()) => {
            error!(event = "journal-refuses", error = why);
            core.board.raise(REFUSES, ComplaintFigures::why(&Cause::verbatim(why)));
        }
        Err(fault) => {
            warn!(event = "journal-failed", error = chain(&fault));
            if fault.is_ruin() {
                core.ruin.notify_one();
            }
        }
    }
}
