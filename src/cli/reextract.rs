//! `gaiter reextract`: applies today's method to stored scans and keeps the old results.
//!
//! A station may run at the same time; see [`crate::store::revision`].

mod again;
mod choices;
mod report;

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::json;

use super::args::ReextractArgs;
use super::parallel::{in_order, usual_jobs};
use super::terminal;
use super::terminal::progress::Progress;
use super::{Exit, complain, exit_of_printing, print, terminal_safe};
use crate::station::runtime::chain;
use crate::store::revision::{Family, clear_staging, families};
use crate::store::{Access, StoreFault};
use again::{Again, Intent, ReextractFault, ReextractOutcome, again};
use choices::Choices;
use report::{ReextractEntry, report};

/// Measures the scan of every record again and returns the worst exit.
pub fn reextract(args: &ReextractArgs) -> Result<Exit, Exit> {
    let choices = Choices::from_config(args.config.as_deref())?;
    let mut records = records(&args.records)?;
    let all = records.len();
    records.retain(|family| args.since.is_none_or(|since| family.latest().0.first_seen >= since));
    if !args.dry_run {
        clear(&records);
    }
    Access::open_umask();
    let intent = Intent { complete: args.complete, dry_run: args.dry_run };
    let jobs = args.jobs.unwrap_or_else(usual_jobs);
    let progress = Progress::new(records.len(), "measuring again");
    let (mut worst, mut entries) = (Exit::Done, Vec::new());
    let work = |family: &Family| {
        let done = again(family, &choices, intent);
        progress.advance();
        done
    };
    in_order(&records, jobs, work, |family, done| {
        let done = done.unwrap_or_else(|panic| Err(ReextractFault::Panic(panic)));
        let (exit, one) = progress.aside(|| print_entry(args, family, done));
        worst = worst.max(exit);
        entries.extend(one);
    });
    drop(progress);
    if !args.json {
        let left_out = all - records.len();
        let printed =
            terminal::print_painted(report(&entries, records.len() - entries.len(), left_out));
        worst = worst.max(exit_of_printing("the result", printed));
    }
    Ok(worst)
}

/// The records at a path, at least one.
fn records(at: &Path) -> Result<Vec<Family>, Exit> {
    // The folder's own name may show that it belongs to a record or a patient.
    let whole = at.canonicalize().unwrap_or_else(|_| at.to_owned());
    let fault = match families(&whole) {
        Ok(records) if records.is_empty() => {
            complain(format_args!(
                "gaiter: {}: no record was found there",
                terminal_safe(at.display())
            ));
            complain("  hint: name the store's folder, [store.folder] path in the configuration");
            return Err(Exit::NoFile);
        }
        Ok(records) => return Ok(records),
        Err(fault) => fault,
    };
    complain(format_args!(
        "gaiter: {}: {}",
        terminal_safe(at.display()),
        terminal_safe(chain(&fault))
    ));
    match fault {
        StoreFault::Transient { source, .. } => Err(Exit::from(&source)),
        _ => Err(Exit::Io),
    }
}

/// Removes what killed runs left next to these records. A failure is ignored, because the leftovers only
/// look untidy.
fn clear(records: &[Family]) {
    let patients: BTreeSet<&Path> =
        records.iter().map(|family| family.patient_folder.as_path()).collect();
    for patient in patients {
        let _ = clear_staging(patient);
    }
}

/// Prints the part of a record's result that cannot wait for the final report. Returns the exit and the
/// report's entry.
fn print_entry(
    args: &ReextractArgs,
    family: &Family,
    done: Result<Again, ReextractFault>,
) -> (Exit, Option<ReextractEntry>) {
    let (name, folder) = family.latest();
    let name = if args.names { terminal_safe(folder.display()) } else { name.scan.clone() };
    let exit = done.as_ref().map_or_else(Exit::from, |_| Exit::Done);
    if args.json {
        let printed = exit_of_printing("the result", json_line(args, family, &done));
        return (exit.max(printed), done.ok().map(|again| ReextractEntry { name, again }));
    }
    match done {
        Ok(again) => (exit, Some(ReextractEntry { name, again })),
        Err(fault) => {
            let code = fault.code();
            complain(format_args!("gaiter: {name}: not measured again [{code}]: {fault}"));
            (exit, None)
        }
    }
}

/// Prints one record as JSON, for programs.
fn json_line(
    args: &ReextractArgs,
    family: &Family,
    done: &Result<Again, ReextractFault>,
) -> std::io::Result<()> {
    let (name, folder) = family.latest();
    let mut line = match done {
        Ok(again) => serde_json::to_value(again)?,
        Err(fault) => json!({
            "outcome": "not_measured",
            "fault": { "code": fault.code(), "message": fault.to_string() },
        }),
    };
    line["scan"] = json!(name.scan);
    line["first_seen"] = json!(name.first_seen);
    if args.names {
        line["folder"] = json!(folder.display().to_string());
    }
    print(format_args!("{line}\n"))
}
