//! Notifications to the service manager; without one they do nothing.

use sd_notify::NotifyState;
use tracing::warn;

use super::overview::Overview;
use super::runtime::chain;

/// Reports that scans are taken in from now on.
pub fn tell_ready() {
    tell(&[NotifyState::Ready]);
}

/// Reports that the configuration is read again; `tell_ready` follows when that is over.
pub fn tell_reloading() {
    match NotifyState::monotonic_usec_now() {
        Ok(now) => tell(&[NotifyState::Reloading, now]),
        Err(error) => warn!(event = "notify-failed", error = chain(&error)),
    }
}

/// Reports that the station is stopping.
pub fn tell_stopping() {
    tell(&[NotifyState::Stopping]);
}

/// Reports that no worker hangs.
pub fn tell_alive() {
    tell(&[NotifyState::Watchdog]);
}

/// Reports the state of the station in one line.
pub fn tell_status(line: &str) {
    tell(&[NotifyState::Status(line)]);
}

/// The state of the station in one line: only codes and counts, because the service manager keeps it in
/// its own log.
pub fn status_line(overview: &Overview) -> String {
    let waiting = overview.pending();
    if overview.is_ready() {
        return format!("ready; {waiting} records to be delivered");
    }
    let codes: Vec<&str> = overview.faults().map(|complaint| complaint.code.as_str()).collect();
    let codes = codes.join(", ");
    format!("not ready: {codes}; {waiting} records to be delivered; see gaiter status")
}

fn tell(states: &[NotifyState<'_>]) {
    if let Err(error) = sd_notify::notify(states) {
        warn!(event = "notify-failed", %error);
    }
}
