//! The station that is asked about a person: the running one, or its state folder while none runs.

use std::env;
use std::io;
use std::path::Path;

use gaiter_flow::patient::erasure::Erasure;
use gaiter_flow::patient::person::Person;
use gaiter_language::Language;
use jiff::Timestamp;

use crate::cli::ask::{AskFault, ask, language, read_patient};
use crate::cli::{Exit, terminal_safe};
use crate::config;
use crate::station::StationError;
use crate::station::operator::control::protocol::{ControlAnswer, Request};
use crate::station::persons::stopped::{Stopped, StoppedFault};
use crate::station::runtime::chain;

/// Why a person was neither disclosed nor erased.
#[derive(Debug, thiserror::Error)]
pub(super) enum PersonFault {
    /// The running station did not answer, or refused.
    #[error("{}", terminal_safe(.0))]
    Ask(#[from] AskFault),
    /// The state folder of the stopped one cannot be used.
    #[error("{}", terminal_safe(chain(.0)))]
    Stopped(#[from] StoppedFault),
    /// The id cannot be read.
    #[error("the patient's id cannot be read: {0}")]
    NoId(io::Error),
    /// No id was given.
    #[error("no patient's id was given; nothing was done")]
    EmptyId,
    /// The second id is another one, or missing.
    #[error("the id was not given a second time in the same way; nothing was erased")]
    NotAgain,
    /// Nothing is known of the patient.
    #[error("the station holds nothing of this patient")]
    Unknown,
    /// A scan of the patient is expected.
    #[error("a scan of this patient is expected; nothing was erased")]
    Awaited,
    /// A file or folder cannot be read or written.
    #[error("{what} {path}: {source}")]
    File { what: &'static str, path: String, source: io::Error },
    /// The folder is there already.
    #[error("{0} is there already; nothing was written: choose another folder with --out DIR")]
    There(String),
    /// The answer cannot be printed.
    #[error("cannot print the answer: {0}")]
    Print(io::Error),
}

impl From<&PersonFault> for Exit {
    fn from(fault: &PersonFault) -> Exit {
        match fault {
            PersonFault::Ask(fault) => Exit::from(fault),
            PersonFault::EmptyId
            | PersonFault::NotAgain
            | PersonFault::Awaited
            | PersonFault::There(_) => Exit::Usage,
            PersonFault::Unknown | PersonFault::Stopped(StoppedFault::NoStation(_)) => Exit::NoFile,
            PersonFault::Stopped(_)
            | PersonFault::NoId(_)
            | PersonFault::File { .. }
            | PersonFault::Print(_) => Exit::Io,
        }
    }
}

impl PersonFault {
    /// Whether the station ended, or was away, before it answered.
    pub(super) fn is_silence(&self) -> bool {
        matches!(self, PersonFault::Ask(AskFault::Io(_) | AskFault::NoStation { .. }))
    }

    /// What the operator can do, if anything.
    pub(super) fn hint(&self) -> Option<String> {
        match self {
            PersonFault::Ask(fault) => fault.hint(Language::En),
            PersonFault::Stopped(StoppedFault::OtherUser(_)) => {
                Some("run it as the station's user, usually: sudo -u gaiter gaiter …".to_owned())
            }
            PersonFault::Stopped(StoppedFault::Station(StationError::Lock(_))) => {
                Some("the station is about to start or to end: try again".to_owned())
            }
            PersonFault::Awaited => Some("gaiter patient clear, then try again".to_owned()),
            _ => None,
        }
    }
}

/// A station that is asked about a person.
pub(super) struct Reached<'a> {
    config: &'a Path,
    stopped: Option<Stopped>,
    pub language: Language,
}

impl<'a> Reached<'a> {
    /// Reads a patient's id; finds the station of a configuration, and what it holds of the patient.
    pub(super) fn find(config: &'a Path) -> Result<(Reached<'a>, Person), PersonFault> {
        let patient = read_patient().map_err(PersonFault::NoId)?;
        if patient.is_empty() {
            return Err(PersonFault::EmptyId);
        }
        let (stopped, person) = match ask(config, &Request::Person { patient: patient.clone() }) {
            Ok(ControlAnswer::Person(person)) => (None, *person),
            Ok(_) => return Err(AskFault::another_answer().into()),
            Err(AskFault::NoStation { .. }) => {
                let stopped = Stopped::take(config::read(config).map_err(AskFault::Config)?)?;
                let person = stopped.person(&patient)?;
                (Some(stopped), person)
            }
            Err(fault) => return Err(fault.into()),
        };
        if person.is_unknown() {
            return Err(PersonFault::Unknown);
        }
        Ok((Reached { config, stopped, language: language(config) }, person))
    }

    /// Notes in the station's history that a person's data was disclosed.
    pub(super) fn disclosed(&self, patient: &str) -> Result<(), PersonFault> {
        match &self.stopped {
            Some(stopped) => Ok(stopped.disclosed(patient, &user())?),
            None => {
                let patient = patient.to_owned();
                ask(self.config, &Request::Disclosed { patient, by: user() })?;
                Ok(())
            }
        }
    }

    /// Asks for the erasure of a person. Returns what has become of it if that is known at once.
    pub(super) fn erase(
        &self,
        patient: &str,
        leaves_owed: bool,
    ) -> Result<Option<Erasure>, PersonFault> {
        match &self.stopped {
            Some(stopped) => Ok(stopped.erase(patient, &user(), leaves_owed)?),
            None => {
                let (patient, again) = (patient.to_owned(), patient.to_owned());
                ask(self.config, &Request::Erase { patient, again, by: user(), leaves_owed })?;
                Ok(None)
            }
        }
    }

    /// Carries an erasure on that was begun by a station that no longer runs. An erasure that was noted before
    /// `asked` is an earlier one, unless this one `is_noted`.
    ///
    /// # Errors
    /// If the state folder cannot be taken: the station may be about to start.
    pub(super) fn erase_without_station(
        &self,
        patient: &str,
        asked: Timestamp,
        is_noted: bool,
        leaves_owed: bool,
    ) -> Result<Option<Erasure>, PersonFault> {
        let whole = config::read(self.config).map_err(AskFault::Config)?;
        let stopped = Stopped::take(whole)?;
        let is_this = |erasure: &Erasure| is_noted || erasure.at >= asked;
        let found = stopped.erasure(patient).filter(is_this);
        match found.filter(|erasure| erasure.ended.is_some()) {
            Some(ended) => Ok(Some(ended)),
            None => Ok(stopped.erase(patient, &user(), leaves_owed)?),
        }
    }

    /// What has become of the erasure of a person at a running station.
    pub(super) fn erasure(&self, patient: &str) -> Result<Option<Erasure>, PersonFault> {
        let request = Request::Erasure { patient: patient.to_owned() };
        match ask(self.config, &request)? {
            ControlAnswer::Erasure(erasure) => Ok(erasure),
            _ => Err(AskFault::another_answer().into()),
        }
    }
}

/// The user of the machine who runs the verb, as far as it is known.
fn user() -> String {
    let uid = rustix::process::getuid().as_raw();
    match env::var("SUDO_USER") {
        Ok(name) => format!("uid {uid}, for {name}"),
        Err(_) => format!("uid {uid}"),
    }
}
