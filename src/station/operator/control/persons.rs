//! What the station answers about one person, and how it takes the wish to erase them.

use gaiter_flow::patient::person::Person;
use gaiter_record::SourceKind;

use super::protocol::{Answer, Fault, FaultKind, Request};
use crate::station::custody::CustodyFault;
use crate::station::operator::page::desk::Desk;
use crate::station::persons::{erase, person, stopped};
use crate::station::runtime::causes::chain;

/// Answers a request about a person.
pub(super) fn answer(desk: &Desk, request: &Request) -> Result<Answer, Fault> {
    match request {
        Request::Person { patient } => {
            known(desk, patient).map(|person| Answer::Person(Box::new(person)))
        }
        Request::Disclosed { patient, by } => {
            stopped::disclosed(&desk.core.custody, patient, by)?;
            Ok(Answer::Sentence("the disclosure is in the station's history".to_owned()))
        }
        Request::Erase { patient, again, by } => erase(desk, patient, again, by),
        Request::Erasure { patient } => {
            let erasures = desk.core.custody.erasures();
            Ok(Answer::Erasure(erasures.of(&erasures.hash(patient))))
        }
        _ => Err(Fault::new(FaultKind::Request, "request-malformed", "this is about no person")),
    }
}

fn known(desk: &Desk, patient: &str) -> Result<Person, Fault> {
    let core = &desk.core;
    if core.identity.patient(patient, SourceKind::Operator).is_none() {
        let message = "this is not a patient id that patient.pattern and patient.check_digit allow";
        return Err(Fault::new(FaultKind::Request, "patient-id-not-allowed", message));
    }
    Ok(person(&core.config, &core.identity, (&core.custody, &core.stores), patient)?)
}

fn erase(desk: &Desk, patient: &str, again: &str, by: &str) -> Result<Answer, Fault> {
    if patient != again {
        let message = "the two ids differ; nothing was erased";
        return Err(Fault::new(FaultKind::Request, "ids-differ", message));
    }
    if known(desk, patient)?.is_awaited() {
        let message = "a scan of this patient is expected; nothing was erased: gaiter patient clear, \
                       then erase";
        return Err(Fault::new(FaultKind::Request, "patient-awaited", message));
    }
    erase::ask(&desk.core, patient, by)?;
    Ok(Answer::Sentence("the erasure is noted, and begins".to_owned()))
}

impl From<CustodyFault> for Fault {
    fn from(fault: CustodyFault) -> Fault {
        Fault::new(FaultKind::Failed, "custody-failed", chain(&fault))
    }
}
