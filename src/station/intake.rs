//! The intake of one export folder: look, settle, take in, over and over.
//!
//! Everything that touches the folder runs in a thread that may hang (see `station::share::stall`). The worker
//! itself never blocks, so it can always stop, send its heartbeat and report that the share stalls.

pub(in crate::station) mod export_locks;
pub(in crate::station) mod ingest;
mod inspection;
mod memory;
mod notes;
pub(in crate::station) mod phantom;
pub(crate) mod scan_dir;
pub(in crate::station) mod stable_read;
pub(in crate::station) mod watch;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use gaiter_flow::export::mount::MountGuard;
use gaiter_flow::settle::{Gone, Memory};
use gaiter_flow::{Appeared, Fingerprint, Look, LookTime, Settled, Settling};
use tokio::sync::{Notify, mpsc};
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;

use self::export_locks::ExportLocks;
use self::ingest::{Admitted, Beginnings, TakeFault, Taken};
use self::scan_dir::Found;
use self::stable_read::Export;
use self::watch::Watch;
use super::booth::Booth;
use super::core::Core;
use super::runtime::{ASLEEP, Heartbeat, Stop, random_unit};
use super::share::stall::{DEADLINE, StepCounter, patiently};
use notes::Notes;

/// The shortest time from one look to the next, however many hints there are.
const LOOK_PAUSE_MIN: Duration = Duration::from_millis(100);

/// A look at a large folder takes long; the rest after it is this many times as long.
const REST_PER_LOOK: u32 = 10;

/// The same while a file is about to settle: the operator is waiting for it.
const REST_PER_LOOK_SETTLING: u32 = 2;

/// How long files are taken in before the folder is looked at again, so that no new scan waits longer
/// because of a backlog.
const TAKING: Duration = Duration::from_secs(1);

/// Interval at which the journal may forget files that are gone.
const FORGETTING: Duration = Duration::from_secs(3600);

/// How soon a closed gate is tried again.
const GATE_RETRY: Duration = Duration::from_secs(2);

/// An export folder of the configuration.
pub struct ExportDir {
    /// Its place among them, from 0.
    pub place: usize,
    pub folder: PathBuf,
}

/// One export folder and what is known of its files.
struct Intake {
    booth: Arc<Booth>,
    export_locks: Arc<ExportLocks>,
    folder: PathBuf,
    guard: MountGuard,
    settling: Settling,
    notes: Notes,
    beat: Heartbeat,
    next_forgetting: Duration,
    /// The memory of the looks that the journal holds.
    kept: Option<Memory>,
}

/// The result of a round.
struct Round {
    watch: Watch,
    /// How long to rest before anything else.
    rest: Duration,
    /// How long to wait for a hint after that.
    pause: Duration,
}

/// Runs the intake of one export folder until asked to stop. After the first look, in reach or not, it
/// drops `looked`.
///
/// # Errors
/// If a step of its own panicked.
pub async fn worker(
    booth: Arc<Booth>,
    export_locks: Arc<ExportLocks>,
    ExportDir { place, folder }: ExportDir,
    beat: Heartbeat,
    mut stop: Stop,
    looked: mpsc::Sender<()>,
) -> Result<(), JoinError> {
    let core = Arc::clone(booth.core());
    let scanner = &core.config.scanner;
    let settling = Settling::new(scanner.quiet, scanner.short_wait, core.config.status.overdue);
    let memory = memory::recall(&core, &folder).await?;
    let settling = settling.remembering(memory);
    let patient = &core.config.patient;
    let settling = match patient.sidecar {
        Some(_) => settling.awaiting_companions(patient.sidecar_wait),
        None => settling,
    };
    let guard = MountGuard::default();
    let hint = Arc::new(Notify::new());
    let mut looks = booth.looks();
    let mut watch = Watch::new(folder.clone(), scanner.watch.subfolders, Arc::clone(&hint));
    let notes = Notes::new(Arc::clone(&booth), place, &folder);
    let mut looked = Some(looked);
    let next_forgetting = core.now() + FORGETTING;
    let kept = None;
    let mut intake =
        Intake { booth, export_locks, folder, guard, settling, notes, beat, next_forgetting, kept };
    while !stop.is_requested() {
        let Some(round) = intake.round(watch, &mut stop).await? else { break };
        watch = round.watch;
        drop(looked.take());
        let (rested, planned) = (core.now(), round.rest + round.pause);
        let rest = intake.beat.during(sleep(round.rest));
        tokio::select! {
            () = stop.requested() => break,
            () = rest => {}
        }
        let pause = intake.beat.during(sleep(round.pause));
        tokio::select! {
            () = stop.requested() => break,
            () = hint.notified() => {}
            _ = looks.changed() => {}
            () = pause => {}
        }
        if core.now().saturating_sub(rested) > planned + ASLEEP {
            // The machine was stopped, and so may the program that writes the export have been.
            intake.settling.note_gap();
        }
    }
    Ok(())
}

