//! The operator's decisions: `gaiter assign`, `unassign`, `amend`, `patient` and `gdt-order`. Those that only send a
//! request are in the dispatch of the verbs.

mod amend;

use std::ffi::OsString;
use std::fs::File;
use std::io::Read;

use gaiter_record::gdt::order::ORDER_MOST;

use super::args::{AskArgs, AssignArgs, GdtOrderArgs, PatientVerb, UnassignArgs};
use super::ask::read_patient;
use super::{Exit, ask, compare, complain, person, terminal_safe};
use crate::station::operator::control::protocol::Request;
pub use amend::amend;

/// Assigns a scan to a patient.
pub fn assign(args: &AssignArgs) -> Exit {
    let AssignArgs { one, stray } = args;
    let request = |patient| Request::Assign { scan: one.scan.clone(), patient };
    let command = format!("gaiter assign {}", one.scan);
    unless_given(stray.as_ref(), &command, || with_patient(&one.ask, request))
}

/// Takes a scan back from its patient.
pub fn unassign(args: &UnassignArgs) -> Exit {
    let (scan, asking) = (args.of.scan.clone(), &args.of.ask);
    match args.from {
        true => with_patient(asking, |patient| Request::Unassign { scan, patient: Some(patient) }),
        false => ask::sentence(asking, &Request::Unassign { scan, patient: None }),
    }
}

/// Sets, clears or shows the patient of the next scan; compares visits, names the affected leg, discloses and erases.
pub fn patient(verb: &PatientVerb) -> Exit {
    match verb {
        PatientVerb::Set(args) => unless_given(args.stray.as_ref(), "gaiter patient set", || {
            with_patient(&args.ask, |patient| Request::NameNext { patient, replace: true })
        }),
        PatientVerb::Clear(args) => ask::sentence(args, &Request::CallOff),
        PatientVerb::Show(args) => ask::sentence(args, &Request::Next),
        PatientVerb::Visits(args) => {
            let command = "gaiter patient visits";
            unless_given(args.stray.as_ref(), command, || {
                compare::visits(&args.how).unwrap_or_else(|exit| exit)
            })
        }
        PatientVerb::Affected(args) => {
            let command = format!("gaiter patient affected {}", args.leg);
            let request = |patient| Request::NameAffected { patient, affected: args.leg.clone() };
            unless_given(args.stray.as_ref(), &command, || with_patient(&args.ask, request))
        }
        PatientVerb::Disclose(args) => {
            let command = "gaiter patient disclose";
            unless_given(args.stray.as_ref(), command, || person::disclose(args))
        }
        PatientVerb::Erase(args) => {
            let command = "gaiter patient erase";
            unless_given(args.stray.as_ref(), command, || person::erase(args))
        }
    }
}

/// Does what a verb does, unless a patient's id is on the command line: then it prints how to give it instead.
fn unless_given(stray: Option<&OsString>, command: &str, does: impl FnOnce() -> Exit) -> Exit {
    if stray.is_none() {
        return does();
    }
    complain(format_args!(
        "gaiter: a patient's id is never an argument, because every user of the machine can read \
         arguments; nothing was changed\n  hint: run {command} and type the id when it is asked for, \
         or hand it over on standard input"
    ));
    Exit::Usage
}

/// Reads the patient's id from the operator and sends the request with it.
fn with_patient(args: &AskArgs, request: impl FnOnce(String) -> Request) -> Exit {
    match read_patient() {
        Ok(patient) if patient.is_empty() => {
            complain("gaiter: no patient's id was given; nothing was changed");
            Exit::Usage
        }
        Ok(patient) => ask::sentence(args, &request(patient)),
        Err(error) => {
            complain(format_args!("gaiter: the patient's id cannot be read: {error}"));
            Exit::Io
        }
    }
}

/// Sends an order to the running station.
pub fn order(args: &GdtOrderArgs) -> Exit {
    let mut bytes = Vec::new();
    // Reads one byte more than an order can have, so that the station sees that it is too large.
    let read =
        File::open(&args.file).and_then(|file| file.take(ORDER_MOST + 1).read_to_end(&mut bytes));
    match read {
        Ok(_) => ask::sentence(&args.ask, &Request::Order { bytes }),
        Err(error) => {
            complain(format_args!("gaiter: {}: {error}", terminal_safe(args.file.display())));
            Exit::from(&error)
        }
    }
}
