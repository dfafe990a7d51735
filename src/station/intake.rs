//! The intake of one export folder: look, settle, take, over and over.
//!
//! Whatever touches the folder runs in a thread that may hang (see `station::stall`); the worker
//! itself never blocks, so it stays able to stop, to beat and to say that the share stalls.

pub(in crate::station) mod admission;
pub(in crate::station) mod export_locks;
pub mod file_system;
pub(in crate::station) mod ingest;
mod memory;
mod notes;
pub(crate) mod scan_dir;
pub(in crate::station) mod stable_read;
pub(in crate::station) mod watch;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio::sync::{Notify, mpsc};
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;

use self::ingest::{Admitted, TakeFault, Taken};
use self::stable_read::Export;
use self::watch::Watch;
use super::assembly::Station;
use super::beat::Beat;
use super::jitter;
use super::stall::{DEADLINE, LOOK_UP, Pulse, patiently};
use super::stop::Stop;
use crate::flow::mount::MountGuard;
use crate::flow::settle::Memory;
use crate::flow::{Look, LookTime, Mark, Settled, Settling};
use notes::Notes;

/// The shortest time from one look to the next, however many hints there are.
const BREATH: Duration = Duration::from_millis(100);

/// A look at a large folder takes long; this many times as long is rested after it.
const REST_PER_LOOK: u32 = 10;

/// The same while a file is about to settle: the operator waits for it.
const REST_PER_LOOK_SETTLING: u32 = 2;

/// How long files are taken before the folder is looked at again: no fresh scan waits longer for a
/// backlog.
const TAKING: Duration = Duration::from_secs(1);

/// How often it is looked whether the journal may forget files that are gone.
const FORGETTING: Duration = Duration::from_secs(3600);

/// A wait that lasts this much longer than it was to last was no wait of ours alone: the machine slept, or
/// its virtual machine was stopped.
const ASLEEP: Duration = Duration::from_secs(2);

/// How soon a gate that is shut is tried again.
const SHUT: Duration = Duration::from_secs(2);

/// One export folder and what is known of its files.
struct Intake {
    station: Arc<Station>,
    folder: PathBuf,
    guard: MountGuard,
    settling: Settling,
    notes: Notes,
    beat: Beat,
    next_forgetting: Duration,
    /// What the journal has of the looks.
    kept: Option<Memory>,
}

/// What a round came to.
struct Round {
    watch: Watch,
    /// How long is rested before anything else.
    rest: Duration,
    /// How long is waited for a hint then.
    pause: Duration,
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
    let settling = Settling::new(scanner.quiet, scanner.short_wait, scanner.watch.overdue);
    let memory = memory::recall(&station, &folder).await?;
    let settling = settling.remembering(memory);
    let patient = &station.config.patient;
    let settling = match patient.sidecar {
        Some(_) => settling.awaiting_companions(patient.sidecar_wait),
        None => settling,
    };
    let guard = MountGuard::new(scanner.watch.expected.clone());
    let hint = Arc::new(Notify::new());
    let pressed = station.booth.look(place);
    let mut watch = Watch::new(folder.clone(), scanner.watch.subfolders, Arc::clone(&hint));
    let notes = Notes::new(Arc::clone(&station), place, &folder);
    let mut looked = Some(looked);
    let next_forgetting = station.now() + FORGETTING;
    let kept = None;
    let mut intake =
        Intake { station, folder, guard, settling, notes, beat, next_forgetting, kept };
    while !stop.is_requested() {
        let Some(round) = intake.round(watch, &mut stop).await? else { break };
        watch = round.watch;
        if let Some(looked) = looked.take() {
            // Nobody listens any more where readiness did not wait for a folder out of reach.
            let _ = looked.send(()).await;
        }
        let (rested, planned) = (intake.station.now(), round.rest + round.pause);
        let rest = intake.beating(sleep(round.rest));
        tokio::select! {
            () = stop.requested() => break,
            () = rest => {}
        }
        let pause = intake.beating(sleep(round.pause));
        tokio::select! {
            () = stop.requested() => break,
            () = hint.notified() => {}
            () = pressed.notified() => {}
            () = pause => {}
        }
        if intake.station.now().saturating_sub(rested) > planned + ASLEEP {
            // The machine stood still, and so may the program that writes the export.
            intake.settling.slept();
        }
    }
    Ok(())
}

