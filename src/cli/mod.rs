//! The command line: one file per verb.

pub mod act;
pub mod args;
pub mod ask;
pub mod check;
pub mod demo;
pub mod exit;
pub mod extract;
pub mod manual;
pub mod measure;
pub mod ord;
pub mod order;
pub mod paint;
pub mod parallel;
pub mod progress;
pub mod reextract;
pub mod report;
pub mod run;
pub mod scans;
pub mod screen;
pub mod status;
pub mod table;

use std::fmt::Display;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;

use crate::config::ConfigError;
use args::{Args, Verb};
pub use exit::Exit;

/// Runs the verb of the command line; the exit codes are those of [`Exit`].
pub fn main() -> ExitCode {
    let exit = match Args::try_parse() {
        Ok(args) => dispatch(args.verb),
        Err(said) => explain(&said),
    };
    exit.into()
}

fn dispatch(verb: Verb) -> Exit {
    match verb {
        Verb::Demo(args) => demo::demo(&args),
        Verb::Run(args) => run::run(&args),
        Verb::Extract(args) => extract::extract(&args),
        Verb::Reextract(args) => reextract::reextract(&args),
        Verb::Report(args) => report::report(&args),
        Verb::Measure(args) => measure::measure(&args),
        Verb::Check(args) => check::check(&args),
        Verb::Status(args) => status::status(&args),
        Verb::Scans(args) => scans::scans(&args),
        Verb::Show(args) => scans::show(&args),
        Verb::Explain(args) => scans::explain(&args),
        Verb::Retry(args) => act::retry(&args),
        Verb::Release(args) => act::release(&args),
        Verb::Assign(args) => act::assign(&args),
        Verb::Unassign(args) => act::unassign(&args),
        Verb::GiveUp(args) => act::give_up(&args),
        Verb::Patient(verb) => act::patient(&verb),
        Verb::GdtOrder(args) => order::order(&args),
        Verb::Page(args) => act::page(&args),
        Verb::Pause(args) => act::pause(&args),
        Verb::Resume(args) => act::resume(&args),
        Verb::Completions(args) => manual::completions(&args),
        Verb::Man(args) => manual::man(&args),
    }
}

/// Prints what clap has to say. Help and version were asked for and are no fault; for everything
/// else the contract has its own code, not clap's 2.
fn explain(said: &clap::Error) -> Exit {
    let asked_for = !said.use_stderr();
    // clap writes to a closed pipe without a panic, and there is nobody left to tell.
    let _ = said.print();
    if asked_for { Exit::Done } else { Exit::Usage }
}

/// Writes to standard output, as is. A reader that has gone away (`gaiter … | head`) wants no more
/// and is no fault.
///
/// # Errors
/// Anything else that keeps the text from being written, a full disk above all.
pub fn print(text: impl Display) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match write!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

/// Writes a diagnostic and a line end to standard error. Where that fails there is nobody to tell.
pub fn complain(text: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// A text from outside, a file's name above all, on one line: control characters, line separators
/// and marks that turn the writing direction are shown escaped, so that no name can forge a line
/// or move the cursor.
pub fn shown(text: impl Display) -> String {
    let mut shown = String::new();
    for c in text.to_string().chars() {
        match c {
            '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => shown.extend(c.escape_default()),
            c if c.is_control() => shown.extend(c.escape_default()),
            c => shown.push(c),
        }
    }
    shown
}

/// How a verb ends that got no configuration.
pub fn exit_of(error: &ConfigError) -> Exit {
    match error {
        ConfigError::Faults { .. } => Exit::Config,
        ConfigError::Unreadable { source, .. } if source.kind() == io::ErrorKind::NotFound => {
            Exit::NoFile
        }
        ConfigError::Unreadable { .. } => Exit::Io,
    }
}

/// Tells why there is no configuration, every fault of it, and how the verb ends.
pub fn explain_config(error: &ConfigError) -> Exit {
    match error {
        ConfigError::Unreadable { source, .. } => {
            complain(format_args!("gaiter: {}: {source}", shown(error)));
            complain("  hint: name the configuration with --config FILE");
        }
        ConfigError::Faults { faults, .. } => {
            faults.iter().for_each(complain);
            complain(format_args!("gaiter: {}", shown(error)));
        }
    }
    exit_of(error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_cannot_forge_a_line() {
        let forged = "a\r\n\u{1b}[2Jgaiter: b.obj\u{9b}\u{2028}\u{202e}\t\u{7f}";
        let escaped = r"a\r\n\u{1b}[2Jgaiter: b.obj\u{9b}\u{2028}\u{202e}\t\u{7f}";
        assert_eq!(shown(forged), escaped);
        let honest = "Jürgen's \"Müßig\" – 扫描.obj";
        assert_eq!(shown(honest), honest);
    }
}
