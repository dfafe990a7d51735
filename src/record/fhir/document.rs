//! Files of the record as documents.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::Parts;
use super::bundle::Entry;
use crate::record::file::RecordFile;

/// The media type of a file by the ending of its name.
const TYPES: [(&str, &str); 12] = [
    ("pdf", "application/pdf"),
    ("json", "application/json"),
    ("csv", "text/csv"),
    ("html", "text/html"),
    ("svg", "image/svg+xml"),
    ("png", "image/png"),
    ("step", "model/step"),
    ("iges", "model/iges"),
    ("stl", "model/stl"),
    ("obj", "model/obj"),
    ("glb", "model/gltf-binary"),
    ("txt", "text/plain"),
];

/// The media type of any other file.
const OTHER: &str = "application/octet-stream";

/// The file that is the report itself.
const PDF: &str = "report.pdf";

impl Parts<'_> {
    /// A document for each file that the rules name and the record has.
    pub(super) fn documents(&self, report: &Entry) -> Vec<Entry> {
        let named = self.rules.attach.iter().filter(|name| *name != PDF);
        let files = named.filter_map(|name| self.sent.files.iter().find(|of| of.name == *name));
        files.map(|file| self.document(file, report)).collect()
    }

    fn document(&self, file: &RecordFile, report: &Entry) -> Entry {
        let (part, status) = (format!("file/{}", file.name), self.status());
        let identifier = self.identifier(self.sent.key.part(&part));
        let words = self.rules.language.text("fhir.document");
        let resource = json!({
            "resourceType": "DocumentReference",
            "identifier": self.identifiers(&part),
            "status": status.of_document(),
            "docStatus": status.code(),
            "type": self.concept("record-file", words, &[]),
            "subject": { "reference": self.sent.subject },
            "description": format!("{}: {words}", file.name),
            "content": [{ "attachment": self.attachment(file) }],
            "context": { "related": [{ "reference": report.reference() }] },
        });
        Entry::new(identifier, resource)
    }

    /// The report's PDF; `None` if the rules do not name it, or if the record has none.
    pub(super) fn pdf(&self) -> Option<Value> {
        let is_named = self.rules.attach.iter().any(|name| name == PDF);
        let file = self.sent.files.iter().find(|file| is_named && file.name == PDF)?;
        Some(self.attachment(file))
    }

    fn attachment(&self, file: &RecordFile) -> Value {
        json!({
            "contentType": media_type(&file.name),
            "language": self.rules.language.tag(),
            "data": STANDARD.encode(&file.bytes),
            "size": file.bytes.len(),
            "title": file.name,
        })
    }
}

/// The media type of a file.
pub fn media_type(name: &str) -> &'static str {
    let ending = name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
    TYPES.iter().find(|(known, _)| *known == ending).map_or(OTHER, |(_, kind)| kind)
}
