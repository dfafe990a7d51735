//! Notifications to the service manager; without one they do nothing.

use sd_notify::NotifyState;
use tracing::warn;

use super::overview::Overview;
use super::runtime::chain;

/// Reports that the configuration is read again; [`NotifyState::Ready`] follows when that is over.
pub fn notify_reloading() {
    match NotifyState::monotonic_usec_now() {
        Ok(now) => notify(&[NotifyState::Reloading, now]),
        Err(error) => warn!(event = "notify-failed", error = chain(&error)),
    }
}

/// Reports the state of the station in one line.
pub fn notify_status(line: &str) {
    notify(&[NotifyState::Status(line)]);
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

/// Reports this, all at once.
pub fn notify(states: &[NotifyState<'_>]) {
    if let Err(error) = sd_notify::notify(states) {
        warn!(event = "notify-failed", %error);
    }
}
