//! The intake of one export folder: look, settle, take, over and over.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::{Notify, mpsc};
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;
use tracing::{info, warn};

use super::assembly::Station;
use super::beat::Beat;
use super::chance;
use super::error::chain;
use super::look::{self, Found};
use super::stop::Stop;
use super::take::{Taken, take};
use super::watch::Watch;
use crate::flow::{Look, LookTime, Settled, Settling};

/// The shortest time from one look to the next, however many hints there are.
const BREATH: Duration = Duration::from_millis(100);

/// A look at a large folder takes long; this many times as long is rested after it.
const REST_PER_LOOK: u32 = 10;

/// One export folder and what is known of its files.
struct Intake {
    station: Arc<Station>,
    folder: PathBuf,
    /// The folder's place in the configuration: what the log calls it.
    place: usize,
    settling: Settling,
    said: Said,
}

/// What the log has been told, so that it is told changes only.
#[derive(Default)]
struct Said {
    out_of_reach: bool,
    unwatched: bool,
    strange: usize,
}

/// Works one export folder until it is asked to stop. After the first look, in reach or not, it
/// says so on `looked`.
///
/// # Errors
/// Where a step of its own panicked.
pub async fn worker(
    station: Arc<Station>,
    place: usize,
    folder: PathBuf,
    beat: Beat,
    mut stop: Stop,
    looked: mpsc::Sender<()>,
) -> Result<(), JoinError> {
    let scanner = &station.config.scanner;
    let (rescan, settling) = (scanner.rescan, Settling::new(scanner.quiet, scanner.short_wait));
    let hint = Arc::new(Notify::new());
    let mut watch = Watch::new(folder.clone(), Arc::clone(&hint));
    let mut looked = Some(looked);
    let said = Said::default();
    let station_clock = Arc::clone(&station);
    let mut intake = Intake { station, folder, place, settling, said };
    while !stop.is_requested() {
        beat.beat(station_clock.now());
        let took;
        (watch, took) = intake.look_and_take(watch, &mut stop).await?;
        if let Some(looked) = looked.take() {
            // Nobody listens any more where readiness did not wait for a folder out of reach.
            let _ = looked.send(()).await;
        }
        let breath = BREATH.max(took * REST_PER_LOOK).min(rescan);
        let due = intake.settling.next_due().map(|at| at.saturating_sub(intake.station.now()));
        let pause = due.map_or(rescan, |due| due.min(rescan)).saturating_sub(breath);
        tokio::select! {
            () = stop.requested() => break,
            () = sleep(breath) => {}
        }
        tokio::select! {
            () = stop.requested() => break,
            () = hint.notified() => {}
            () = sleep(pause) => {}
        }
    }
    Ok(())
}

impl Intake {
    /// One look, and all that has settled by it; returns how long the look itself took.
    async fn look_and_take(
        &mut self,
        mut watch: Watch,
        stop: &mut Stop,
    ) -> Result<(Watch, Duration), JoinError> {
        let (station, folder) = (Arc::clone(&self.station), self.folder.clone());
        let (watch, armed, found, when) = spawn_blocking(move || {
            let armed = watch.keep_armed();
            let began = station.now();
            let found = look::look(&folder);
            (watch, armed, found, LookTime { began, ended: station.now() })
        })
        .await?;
        self.say_watched(armed);
        let look = self.say_found(found);
        for settled in self.settling.observe(look, when) {
            if stop.is_requested() {
                break;
            }
            self.take(settled).await?;
        }
        Ok((watch, when.ended.saturating_sub(when.began)))
    }

    async fn take(&mut self, settled: Settled) -> Result<(), JoinError> {
        let station = Arc::clone(&self.station);
        let (settled, taken) = spawn_blocking(move || {
            let taken = take(&station, &settled);
            (settled, taken)
        })
        .await?;
        match taken {
            Ok(Taken::Done) => self.settling.taken(&settled),
            Ok(Taken::CutShort) => self.settling.cut_short(&settled),
            Ok(Taken::Changed) => self.settling.changed(&settled, self.station.now()),
            Err(fault) => {
                warn!(event = "intake-failed", export_dir = self.place, error = chain(&fault));
                self.settling.failed(&settled, self.station.now(), chance::unit());
            }
        }
        Ok(())
    }

    fn say_found(&mut self, found: std::io::Result<Found>) -> Look {
        let place = self.place;
        let found = match found {
            Ok(found) => found,
            Err(error) => {
                if !std::mem::replace(&mut self.said.out_of_reach, true) {
                    warn!(event = "export-dir-out-of-reach", export_dir = place, %error);
                }
                return Look::OutOfReach;
            }
        };
        if std::mem::replace(&mut self.said.out_of_reach, false) {
            info!(event = "export-dir-in-reach", export_dir = place);
        }
        if found.strange > self.said.strange {
            info!(event = "files-ignored", export_dir = place, count = found.strange);
        }
        self.said.strange = found.strange;
        Look::Seen(found.files)
    }

    fn say_watched(&mut self, armed: notify::Result<()>) {
        match armed {
            Ok(()) => self.said.unwatched = false,
            // The kind only: notify's errors name the path.
            Err(error) => {
                if !std::mem::replace(&mut self.said.unwatched, true) {
                    let (event, export_dir) = ("watch-unavailable", self.place);
                    info!(event, export_dir, error = ?error.kind);
                }
            }
        }
    }
}
