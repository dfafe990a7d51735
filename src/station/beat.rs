//! The workers' beats, by which the watchdog knows that they still turn.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The last sign of life of one worker, on a clock that stands still while the machine sleeps: nobody
/// turns then, and nobody hangs.
#[derive(Debug, Clone)]
pub struct Beat(Arc<Mutex<Instant>>);

impl Default for Beat {
    fn default() -> Beat {
        Beat(Arc::new(Mutex::new(Instant::now())))
    }
}

impl Beat {
    /// The worker turns.
    pub fn beat(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    }

    /// How long ago that was.
    pub fn age(&self) -> Duration {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).elapsed()
    }
}
