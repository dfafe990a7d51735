//! What the service manager is told, if there is one; without one all of this is nothing.

use sd_notify::NotifyState;
use tracing::warn;

use super::error::chain;
use super::operator::overview::Overview;

/// Scans are taken from now on.
pub fn tell_ready() {
    tell(&[NotifyState::Ready]);
}

/// A configuration is read again; readiness is told when that is over.
pub fn tell_reloading() {
    match NotifyState::monotonic_usec_now() {
        Ok(now) => tell(&[NotifyState::Reloading, now]),
        Err(error) => warn!(event = "notify-failed", error = chain(&error)),
    }
}

/// The station comes to its end.
pub fn tell_stopping() {
    tell(&[NotifyState::Stopping]);
}

/// Every worker turns.
pub fn tell_alive() {
    tell(&[NotifyState::Watchdog]);
}

/// How the station is, in one line.
pub fn tell_status(line: &str) {
    tell(&[NotifyState::Status(line)]);
}

/// How the station is, in one line: codes and counts, for the service manager keeps what it is told
/// in a log of its own.
pub fn status_line(overview: &Overview) -> String {
    let waiting = overview.pending();
    if overview.complaints.is_empty() {
        return format!("ready; {waiting} records to be delivered");
    }
    let codes: Vec<&str> =
        overview.complaints.iter().map(|complaint| complaint.code.as_str()).collect();
    let codes = codes.join(", ");
    format!("not ready: {codes}; {waiting} records to be delivered; see gaiter status")
}

fn tell(states: &[NotifyState<'_>]) {
    if let Err(error) = sd_notify::notify(states) {
        warn!(event = "notify-failed", %error);
    }
}
