//! The delivery: works on as many scans at once as there are jobs allowed, each store at its own pace.
//!
//! The work is in the journal and is read from there each time that something can start; a hint only makes
//! the next read come sooner. [`Outbox`] decides what is tried when. Its pauses use the monotonic clock:
//! after a restart everything is tried at once. Every step that may wait for a disk, a share or a measurement
//! is a job of its own; this loop waits for none of them.

mod hand_over;
pub(in crate::station) mod measuring;
pub mod preview;
mod store_reach;
mod store_search;
mod stored_record;
pub(in crate::station) mod work;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::thread::available_parallelism;
use std::time::Duration;

use gaiter_flow::Outbox;
use gaiter_flow::cause::Cause;
use gaiter_flow::facts::{StoreAttempt, StoreRefusal};
use gaiter_flow::outbox::{Ended, Key};
use jiff::Timestamp;
use tokio::task::{JoinError, JoinSet, spawn_blocking};
use tokio::time::sleep;

use self::work::Ready;
use super::booth::Booth;
use super::journal::{Due, KEPT, Task};
use super::runtime::{Heartbeat, Stop, random_unit};
use crate::store::FolderStore;

/// How often the journal is read without a hint.
const RECHECK: Duration = Duration::from_secs(5);

/// At most this many scans at a time, however many cores there are.
const JOBS_MAX: usize = 5;

/// While a step at a store takes longer than this, nothing else is begun there, and it keeps no other store
/// waiting: a server that hangs would otherwise take all jobs.
const SLOW: Duration = Duration::from_secs(5);

/// The result of a job.
enum Done {
    Asked { store: String, in_reach: bool },
    Prepared { dues: Vec<Due>, ready: Result<Arc<Ready>, Ended> },
    Ended { due: Due, ended: Ended },
}

#[derive(Default)]
struct Scheduler {
    outbox: Outbox,
    jobs: JoinSet<Done>,
    /// The steps that are running at each store, and when they began.
    at_store: BTreeMap<(String, Option<Key>), Duration>,
}

/// Makes deliveries until asked to stop, then finishes what is running.
///
/// # Errors
/// If a job panicked.
pub async fn worker(booth: Arc<Booth>, beat: Heartbeat, mut stop: Stop) -> Result<(), JoinError> {
    let cores = available_parallelism().map_or(1, usize::from);
    // One more than cores: while a record is being synced, no core is idle.
    let jobs_max = (cores + 1).min(JOBS_MAX);
    let mut scheduler = Scheduler::default();
    for store in booth.core().stores.iter() {
        scheduler.outbox.asking(store.name());
        scheduler.ask(&booth, store.name().to_owned());
    }
    while !stop.is_requested() {
        beat.beat();
        let now = booth.core().now();
        // A backlog is long, and each step of a scan wakes this loop.
        if !booth.core().is_paused() && scheduler.outbox.can_start(now, jobs_max) {
            scheduler.start_ready(&booth, now, jobs_max, cores).await?;
        }
        scheduler.find_stalled(&booth);
        let wait =
            scheduler.outbox.next_in(now, jobs_max).map_or(RECHECK, |next| next.min(RECHECK));
        tokio::select! {
            () = stop.requested() => break,
            Some(done) = scheduler.jobs.join_next() => scheduler.on_done(&booth, done?).await?,
            () = booth.core().work.notified() => {}
            () = sleep(wait) => {}
        }
    }
    while let Some(done) = scheduler.jobs.join_next().await {
        beat.beat();
        scheduler.on_done(&booth, done?).await?;
    }
    Ok(())
}

impl Scheduler {
    /// Starts what the journal lists as to be done, as far as stores, free jobs and pauses allow.
    async fn start_ready(
        &mut self,
        booth: &Arc<Booth>,
        now: Duration,
        jobs_max: usize,
        cores: usize,
    ) -> Result<(), JoinError> {
        let core = Arc::clone(booth.core());
        let pending = spawn_blocking(move || {
            let journal = core.custody.journal();
            journal.is_in_place().and_then(|()| journal.pending())
        });
        let Some(pending) = booth.core().logged(pending.await?) else { return Ok(()) };
        let keys: Vec<Key> = pending.iter().map(key).collect();
        let pending: BTreeMap<Key, Due> = keys.iter().cloned().zip(pending).collect();
        booth.core().to_retry_now().iter().for_each(|scan| self.outbox.retry_now(scan));
        let plan = self.outbox.plan(&keys, now, jobs_max);
        let erasing = booth.core().custody.erasures().awaited_stores();
        for store in plan.ask.into_iter().chain(self.outbox.to_ask(erasing, now)) {
            self.ask(booth, store);
        }
        // A single scan gets all cores.
        let threads = (cores / self.outbox.busy().max(1)).max(1);
        for group in plan.attempts {
            let dues = group.iter().filter_map(|key| pending.get(key).cloned()).collect();
            self.attempt(booth, dues, threads);
        }
        Ok(())
    }

