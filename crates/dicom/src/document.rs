//! The report's PDF and meshes as encapsulated documents.

use dicom_dictionary_std::tags;
use gaiter_record::RecordFile;

use super::content::Concept;
use super::dataset::Dataset;
use super::{DicomObject, Parts, SopClass, moment};

/// The endings of files that there are objects for, with their kind and media type.
const ENDINGS: [(&str, SopClass, &str); 3] = [
    ("pdf", SopClass::Pdf, "application/pdf"),
    ("stl", SopClass::Stl, "model/stl"),
    ("obj", SopClass::Obj, "model/obj"),
];

/// The place of the first file among the objects of a record; the figures are before it.
const FIRST_NUMBER: u32 = 2;

/// Whether there is an object for a file of this name.
pub fn attachable(name: &str) -> bool {
    kind(name).is_some()
}

fn kind(name: &str) -> Option<(SopClass, &'static str)> {
    let (_, ending) = name.rsplit_once('.')?;
    let found = ENDINGS.into_iter().find(|(known, ..)| ending.eq_ignore_ascii_case(known));
    found.map(|(_, class, media_type)| (class, media_type))
}

impl Parts<'_> {
    /// An object for each file that the rules name and the record has.
    pub(crate) fn documents(&self) -> Vec<DicomObject> {
        let named = self.rules.attach.iter();
        let files = named.filter_map(|name| self.sent.files.iter().find(|of| of.name == *name));
        let documents = (FIRST_NUMBER..).zip(files);
        documents.filter_map(|(number, file)| self.document(number, file)).collect()
    }

    /// The object of a file; `None` if there is no kind of object for it.
    fn document(&self, number: u32, file: &RecordFile) -> Option<DicomObject> {
        let (class, media_type) = kind(&file.name)?;
        let language = self.rules.language;
        let title = match class {
            SopClass::Pdf => language.text("hospital.report").to_owned(),
            _ => format!("{}: {}", file.name, language.text("hospital.document")),
        };
        let own = Dataset::new()
            .text(tags::ACQUISITION_DATE_TIME, moment(&self.at).concat())
            .text(tags::DOCUMENT_TITLE, title)
            .items(tags::CONCEPT_NAME_CODE_SEQUENCE, Vec::new())
            .text(tags::MIME_TYPE_OF_ENCAPSULATED_DOCUMENT, media_type)
            // The id is on every page of the report, and on no mesh.
            .text(tags::BURNED_IN_ANNOTATION, if class == SopClass::Pdf { "YES" } else { "NO" })
            .value(tags::ENCAPSULATED_DOCUMENT_LENGTH, file.bytes.len() as u32)
            .value(tags::ENCAPSULATED_DOCUMENT, file.bytes.clone());
        let own = match class {
            SopClass::Pdf => own.text(tags::CONVERSION_TYPE, "WSD"),
            _ => own.and(self.mesh()),
        };
        Some(self.object(class, &format!("file/{}", file.name), number, own))
    }

    /// What a mesh has besides: both legs lie in the body frame, in millimetres.
    fn mesh(&self) -> Dataset {
        Dataset::new()
            .text(tags::FRAME_OF_REFERENCE_UID, self.sent.study.part_uid("frame"))
            .text(tags::POSITION_REFERENCE_INDICATOR, "")
            .items(tags::MEASUREMENT_UNITS_CODE_SEQUENCE, Concept::new("mm", "UCUM", "mm").items())
            .text(tags::MODEL_MODIFICATION, "NO")
            .text(tags::MODEL_MIRRORING, "NO")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pdf_and_meshes_go_and_nothing_else_does() {
        for name in ["report.pdf", "left.stl", "right-solid.OBJ"] {
            assert!(attachable(name), "{name}");
        }
        for name in ["record.json", "left.step", "SHA256SUMS", "pdf", ""] {
            assert!(!attachable(name), "{name}");
        }
    }
}
