//! The command line: the verbs, each in the file of its name or with related verbs; their options are in [`args`].

pub mod act;
pub mod args;
pub mod ask;
pub mod calibrate;
pub mod check;
pub mod compare;
pub mod demo;
pub mod exit;
pub mod extract;
pub mod manual;
pub mod ord;
pub mod order;
pub mod parallel;
mod person;
pub mod reextract;
pub mod report;
pub mod run;
pub mod scans;
pub mod sizes;
pub mod status;
pub mod terminal;

use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::error::ErrorKind;
use gaiter_record::ReportChoice;
use gaiter_sizes::Garment;
use jiff::Zoned;
use serde::Serialize;

use crate::config::{self, Config, ConfigError};
use crate::station::operator::control::protocol::Request;
use args::{Args, Verb, usual_config};
pub use exit::Exit;

/// Runs the verb of the command line. The exit codes are those of [`Exit`].
pub fn main() -> ExitCode {
    let exit = match Args::of_process() {
        Ok(args) => dispatch(args.verb),
        Err(error) => explain(&error),
    };
    exit.into()
}

fn dispatch(verb: Verb) -> Exit {
    match verb {
        Verb::Demo(args) => demo::demo(&args).unwrap_or_else(|exit| exit),
        Verb::Run(args) => run::run(&args).unwrap_or_else(|exit| exit),
        Verb::Extract(args) => extract::extract(&args).unwrap_or_else(|exit| exit),
        Verb::Calibrate(args) => calibrate::calibrate(&args).unwrap_or_else(|exit| exit),
        Verb::Reextract(args) => reextract::reextract(&args).unwrap_or_else(|exit| exit),
        Verb::Report(args) => report::report(&args).unwrap_or_else(|exit| exit),
        Verb::Sizes(args) => sizes::sizes(&args).unwrap_or_else(|exit| exit),
        Verb::Order(args) => order::order(&args).unwrap_or_else(|exit| exit),
        Verb::Compare(args) => compare::compare(&args).unwrap_or_else(|exit| exit),
        Verb::Measure(args) => run::measure(&args),
        Verb::Check(args) => check::check(&args),
        Verb::Status(args) => status::status(&args),
        Verb::Scans(args) => scans::scans(&args),
        Verb::Show(args) => scans::show(&args),
        Verb::Explain(args) => scans::explain(&args),
        Verb::Retry(args) => ask::sentence(&args.ask, &Request::Retry { scan: args.scan }),
        Verb::Release(args) => ask::sentence(&args.ask, &Request::Release { scan: args.scan }),
        Verb::Assign(args) => act::assign(&args),
        Verb::Unassign(args) => act::unassign(&args),
        Verb::GiveUp(args) => ask::sentence(&args.ask, &Request::GiveUp { scan: args.scan }),
        Verb::Amend(args) => act::amend(&args),
        Verb::Patient(verb) => act::patient(&verb),
        Verb::GdtOrder(args) => act::order(&args),
        Verb::Page(args) => ask::sentence(&args, &Request::Page),
        Verb::Pause(args) => ask::sentence(&args, &Request::Pause),
        Verb::Resume(args) => ask::sentence(&args, &Request::Resume),
        Verb::Schema(args) => manual::schema(&args),
        Verb::Completions(args) => manual::completions(&args),
        Verb::Man(args) => manual::man(&args),
    }
}

/// Prints clap's message. Requested help and version text are no fault. For everything else the
/// documented exit code is used, not clap's 2.
fn explain(error: &clap::Error) -> Exit {
    let asked_for = !error.use_stderr();
    // clap writes to a closed pipe without a panic, and then no reader is left.
    let _ = error.print();
    let is_patient = std::env::args_os().nth(1).is_some_and(|verb| verb == "patient");
    if error.kind() == ErrorKind::InvalidSubcommand && is_patient {
        complain("  hint: gaiter patient set asks for the id of the next patient");
    }
    if asked_for { Exit::Done } else { Exit::Usage }
}

