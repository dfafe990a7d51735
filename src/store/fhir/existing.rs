//! What the server has of a record already, and what of it is to be replaced.

use gaiter_record::fhir::{Entry, FhirKey, Identifier, Replacement, Status};
use http::Method;
use serde_json::Value;

use super::FhirStore;
use super::answers::{Asked, reference};
use crate::store::StoreFault;
use crate::store::server::ServerFault;

/// The kinds of resources that say something about a patient's legs. A device says nothing about a patient.
const KINDS: [&str; 3] = ["Observation", "DiagnosticReport", "DocumentReference"];

/// The most resources of a kind that a search asks for: more than a record has.
const COUNT: usize = 100;

impl FhirStore {
    /// The entries that were not created because the server has others in their place, which are of an earlier
    /// revision or were withdrawn.
    pub(super) fn stale(
        &self,
        created: &[(Entry, Asked)],
        key: &FhirKey,
        revision: u32,
        patient: &str,
    ) -> Result<Vec<Replacement>, StoreFault> {
        let mut stale = Vec::new();
        let old = created.iter().filter(|(of, asked)| !asked.is_new && KINDS.contains(&of.kind()));
        for (entry, asked) in old {
            let there = self.ask(Method::GET, &asked.reference, None, &[patient])?;
            if !entry.identifier.is_of(&there) {
                let why = "it has kept another resource in the place of one of a record".to_owned();
                return Err(ServerFault::Answer(why).into());
            }
            let is_withdrawn = there["status"] == Status::EnteredInError.code();
            if is_withdrawn || self.revision_of(&there, key) < revision {
                stale.push(Replacement {
                    resource: entry.resource.clone(),
                    reference: asked.reference.clone(),
                    version: version(&there),
                });
            }
        }
        Ok(stale)
    }

    /// Everything of a record that is on the server and holds, marked as entered in error.
    pub(super) fn marked_in_error(
        &self,
        key: &FhirKey,
        patient: &str,
    ) -> Result<Vec<Replacement>, StoreFault> {
        let system = self.rules.identifiers.clone();
        let identifier = Identifier { system, value: key.record() };
        let mut marked = Vec::new();
        for kind in KINDS {
            for mut resource in self.found(kind, &identifier, COUNT, &[patient])? {
                if resource["status"] == Status::EnteredInError.code() {
                    continue;
                }
                let (reference, version) = (reference(&resource)?, version(&resource));
                resource["status"] = Status::EnteredInError.of_document().into();
                if kind == "DocumentReference" {
                    resource["docStatus"] = Status::EnteredInError.code().into();
                }
                marked.push(Replacement { resource, reference, version });
            }
        }
        Ok(marked)
    }

    /// The revision that a resource of the server is of; 0 if it does not say.
    fn revision_of(&self, resource: &Value, key: &FhirKey) -> u32 {
        let prefix = key.part("r");
        let own = resource["identifier"].as_array().into_iter().flatten();
        own.filter(|of| of["system"].as_str() == Some(&self.rules.identifiers))
            .filter_map(|of| of["value"].as_str()?.strip_prefix(&prefix)?.parse().ok())
            .max()
            .unwrap_or(0)
    }
}

fn version(resource: &Value) -> Option<String> {
    resource["meta"]["versionId"].as_str().map(str::to_owned)
}
