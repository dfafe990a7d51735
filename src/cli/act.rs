//! `gaiter retry`, `release`, `assign`, `unassign`, `give-up`, `patient`, `page`, `pause` and `resume`: what a
//! person decides.

use std::io::{self, BufRead, IsTerminal, Read, Write};

use super::args::{AskArgs, OneArgs, PatientVerb};
use super::{Exit, ask, complain};
use crate::station::operator::control::protocol::Request;

/// No patient's id is longer, bytes.
const ID_MOST: u64 = 1024;

/// A refused scan is to be tried again.
pub fn retry(args: &OneArgs) -> Exit {
    ask::sentence(&args.ask, &Request::Retry { scan: args.scan.clone() })
}

/// A held scan is to be delivered.
pub fn release(args: &OneArgs) -> Exit {
    ask::sentence(&args.ask, &Request::Release { scan: args.scan.clone() })
}

/// A scan is this patient's.
pub fn assign(args: &OneArgs) -> Exit {
    with_patient(&args.ask, |patient| Request::Assign { scan: args.scan.clone(), patient })
}

/// A scan is not its patient's.
pub fn unassign(args: &OneArgs) -> Exit {
    ask::sentence(&args.ask, &Request::Unassign { scan: args.scan.clone() })
}

/// A refused or held scan needs no decision any more.
pub fn give_up(args: &OneArgs) -> Exit {
    ask::sentence(&args.ask, &Request::GiveUp { scan: args.scan.clone() })
}

/// Whose the next scan is.
pub fn patient(verb: &PatientVerb) -> Exit {
    match verb {
        PatientVerb::Set(args) => {
            with_patient(args, |patient| Request::NameNext { patient, replace: true })
        }
        PatientVerb::Clear(args) => ask::sentence(args, &Request::CallOff),
        PatientVerb::Show(args) => ask::sentence(args, &Request::Next),
    }
}

/// Asks with the patient's id that a person gives.
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

/// The patient's id: a line of standard input, asked for where a person sits at it.
fn read_patient() -> io::Result<String> {
    let stdin = io::stdin();
    if stdin.is_terminal() {
        let mut screen = io::stderr().lock();
        screen.write_all(b"patient's id: ")?;
        screen.flush()?;
    }
    let mut line = String::new();
    stdin.lock().take(ID_MOST).read_line(&mut line)?;
    Ok(line.trim().to_owned())
}

/// Where the operator's page is.
pub fn page(args: &AskArgs) -> Exit {
    ask::sentence(args, &Request::Page)
}

/// No scan is to be taken until somebody resumes.
pub fn pause(args: &AskArgs) -> Exit {
    ask::sentence(args, &Request::Pause)
}

/// Go on.
pub fn resume(args: &AskArgs) -> Exit {
    ask::sentence(args, &Request::Resume)
}
