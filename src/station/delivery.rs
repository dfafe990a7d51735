//! The delivery: keeps as many scans going as there are hands, each store at its own pace.
//!
//! What is to be done stands in the journal and is read from there each time; a hint only makes
//! the next reading come sooner. What is tried when is decided by [`Outbox`], whose pauses are on
//! the monotonic clock: after a restart everything is tried at once. Every step that may wait for
//! a disk, a share or a measurement is a job of its own; this loop waits for none of them.

pub mod measure;
pub(in crate::station) mod measuring;
pub mod preview;
pub(in crate::station) mod work;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::thread::available_parallelism;
use std::time::Duration;

use jiff::Timestamp;
use tokio::task::{JoinError, JoinSet, spawn_blocking};
use tokio::time::sleep;
use tracing::{info, warn};

use self::work::Ready;
use super::assembly::Station;
use super::beat::Beat;
use super::error::chain;
use super::jitter;
use super::journal::{Due, KEPT, Task};
use super::stop::Stop;
use crate::flow::Outbox;
use crate::flow::outbox::{Ended, Key};

/// How often the journal is read where nothing hints at it.
const RECHECK: Duration = Duration::from_secs(5);

/// At most this many scans at a time, however many cores there are.
const MOST_HANDS: usize = 5;

/// A step at a store that takes longer has stalled. A record has some megabytes.
const STALLED: Duration = Duration::from_secs(60);

/// What a job came to.
enum Done {
    Asked { store: String, in_reach: bool },
    Prepared { dues: Vec<Due>, ready: Result<Arc<Ready>, Ended> },
    Ended { due: Due, ended: Ended },
}

#[derive(Default)]
struct Bench {
    outbox: Outbox,
    dues: BTreeMap<Key, Due>,
    jobs: JoinSet<Done>,
    /// What was begun at each store, and when.
    at_store: BTreeMap<(String, Option<Key>), Duration>,
}

/// Makes deliveries until it is asked to stop; what is in hand then is finished.
///
/// # Errors
/// Where a job panicked.
pub async fn worker(station: Arc<Station>, beat: Beat, mut stop: Stop) -> Result<(), JoinError> {
    let cores = available_parallelism().map_or(1, usize::from);
    // One more than cores: while a record is being synced, no core is idle.
    let hands = (cores + 1).min(MOST_HANDS);
    let mut bench = Bench::default();
    for store in &station.stores {
        bench.outbox.asking(store.name());
        bench.ask(&station, store.name().to_owned());
    }
    while !stop.is_requested() {
        beat.beat();
        if !station.is_paused() {
            bench.take_up(&station, hands, cores).await?;
        }
        bench.find_stalled(&station);
        let wait = bench.outbox.next_in(station.now()).map_or(RECHECK, |next| next.min(RECHECK));
        tokio::select! {
            () = stop.requested() => break,
            Some(done) = bench.jobs.join_next() => bench.put_down(&station, done?).await?,
            () = station.work.notified() => {}
            () = sleep(wait) => {}
        }
    }
    while let Some(done) = bench.jobs.join_next().await {
        beat.beat();
        bench.put_down(&station, done?).await?;
    }
    Ok(())
}

impl Bench {
    /// Starts what the journal says is to be done, as far as stores, hands and pauses allow.
    async fn take_up(
        &mut self,
        station: &Arc<Station>,
        hands: usize,
        cores: usize,
    ) -> Result<(), JoinError> {
        let journal = Arc::clone(station);
        let pending = spawn_blocking(move || {
            let journal = journal.custody.journal();
            journal.is_in_place().and_then(|()| journal.pending())
        });
        let pending = match pending.await? {
            Ok(pending) => pending,
            Err(error) => {
                station.check_corruption(&error);
                warn!(event = "journal-failed", error = chain(&error));
                return Ok(());
            }
        };
        let keys: Vec<Key> = pending.iter().map(key).collect();
        self.dues = keys.iter().cloned().zip(pending).collect();
        station.to_retry_now().iter().for_each(|scan| self.outbox.retry_now(scan));
        let now = station.now();
        let plan = self.outbox.plan(&keys, now, hands);
        for store in plan.ask {
            self.ask(station, store);
        }
        // A scan that comes alone has all cores to itself.
        let threads = (cores / self.outbox.busy().max(1)).max(1);
        for group in plan.attempts {
            let dues: Vec<Due> =
                group.iter().filter_map(|key| self.dues.get(key).cloned()).collect();
            self.attempt(station, dues, threads);
        }
        Ok(())
    }