impl Intake {
    fn core(&self) -> &Core {
        self.booth.core()
    }

    /// One look, and the intake of what has settled; `None` if a stop came in between.
    async fn round(&mut self, watch: Watch, stop: &mut Stop) -> Result<Option<Round>, JoinError> {
        let Some((watch, due, took)) = self.look(watch, stop).await? else { return Ok(None) };
        let (rescan, quiet) = (self.core().config.scanner.rescan, self.core().config.scanner.quiet);
        let soon = self.core().now() + quiet;
        let is_settling = self.settling.next_due().is_some_and(|at| at <= soon);
        let rests = if is_settling { REST_PER_LOOK_SETTLING } else { REST_PER_LOOK };
        let rest = LOOK_PAUSE_MIN.max(took * rests).min(rescan);
        let began = Instant::now();
        let is_open = self.take_all(due, TAKING.max(rest), stop).await?;
        let took = began.elapsed();
        self.notes.waiting(&mut self.settling);
        let due = self.settling.next_due().map(|at| at.saturating_sub(self.core().now()));
        let pause = match due {
            Some(_) if !is_open => GATE_RETRY.min(rescan),
            Some(due) => due.min(rescan),
            None => rescan,
        };
        let rest = rest.saturating_sub(took);
        Ok(Some(Round { watch, rest, pause: pause.saturating_sub(rest) }))
    }

    /// Looks at the folder. Returns the watch, what is due, and how long the look took.
    async fn look(
        &mut self,
        mut watch: Watch,
        stop: &mut Stop,
    ) -> Result<Option<(Watch, Vec<Settled>, Duration)>, JoinError> {
        let (core, folder) = (Arc::clone(self.booth.core()), self.folder.clone());
        let export_locks = Arc::clone(&self.export_locks);
        let look = move |counter: &StepCounter| {
            let armed = watch.keep_armed();
            let began = core.now();
            let is_ours = export_locks.hold(&folder);
            let found = is_ours.and_then(|is_ours| {
                let found =
                    is_ours.then(|| scan_dir::look(&folder, &core.config.scanner.watch, counter));
                found.transpose()
            });
            (watch, armed, found, LookTime { began, ended: core.now() })
        };
        let looked =
            patiently(DEADLINE, stop, look, || self.beat.beat(), || self.notes.stalled()).await?;
        let Some((watch, armed, found, when)) = looked else { return Ok(None) };
        self.notes.watched(armed);
        let look = match self.notes.found(found, &mut self.guard) {
            Some(Found { scans, unrelated, folders, .. }) => {
                self.forget_gone(scans.keys().cloned().collect()).await?;
                self.settling.found_in(folders);
                self.settling.pass_over(unrelated, when);
                Look::Seen(scans)
            }
            None => Look::OutOfReach,
        };
        let due = self.settling.observe(look, when);
        self.mark(stop).await?;
        let gone = self.settling.gone(!due.is_empty());
        self.lose(gone).await?;
        self.remember().await?;
        self.notes.waiting(&mut self.settling);
        Ok(Some((watch, due, when.ended.saturating_sub(when.began))))
    }

    /// Reports contents that were seen and are gone before they were taken, except those that the journal
    /// knows: to the booth before anything else is taken, then to the operator.
    async fn lose(&mut self, gone: Vec<Gone>) -> Result<(), JoinError> {
        if gone.is_empty() {
            return Ok(());
        }
        let booth = Arc::clone(&self.booth);
        let lost = spawn_blocking(move || {
            let journal = booth.core().custody.journal();
            let is_known = |of: &Gone| journal.was_sighted(&of.path, of.stamp).unwrap_or(false);
            let lost: Vec<Gone> = gone.into_iter().filter(|content| !is_known(content)).collect();
            let appeared: Vec<Appeared> = lost.iter().map(|content| content.appeared).collect();
            booth.gone(&appeared);
            lost
        });
        self.notes.gone(lost.await?);
        Ok(())
    }

