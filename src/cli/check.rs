//! `gaiter check`: checks the configuration and, if it has no fault, the folders and disks it names.

mod booth;
mod environment;
mod names;
mod readers;
mod row;
mod servers;
mod tables;
mod unit;

use std::path::Path;

use anstyle::Style;
use serde::Serialize;

use super::args::CheckArgs;
use super::terminal::{self, painted};
use super::{Exit, ask, exit_of_printing, explain_config, print_json, terminal_safe};
use crate::config::{self, Config, ConfigError, ConfigFault};
use crate::station::operator::control::protocol::{ControlAnswer, Request};
use crate::station::operator::control::status::{ComplaintStatus, Status};
use row::{Example, Row, Verdict};

/// Checks the configuration, then the environment, and prints both.
///
/// A fault of the environment, such as a share that is down today, is no reason to change the
/// configuration file. So it has an exit code of its own.
pub fn check(args: &CheckArgs) -> Exit {
    let read = config::read(&args.config);
    let checks = read.as_ref().map(|config| around(&args.config, config)).unwrap_or_default();
    let exit = read.as_ref().map_or_else(Exit::from, |_| worst(&checks));
    let printed = match (args.json, read) {
        (true, read) => print_json(&Report::new(&args.config, exit, read.err(), checks)),
        (false, Ok(_)) => {
            let mut rows = vec![Row::ok("configuration", &args.config, "no fault")];
            rows.extend(checks);
            terminal::print_painted(table(&rows))
        }
        (false, Err(error)) => return explain_config(&error),
    };
    exit.max(exit_of_printing("the result", printed))
}

/// The checks of what is around the station: folders and disks, who may read, servers, the system's service, the
/// booth; and what the running station advises.
fn around(file: &Path, config: &Config) -> Vec<Row> {
    let running = match ask::ask(file, &Request::Status) {
        Ok(ControlAnswer::Status(status)) => Some(status),
        _ => None,
    };
    let mut rows = environment::rows(config);
    rows.extend(tables::rows(config));
    rows.extend(readers::rows(config));
    rows.extend(servers::rows(config));
    rows.extend(unit::rows(file, config));
    rows.extend(booth::rows(config, running.as_deref()));
    rows.extend(running.iter().flat_map(|status| moved(status)));
    rows.extend(running.and_then(|status| habit(config, &status)));
    rows
}

/// Records that the running station is to take back from a server at an earlier address.
fn moved(status: &Status) -> Vec<Row> {
    let moved = status.complaints.iter().filter(|of| of.complaint.code == "store-moved");
    let row = |of: &ComplaintStatus| {
        let place = of.complaint.subject.as_deref().unwrap_or_default();
        Row::at("take-backs", place, Verdict::Warn, format!("{}: {}", of.message, of.remedy))
    };
    moved.map(row).collect()
}

/// The running station's advice if the configuration does not fit the orders it has seen from the practice.
fn habit(config: &Config, status: &Status) -> Option<Row> {
    config.patient.orders.as_ref()?;
    let advice = status.booth.advice.clone()?;
    Some(Row::at("orders", "patient.orders.when", Verdict::Warn, advice))
}

fn worst(rows: &[Row]) -> Exit {
    let failed = rows.iter().any(|row| row.verdict == Verdict::Fail);
    if failed { Exit::Io } else { Exit::Done }
}

fn colour(verdict: Verdict) -> Style {
    match verdict {
        Verdict::Ok => terminal::GOOD,
        Verdict::Warn => terminal::CARE,
        Verdict::Fail => terminal::BAD,
    }
}

/// One row per check with aligned columns, then the totals.
fn table(rows: &[Row]) -> String {
    let width = |of: fn(&Row) -> &str| rows.iter().map(|row| of(row).chars().count()).max();
    let check = width(|row| row.check).unwrap_or(0);
    let place = width(|row| &row.place).unwrap_or(0);
    let mut text: String = rows
        .iter()
        .map(|row| {
            let Row { verdict, detail, .. } = row;
            let verdict = painted(colour(*verdict), format_args!("{:4}", verdict.word()));
            let examples: String = row.examples.iter().map(example).collect();
            format!("{verdict}  {:check$}  {:place$}  {detail}\n{examples}", row.check, row.place)
        })
        .collect();
    let count = |verdict| rows.iter().filter(|row| row.verdict == verdict).count();
    let (ok, warn, fail) = (count(Verdict::Ok), count(Verdict::Warn), count(Verdict::Fail));
    text += &format!("{ok} ok, {warn} to check, {fail} failed\n");
    text
}

/// A file name and the patient it names, printed below the check that found them.
fn example(example: &Example) -> String {
    format!("      {} → {}\n", terminal_safe(&example.name), terminal_safe(&example.patient))
}

/// What `--json` prints: one object in every case.
#[derive(Debug, Serialize)]
struct Report {
    /// The path of the file as given on the command line.
    config: String,
    /// The exit code: 0, 66, 74 or 78.
    exit: u8,
    /// Why the file could not be read, if it could not.
    unreadable: Option<String>,
    faults: Vec<ConfigFault>,
    /// The checks of the environment; empty if the configuration has faults.
    checks: Vec<Row>,
}

impl Report {
    fn new(file: &Path, exit: Exit, error: Option<ConfigError>, checks: Vec<Row>) -> Report {
        let (unreadable, faults) = match error {
            None => (None, Vec::new()),
            Some(ConfigError::Unreadable { source, .. }) => (Some(source.to_string()), Vec::new()),
            Some(ConfigError::Faults { faults, .. }) => (None, faults),
        };
        let (config, exit) = (file.display().to_string(), exit.code());
        Report { config, exit, unreadable, faults, checks }
    }
}
