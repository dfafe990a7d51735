//! The station's own clock, and the id that tells one boot of the machine from another.

use std::fs;
use std::time::Duration;

use jiff::Timestamp;
use jiff::tz::TimeZone;
use rustix::time::{ClockId, clock_gettime};

/// If a wait lasts this much longer than planned, the machine slept, or it or the process was stopped. A busy
/// machine is late, too, but not by so much.
pub const ASLEEP: Duration = Duration::from_secs(2);

/// The daemon's monotonic clock. It counts from the boot of the machine, so that a time in the journal
/// means the same to the next run. It goes on while the machine sleeps: a name given in the evening is
/// not valid the next morning.
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
