//! What a record states of an extraction: the same however often it is made, with the method that was used
//! and the heights that were asked for.

#![allow(clippy::unwrap_used)]

use gaiter_leg::method::{AxisFit, SectionFit, Tape};
use gaiter_leg::{Level, Method, WholeBody, extract_crop};
use gaiter_record::same_numbers::crop_differs;
use support::recorded::export;
use support::records::{bodies, measured, record_of};

/// What most tests measure.
const BODY: &str = "f_average_clean";

#[test]
fn two_runs_give_the_same_bytes() {
    let bytes = export("f_average_tc2");
    let json = || serde_json::to_vec(&record_of(&bytes, &Method::default()).1).unwrap();
    let first = json();
    assert!(first == json(), "two runs");
}

#[test]
fn the_record_names_the_paper_s_method() {
    let tape = Tape::Leg(AxisFit::Principal);
    let method = Method { fit: SectionFit::Paper, tape, ..Method::default() };
    let words = record_of(&export(BODY), &method).1.made_by.method;
    let words = ["fit", "tape", "axis"].map(|key| words[key].as_str());
    assert_eq!(words, ["paper", "leg", "principal"]);
}

#[test]
fn the_tilt_of_a_leg_is_that_of_its_shank() {
    for (name, _, record) in bodies() {
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
    let landmarks = measured(BODY).0.legs[0].landmarks.iter();
    let across = landmarks.filter(|at| Level::SOUGHT.contains(&at.level));
    let levels: Vec<f64> = across.map(|at| at.height_mm).collect();
    let method = Method { at_heights_mm: levels.clone(), ..Method::default() };
    let (_, record) = record_of(&export(BODY), &method);
    assert_eq!(record.legs[0].at.len(), 4);
    let asked = levels.iter().map(|height| ((height * 1e3).round() / 1e3).to_string());
    let asked = asked.collect::<Vec<_>>().join(", ");
    assert_eq!(record.made_by.method["at_heights_mm"], asked);
}

#[test]
fn a_height_that_no_leg_has_is_null_and_a_finding_of_each_leg() {
    let method = Method { at_heights_mm: vec![200.0, 900.0], ..Method::default() };
    let (_, record) = record_of(&export(BODY), &method);
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

#[test]
fn the_record_of_a_crop_says_what_that_of_the_whole_says() {
    let (whole, method) = (&measured(BODY).0, Method::default());
    let crop = |told: &WholeBody| extract_crop(&whole.crop().to_ply(), told, &method).unwrap();
    let mut told = WholeBody::from_extraction(whole);
    assert_eq!(crop_differs(whole, &crop(&told), &method).unwrap(), None);
    told.body.scale_mm *= 1.02;
    let differs = crop_differs(whole, &crop(&told), &method).unwrap();
    assert!(differs.is_some_and(|differs| differs.starts_with('.')), "another stature");
}
