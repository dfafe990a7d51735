//! What the server has of a record already, and what of it is to be replaced.

use gaiter_record::fhir::{Entry, FhirKey, Identifier, Replacement, Status};
use http::Method;
use serde_json::Value;

use super::FhirStore;
use super::answers::{Asked, reference};
use crate::store::server::ServerFault;
use crate::store::{Rejection, StoreFault};

/// The kind that states whether a whole record is valid.
pub(super) const REPORT: &str = "DiagnosticReport";

/// The kinds of resources with data about a patient's legs. A device has none.
const KINDS: [&str; 3] = ["Observation", REPORT, "DocumentReference"];

/// The most resources of a kind that a search asks for: more than a record has.
const COUNT: usize = 100;

impl FhirStore {
    /// The entries that were not created because the server has others in their place, which are of an earlier
    /// revision or were withdrawn.
    ///
    /// # Errors
    /// [`Rejection::TakenBackThere`] if another station, or somebody at the server, withdrew the report: whose it is was
    /// decided there, and this station may not know it. Its own withdrawals come before what it sends now.
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
            let is_withdrawn = is_in_error(&there);
            let mark = self.identifier(key.withdrawal(&self.station));
            if is_withdrawn && entry.kind() == REPORT && !mark.is_of(&there) {
                return Err(StoreFault::Permanent(Rejection::TakenBackThere));
            }
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

    /// Everything of a record that searches find on the server.
    pub(super) fn of_record(&self, key: &FhirKey, patient: &str) -> Result<Vec<Value>, StoreFault> {
        let identifier = self.identifier(key.record());
        let mut there = Vec::new();
        for kind in KINDS {
            there.extend(self.found(kind, &identifier, COUNT, &[patient])?);
        }
        Ok(there)
    }

    /// Those of these resources that hold, marked as entered in error. With `mark`, each that lacks this identifier
    /// is given it.
    pub(super) fn in_error(
        there: &[Value],
        mark: Option<&Identifier>,
    ) -> Result<Vec<Replacement>, StoreFault> {
        let mut marked = Vec::new();
        for resource in there {
            let lacking = mark.filter(|mark| !mark.is_of(resource));
            if is_in_error(resource) && lacking.is_none() {
                continue;
            }
            let (reference, version) = (reference(resource)?, version(resource));
            let mut resource = resource.clone();
            resource["status"] = Status::EnteredInError.of_document().into();
            if resource["resourceType"] == "DocumentReference" {
                resource["docStatus"] = Status::EnteredInError.word().into();
            }
            if let (Some(mark), Some(own)) = (lacking, resource["identifier"].as_array_mut()) {
                own.push(mark.json());
            }
            marked.push(Replacement { resource, reference, version });
        }
        Ok(marked)
    }

    /// Checks that searches have found what the server has confirmed by this receipt: the report, and the
    /// observations in it. A search does not find what is not in its index yet, or what the station may not see.
    ///
    /// # Errors
    /// [`ServerFault::NotShown`] for a record that was sent and not confirmed, if there is no report: all of it came in
    /// together, or may yet.
    pub(super) fn all_found(
        &self,
        there: &[Value],
        receipt: Option<&str>,
        patient: &str,
    ) -> Result<(), StoreFault> {
        let known: Vec<String> = there.iter().map(reference).collect::<Result<_, _>>()?;
        let is_found = |of: &str| known.iter().any(|known| is_reference(of, known));
        let results = there.iter().filter_map(|of| of["result"].as_array()).flatten();
        let mut results = results.filter_map(|of| of["reference"].as_str());
        let hidden = || {
            let why = "a search does not find what the server has confirmed".to_owned();
            Err(ServerFault::Answer(why).into())
        };
        if !results.all(is_found) {
            return hidden();
        }
        let Some(receipt) = receipt else { return Ok(()) };
        let has_report = || there.iter().any(|of| of["resourceType"] == REPORT);
        if is_found(receipt) || receipt.is_empty() && has_report() {
            return Ok(());
        }
        if receipt.is_empty() {
            return match self.subject(patient) {
                // Nothing can be of a patient whom it does not know.
                Err(StoreFault::Permanent(Rejection::NotRegistered)) => Ok(()),
                _ => Err(ServerFault::NotShown.into()),
            };
        }
        match self.ask(Method::GET, receipt, None, &[patient]) {
            // It was deleted there.
            Err(StoreFault::Permanent(Rejection::ServerRefused { status: 410, .. })) => Ok(()),
            Ok(_) | Err(StoreFault::Server(ServerFault::Forbidden { status: 404, .. })) => hidden(),
            Err(fault) => Err(fault),
        }
    }

    /// An identifier of what is sent.
    pub(super) fn identifier(&self, value: String) -> Identifier {
        Identifier { system: self.rules.identifiers.clone(), value }
    }

    /// The revision that a resource of the server is of; 0 if it does not state it.
    fn revision_of(&self, resource: &Value, key: &FhirKey) -> u32 {
        let prefix = key.part("r");
        let own = resource["identifier"].as_array().into_iter().flatten();
        own.filter(|of| of["system"].as_str() == Some(&self.rules.identifiers))
            .filter_map(|of| of["value"].as_str()?.strip_prefix(&prefix)?.parse().ok())
            .max()
            .unwrap_or(0)
    }
}

fn is_in_error(resource: &Value) -> bool {
    resource["status"] == Status::EnteredInError.word()
}

/// Whether a reference in a resource is this one; servers may write their address before it and a version behind.
fn is_reference(of: &str, known: &str) -> bool {
    let of = of.split_once("/_history/").map_or(of, |(of, _)| of);
    of.strip_suffix(known).is_some_and(|before| before.is_empty() || before.ends_with('/'))
}

fn version(resource: &Value) -> Option<String> {
    resource["meta"]["versionId"].as_str().map(str::to_owned)
}
