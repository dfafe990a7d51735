//! The patient on the server: searched by the id, never created, and never guessed.

use gaiter_record::fhir::Identifier;
use http::Method;
use serde_json::Value;

use super::FhirStore;
use super::answers::reference;
use crate::store::server::ServerFault;
use crate::store::{Rejection, StoreFault};

/// The most patients of one id that a search asks for.
const PATIENTS_MOST: usize = 10;

impl FhirStore {
    /// The reference of the patient of this id: `Patient/17`.
    pub(super) fn subject(&self, id: &str) -> Result<String, StoreFault> {
        let identifier = Identifier { system: self.server.patients.clone(), value: id.to_owned() };
        // Servers repeat the address in their messages.
        let secret = [identifier.query(), id.to_owned()];
        let secret = secret.each_ref().map(String::as_str);
        let found = self.found("Patient", &identifier, PATIENTS_MOST, &secret)?;
        // A server keeps who was merged into another, often with the identifier that both have now.
        let left: Vec<&Value> = found.iter().filter(|patient| !is_replaced(patient)).collect();
        match left.as_slice() {
            [] if found.is_empty() => Err(StoreFault::Permanent(Rejection::NotRegistered)),
            [] => Err(StoreFault::Permanent(Rejection::PatientNotInUse)),
            [patient] if is_in_use(patient, &identifier) => reference(patient),
            [_] => Err(StoreFault::Permanent(Rejection::PatientNotInUse)),
            several => Err(StoreFault::Permanent(Rejection::RegisteredTwice(several.len()))),
        }
    }

    /// The resources of a kind that a search by an identifier finds. A server that answers with one that lacks the
    /// identifier has ignored what was asked, and nothing of its answer is used. Of those that have it in other
    /// capital and small letters none is meant.
    pub(super) fn found(
        &self,
        kind: &str,
        identifier: &Identifier,
        most: usize,
        secret: &[&str],
    ) -> Result<Vec<Value>, StoreFault> {
        let path = format!("{kind}?identifier={}&_count={most}", identifier.query());
        let mut answer = self.ask(Method::GET, &path, None, secret)?;
        let not_usable = |why: &str| Err(ServerFault::Answer(why.to_owned()).into());
        if answer["resourceType"] != "Bundle" {
            return not_usable("a search gives no bundle");
        }
        let entries = answer["entry"].as_array_mut().map(std::mem::take).unwrap_or_default();
        let mut found: Vec<Value> = entries
            .into_iter()
            .filter_map(|mut entry| Some(entry.get_mut("resource")?.take()))
            .filter(|resource| resource["resourceType"] == kind)
            .collect();
        if !found.iter().all(|resource| identifier.is_like(resource)) {
            return not_usable("a search by an identifier finds what does not have it");
        }
        found.retain(|resource| identifier.is_of(resource));
        // What is not seen could not be marked as wrong. Two patients are enough to know that there are several.
        let is_enough = kind == "Patient" && found.len() > 1;
        let mut links = answer["link"].as_array().into_iter().flatten();
        if !is_enough && links.any(|link| link["relation"] == "next") {
            return not_usable("a search does not give at once what it finds");
        }
        Ok(found)
    }
}

/// Whether a patient was merged into another.
fn is_replaced(patient: &Value) -> bool {
    let mut links = patient["link"].as_array().into_iter().flatten();
    links.any(|link| link["type"] == "replaced-by")
}

/// Whether a patient's record is in use: not closed, not merged into another, and the id is still the patient's.
fn is_in_use(patient: &Value, identifier: &Identifier) -> bool {
    let mut own = patient["identifier"].as_array().into_iter().flatten();
    let is_old = own.any(|of| {
        of["use"] == "old"
            && of["system"].as_str() == Some(&identifier.system)
            && of["value"].as_str() == Some(&identifier.value)
    });
    patient["active"] != false && !is_replaced(patient) && !is_old
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_patient_that_is_closed_merged_or_has_another_id_by_now_is_not_in_use() {
        let identifier = Identifier { system: "urn:p".to_owned(), value: "4711".to_owned() };
        let of = |more: Value| {
            let mut patient = json!({
                "resourceType": "Patient", "id": "17",
                "identifier": [{ "system": "urn:p", "value": "4711" }],
            });
            for (key, value) in more.as_object().unwrap() {
                patient[key] = value.clone();
            }
            is_in_use(&patient, &identifier)
        };
        assert!(of(json!({})) && of(json!({ "active": true })));
        assert!(of(json!({ "link": [{ "type": "seealso", "other": {} }] })));
        assert!(!of(json!({ "active": false })));
        assert!(!of(json!({ "link": [{ "type": "replaced-by", "other": {} }] })));
        let old = json!({ "use": "old", "system": "urn:p", "value": "4711" });
        assert!(!of(json!({ "identifier": [old] })));
        let other = json!({ "use": "old", "system": "urn:p", "value": "4" });
        let own = json!({ "system": "urn:p", "value": "4711" });
        assert!(of(json!({ "identifier": [other, own] })));
    }
}