impl Intake {
    fn beat(&self) {
        self.beat.beat();
    }

    /// Waits, and beats meanwhile.
    async fn beating(&self, wait: impl Future<Output = ()>) {
        tokio::pin!(wait);
        loop {
            self.beat();
            tokio::select! {
                () = &mut wait => return,
                () = sleep(LOOK_UP) => {}
            }
        }
    }

    /// One look, and what has settled by it; none where a stop came in between.
    async fn round(&mut self, watch: Watch, stop: &mut Stop) -> Result<Option<Round>, JoinError> {
        let Some((watch, due, took)) = self.look(watch, stop).await? else { return Ok(None) };
        let (rescan, quiet) =
            (self.station.config.scanner.rescan, self.station.config.scanner.quiet);
        let soon = self.station.now() + quiet;
        let is_settling = self.settling.next_due().is_some_and(|at| at <= soon);
        let rests = if is_settling { REST_PER_LOOK_SETTLING } else { REST_PER_LOOK };
        let rest = BREATH.max(took * rests).min(rescan);
        let began = Instant::now();
        let is_open = self.take_all(due, TAKING.max(rest), stop).await?;
        let took = began.elapsed();
        self.notes.waiting(&mut self.settling);
        let due = self.settling.next_due().map(|at| at.saturating_sub(self.station.now()));
        let pause = match due {
            Some(_) if !is_open => SHUT.min(rescan),
            Some(due) => due.min(rescan),
            None => rescan,
        };
        let rest = rest.saturating_sub(took);
        Ok(Some(Round { watch, rest, pause: pause.saturating_sub(rest) }))
    }

    /// Looks at the folder; gives the watch back, what is due, and how long the look took.
    async fn look(
        &mut self,
        mut watch: Watch,
        stop: &mut Stop,
    ) -> Result<Option<(Watch, Vec<Settled>, Duration)>, JoinError> {
        let (station, folder) = (Arc::clone(&self.station), self.folder.clone());
        let look = move |pulse: &Pulse| {
            let armed = watch.keep_armed();
            let began = station.now();
            let is_ours = station.lasting.export_locks.hold(&folder);
            let found = is_ours.and_then(|is_ours| {
                let found =
                    is_ours.then(|| scan_dir::look(&folder, &station.config.scanner.watch, pulse));
                found.transpose()
            });
            (watch, armed, found, LookTime { began, ended: station.now() })
        };
        let looked =
            patiently(DEADLINE, stop, look, || self.beat(), || self.notes.stalled()).await?;
        let Some((watch, armed, found, when)) = looked else { return Ok(None) };
        self.notes.watched(armed);
        let (look, passers) = self.notes.found(found, &mut self.guard);
        if let Look::Seen(scans) = &look {
            self.forget_gone(scans.keys().cloned().collect()).await?;
            self.settling.pass_over(passers, when);
        }
        let due = self.settling.observe(look, when);
        self.mark(stop).await?;
        self.remember().await?;
        self.notes.waiting(&mut self.settling);
        Ok(Some((watch, due, when.ended.saturating_sub(when.began))))
    }

    /// Now and then, and where the journal does not keep its scans for ever, lets it forget the files
    /// of forgotten scans that are gone.
    async fn forget_gone(&mut self, present: BTreeSet<PathBuf>) -> Result<(), JoinError> {
        let now = self.station.now();
        if self.station.config.retention.journal.is_none() || now < self.next_forgetting {
            return Ok(());
        }
        self.next_forgetting = now + FORGETTING;
        let (station, folder) = (Arc::clone(&self.station), self.folder.clone());
        let forgotten = spawn_blocking(move || {
            let is_other = |other: &&PathBuf| **other != folder && other.starts_with(&folder);
            let others = station.config.scanner.export_dirs.iter();
            let others: Vec<PathBuf> = others.filter(is_other).cloned().collect();
            station.custody.journal().forget_sightings(&folder, &others, &present)
        });
        if let Err(fault) = forgotten.await? {
            self.notes.failed(&fault);
        }
        Ok(())
    }

