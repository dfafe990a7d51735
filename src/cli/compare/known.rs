//! What the station knows of a patient whose visits are compared. A comparison is made without it, too: it then
//! states what is not known.

use std::error::Error;
use std::path::Path;

use gaiter_flow::patient::person::KnownVisits;

use crate::cli::ask::{AskFault, ask};
use crate::cli::{complain, terminal_safe};
use crate::config;
use crate::station::operator::control::protocol::{ControlAnswer, Request};
use crate::station::persons::stopped::{Stopped, StoppedFault};
use crate::station::runtime::chain;

/// What the station of a configuration knows of a patient, from its state folder while none runs; nothing if no station
/// ever ran.
pub(super) fn known(config: &Path, patient: &str) -> KnownVisits {
    let unreported = |fault: &dyn Error| {
        complain(format_args!(
            "gaiter: the station does not say what it knows of this patient, so no record that was \
             removed is noticed, and only --affected names a leg: {}",
            terminal_safe(chain(fault))
        ));
        KnownVisits::default()
    };
    match ask(config, &Request::Visits { patient: patient.to_owned() }) {
        Ok(ControlAnswer::Visits(known)) => known,
        Ok(_) => unreported(&AskFault::another_answer()),
        Err(AskFault::NoStation { .. }) => match config::read(config) {
            Ok(config) => match Stopped::take(config).and_then(|of| of.visits(patient)) {
                Ok(known) => known,
                Err(StoppedFault::NoStation(_)) => KnownVisits::default(),
                Err(fault) => unreported(&fault),
            },
            Err(error) => unreported(&error),
        },
        Err(fault) => unreported(&fault),
    }
}
