//! The report, and files of the record as documents.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::bundle::Entry;
use super::{Parts, narrative};
use crate::completeness::Completeness;
use crate::{ImagingRequest, Patient, RecordFile};

/// The media type of a file by the ending of its name.
const TYPES: [(&str, &str); 11] = [
    ("pdf", "application/pdf"),
    ("json", "application/json"),
    ("csv", "text/csv"),
    ("html", "text/html"),
    ("svg", "image/svg+xml"),
    ("step", "model/step"),
    ("igs", "model/iges"),
    ("stl", "model/stl"),
    ("obj", "model/obj"),
    ("glb", "model/gltf-binary"),
    ("txt", "text/plain"),
];

/// The media type of any other file.
const OTHER: &str = "application/octet-stream";

/// The file that is the report itself.
const PDF: &str = "report.pdf";

/// The part of a record that is its report.
const PART: &str = "report";

/// The study of a request, whether the server knows it or not.
fn study(request: &ImagingRequest) -> Value {
    let value = format!("urn:oid:{}", request.study_instance_uid);
    json!({ "type": "ImagingStudy", "identifier": { "system": "urn:dicom:uid", "value": value } })
}

/// The order with this accession number (HL7 table 0203).
fn order(number: &str) -> Value {
    let system = "http://terminology.hl7.org/CodeSystem/v2-0203";
    let kind = json!({ "coding": [{ "system": system, "code": "ACSN" }] });
    json!({ "type": "ServiceRequest", "identifier": { "type": kind, "value": number } })
}

impl Parts<'_> {
    /// The report: the observations of both legs, the verdict, and the PDF.
    pub(super) fn report(&self, observations: &[Entry]) -> Entry {
        let (record, language) = (self.sent.record, self.rules.language);
        let identifier = self.identifier(self.sent.key.part(PART));
        let title = language.text("hospital.report");
        let verdict = Completeness::from_record(record, &self.rules.garment).sentences(language);
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
        if let Some(request) = record.patient.as_ref().and_then(Patient::request) {
            resource["imagingStudy"] = json!([study(request)]);
            if let Some(number) = &request.accession_number {
                resource["basedOn"] = json!([order(number)]);
            }
        }
        if let Some(pdf) = self.pdf() {
            resource["presentedForm"] = json!([pdf]);
        }
        Entry::new(identifier, resource)
    }

    /// A document for each file that the rules name and the record has.
    pub(super) fn documents(&self, report: &Entry) -> Vec<Entry> {
        let named = self.rules.attach.iter().filter(|name| *name != PDF);
        let files = named.filter_map(|name| self.sent.files.iter().find(|of| of.name == *name));
        files.map(|file| self.document(file, report)).collect()
    }

    fn document(&self, file: &RecordFile, report: &Entry) -> Entry {
        let (part, status) = (format!("file/{}", file.name), self.status());
        let identifier = self.identifier(self.sent.key.part(&part));
        let words = self.rules.language.text("hospital.document");
        let resource = json!({
            "resourceType": "DocumentReference",
            "identifier": self.identifiers(&part),
            "status": status.of_document(),
            "docStatus": status.word(),
            "type": self.concept("record-file", words, &[]),
            "subject": { "reference": self.sent.subject },
            "description": format!("{}: {words}", file.name),
            "content": [{ "attachment": Parts::attachment(file) }],
            "context": { "related": [{ "reference": report.reference() }] },
        });
        Entry::new(identifier, resource)
    }

    /// The report's PDF; `None` if the rules do not name it, or if the record has none.
    pub(super) fn pdf(&self) -> Option<Value> {
        let is_named = self.rules.attach.iter().any(|name| name == PDF);
        let file = self.sent.files.iter().find(|file| is_named && file.name == PDF)?;
        let mut pdf = Parts::attachment(file);
        pdf["language"] = self.rules.language.tag().into();
        Some(pdf)
    }

    fn attachment(file: &RecordFile) -> Value {
        json!({
            "contentType": media_type(&file.name),
            "data": STANDARD.encode(&file.bytes),
            "size": file.bytes.len(),
            "title": file.name,
        })
    }
}

/// The media type of a file.
fn media_type(name: &str) -> &'static str {
    let ending = name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
    TYPES.iter().find(|(known, _)| *known == ending).map_or(OTHER, |(_, kind)| kind)
}

#[cfg(test)]
mod tests {
    use gaiter_cad::{FileFormat, FileKind, Schema, Shape};

    use super::*;

    #[test]
    fn every_file_of_a_surface_has_a_media_type_of_its_own() {
        let (step, newer) = (FileFormat::Step(Schema::Ap214), FileFormat::Step(Schema::Ap242));
        for (format, expected) in [
            (step, "model/step"),
            (newer, "model/step"),
            (FileFormat::Iges, "model/iges"),
            (FileFormat::Stl, "model/stl"),
            (FileFormat::Obj, "model/obj"),
            (FileFormat::Glb, "model/gltf-binary"),
        ] {
            for shape in [Shape::Tube, Shape::Solid] {
                let name = format!("left{}", FileKind { format, shape }.ending());
                assert_eq!(media_type(&name), expected, "{name}");
            }
        }
    }

    #[test]
    fn a_file_of_no_known_kind_is_bytes() {
        assert_eq!(
            ["REPORT.PDF", "record.json", "order.csv"].map(media_type),
            ["application/pdf", "application/json", "text/csv",]
        );
        assert_eq!(["SHA256SUMS", "scanner.ord", "", "pdf."].map(media_type), [OTHER; 4]);
    }
}