    /// Takes files for as long as `budget` lasts, at least one; says whether the gate was open.
    async fn take_all(
        &mut self,
        due: Vec<Settled>,
        budget: Duration,
        stop: &mut Stop,
    ) -> Result<bool, JoinError> {
        let began = Instant::now();
        let station = Arc::clone(&self.station);
        let (known, fresh) = spawn_blocking(move || {
            let (known, fresh) = ingest::dealt_with(&station, due);
            // Tells what is free although nothing may be due; what is refused unread needs no room.
            let largest = station.config.scanner.max_scan_bytes;
            let next = fresh.iter().map(|file| file.stamp.size).find(|size| *size <= largest);
            station.intake_gate(next.unwrap_or(0));
            (known, fresh)
        })
        .await?;
        known.iter().for_each(|settled| self.settling.taken(settled));
        for settled in fresh {
            if stop.is_requested() || began.elapsed() > budget {
                break;
            }
            self.beat();
            if !self.take(settled, stop).await? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Takes one file and notes what became of it; says whether the gate was open.
    async fn take(&mut self, settled: Settled, stop: &mut Stop) -> Result<bool, JoinError> {
        let (station, began) = (Arc::clone(&self.station), self.station.now());
        let (settled, admitted) = spawn_blocking(move || {
            let admitted = ingest::admitted(&station, &settled);
            (settled, admitted)
        })
        .await?;
        let read = match admitted {
            Ok(Admitted::Shut) => return Ok(false),
            Ok(Admitted::Refused) => {
                self.settling.taken(&settled);
                return Ok(true);
            }
            Ok(Admitted::ToBeRead) => self.read(settled.clone(), stop).await?,
            Err(fault) => Some(Err(fault)),
        };
        // A stop while the share hangs leaves the file to the next start.
        let Some(read) = read else { return Ok(true) };
        let station = Arc::clone(&self.station);
        // Where no capture waits it does not matter, and a backlog has many files to compare with.
        let is_awaited = self.station.booth.last_opened().is_some();
        let began_at = |export: &Export| match is_awaited {
            true => self.settling.began(&settled, &export.bytes),
            false => settled.writing.began(&export.bytes),
        };
        let read = read.map(|export| export.map(|export| (began_at(&export), export)));
        let (settled, taken, mark) = spawn_blocking(move || {
            let mut mark = None;
            let taken = read.and_then(|export| match export {
                Some((content_began, export)) => {
                    mark = Some(Mark::of(began, station.now(), &export.bytes));
                    ingest::take(&station, &settled, content_began, &export)
                }
                None => Ok(Taken::Changed),
            });
            (settled, taken, mark)
        })
        .await?;
        let now = self.station.now();
        mark.into_iter().for_each(|mark| self.settling.read(&settled, &mark));
        match taken {
            Ok(Taken::Done) => self.settling.taken(&settled),
            Ok(Taken::CutShort) => self.settling.cut_short(&settled),
            Ok(Taken::Changed) => self.settling.changed(&settled, now),
            Err(fault) => {
                self.notes.failed(&fault);
                self.settling.failed(&settled, now, jitter::unit());
            }
        }
        Ok(true)
    }

    /// Reads a file at the share; none where a stop was asked for before it answered.
    async fn read(
        &mut self,
        settled: Settled,
        stop: &mut Stop,
    ) -> Result<Option<Result<Option<Export>, TakeFault>>, JoinError> {
        let read =
            move |pulse: &Pulse| stable_read::read(&settled, pulse).map_err(TakeFault::Source);
        patiently(DEADLINE, stop, read, || self.beat(), || self.notes.stalled()).await
    }
}
