//! Work at a share that may hang. It runs on its own thread, which is awaited and never cut off.
//! Meanwhile the waiting worker can stop, and can report that the share stalls.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use tokio::task::{JoinError, spawn_blocking};
use tokio::time::sleep;

use crate::station::runtime::Stop;

/// How long the work may take without a step forward before the share counts as stalled. A restarting
/// SMB server answers again within about 15 s, and a disk that spins up within 10 s.
pub const DEADLINE: Duration = Duration::from_secs(30);

/// How often a waiting worker wakes up and beats, whatever it waits for.
pub const LOOK_UP: Duration = Duration::from_secs(1);

/// The steps of one piece of work: entries listed, pieces read.
#[derive(Debug, Clone, Default)]
pub struct StepCounter(Arc<AtomicU64>);

impl StepCounter {
    /// One step forward.
    pub fn step(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn count(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

/// Detects work that has stalled: it made no step within the deadline.
struct Stall {
    deadline: Duration,
    steps: u64,
    last_step: Duration,
    reported: bool,
}

impl Stall {
    /// Starts to observe work that begins at this time.
    fn new(deadline: Duration, now: Duration) -> Stall {
        Stall { deadline, steps: 0, last_step: now, reported: false }
    }

    /// Takes in how many steps were made by now. Returns `true` once if the work stalls.
    fn observe(&mut self, steps: u64, now: Duration) -> bool {
        if steps != self.steps {
            self.steps = steps;
            self.last_step = now;
        }
        let stalls = now.saturating_sub(self.last_step) >= self.deadline;
        stalls && !std::mem::replace(&mut self.reported, true)
    }
}

/// Does `work` on a thread and returns its result. If a stop is requested first, returns `None`; the work
/// continues and its result is dropped. `beat` is called while waiting, and `stalled` once if the work makes
/// no step within `deadline`. The same work is still awaited then, so that no share ever holds two threads.
///
/// # Errors
/// If the work panicked.
pub async fn patiently<T: Send + 'static>(
    deadline: Duration,
    stop: &mut Stop,
    work: impl FnOnce(&StepCounter) -> T + Send + 'static,
    beat: impl Fn(),
    stalled: impl Fn(),
) -> Result<Option<T>, JoinError> {
    let (counter, began) = (StepCounter::default(), Instant::now());
    let mut stall = Stall::new(deadline, began.elapsed());
    let theirs = counter.clone();
    let mut thread = spawn_blocking(move || work(&theirs));
    loop {
        tokio::select! {
            biased;
            done = &mut thread => return done.map(Some),
            () = stop.requested() => return Ok(None),
            () = sleep(LOOK_UP.min(deadline)) => {}
        }
        beat();
        if stall.observe(counter.count(), began.elapsed()) {
            stalled();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicUsize;
    use std::sync::mpsc;

    use super::*;
    use crate::station::runtime::Stopper;

    const SHORT: Duration = Duration::from_millis(20);

    #[tokio::test]
    async fn work_that_hangs_is_told_of_once_and_waited_for() {
        let (_stopper, mut stop) = Stopper::new();
        let (let_go, hangs) = mpsc::channel();
        let (beats, stalls) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let beat = || {
            // It keeps beating after the stall was reported.
            if beats.fetch_add(1, Ordering::Relaxed) == 3 {
                let_go.send(7).unwrap();
            }
        };
        let stalled = || {
            stalls.fetch_add(1, Ordering::Relaxed);
        };
        let done = patiently(SHORT, &mut stop, move |_| hangs.recv(), beat, stalled);
        assert_eq!(done.await.unwrap(), Some(Ok(7)));
        assert_eq!(stalls.load(Ordering::Relaxed), 1);
    }

    #[test]
    fn work_stalls_once_it_makes_no_step_for_the_deadline_and_is_told_of_once() {
        let second = Duration::from_secs(1);
        let mut stall = Stall::new(30 * second, Duration::ZERO);
        // A step every 29 s is no stall, however long the work takes.
        let steady = (1..1000).find(|n: &u32| stall.observe(u64::from(*n), 29 * *n * second));
        assert_eq!(steady, None);
        let last = 29 * 999 * second;
        let reported: Vec<u32> =
            (1..90).filter(|n| stall.observe(999, last + *n * second)).collect();
        assert_eq!(reported, [30]);
    }

    #[tokio::test]
    async fn a_stop_does_not_wait_for_work_that_hangs() {
        let (stopper, mut stop) = Stopper::new();
        let (let_go, hangs) = mpsc::channel::<()>();
        let hung = patiently(DEADLINE, &mut stop, move |_| hangs.recv(), || (), || ());
        let (done, ()) = tokio::join!(hung, async { stopper.request() });
        assert!(done.unwrap().is_none());
        drop(let_go);
    }
}