    /// From time to time, unless the journal keeps its scans for ever, lets it forget files that are
    /// gone and whose scans are forgotten.
    async fn forget_gone(&mut self, present: BTreeSet<PathBuf>) -> Result<(), JoinError> {
        let now = self.core().now();
        if self.core().config.retention.journal.is_none() || now < self.next_forgetting {
            return Ok(());
        }
        self.next_forgetting = now + FORGETTING;
        let (core, folder) = (Arc::clone(self.booth.core()), self.folder.clone());
        let forgotten = spawn_blocking(move || {
            let is_other = |other: &&PathBuf| **other != folder && other.starts_with(&folder);
            let others = core.config.scanner.export_dirs.iter();
            let others: Vec<PathBuf> = others.filter(is_other).cloned().collect();
            core.custody.journal().forget_sightings(&folder, &others, &present)
        });
        if let Err(fault) = forgotten.await? {
            self.notes.failed(&fault);
        }
        Ok(())
    }

    /// Takes in files for as long as `budget` lasts, at least one. Returns whether the gate was open.
    async fn take_all(
        &mut self,
        due: Vec<Settled>,
        budget: Duration,
        stop: &mut Stop,
    ) -> Result<bool, JoinError> {
        let began = Instant::now();
        let core = Arc::clone(self.booth.core());
        let (known, fresh) = spawn_blocking(move || {
            let (known, fresh) = ingest::dealt_with(&core, due);
            // Reports what is free even if nothing is due; files that are refused unread need no room.
            let largest = core.config.scanner.max_scan_bytes;
            let next = fresh.iter().map(|file| file.group.stamp.size).find(|size| *size <= largest);
            core.intake_gate(next.unwrap_or(0));
            (known, fresh)
        })
        .await?;
        known.iter().for_each(|settled| self.settling.taken(settled));
        for settled in fresh {
            if stop.is_requested() || began.elapsed() > budget {
                break;
            }
            self.beat.beat();
            if !self.take(settled, stop).await? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Takes in one file and notes the outcome. Returns whether the gate was open.
    async fn take(&mut self, settled: Settled, stop: &mut Stop) -> Result<bool, JoinError> {
        let (core, began) = (Arc::clone(self.booth.core()), self.core().now());
        let (settled, admitted) = spawn_blocking(move || {
            let admitted = ingest::admitted(&core, &settled);
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
        // If a stop comes while the share hangs, the file is left to the next start.
        let Some(read) = read else { return Ok(true) };
        let gone = match &read {
            Ok(Some(export)) => self.settling.overwritten_by(&settled, &export.bytes),
            Ok(None) | Err(_) => None,
        };
        self.lose(gone.into_iter().collect()).await?;
        let booth = Arc::clone(&self.booth);
        // Without a waiting capture it does not matter, and a backlog has many files to compare with.
        let asked = Arc::clone(&booth);
        let is_awaited = spawn_blocking(move || asked.last_opened().is_some()).await?;
        let beginnings = |export: &Export| match is_awaited {
            true => {
                let own = self.settling.began(&settled, &export.bytes);
                Beginnings { own, others: self.settling.others(&settled, &export.bytes) }
            }
            false => Beginnings { own: settled.writing.began(&export.bytes), others: Vec::new() },
        };
        let read = read.map(|export| export.map(|export| (beginnings(&export), export)));
        let take = spawn_blocking(move || {
            let (mut mark, mut is_kept) = (None, false);
            let taken = read.and_then(|export| match export {
                Some((beginnings, export)) => {
                    mark = Some(Fingerprint::whole(began, booth.core().now(), &export.bytes));
                    let taken = ingest::take(&booth, &settled, beginnings, &export);
                    is_kept = taken.is_err() && booth.core().custody.spool().holds(&export.scan);
                    taken
                }
                None => Ok(Taken::Changed),
            });
            (settled, taken, mark, is_kept)
        });
        // Its inspection may take long.
        let (settled, taken, mark, is_kept) = self.beat.during(take).await?;
        let now = self.core().now();
        mark.into_iter().for_each(|mark| self.settling.read(&settled, &mark));
        if is_kept {
            self.settling.kept(&settled);
        }
        match taken {
            Ok(Taken::Done) => self.settling.taken(&settled),
            Ok(Taken::CutShort) => self.settling.cut_short(&settled),
            Ok(Taken::LineEnd) => self.settling.lacks_line_end(&settled),
            Ok(Taken::Changed) => self.settling.changed(&settled, now),
            Err(fault) => {
                self.notes.failed(&fault);
                self.settling.failed(&settled, now, random_unit());
            }
        }
        Ok(true)
    }

    /// Reads a file from the share; `None` if a stop was requested before the share answered.
    async fn read(
        &mut self,
        settled: Settled,
        stop: &mut Stop,
    ) -> Result<Option<Result<Option<Export>, TakeFault>>, JoinError> {
        let read = move |counter: &StepCounter| {
            stable_read::read(&settled, counter).map_err(TakeFault::Source)
        };
        patiently(DEADLINE, stop, read, || self.beat.beat(), || self.notes.stalled()).await
    }
}
