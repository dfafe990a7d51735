//! The workers' beats, which tell the watchdog that they are alive.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tokio::time::sleep;

/// How often a worker beats while it waits: a hung one is found after half a minute.
const PACE: Duration = Duration::from_secs(1);

/// The last sign of life of one worker, on a clock that stops while the machine sleeps: no worker runs
/// then, and none hangs.
#[derive(Debug, Clone)]
pub struct Heartbeat(Arc<Mutex<Instant>>);

impl Default for Heartbeat {
    fn default() -> Heartbeat {
        Heartbeat(Arc::new(Mutex::new(Instant::now())))
    }
}

impl Heartbeat {
    /// Notes that the worker is alive.
    pub fn beat(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    }

    /// Waits, and beats meanwhile.
    pub async fn during<T>(&self, wait: impl Future<Output = T>) -> T {
        tokio::pin!(wait);
        loop {
            self.beat();
            tokio::select! {
                done = &mut wait => return done,
                () = sleep(PACE) => {}
            }
        }
    }

    /// The time since the last beat.
    pub fn age(&self) -> Duration {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).elapsed()
    }
}
