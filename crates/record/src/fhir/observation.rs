//! An observation per leg: each girth and height of the sheet as a component.

use gaiter_leg::Side;
use serde_json::{Value, json};

use super::bundle::Entry;
use super::{Parts, narrative};
use crate::export::{ExportFigure, What, export_figures};
use crate::report::{grouped, title};
use crate::rounding;

impl Parts<'_> {
    /// The observation of a leg.
    pub(super) fn observation(&self, side: Side, device: &Entry) -> Entry {
        let (record, language) = (self.sent.record, self.rules.language);
        let part = side.word();
        let identifier = self.identifier(self.sent.key.part(part));
        let figures: Vec<ExportFigure> =
            export_figures(record).into_iter().filter(|figure| figure.side == side).collect();
        let leg = language.word("leg.heading", part);
        let line = |figure: &ExportFigure| {
            format!("{} {} cm", figure.code(), rounding::number(figure.cm, 1, language))
        };
        let lines: Vec<String> = figures.iter().map(line).collect();
        let mut resource = json!({
            "resourceType": "Observation",
            "language": language.tag(),
            "text": narrative(leg, &lines),
            "identifier": self.identifiers(part),
            "status": self.status().word(),
            "category": [exam()],
            "code": self.concept("leg-measures", language.text("hospital.leg_measures"), &[]),
            "subject": { "reference": self.sent.subject },
            "effectiveDateTime": self.effective(),
            "bodySite": self.concept(&format!("{part}-leg"), leg, &[lower_limb()]),
            "method": { "text": format!("gaiter {}", record.made_by.gaiter) },
            "device": { "reference": device.reference() },
            "component": figures.iter().map(|figure| self.component(figure)).collect::<Vec<_>>(),
        });
        if figures.is_empty() {
            // An observation has a value, components, or the reason why it has neither.
            resource["dataAbsentReason"] = unknown();
            if let Some(fields) = resource.as_object_mut() {
                fields.remove("component");
            }
        }
        let notes = self.notes(&figures);
        if !notes.is_empty() {
            resource["note"] = notes.into();
        }
        Entry::new(identifier, resource)
    }

    fn component(&self, figure: &ExportFigure) -> Value {
        let language = self.rules.language;
        let (key, further) = match figure.what {
            What::Girth => ("hospital.girth_at", vec![limb_circumference()]),
            What::Height => ("hospital.height_at", Vec::new()),
        };
        let words = language.filled(key, &[("level", &figure.level.name())]);
        let mut quantity = json!({
            "value": figure.cm, "unit": "cm", "system": UCUM, "code": "cm",
        });
        if let Some(sd_cm) = figure.sd_cm {
            quantity["extension"] = json!([uncertainty(sd_cm)]);
        }
        let mut component = json!({
            "code": self.concept(&figure.code(), &words, &further), "valueQuantity": quantity,
        });
        let mark = match (figure.is_by_hand, figure.doubts.is_empty()) {
            (true, _) => Some(("by-hand", "hospital.by_hand")),
            (false, false) => Some(("doubtful", "hospital.doubtful")),
            (false, true) => None,
        };
        if let Some((code, key)) = mark {
            component["interpretation"] = json!([self.concept(code, language.text(key), &[])]);
        }
        component
    }

    /// The doubts about a leg's figures, each with the figures that it is about.
    fn notes(&self, figures: &[ExportFigure]) -> Vec<Value> {
        let doubts = figures.iter().flat_map(|figure| {
            figure.doubts.iter().map(move |doubt| (doubt.as_str(), figure.code()))
        });
        let sentence = |(doubt, boxes): (&str, Vec<String>)| {
            let title = title(doubt, self.rules.language);
            json!({ "text": format!("{}: {title}", boxes.join(", ")) })
        };
        grouped(doubts).into_iter().map(sentence).collect()
    }
}

// Codes of others, where the reference of this project calls them good. Everything else has an own code.

/// SNOMED CT.
const SNOMED: &str = "http://snomed.info/sct";

/// The units of UCUM.
const UCUM: &str = "http://unitsofmeasure.org";

/// Lower limb circumference (observable entity); ValueSet of circumferences of HL7 Europe's discharge report.
fn limb_circumference() -> Value {
    snomed("413171006", "Lower limb circumference")
}

/// Lower limb structure; DICOM PS3.16, CID 4.
fn lower_limb() -> Value {
    snomed("61685007", "Lower limb structure")
}

/// Category of an observation: an examination.
fn exam() -> Value {
    let system = "http://terminology.hl7.org/CodeSystem/observation-category";
    json!({ "coding": [{ "system": system, "code": "exam" }] })
}

/// Why a component has no value: nothing is known.
fn unknown() -> Value {
    let system = "http://terminology.hl7.org/CodeSystem/data-absent-reason";
    json!({ "coding": [{ "system": system, "code": "unknown" }] })
}

/// The standard deviation of a quantity, in its unit; an extension of FHIR itself.
fn uncertainty(value: f64) -> Value {
    let url = "http://hl7.org/fhir/StructureDefinition/iso21090-uncertainty";
    json!({ "url": url, "valueDecimal": value })
}

fn snomed(code: &str, display: &str) -> Value {
    json!({ "system": SNOMED, "code": code, "display": display })
}
