//! `gaiter amend`: a person sets a measure of a record, at the running station or in a folder.

use std::path::Path;

use gaiter_record::measure::amendment::Deed;
use gaiter_record::rounding;
use gaiter_record::{RECORD, ReportChoice};
use jiff::Timestamp;
use serde_json::json;

use super::with_patient;
use crate::cli::args::{AmendArgs, Named};
use crate::cli::terminal::{self, screen, table};
use crate::cli::{Exit, ask, complain, config_if_any, print, report_choice, terminal_safe};
use crate::station::operator::act::{Measured, Setting};
use crate::station::operator::control::protocol::Request;
use crate::station::runtime::chain;
use crate::store::revision::amend::{AmendRecordFault, Amended, amend_record};

/// Sets the measure.
pub fn amend(args: &AmendArgs) -> Exit {
    let setting = Setting {
        measures: vec![measured(args)],
        reason: args.reason.clone(),
        by: args.by.clone(),
        is_sure: args.sure,
    };
    match Named::from_arg(&args.record) {
        Named::Scan(scan) => {
            let request = |patient| Request::Amend { scan, patient, setting };
            match args.of {
                true => with_patient(&args.ask, |patient| request(Some(patient))),
                false => ask::sentence(&args.ask, &request(None)),
            }
        }
        Named::File(path) => in_folder(args, &path, &setting).unwrap_or_else(|exit| exit),
    }
}

/// What the command line sets.
fn measured(args: &AmendArgs) -> Measured {
    // As in the record: to a thousandth of a millimetre.
    let mm = |cm: Option<f64>| cm.map(|cm| rounding::mm(cm * 10.0));
    let is = match (args.not_measurable, args.take_back) {
        (true, _) => Deed::NotMeasurable,
        (_, true) => Deed::TakenBack,
        _ => Deed::Measured,
    };
    Measured {
        leg: args.leg.word().to_owned(),
        measure: args.level.word().to_owned(),
        is,
        girth_mm: mm(args.girth_cm),
        height_mm: mm(args.height_cm),
        length_mm: mm(args.length_cm),
    }
}

/// Amends the record in a folder, without a station.
fn in_folder(args: &AmendArgs, path: &Path, setting: &Setting) -> Result<Exit, Exit> {
    let (choice, _) = report_choice(config_if_any(&args.ask.config)?.as_ref());
    // The record's own file names its folder, too; no other file does.
    let is_record = path.file_name().is_some_and(|name| name == RECORD);
    let folder = path.parent().filter(|_| is_record && path.is_file()).unwrap_or(path);
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    if folder.is_file() {
        return Err(refused(args, path, &AmendRecordFault::NoRecord));
    }
    let amended = amend_record(folder, &setting.amendments(Timestamp::now()), args.sure, &choice);
    let amended = amended.map_err(|fault| refused(args, path, &fault))?;
    Ok(report_amended(args, &amended, &choice))
}

fn report_amended(args: &AmendArgs, amended: &Amended, choice: &ReportChoice) -> Exit {
    let Amended { folder, record } = amended;
    let text = match args.ask.json {
        true => {
            let folder = folder.display().to_string();
            format!("{}\n", json!({ "folder": folder, "revision": record.revision }))
        }
        false => {
            let table = table::render(record, &choice.garment, screen::columns());
            format!("{}\n{table}\n", terminal_safe(folder.display()))
        }
    };
    match terminal::print_painted(text) {
        Ok(()) => Exit::Done,
        Err(error) => {
            complain(format_args!("gaiter: the record is amended, but: {error}"));
            Exit::Io
        }
    }
}

fn refused(args: &AmendArgs, path: &Path, fault: &AmendRecordFault) -> Exit {
    let (code, exit) = match fault {
        AmendRecordFault::NoRecord => ("no-record", Exit::NoFile),
        AmendRecordFault::Amend(fault) if fault.is_far_off() => ("measure-far-off", Exit::Usage),
        AmendRecordFault::Amend(_) => ("measure-not-possible", Exit::Usage),
        AmendRecordFault::Stored(fault) => (fault.code(), Exit::Unmeasurable),
        AmendRecordFault::OtherVersion(_)
        | AmendRecordFault::Withdrawn
        | AmendRecordFault::Meanwhile => ("record-not-amended", Exit::Unmeasurable),
        AmendRecordFault::Files(_) => ("record-not-written", Exit::Internal),
        AmendRecordFault::Unlisted(_) | AmendRecordFault::Io(_) => ("record-io", Exit::Io),
    };
    let message = format!(
        "{}: nothing was set: {}",
        terminal_safe(path.display()),
        terminal_safe(chain(fault))
    );
    if args.ask.json {
        let fault = json!({ "fault": { "code": code, "message": message, "exit": exit.code() } });
        // If printing fails, the exit code still informs the caller.
        let _ = print(format_args!("{fault:#}\n"));
    } else {
        complain(format_args!("gaiter: {message} [{code}]"));
        if code == "measure-far-off" {
            complain("  hint: --sure sets it all the same");
        }
    }
    exit
}
