//! Terminal output: local time, colours, tables, progress, and text that fits it.

pub mod progress;
pub mod screen;
pub mod table;

use std::fmt::Display;
use std::io;

use anstyle::{AnsiColor, Style};
use gaiter_flow::health;
use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::print_to;

/// A time in the time zone of this machine, as the operator's page shows it; records and JSON hold UTC.
pub fn local(time: Timestamp) -> String {
    health::local(time, &TimeZone::system())
}

/// All is well. A colour only repeats the words.
pub const GOOD: Style = AnsiColor::Green.on_default().bold();

/// Needs attention.
pub const CARE: Style = AnsiColor::Yellow.on_default().bold();

/// Something is wrong.
pub const BAD: Style = AnsiColor::Red.on_default().bold();

/// The label of a figure.
pub const LABEL: Style = AnsiColor::Cyan.on_default();

/// A text with a colour.
pub fn painted(style: Style, text: impl Display) -> String {
    format!("{style}{text}{style:#}")
}

/// Writes a text with colours to standard output; see [`crate::cli::print`]. They are used if the output is a terminal
/// that is not dumb and `NO_COLOR` does not forbid them; `CLICOLOR_FORCE` turns them on for pipes.
///
/// # Errors
/// See [`crate::cli::print`].
pub fn print_painted(text: impl Display) -> io::Result<()> {
    print_to(anstream::stdout().lock(), text.to_string().as_bytes())
}
