//! What a record states of an extraction: the same whatever the export's unit and however often it is
//! made, with the method that was used and the heights that were asked for.

#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use gaiter_leg::method::{AxisFit, SectionFit, Tape, Unit, UnitChoice};
use gaiter_leg::{Extraction, Level, Method};
use gaiter_record::Record;
use gaiter_scan::Scan;
use serde_json::Value;
use support::recorded::{export, obj, scan};
use support::records::record_of;

/// The body, in mm.
static BODY: LazyLock<Scan> = LazyLock::new(|| scan("f_average_clean"));

/// What is measured on it as it is.
static PLAIN: LazyLock<(Extraction, Record)> =
    LazyLock::new(|| record_of(&obj(&BODY), &Method::default()));

/// A record's measures as JSON, without what describes the file.
fn measures(record: &Record) -> Value {
    let mut value = serde_json::to_value(record).unwrap();
    value["body"].as_object_mut().unwrap().remove("from_export");
    serde_json::json!({"body": value["body"], "legs": value["legs"], "findings": value["findings"]})
}

/// All numbers equal to 1e-6 or to the last place that is written for their unit; all else equal.
fn equal(found: &Value, expected: &Value, name: &str, numbers: &mut usize) {
    match (found, expected) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap(), b.as_f64().unwrap());
            let last_place = match name {
                _ if name.ends_with("_per_mm") => 1e-5,
                _ if name.ends_with("_mm") => 1e-3,
                _ if name.ends_with("_deg") => 1e-2,
                _ => 1e-6,
            };
            let limit = 1e-6 * b.abs() + 1.01 * last_place;
            assert!((a - b).abs() <= limit, "{name}: {a} for {b}");
            *numbers += 1;
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{name}");
            a.iter().zip(b).for_each(|(a, b)| equal(a, b, name, numbers));
        }
        (Value::Object(a), Value::Object(b)) => {
            assert!(a.keys().eq(b.keys()), "{name}: {:?} for {:?}", a.keys(), b.keys());
            a.iter().for_each(|(key, value)| equal(value, &b[key], key, numbers));
        }
        _ => assert_eq!(found, expected, "{name}"),
    }
}

#[test]
fn every_unit_gives_the_same_record() {
    let units = [(Unit::Mm, 1.0), (Unit::Cm, 10.0), (Unit::In, 25.4), (Unit::M, 1000.0)];
    for (unit, in_mm) in units {
        let points = BODY.points.iter().map(|p| p / in_mm).collect();
        let bytes = obj(&Scan { points, triangles: BODY.triangles.clone() });
        for choice in [UnitChoice::Auto, UnitChoice::Declared(unit)] {
            let method = Method { unit: choice, ..Method::default() };
            let (_, record) = record_of(&bytes, &method);
            assert_eq!(record.scan.unit, unit.word());
            assert_eq!(record.scan.unit_inferred, choice == UnitChoice::Auto);
            let mut numbers = 0;
            equal(&measures(&record), &measures(&PLAIN.1), "record", &mut numbers);
            assert!(numbers > 1000, "only {numbers} numbers");
        }
    }
}

#[test]
fn two_runs_give_the_same_bytes() {
    let bytes = obj(&scan("f_average_tc2"));
    let json = || serde_json::to_vec(&record_of(&bytes, &Method::default()).1).unwrap();
    let first = json();
    assert!(first == json(), "two runs");
}

#[test]
fn the_record_names_the_paper_s_method() {
    let tape = Tape::Leg(AxisFit::Principal);
    let method = Method { fit: SectionFit::Paper, tape, ..Method::default() };
    let words = record_of(&obj(&BODY), &method).1.made_by.method;
    let words = ["fit", "tape", "axis"].map(|key| words[key].as_str());
    assert_eq!(words, ["paper", "leg", "principal"]);
}

#[test]
fn the_tilt_of_a_leg_is_that_of_its_shank() {
    for name in ["f_average_clean", "m_average_clean", "f_average_tc2"] {
        let (_, record) = record_of(&export(name), &Method::default());
        assert_eq!(record.legs.len(), 2, "{name}");
        for leg in &record.legs {
            let [_, _, up] = leg.axes.as_ref().unwrap().shank.direction;
            let off_deg = leg.tilt_deg - up.acos().to_degrees();
            assert!(off_deg.abs() < 0.01, "{name} {}: {off_deg}", leg.side);
        }
    }
}

#[test]
fn heights_asked_for_are_named_in_the_method_and_have_a_girth_each() {
    let landmarks = PLAIN.0.legs[0].landmarks.iter();
    let across = landmarks.filter(|at| Level::SOUGHT.contains(&at.level));
    let levels: Vec<f64> = across.map(|at| at.height_mm).collect();
    let method = Method { at_heights_mm: levels.clone(), ..Method::default() };
    let (_, record) = record_of(&obj(&BODY), &method);
    assert_eq!(record.legs[0].at.len(), 4);
    let asked = levels.iter().map(|height| ((height * 1e3).round() / 1e3).to_string());
    let asked = asked.collect::<Vec<_>>().join(", ");
    assert_eq!(record.made_by.method["at_heights_mm"], asked);
}

#[test]
fn a_height_that_no_leg_has_is_null_and_a_finding_of_each_leg() {
    let method = Method { at_heights_mm: vec![200.0, 900.0], ..Method::default() };
    let (_, record) = record_of(&obj(&BODY), &method);
    let missing: Vec<_> =
        record.findings.iter().filter(|f| f.code == "height-not-measured").collect();
    let legs: Vec<_> = missing.iter().map(|finding| finding.leg.as_deref().unwrap()).collect();
    assert_eq!(legs, ["left", "right"]);
    assert!(missing[0].message.starts_with("no girth at 900 mm: girths were measured from"));
    for leg in &record.legs {
        assert!(leg.at[0].girth_tape_mm.is_some() && leg.at[0].doubts.is_empty());
        let none = &leg.at[1];
        assert_eq!(none.height_mm, 900.0);
        let figures =
            [none.along_axis_mm, none.girth_tape_mm, none.girth_contour_mm, none.girth_sd_mm];
        assert_eq!(figures, [None; 4]);
        assert_eq!(none.doubts, ["height-not-measured"]);
    }
    assert_eq!(record.legs.len(), 2);
}
