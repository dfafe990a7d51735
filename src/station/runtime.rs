//! What every worker uses: beats, stops, locks, the clock, random numbers, caught panics, causes of errors.

use std::any::Any;
use std::collections::hash_map::RandomState;
use std::error::Error;
use std::fs;
use std::hash::{BuildHasher, Hasher};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use jiff::Timestamp;
use jiff::tz::TimeZone;
use rustix::time::{ClockId, clock_gettime};
use tokio::sync::watch;
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
        *locked(&self.0) = Instant::now();
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
        locked(&self.0).elapsed()
    }
}

/// Whether the station should stop.
#[derive(Debug, Clone)]
pub struct Stop(watch::Receiver<bool>);

/// Asks the station's workers to stop.
#[derive(Debug)]
pub struct Stopper(watch::Sender<bool>);

impl Stopper {
    /// Creates a stopper, and the request that workers watch.
    pub fn new() -> (Stopper, Stop) {
        let (sender, receiver) = watch::channel(false);
        (Stopper(sender), Stop(receiver))
    }

    /// Asks all workers to stop.
    pub fn request(&self) {
        self.0.send_replace(true);
    }
}

impl Stop {
    /// Whether a stop has been requested.
    pub fn is_requested(&self) -> bool {
        *self.0.borrow()
    }

    /// Returns when a stop is requested or the stopper is gone.
    pub async fn requested(&mut self) {
        let _ = self.0.wait_for(|requested| *requested).await;
    }
}

/// If a wait lasts this much longer than planned, the machine slept, or it or the process was stopped. A busy
/// machine is late, too, but not by so much.
pub const ASLEEP: Duration = Duration::from_secs(2);

/// The daemon's monotonic clock. It counts from the boot of the machine, so that a time in the journal means
/// the same to the next run. It continues while the machine sleeps: a name given in the evening is not valid
/// the next morning.
#[derive(Debug)]
pub struct Clock {
    began: Duration,
    boot: String,
}

impl Clock {
    /// Creates the clock of a station that starts now.
    pub fn start() -> Clock {
        Clock { began: since_boot(), boot: boot_id() }
    }

    /// The time since the machine was booted.
    pub fn now(&self) -> Duration {
        since_boot()
    }

    /// How long the station has been running.
    pub fn running(&self) -> Duration {
        self.now().saturating_sub(self.began)
    }

    /// The id of this boot of the machine. Empty if the system does not report one; then every start of
    /// the station counts as a boot of the machine.
    pub fn boot(&self) -> &str {
        &self.boot
    }
}

/// Locks what is whole even after a panic, because it is changed in one step.
pub fn locked<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How far this machine's local time was ahead of UTC at a time, minutes.
pub fn utc_offset_min(at: Timestamp) -> Option<i16> {
    let seconds = TimeZone::system().to_offset(at).seconds();
    i16::try_from(seconds / 60).ok()
}

/// The time since the machine was booted, including its sleeps.
fn since_boot() -> Duration {
    let time = clock_gettime(ClockId::Boottime);
    let nanoseconds = u32::try_from(time.tv_nsec).unwrap_or(0);
    Duration::new(time.tv_sec.unsigned_abs(), nanoseconds)
}

fn boot_id() -> String {
    let id = fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default();
    id.trim().to_owned()
}

/// Random bits, such as for names of temporary files; nothing secret depends on them. Each `RandomState` differs from
/// the previous one and from those of other runs.
pub fn random_bits() -> u64 {
    RandomState::new().build_hasher().finish()
}

/// Uniform in [0, 1), so that attempts spread out.
pub fn random_unit() -> f64 {
    // 53 bits are what an f64 can hold between 0 and 1.
    (random_bits() >> 11) as f64 / (1_u64 << 53) as f64
}

/// An error and its causes in one line.
pub fn chain(error: &dyn Error) -> String {
    let mut line = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        line = format!("{line}: {error}");
        cause = error.source();
    }
    line
}

/// Runs what belongs to one scan, so that a panic affects only that scan: its result, or the message of its panic.
/// The job changes nothing that outlives it, so nothing half-changed is visible after a panic.
pub fn caught<T>(job: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(job)).map_err(|panic| message(panic.as_ref()))
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "a panic that says nothing".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_ends_the_job_and_not_the_caller() {
        assert_eq!(caught(|| 1), Ok(1));
        assert_eq!(caught(|| -> u8 { panic!("index 7") }), Err("index 7".to_owned()));
        let message = caught(|| -> u8 { panic!("row {} of {}", 7, 3) });
        assert_eq!(message, Err("row 7 of 3".to_owned()));
    }
}
