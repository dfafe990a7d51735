//! `gaiter retry`, `release`, `assign`, `unassign`, `give-up`, `amend`, `patient`, `gdt-order`, `page`,
//! `pause` and `resume`: the operator's decisions.

mod amend;
mod order;

use super::args::{AskArgs, AssignArgs, OneArgs, PatientVerb, UnassignArgs};
use super::ask::read_patient;
use super::{Exit, ask, compare, complain, person};
use crate::station::operator::control::protocol::Request;
pub use amend::amend;
pub use order::order;

/// Tries a refused scan again.
pub fn retry(args: &OneArgs) -> Exit {
    ask::sentence(&args.ask, &Request::Retry { scan: args.scan.clone() })
}

/// Delivers a held scan.
pub fn release(args: &OneArgs) -> Exit {
    ask::sentence(&args.ask, &Request::Release { scan: args.scan.clone() })
}

/// Assigns a scan to a patient.
pub fn assign(args: &AssignArgs) -> Exit {
    let AssignArgs { one, stray } = args;
    if stray.is_some() {
        return not_an_argument(&format!("gaiter assign {}", one.scan));
    }
    with_patient(&one.ask, |patient| Request::Assign { scan: one.scan.clone(), patient })
}

/// Takes a scan back from its patient.
pub fn unassign(args: &UnassignArgs) -> Exit {
    let (scan, asking) = (args.of.scan.clone(), &args.of.ask);
    match args.from {
        true => with_patient(asking, |patient| Request::Unassign { scan, patient: Some(patient) }),
        false => ask::sentence(asking, &Request::Unassign { scan, patient: None }),
    }
}

/// Marks a refused or held scan as needing no further decision.
pub fn give_up(args: &OneArgs) -> Exit {
    ask::sentence(&args.ask, &Request::GiveUp { scan: args.scan.clone() })
}

/// Sets, clears or shows the patient of the next scan; compares visits, names the affected leg, discloses and erases.
pub fn patient(verb: &PatientVerb) -> Exit {
    match verb {
        PatientVerb::Set(args) if args.stray.is_some() => not_an_argument("gaiter patient set"),
        PatientVerb::Set(args) => {
            with_patient(&args.ask, |patient| Request::NameNext { patient, replace: true })
        }
        PatientVerb::Clear(args) => ask::sentence(args, &Request::CallOff),
        PatientVerb::Show(args) => ask::sentence(args, &Request::Next),
        PatientVerb::Visits(args) if args.stray.is_some() => {
            not_an_argument("gaiter patient visits")
        }
        PatientVerb::Visits(args) => compare::visits(&args.how),
        PatientVerb::Affected(args) if args.stray.is_some() => {
            not_an_argument(&format!("gaiter patient affected {}", args.leg))
        }
        PatientVerb::Affected(args) => with_patient(&args.ask, |patient| Request::NameAffected {
            patient,
            affected: args.leg.clone(),
        }),
        PatientVerb::Disclose(args) if args.stray.is_some() => {
            not_an_argument("gaiter patient disclose")
        }
        PatientVerb::Disclose(args) => person::disclose(args),
        PatientVerb::Erase(args) if args.stray.is_some() => not_an_argument("gaiter patient erase"),
        PatientVerb::Erase(args) => person::erase(args),
    }
}

/// Says how to give a patient's id, instead of on the command line.
fn not_an_argument(command: &str) -> Exit {
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

/// Prints the link to the operator's page.
pub fn page(args: &AskArgs) -> Exit {
    ask::sentence(args, &Request::Page)
}

/// Stops taking scans until `gaiter resume`.
pub fn pause(args: &AskArgs) -> Exit {
    ask::sentence(args, &Request::Pause)
}

/// Takes scans again.
pub fn resume(args: &AskArgs) -> Exit {
    ask::sentence(args, &Request::Resume)
}
