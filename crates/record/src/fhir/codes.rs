//! Codes of others, where the reference of this project calls them good. Everything else has an own code.

use serde_json::{Value, json};

/// SNOMED CT.
const SNOMED: &str = "http://snomed.info/sct";

/// The units of UCUM.
pub(super) const UCUM: &str = "http://unitsofmeasure.org";

/// Lower limb circumference (observable entity); ValueSet of circumferences of HL7 Europe's discharge report.
pub(super) fn limb_circumference() -> Value {
    snomed("413171006", "Lower limb circumference")
}

/// Lower limb structure; DICOM PS3.16, CID 4.
pub(super) fn lower_limb() -> Value {
    snomed("61685007", "Lower limb structure")
}

/// Category of an observation: an examination.
pub(super) fn exam() -> Value {
    let system = "http://terminology.hl7.org/CodeSystem/observation-category";
    json!({ "coding": [{ "system": system, "code": "exam" }] })
}

/// Why a component has no value: nothing is known.
pub(super) fn unknown() -> Value {
    let system = "http://terminology.hl7.org/CodeSystem/data-absent-reason";
    json!({ "coding": [{ "system": system, "code": "unknown" }] })
}

/// The standard deviation of a quantity, in its unit; an extension of FHIR itself.
pub(super) fn uncertainty(value: f64) -> Value {
    let url = "http://hl7.org/fhir/StructureDefinition/iso21090-uncertainty";
    json!({ "url": url, "valueDecimal": value })
}

fn snomed(code: &str, display: &str) -> Value {
    json!({ "system": SNOMED, "code": code, "display": display })
}