    /// Asks a store whether it is in reach, and searches it where the journal was rebuilt.
    fn ask(&mut self, station: &Arc<Station>, store: String) {
        self.at_store.insert((store.clone(), None), station.now());
        let station = Arc::clone(station);
        self.jobs.spawn_blocking(move || {
            let in_reach = station.ask_store(&store);
            Done::Asked { store, in_reach }
        });
    }

    /// Begins deliveries of one scan to one patient: taken back at once, or measured first.
    fn attempt(&mut self, station: &Arc<Station>, dues: Vec<Due>, threads: usize) {
        let (withdraw, deliver): (Vec<Due>, Vec<Due>) =
            dues.into_iter().partition(|due| due.task == Task::Withdraw);
        for due in withdraw {
            self.at_store(station, due, work::withdraw);
        }
        let Some(first) = deliver.first().cloned() else { return };
        let station = Arc::clone(station);
        self.jobs.spawn_blocking(move || {
            let ready = work::prepare(&station, &first, threads).map(Arc::new);
            Done::Prepared { dues: deliver, ready }
        });
    }

    /// Begins a step at a store.
    fn at_store(
        &mut self,
        station: &Arc<Station>,
        due: Due,
        step: impl FnOnce(&Station, &Due) -> Ended + Send + 'static,
    ) {
        self.at_store.insert((due.store.clone(), Some(key(&due))), station.now());
        let station = Arc::clone(station);
        self.jobs.spawn_blocking(move || {
            let ended = step(&station, &due);
            Done::Ended { due, ended }
        });
    }

    async fn put_down(&mut self, station: &Arc<Station>, done: Done) -> Result<(), JoinError> {
        match done {
            Done::Asked { store, in_reach } => {
                self.at_store.remove(&(store.clone(), None));
                self.outbox.asked(&store, in_reach, station.now(), jitter::unit());
            }
            Done::Prepared { dues, ready: Ok(ready) } => {
                for due in dues {
                    let ready = Arc::clone(&ready);
                    self.at_store(station, due, move |station, due| {
                        work::put(station, due, &ready)
                    });
                }
            }
            Done::Prepared { dues, ready: Err(ended) } => {
                for due in dues {
                    self.end(station, due, ended).await?;
                }
            }
            Done::Ended { due, ended } => {
                self.at_store.remove(&(due.store.clone(), Some(key(&due))));
                self.end(station, due, ended).await?;
            }
        }
        Ok(())
    }

    async fn end(
        &mut self,
        station: &Arc<Station>,
        due: Due,
        ended: Ended,
    ) -> Result<(), JoinError> {
        let pause = self.outbox.ended(&key(&due), ended, station.now(), jitter::unit());
        let Some(pause) = pause else { return Ok(()) };
        let station = Arc::clone(station);
        let noted = spawn_blocking(move || {
            let next_at = Timestamp::now().checked_add(pause).unwrap_or(Timestamp::MAX);
            let code = match ended {
                Ended::StoreFailed => "store-unavailable",
                Ended::Kept => KEPT,
                Ended::PutOff | Ended::ForGood => "put-off",
            };
            let noted = station.custody.journal().put_off(&due, code, next_at);
            noted.inspect_err(|error| station.check_corruption(error))
        });
        if let Err(error) = noted.await? {
            // For people only; the pause itself holds.
            warn!(event = "journal-failed", error = chain(&error));
        }
        Ok(())
    }

    /// A step that does not come back makes its store stalled; others go on.
    fn find_stalled(&mut self, station: &Station) {
        let now = station.now();
        for ((store, _), began) in &self.at_store {
            if now.saturating_sub(*began) >= STALLED && station.note_stalled(store) {
                info!(event = "store-stalled", store);
                self.outbox.stalled(store);
            }
        }
    }
}

fn key(due: &Due) -> Key {
    let patient = due.patient.as_ref().map(|patient| patient.id.clone());
    Key { scan: due.scan.clone(), patient, store: due.store.clone() }
}
