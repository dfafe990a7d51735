//! The report: the observations of both legs, the verdict, and the PDF.

use serde_json::{Value, json};

use super::bundle::Entry;
use super::{Parts, narrative};
use crate::completeness::Completeness;

/// The part of a record that is its report.
pub(super) const PART: &str = "report";

impl Parts<'_> {
    pub(super) fn report(&self, observations: &[Entry]) -> Entry {
        let (record, language) = (self.sent.record, self.rules.language);
        let identifier = self.identifier(self.sent.key.part(PART));
        let title = language.text("hospital.report");
        let verdict = Completeness::of(record, &self.rules.garment).sentences(language);
        let refer = |entry: &Entry| json!({ "reference": entry.reference() });
        let mut resource = json!({
            "resourceType": "DiagnosticReport",
            "language": language.tag(),
            "text": narrative(title, &verdict),
            "identifier": self.identifiers(PART),
            "status": self.status().word(),
            "code": self.concept("leg-report", title, &[]),
            "subject": { "reference": self.sent.subject },
            "effectiveDateTime": self.effective(),
            "conclusion": verdict.join(" "),
        });
        let result: Vec<Value> = observations.iter().map(refer).collect();
        if !result.is_empty() {
            resource["result"] = result.into();
        }
        if let Some(pdf) = self.pdf() {
            resource["presentedForm"] = json!([pdf]);
        }
        Entry::new(identifier, resource)
    }
}
