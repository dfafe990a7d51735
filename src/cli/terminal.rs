//! Terminal output: local time, colours, tables, progress, and text that fits it.

pub mod paint;
pub mod progress;
pub mod screen;
pub mod table;

use gaiter_flow::health;
use jiff::Timestamp;
use jiff::tz::TimeZone;

/// A time in the time zone of this machine, as the operator's page shows it; records and JSON hold UTC.
pub fn local(time: Timestamp) -> String {
    health::local(time, &TimeZone::system())
}