/// Writes text to standard output unchanged. A reader that has gone away (`gaiter … | head`) needs no
/// more, so that is no fault.
///
/// # Errors
/// Anything else that prevents the write, typically a full disk.
pub fn print(text: impl Display) -> io::Result<()> {
    print_to(io::stdout().lock(), text.to_string().as_bytes())
}

/// Writes bytes to an output as [`print()`] does; they need not be UTF-8.
///
/// # Errors
/// See [`print()`].
pub fn print_to(mut out: impl Write, bytes: &[u8]) -> io::Result<()> {
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

/// Writes a value as JSON, for programs, as [`print()`] does.
///
/// # Errors
/// See [`print()`].
pub fn print_json(value: &impl Serialize) -> io::Result<()> {
    print(serde_json::to_string_pretty(value)? + "\n")
}

/// The exit of a verb after it printed this; a failure to print is reported.
pub fn exit_of_printing(what: &str, printed: io::Result<()>) -> Exit {
    match printed {
        Ok(()) => Exit::Done,
        Err(error) => {
            complain(format_args!("gaiter: {what} cannot be printed: {error}"));
            Exit::Io
        }
    }
}

/// Writes a diagnostic line to standard error. A failure is ignored, because it cannot be reported.
pub fn complain(text: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Prints why a verb failed, and returns its exit.
pub fn failed<F: Display>(fault: &F) -> Exit
where
    for<'f> Exit: From<&'f F>,
{
    complain(format_args!("gaiter: {fault}"));
    Exit::from(fault)
}

/// Text from outside, typically a file name, on one line; see [`gaiter_toml::printable`].
pub fn terminal_safe(text: impl Display) -> String {
    gaiter_toml::printable(&text.to_string())
}

/// The configuration for a verb that needs it.
///
/// # Errors
/// The exit of the verb if it cannot be read or has faults; all are printed.
pub fn config_at(path: &Path) -> Result<Config, Exit> {
    config::read(path).map_err(|error| explain_config(&error))
}

/// The configuration for a verb that also works on a machine without a station; `None` if there is none at the
/// usual place.
///
/// # Errors
/// The exit of the verb if it cannot be read or has faults; all are printed.
pub fn config_if_any(path: &Path) -> Result<Option<Config>, Exit> {
    match config::read(path) {
        Ok(config) => Ok(Some(config)),
        Err(ConfigError::Unreadable { source, .. })
            if source.kind() == io::ErrorKind::NotFound && path == usual_config() =>
        {
            Ok(None)
        }
        Err(error) => Err(explain_config(&error)),
    }
}

/// How reports are made today, and the garments that can be ordered; the defaults without a configuration.
pub fn report_choice(config: Option<&Config>) -> (ReportChoice, Vec<Garment>) {
    match config {
        Some(config) => (config.report_choice(Zoned::now().date()), config.garments.clone()),
        None => (ReportChoice::default(), Garment::shipped().to_vec()),
    }
}

/// Prints why there is no usable configuration, with every fault in it, and returns the exit.
pub fn explain_config(error: &ConfigError) -> Exit {
    match error {
        ConfigError::Unreadable { source, .. } => {
            complain(format_args!("gaiter: {}: {source}", terminal_safe(error)));
            complain(match source.kind() {
                io::ErrorKind::PermissionDenied => {
                    "  hint: the station's user must be able to read it: chmod 644"
                }
                _ => "  hint: name the configuration with --config FILE, or in GAITER_CONFIG",
            });
        }
        ConfigError::Faults { faults, .. } => {
            faults.iter().for_each(|fault| complain(format_args!("{fault:#}")));
            complain(format_args!("gaiter: {}", terminal_safe(error)));
        }
    }
    Exit::from(error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_cannot_forge_a_line() {
        let forged = "a\r\n\u{1b}[2Jgaiter: b.obj\u{9b}\u{2028}\u{202e}\t\u{7f}";
        let escaped = r"a\r\n\u{1b}[2Jgaiter: b.obj\u{9b}\u{2028}\u{202e}\t\u{7f}";
        assert_eq!(terminal_safe(forged), escaped);
        let honest = "Jürgen's \"Müßig\" – 扫描.obj";
        assert_eq!(terminal_safe(honest), honest);
    }
}
