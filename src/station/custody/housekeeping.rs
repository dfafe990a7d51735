//! Letting go what the configuration lets go, once an hour: nothing that is still to be delivered;
//! and soon, what was to go and could not. It tells the service manager how the station is as well, and
//! looks into errors of the journal.

use std::sync::Arc;
use std::time::Duration;

use jiff::Timestamp;
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;
use tracing::{info, warn};

use super::CustodyFault;
use super::wall_clock::Timekeeper;
use crate::flow::retention::before;
use crate::station::assembly::Station;
use crate::station::beat::Beat;
use crate::station::error::chain;
use crate::station::journal::integrity::suspicion;
use crate::station::operator::overview::Overview;
use crate::station::service::{status_line, tell_status};
use crate::station::stop::Stop;

/// How often it is looked what may go.
const ROUND: Duration = Duration::from_secs(3600);

/// How often the service manager is told how the station is, where that has changed.
const STATUS: Duration = Duration::from_secs(30);

/// How often the worker shows that it turns, and looks at the clock on the wall.
const BREATH: Duration = Duration::from_secs(1);

/// Lets go what may go until it is asked to stop.
///
/// # Errors
/// Where a round panicked.
pub async fn worker(station: Arc<Station>, beat: Beat, mut stop: Stop) -> Result<(), JoinError> {
    let mut next = station.now();
    let (mut next_status, mut said) = (station.now(), String::new());
    let (mut next_check, mut timekeeper) = (Duration::ZERO, Timekeeper::default());
    while !stop.is_requested() {
        beat.beat();
        let round_is_due = station.now() >= next;
        if round_is_due {
            next = station.now() + ROUND;
        }
        let round = Arc::clone(&station);
        let kept = spawn_blocking(move || {
            let kept = keep(&round, &mut timekeeper, round_is_due);
            (kept, timekeeper)
        });
        let (kept, told) = kept.await?;
        timekeeper = told;
        if let Err(fault) = kept {
            station.check_corruption(&fault);
            warn!(event = "housekeeping-failed", error = chain(&fault));
        }
        if station.now() >= next_status {
            next_status = station.now() + STATUS;
            let station = Arc::clone(&station);
            let line = spawn_blocking(move || status_line(&Overview::take(&station))).await?;
            if line != said {
                tell_status(&line);
                said = line;
            }
        }
        tokio::select! {
            () = stop.requested() => break,
            () = sleep(BREATH) => {}
            () = station.suspicion.told(), if station.now() >= next_check => {
                next_check = station.now() + suspicion::PAUSE;
                let station = Arc::clone(&station);
                spawn_blocking(move || suspicion::look_into(&station)).await?;
            }
        }
    }
    Ok(())
}

fn keep(
    station: &Station,
    timekeeper: &mut Timekeeper,
    round_is_due: bool,
) -> Result<(), CustodyFault> {
    let now = timekeeper.look(station, round_is_due)?;
    station.custody.tidy()?;
    if round_is_due { let_go(station, now) } else { Ok(()) }
}

/// Lets go what may go by this time.
fn let_go(station: &Station, now: Timestamp) -> Result<(), CustodyFault> {
    let (custody, kept) = (&station.custody, station.config.retention);
    let mut gone = [0; 3];
    // What is not kept at all does not grow old.
    let spool_now = if kept.spool.is_zero() { Timestamp::now() } else { now };
    if let Some(before) = before(Some(kept.spool), spool_now) {
        gone[0] = custody.let_go_spooled(before)?;
    }
    if let Some(before) = before(kept.quarantine, now) {
        gone[1] = custody.let_go_quarantined(before)?;
    }
    if let Some(before) = before(kept.journal, now) {
        gone[2] = custody.forget(before)?;
    }
    if gone != [0; 3] {
        let [spooled, quarantined, scans] = gone;
        info!(event = "let-go", spooled, quarantined, scans);
    }
    Ok(())
}
