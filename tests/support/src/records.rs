//! Records of recorded bodies.

#![allow(clippy::unwrap_used)]

use std::sync::OnceLock;

#[cfg(feature = "dicom")]
use gaiter_dicom::DicomRules;
use gaiter_leg::{Extraction, Method, extract};
use gaiter_record::fhir::FhirRules;
use gaiter_record::hl7::{Charset, Hl7Rules, PdfForm};
use gaiter_record::measure::amendment::{Amendment, Deed};
use gaiter_record::{Provenance, Record, record, sha256};
use gaiter_scan::{Format, Scan};
use serde_json::json;

use crate::recorded::export;
use crate::writers::ply;

const BODIES: [&str; 3] = ["f_average_clean", "f_average_tc2", "m_average_clean"];

/// What the default method measures on a recorded body, and the record of it; measured once.
pub fn measured(body: &str) -> &'static (Extraction, Record) {
    static MEASURED: [OnceLock<(Extraction, Record)>; BODIES.len()] =
        [const { OnceLock::new() }; BODIES.len()];
    let index = BODIES.iter().position(|name| *name == body).unwrap();
    MEASURED[index].get_or_init(|| record_of(&export(body), &Method::default()))
}

/// The recorded bodies by name, as [`measured`].
pub fn bodies() -> impl Iterator<Item = (&'static str, &'static Extraction, &'static Record)> {
    BODIES.into_iter().map(|body| {
        let (extraction, record) = measured(body);
        (body, extraction, record)
    })
}

/// The record of an export that nobody says more about.
pub fn record_of(bytes: &[u8], method: &Method) -> (Extraction, Record) {
    record_of_file(bytes, Format::Obj, method)
}

/// The record of a scan, which is handed over as [`ply`].
pub fn record_of_scan(scan: &Scan, method: &Method) -> Record {
    record_of_file(&ply(scan), Format::Ply, method).1
}

fn record_of_file(bytes: &[u8], format: Format, method: &Method) -> (Extraction, Record) {
    let extraction = extract(bytes, format, method).unwrap();
    let provenance = Provenance::of_scan(sha256(bytes));
    let record = record(&extraction, &provenance, method);
    (extraction, record)
}

/// A measure of the right leg that a person set.
fn set(measure: &str, is: Deed, girth_mm: Option<f64>, height_mm: Option<f64>) -> Amendment {
    Amendment {
        leg: "right".to_owned(),
        measure: measure.to_owned(),
        is,
        girth_mm,
        height_mm,
        length_mm: None,
        reason: "swollen since".to_owned(),
        by: "Anna Berg".to_owned(),
        at: "2026-11-20T10:00:00Z".parse().unwrap(),
    }
}

/// A record with every mark on its right leg: C in doubt, E estimated, B with a girth by hand, D not measurable.
pub fn marked() -> Record {
    let mut record = measured("f_average_clean").1.clone();
    let right = record.legs.iter_mut().find(|leg| leg.side == "right").unwrap();
    right.landmarks.values_mut().for_each(|found| found.doubts.clear());
    let c = right.landmarks.get_mut("C").unwrap();
    c.doubts = vec!["gap".to_owned(), "never-heard-of".to_owned()];
    // Half of a step is rounded up, as on the sheet.
    (c.girth_tape_mm, c.girth_sd_mm) = (223.5, Some(1.234_56));
    right.landmarks.remove("E");
    let estimate = json!({
        "by": "proportion", "rule": {"is": "stature-share"}, "height_mm": 450.0, "along_axis_mm": 450.0, "girth_tape_mm": 380.0,
        "height_sd_mm": 9.0, "girth_sd_mm": 6.0, "doubts": [],
    });
    right.estimates.insert("E".to_owned(), serde_json::from_value(estimate).unwrap());
    let by_hand =
        [set("B", Deed::Measured, Some(231.0), None), set("D", Deed::NotMeasurable, None, None)];
    record.amended(&by_hand, true).unwrap()
}

/// A `record.json` that names a patient, or none, and has no legs.
pub fn without_legs(scan: &str, patient: Option<&str>, revision: u32) -> Vec<u8> {
    let patient = patient.map(|id| json!({"id": id, "sources": [{"kind": "order"}]}));
    let record = json!({
        "schema": "gaiter.leg-record/1", "revision": revision, "station": "booth-1",
        "patient": patient,
        "acquired": {"at": "2026-11-21T09:14:00Z", "from": "press"},
        "made_by": {"gaiter": "0.1.0", "method": {}},
        "scan": {"sha256": scan, "format": "obj", "unit": "cm",
                 "unit_inferred": true, "points": 1, "triangles": 1},
        "body": {"stature_mm": null, "crotch_height_mm": null, "crotch_from": "saddle",
                 "facing_deg": 0.0,
                 "facing_from": "feet", "from_export": vec![0.0; 16]},
        "legs": [], "differences": null, "findings": []
    });
    record.to_string().into_bytes()
}

/// How resources are written for a FHIR server, in English, with these files as they are.
pub fn fhir_rules(attach: &[&str]) -> FhirRules {
    FhirRules {
        identifiers: "urn:gaiter:record".to_owned(),
        codes: "urn:gaiter:measure".to_owned(),
        language: Default::default(),
        garment: Default::default(),
        attach: attach.iter().map(|name| (*name).to_owned()).collect(),
    }
}

/// How messages are written for a receiver of this name, in English.
pub fn hl7_rules(receiver: &str) -> Hl7Rules {
    Hl7Rules {
        sender: ["GAITER".to_owned(), "booth-1".to_owned()],
        receiver: [receiver.to_owned(), "House & Co".to_owned()],
        processing: 'P',
        version: "2.5".to_owned(),
        authority: "KIS".to_owned(),
        coding: "99GTR".to_owned(),
        pdf: PdfForm::MediaType,
        charset: Charset::Utf8,
        language: Default::default(),
        garment: Default::default(),
    }
}

/// How objects are written for an archive of images, in English, with these files as they are.
#[cfg(feature = "dicom")]
pub fn dicom_rules(attach: &[&str]) -> DicomRules {
    DicomRules {
        issuer: String::new(),
        coding: "99GTR".to_owned(),
        language: Default::default(),
        attach: attach.iter().map(|name| (*name).to_owned()).collect(),
        names: false,
    }
}
