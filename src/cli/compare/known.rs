//! What the station knows of a patient whose visits are compared. A comparison is made without it, too: it is then
//! said what cannot be told.

use std::path::Path;

use gaiter_flow::patient::person::KnownVisits;

use crate::cli::ask::{AskFault, ask};
use crate::cli::{complain, shown};
use crate::config::{self, ConfigError};
use crate::station::operator::control::protocol::{Answer, Request};
use crate::station::persons::stopped::{Stopped, StoppedFault};
use crate::station::runtime::causes::chain;

/// Why the station does not say.
#[derive(Debug, thiserror::Error)]
enum Unknown {
    /// The running station did not answer, or refused.
    #[error(transparent)]
    Ask(#[from] AskFault),
    /// The state folder of the stopped one cannot be used.
    #[error(transparent)]
    Stopped(#[from] StoppedFault),
}

/// What the station of a configuration knows of a patient; nothing if no station ever ran.
pub(super) fn known(config: &Path, patient: &str) -> KnownVisits {
    match asked(config, patient) {
        Ok(known) => known,
        Err(Unknown::Stopped(StoppedFault::NoStation(_))) => KnownVisits::default(),
        Err(fault) => {
            complain(format_args!(
                "gaiter: the station does not say what it knows of this patient, so no record that was \
                 removed is noticed, and only --affected names a leg: {}",
                shown(chain(&fault))
            ));
            KnownVisits::default()
        }
    }
}

/// Asks the running station, or reads its state folder while none runs.
fn asked(config: &Path, patient: &str) -> Result<KnownVisits, Unknown> {
    match ask(config, &Request::Visits { patient: patient.to_owned() }) {
        Ok(Answer::Visits(known)) => Ok(known),
        Ok(_) => Err(AskFault::another_answer().into()),
        Err(AskFault::NoStation { .. }) => {
            let config =
                config::read(config).map_err(|error: ConfigError| AskFault::from(error))?;
            Ok(Stopped::take(config)?.visits(patient)?)
        }
        Err(fault) => Err(fault.into()),
    }
}
