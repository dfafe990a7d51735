//! Times for people at this machine; records and JSON hold UTC.

use jiff::Timestamp;
use jiff::tz::TimeZone;

use gaiter_flow::health;

/// A time in the time zone of this machine, as the operator's page shows it.
pub fn local(time: Timestamp) -> String {
    health::local(time, &TimeZone::system())
}
