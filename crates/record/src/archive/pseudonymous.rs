//! A record as it may leave its house.

use super::words::{Pseudonym, SiteKey};
use crate::provenance::{Patient, Source};
use crate::schema::{Amendment, Record};

/// The record with a pseudonym in place of the patient's id, and the pseudonym; `None` if it names no patient. Names
/// of staff and what they wrote stay in the house, and so do the hospital's numbers of a request.
pub fn pseudonymous(record: Record, site: &SiteKey) -> (Record, Option<Pseudonym>) {
    let pseudonym = record.patient.as_ref().map(|patient| Pseudonym::of(site, &patient.id));
    let patient = pseudonym.as_ref().zip(record.patient);
    let patient = patient.map(|(of, named)| Patient {
        id: of.to_string(),
        sources: named.sources.into_iter().map(|by| Source { request: None, ..by }).collect(),
    });
    let unsigned = |set: Amendment| Amendment { reason: String::new(), by: String::new(), ..set };
    let amendments = record.amendments.into_iter().map(unsigned).collect();
    (Record { patient, amendments, ..record }, pseudonym)
}
