//! Colours, where a reader can see them: a terminal that is not dumb, unless `NO_COLOR` says
//! otherwise; `CLICOLOR_FORCE` asks for them on pipes. No colour says anything that no word says.

use std::fmt::Display;
use std::io::{self, Write};

use anstyle::{AnsiColor, Style};

/// What is as it should be.
pub const GOOD: Style = AnsiColor::Green.on_default().bold();

/// What must be looked at.
pub const CARE: Style = AnsiColor::Yellow.on_default().bold();

/// What is wrong.
pub const BAD: Style = AnsiColor::Red.on_default().bold();

/// What names a figure and is none.
pub const LABEL: Style = AnsiColor::Cyan.on_default();

/// A text in a colour.
pub fn painted(style: Style, text: impl Display) -> String {
    format!("{style}{text}{style:#}")
}

/// Writes a painted text to standard output; see [`super::print`].
///
/// # Errors
/// See [`super::print`].
pub fn print(text: impl Display) -> io::Result<()> {
    let mut out = anstream::stdout().lock();
    match write!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}