    /// Checks whether a store is in reach, and searches it if the journal was rebuilt.
    fn ask(&mut self, booth: &Arc<Booth>, store: String) {
        self.at_store.insert((store.clone(), None), booth.core().now());
        let booth = Arc::clone(booth);
        self.jobs.spawn_blocking(move || {
            let in_reach = store_reach::ask(booth.core(), &store);
            Done::Asked { store, in_reach }
        });
    }

    /// Begins deliveries of one scan to one patient: withdrawals and later revisions at once, others after
    /// measuring.
    fn attempt(&mut self, booth: &Arc<Booth>, dues: Vec<Due>, threads: usize) {
        let (deliver, others): (Vec<Due>, Vec<Due>) =
            dues.into_iter().partition(|due| due.task == Task::Deliver);
        for due in others {
            match due.task {
                Task::HandOver => self.at_store(booth, due, hand_over::hand_over),
                Task::Withdraw | Task::Deliver => self.at_store(booth, due, work::withdraw),
            }
        }
        let Some(first) = deliver.first().cloned() else { return };
        let may_be_stored = deliver.iter().all(|due| due.store != FolderStore::FIRST);
        let booth = Arc::clone(booth);
        self.jobs.spawn_blocking(move || {
            // If the spool was removed, the scan of this record is gone.
            let is_there = booth.core().custody.spool().holds(&first.scan);
            let ready = work::prepare(&booth, &first, threads, may_be_stored && is_there);
            Done::Prepared { dues: deliver, ready: ready.map(Arc::new) }
        });
    }

    /// Begins a step at a store.
    fn at_store(
        &mut self,
        booth: &Arc<Booth>,
        due: Due,
        step: impl FnOnce(&Booth, &Due) -> Ended + Send + 'static,
    ) {
        self.at_store.insert((due.store.clone(), Some(key(&due))), booth.core().now());
        let booth = Arc::clone(booth);
        self.jobs.spawn_blocking(move || {
            let ended = step(&booth, &due);
            Done::Ended { due, ended }
        });
    }

    async fn on_done(&mut self, booth: &Arc<Booth>, done: Done) -> Result<(), JoinError> {
        match done {
            Done::Asked { store, in_reach } => {
                self.at_store.remove(&(store.clone(), None));
                self.outbox.asked(&store, in_reach, booth.core().now(), random_unit());
            }
            Done::Prepared { dues, ready: Ok(ready) } => {
                for due in dues {
                    let ready = Arc::clone(&ready);
                    self.at_store(booth, due, move |booth, due| work::put(booth, due, &ready));
                }
            }
            Done::Prepared { dues, ready: Err(ended) } => {
                for due in dues {
                    self.end(booth, due, ended).await?;
                }
            }
            Done::Ended { due, ended } => {
                self.at_store.remove(&(due.store.clone(), Some(key(&due))));
                self.end(booth, due, ended).await?;
            }
        }
        Ok(())
    }

    async fn end(&mut self, booth: &Arc<Booth>, due: Due, ended: Ended) -> Result<(), JoinError> {
        let pause = self.outbox.ended(&key(&due), ended, booth.core().now(), random_unit());
        let Some(pause) = pause else { return Ok(()) };
        if ended == Ended::NotTaken && self.outbox.is_failing(&due.store) {
            let refusal = StoreRefusal::Fault(Cause::known("several-not-taken", []));
            store_reach::note(booth.core(), &due.store, StoreAttempt::Delivery(Some(refusal)));
        }
        let booth = Arc::clone(booth);
        let noted = spawn_blocking(move || {
            let next_at = Timestamp::now().checked_add(pause).unwrap_or(Timestamp::MAX);
            let code = match ended {
                Ended::StoreFailed => "store-unavailable",
                Ended::NotTaken => work::NOT_TAKEN,
                Ended::Kept => KEPT,
                Ended::PutOff | Ended::ForGood => "put-off",
            };
            // This only informs people; the pause itself holds.
            let core = booth.core();
            core.logged(core.custody.journal().put_off(&due, code, next_at));
        });
        noted.await
    }

    /// Lets a store rest while a step there takes long, and reports it if the step does not return; other stores
    /// continue.
    fn find_stalled(&mut self, booth: &Booth) {
        let now = booth.core().now();
        for ((store, _), began) in &self.at_store {
            let lasts = now.saturating_sub(*began);
            if lasts >= SLOW {
                self.outbox.stalled(store);
            }
            let most = booth.core().stores.named(store).map(|store| store.step_most());
            let is_stalled = most.is_some_and(|most| lasts >= most);
            if is_stalled {
                store_reach::note_stalled(booth.core(), store);
            }
        }
    }
}

fn key(due: &Due) -> Key {
    let patient = due.patient.as_ref().map(|patient| patient.id.clone());
    Key { scan: due.scan.clone(), patient, store: due.store.clone() }
}
