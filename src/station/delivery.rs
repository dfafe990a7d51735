//! The delivery: keeps as many attempts going as there are hands, each scan at its own pace.
//!
//! What is to be done stands in the journal and is read from there each time; a hint only makes
//! the next reading come sooner. Pauses after failures are kept in memory, on the monotonic clock:
//! after a restart everything is tried at once.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::thread::available_parallelism;
use std::time::Duration;

use jiff::Timestamp;
use tokio::task::{JoinError, JoinSet, spawn_blocking};
use tokio::time::sleep;
use tracing::warn;

use super::assembly::Station;
use super::chance;
use super::error::chain;
use super::journal::Due;
use super::stop::Stop;
use super::work::{Ended, deliver};
use crate::flow::{ScanId, backoff};

/// How often the journal is read where nothing hints at it.
const RECHECK: Duration = Duration::from_secs(10);

/// At most this many deliveries at a time: one holds a whole scan in memory.
const MOST_HANDS: usize = 4;

/// A delivery's name: the scan, and the patient's id where one is named.
type Key = (ScanId, Option<String>);

#[derive(Default)]
struct Bench {
    attempts: JoinSet<(Due, Ended)>,
    in_hand: BTreeSet<Key>,
    pauses: BTreeMap<Key, Pause>,
}

#[derive(Clone, Copy)]
struct Pause {
    failures: u32,
    until: Duration,
}

/// Makes deliveries until it is asked to stop; what is in hand then is finished.
///
/// # Errors
/// Where an attempt panicked outside of the extraction.
pub async fn worker(station: Arc<Station>, mut stop: Stop) -> Result<(), JoinError> {
    // One core is left to the intake.
    let cores = available_parallelism().map_or(1, usize::from);
    let hands = cores.saturating_sub(1).clamp(1, MOST_HANDS);
    let mut bench = Bench::default();
    while !stop.is_requested() {
        if bench.in_hand.len() < hands {
            bench.take_up(&station, hands).await?;
        }
        let wait = bench.next_pause_ends(station.now());
        tokio::select! {
            () = stop.requested() => break,
            Some(ended) = bench.attempts.join_next() => bench.put_down(&station, ended?).await?,
            () = station.work.notified() => {}
            () = sleep(wait) => {}
        }
    }
    while let Some(ended) = bench.attempts.join_next().await {
        bench.put_down(&station, ended?).await?;
    }
    Ok(())
}

impl Bench {
    /// Starts what the journal says is to be done, as far as hands and pauses allow.
    async fn take_up(&mut self, station: &Arc<Station>, hands: usize) -> Result<(), JoinError> {
        let journal = Arc::clone(station);
        let pending = match spawn_blocking(move || journal.custody.journal().pending()).await? {
            Ok(pending) => pending,
            Err(error) => {
                warn!(event = "journal-failed", error = chain(&error));
                return Ok(());
            }
        };
        let now = station.now();
        for due in pending {
            let key = key(&due);
            let paused = self.pauses.get(&key).is_some_and(|pause| pause.until > now);
            if self.in_hand.len() >= hands || paused || self.in_hand.contains(&key) {
                continue;
            }
            self.in_hand.insert(key);
            let station = Arc::clone(station);
            self.attempts.spawn_blocking(move || {
                let ended = deliver(&station, &due);
                (due, ended)
            });
        }
        Ok(())
    }

    async fn put_down(
        &mut self,
        station: &Arc<Station>,
        (due, ended): (Due, Ended),
    ) -> Result<(), JoinError> {
        let key = key(&due);
        self.in_hand.remove(&key);
        if ended == Ended::ForGood {
            self.pauses.remove(&key);
            return Ok(());
        }
        let failures = self.pauses.get(&key).map_or(0, |pause| pause.failures).saturating_add(1);
        let pause = backoff::pause(failures, chance::unit());
        self.pauses.insert(key, Pause { failures, until: station.now() + pause });
        let station = Arc::clone(station);
        let noted = spawn_blocking(move || {
            let next_at = Timestamp::now().checked_add(pause).unwrap_or(Timestamp::MAX);
            let custody = &station.custody;
            custody.journal().put_off(&due, custody.store(), next_at)
        });
        if let Err(error) = noted.await? {
            // For people only; the pause itself holds.
            warn!(event = "journal-failed", error = chain(&error));
        }
        Ok(())
    }

    fn next_pause_ends(&self, now: Duration) -> Duration {
        let waiting = self.pauses.iter().filter(|(key, _)| !self.in_hand.contains(key));
        let ends = waiting.map(|(_, pause)| pause.until.saturating_sub(now)).min();
        ends.map_or(RECHECK, |end| end.min(RECHECK))
    }
}

fn key(due: &Due) -> Key {
    (due.scan.clone(), due.patient.as_ref().map(|patient| patient.id.clone()))
}
