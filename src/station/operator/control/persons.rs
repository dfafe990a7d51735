//! What the station answers about one person, and how it takes the wish to erase them.

use gaiter_flow::patient::person::Person;
use gaiter_record::SourceKind;

use super::protocol::{ControlAnswer, ControlFault, ControlFaultKind};
use crate::station::custody::CustodyFault;
use crate::station::operator::page::desk::Desk;
use crate::station::persons::{erase, person, stopped};
use crate::station::runtime::chain;

/// Notes that a person's data was disclosed.
pub(super) fn disclosed(
    desk: &Desk,
    patient: &str,
    by: &str,
) -> Result<ControlAnswer, ControlFault> {
    stopped::disclosed(&desk.core.custody, patient, by)?;
    Ok(ControlAnswer::Sentence(desk.core.config.language.text("act.disclosed").to_owned()))
}

/// All that the station holds of a person.
pub(super) fn known(desk: &Desk, patient: &str) -> Result<Person, ControlFault> {
    let core = &desk.core;
    if core.identity.patient(patient, SourceKind::Operator).is_none() {
        return Err(refused(desk, "patient-id-not-allowed", "act.fault.not_an_id"));
    }
    Ok(person(&core.config, &core.identity, &core.custody, &core.stores, patient)?)
}

/// Asks for the erasure of a person, whose id was given twice.
pub(super) fn erase(
    desk: &Desk,
    patient: &str,
    again: &str,
    by: &str,
    leaves_owed: bool,
) -> Result<ControlAnswer, ControlFault> {
    if patient != again {
        return Err(refused(desk, "ids-differ", "act.fault.ids_differ"));
    }
    if known(desk, patient)?.is_awaited() {
        return Err(refused(desk, "patient-awaited", "act.fault.awaited"));
    }
    erase::ask(&desk.core, patient, by, leaves_owed)?;
    Ok(ControlAnswer::Sentence(desk.core.config.language.text("act.erasing").to_owned()))
}

/// A request that is refused, with the text of a key.
fn refused(desk: &Desk, code: &str, key: &'static str) -> ControlFault {
    desk.fault(ControlFaultKind::Request, code, |language| language.text(key).to_owned())
}

impl From<CustodyFault> for ControlFault {
    fn from(fault: CustodyFault) -> ControlFault {
        ControlFault::new(ControlFaultKind::Failed, "custody-failed", chain(&fault))
    }
}
