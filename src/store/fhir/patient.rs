//! The patient on the server: searched by the id, and never guessed.

use hyper::Method;
use serde_json::{Value, json};

use super::FhirStore;
use crate::flow::server::fhir::Missing;
use crate::record::fhir::{Entry, Identifier};
use crate::store::server::ServerFault;
use crate::store::{Misfit, StoreFault};

/// The patient of a record.
#[derive(Debug)]
pub(super) enum Subject {
    /// On the server: `Patient/17`.
    Known(String),
    /// To be created in the same transaction.
    New(Box<Entry>),
}

impl Subject {
    pub(super) fn reference(&self) -> String {
        match self {
            Subject::Known(reference) => reference.clone(),
            Subject::New(entry) => entry.reference(),
        }
    }

    pub(super) fn created(self) -> Option<Entry> {
        match self {
            Subject::Known(_) => None,
            Subject::New(entry) => Some(*entry),
        }
    }
}

impl FhirStore {
    /// Finds the patient of this id.
    pub(super) fn subject(&self, id: &str) -> Result<Subject, StoreFault> {
        let identifier = Identifier { system: self.server.patients.clone(), value: id.to_owned() };
        let path = format!("Patient?identifier={}&_count=10", identifier.query());
        let found = self.found(&path, "Patient", &identifier, id)?;
        match found.as_slice() {
            [] => match self.server.missing {
                Missing::Wait => Err(StoreFault::Permanent(Misfit::NotRegistered)),
                Missing::Create => {
                    let resource =
                        json!({ "resourceType": "Patient", "identifier": [identifier.json()] });
                    Ok(Subject::New(Box::new(Entry::new(identifier, resource))))
                }
            },
            [patient] if is_in_use(patient) => Ok(Subject::Known(reference(patient)?)),
            [_] => Err(StoreFault::Permanent(Misfit::PatientNotInUse)),
            several => Err(StoreFault::Permanent(Misfit::RegisteredTwice(several.len()))),
        }
    }

    /// The resources of a kind that a search by an identifier finds. A server that answers with one that lacks the
    /// identifier has ignored what was asked, and nothing of its answer is used.
    pub(super) fn found(
        &self,
        path: &str,
        kind: &str,
        identifier: &Identifier,
        secret: &str,
    ) -> Result<Vec<Value>, StoreFault> {
        let answer = self.ask(Method::GET, path, None, &[secret])?;
        if answer["resourceType"] != "Bundle" {
            return Err(ServerFault::Answer("a search gives no bundle".to_owned()).into());
        }
        let entries = answer["entry"].as_array().cloned().unwrap_or_default();
        let found: Vec<Value> = entries
            .into_iter()
            .map(|mut entry| entry["resource"].take())
            .filter(|resource| resource["resourceType"] == kind)
            .collect();
        match found.iter().all(|resource| identifier.is_of(resource)) {
            true => Ok(found),
            false => {
                let why = "a search by an identifier finds what does not have it".to_owned();
                Err(ServerFault::Answer(why).into())
            }
        }
    }
}

/// Whether a patient's record is in use: not closed, and not merged into another.
fn is_in_use(patient: &Value) -> bool {
    let links = patient["link"].as_array().into_iter().flatten();
    let is_replaced = links.into_iter().any(|link| link["type"] == "replaced-by");
    patient["active"] != false && !is_replaced
}

/// The reference of a resource of the server.
pub(super) fn reference(resource: &Value) -> Result<String, StoreFault> {
    let kind = resource["resourceType"].as_str().unwrap_or_default();
    match resource["id"].as_str().filter(|id| is_id(id)) {
        Some(id) => Ok(format!("{kind}/{id}")),
        None => Err(ServerFault::Answer("a resource has no id".to_owned()).into()),
    }
}

/// Whether a text is an id of FHIR: nothing that leads elsewhere.
pub(super) fn is_id(text: &str) -> bool {
    let is_letter = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'.';
    (1..=64).contains(&text.len()) && text.bytes().all(is_letter)
}
