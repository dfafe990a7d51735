//! A record as FHIR R4: an observation per leg, a report with its PDF, and documents, as one transaction; and what a
//! server reports about a fault.
//!
//! Nothing here connects to a server: the store looks up the patient, sends the resources and reads the
//! answers.

mod bundle;
mod document;
mod identity;
mod observation;
pub mod outcome;

use gaiter_language::Language;
use gaiter_sizes::Garment;
use jiff::Timestamp;
use serde_json::{Value, json};

use crate::FIRST_REVISION;
use crate::RecordFile;
use crate::export::taken;
use crate::schema::Record;
use crate::shown::escaped;
pub use bundle::{Entry, Replacement, created, replaced};
pub use identity::{FhirKey, Identifier, uuid, uuid_bytes};

/// The version of FHIR that resources are written in.
pub const VERSION: &str = "4.0";

/// How records are written for a server.
#[derive(Debug, Clone, PartialEq)]
pub struct FhirRules {
    /// The system of the identifiers of what is sent: a URI that belongs to this installation.
    pub identifiers: String,
    /// The system of gaiter's own codes.
    pub codes: String,
    /// The language of texts.
    pub language: Language,
    /// The garment whose measures an order needs.
    pub garment: Garment,
    /// Files of the record that are sent with it, by name: `report.pdf` within the report, any other as a
    /// document. A file that a record lacks is left out.
    pub attach: Vec<String>,
}

gaiter_leg::word_enum! {
    /// The status of the figures in a resource; its words are the codes of observations and reports, and of what is in
    /// a document.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Status {
        /// They hold.
        Final => "final",
        /// They hold, and are not those of the first revision.
        Amended => "amended",
        /// They belong to another patient.
        EnteredInError => "entered-in-error",
    }
}

impl Status {
    /// The code of a document itself.
    pub fn of_document(self) -> &'static str {
        match self {
            Status::Final | Status::Amended => "current",
            Status::EnteredInError => "entered-in-error",
        }
    }
}

/// A record on its way to a server.
#[derive(Debug, Clone, Copy)]
pub struct Sent<'a> {
    /// The record; its patient must be the one that `subject` is.
    pub record: &'a Record,
    /// Its files.
    pub files: &'a [RecordFile],
    /// When the station first saw the scan: the time of a record that does not state when it was taken.
    pub first_seen: Timestamp,
    /// The reference of the patient on the server, such as `Patient/17`.
    pub subject: &'a str,
    /// What identifies scan and patient.
    pub key: &'a FhirKey,
}

/// All resources of a record, each with its identifier; the station, observations, the report, documents. None is a
/// patient.
///
/// The same record with the same rules gives the same resources.
pub fn entries(sent: &Sent<'_>, rules: &FhirRules) -> Vec<Entry> {
    let parts = Parts { sent: *sent, rules };
    let device = parts.device();
    let observations: Vec<Entry> =
        sent.record.sides().map(|side| parts.observation(side, &device)).collect();
    let report = parts.report(&observations);
    let documents = parts.documents(&report);
    [vec![device], observations, vec![report], documents].concat()
}

/// What the resources of a record have in common.
struct Parts<'a> {
    sent: Sent<'a>,
    rules: &'a FhirRules,
}

impl Parts<'_> {
    fn status(&self) -> Status {
        let record = self.sent.record;
        match record.revision == FIRST_REVISION && record.amendments.is_empty() {
            true => Status::Final,
            false => Status::Amended,
        }
    }

    /// The identifiers of a resource: of the record, of this part of it, and of its revision.
    fn identifiers(&self, part: &str) -> Value {
        let key = self.sent.key;
        let revision = self.sent.record.revision;
        let values = [key.record(), key.part(part), key.revision(revision)];
        values.into_iter().map(|value| self.identifier(value).json()).collect()
    }

    fn identifier(&self, value: String) -> Identifier {
        Identifier { system: self.rules.identifiers.clone(), value }
    }

    /// An own code, with the same in words and further codings that mean the same.
    fn concept(&self, code: &str, words: &str, further: &[Value]) -> Value {
        let own = json!({ "system": self.rules.codes, "code": code, "display": words });
        let codings: Vec<Value> = [own].into_iter().chain(further.iter().cloned()).collect();
        json!({ "coding": codings, "text": words })
    }

    /// When the scan was taken, to the second.
    fn effective(&self) -> String {
        let at = taken(self.sent.record, self.sent.first_seen);
        at.strftime("%Y-%m-%dT%H:%M:%S%:z").to_string()
    }

    fn device(&self) -> Entry {
        let station = self.sent.record.station.as_deref().unwrap_or("gaiter");
        let identifier = self.identifier(format!("device/{station}"));
        let words = self.rules.language.text("hospital.device");
        let resource = json!({
            "resourceType": "Device",
            "identifier": [identifier.json()],
            "status": "active",
            "deviceName": [{ "name": format!("gaiter {station}"), "type": "user-friendly-name" }],
            "type": self.concept("station", words, &[]),
        });
        Entry::new(identifier, resource)
    }
}

/// The narrative of a resource, for readers without a program for its fields: a title and lines.
fn narrative(title: &str, lines: &[String]) -> Value {
    let items: String = lines.iter().map(|line| format!("<li>{}</li>", escaped(line))).collect();
    let list = if items.is_empty() { items } else { format!("<ul>{items}</ul>") };
    let title = escaped(title);
    let div = format!("<div xmlns=\"http://www.w3.org/1999/xhtml\"><p>{title}</p>{list}</div>");
    json!({ "status": "generated", "div": div })
}

#[cfg(test)]
mod tests;
