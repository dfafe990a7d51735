//! What a record, its spreadsheet and its drawing say about each level.

#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use gaiter::cad::Output;
use gaiter::leg::method::{B1, LevelChoices};
use gaiter::leg::{Extraction, Level, Method};
use gaiter::record::{Provenance, Record, ReportChoice, ScanFile, record_files, sha256};
use gaiter::scan::Format;
use support::geometry::bodies::{export, record_of};

static BYTES: LazyLock<Vec<u8>> = LazyLock::new(|| export("f_average_clean"));

static MEASURED: LazyLock<(Extraction, Record)> =
    LazyLock::new(|| record_of(&BYTES, &Method::default()));

/// A text file of the record folder.
fn file(extraction: &Extraction, name: &str) -> String {
    let sha256 = sha256(&BYTES);
    let provenance = Provenance::of_scan(sha256);
    let output = Output::default();
    let choice = ReportChoice::default();
    let scan = ScanFile { bytes: &BYTES, format: Format::Obj, ord: None };
    let method = Method::default();
    let files = record_files(extraction, &provenance, &method, &output, &choice, scan).unwrap().1;
    let file = files.into_iter().find(|file| file.name == name).unwrap();
    String::from_utf8(file.bytes).unwrap()
}

#[test]
fn estimates_stand_under_estimates_with_their_proportion_and_never_under_landmarks() {
    let json = serde_json::to_value(&MEASURED.1).unwrap();
    for leg in json["legs"].as_array().unwrap() {
        let keys = |part: &str| -> Vec<String> {
            leg[part].as_object().unwrap().keys().cloned().collect()
        };
        assert_eq!(keys("landmarks"), ["B", "B1", "C", "D", "G", "Y"]);
        assert_eq!(keys("estimates"), ["A", "E", "F"]);
        let e = &leg["estimates"]["E"]["by"];
        assert_eq!(e, "mean of 0.277 of the stature and 45 mm above D");
        assert_eq!(leg["landmarks"]["G"]["by"], "50 mm below the crotch");
        assert!(leg["landmarks"]["Y"]["surface_length_mm"].is_null());
        assert!(leg["foot"]["length_mm"].as_f64().unwrap() > 200.0);
    }
    let method = &json["made_by"]["method"];
    assert_eq!((&method["b1"], &method["g_below_crotch"]), (&"steepest".into(), &"50mm".into()));
}

#[test]
fn a_chosen_b1_is_named_in_the_method_and_at_the_level() {
    let levels = LevelChoices { b1: B1::AboveB { distance_mm: 80.0 }, g_below_crotch_mm: 30.0 };
    let (_, record) = record_of(&BYTES, &Method { levels, ..Method::default() });
    let method = &record.made_by.method;
    assert_eq!(
        ["b1", "b1_above_b", "g_below_crotch"].map(|key| method[key].as_str()),
        ["above-b", "80mm", "30mm"]
    );
    for (leg, plain) in record.legs.iter().zip(&MEASURED.1.legs) {
        let b1 = &leg.landmarks["B1"];
        assert_eq!(b1.by, "80 mm above B");
        assert!((b1.height_mm - leg.landmarks["B"].height_mm - 80.0).abs() < 0.01);
        let lower = leg.landmarks["G"].height_mm - plain.landmarks["G"].height_mm;
        assert!((lower - 20.0).abs() < 0.01, "{lower}");
    }
}

#[test]
fn the_spreadsheet_has_a_line_for_every_level_of_both_legs() {
    let text = file(&MEASURED.0, "measurements.csv");
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(lines.len(), 1 + 2 * Level::ALL.len());
    assert!(lines.iter().all(|cells| cells.len() == lines[0].len()), "{text}");
    let doubts = lines[0].iter().position(|name| *name == "doubts").unwrap();
    for cells in &lines[1..] {
        let is_estimate = ["A", "E", "F"].contains(&cells[1]);
        assert_eq!(cells[doubts].starts_with("estimate"), is_estimate, "{cells:?}");
        assert_eq!(cells[5].is_empty(), is_estimate, "no contour is estimated: {cells:?}");
    }
}

#[test]
fn an_absent_level_has_an_empty_line_and_none_in_the_drawing() {
    let mut extraction = MEASURED.0.clone();
    for leg in &mut extraction.legs {
        leg.landmarks.retain(|landmark| landmark.level != Level::G);
        leg.estimates.clear();
        leg.foot = None;
    }
    let text = file(&extraction, "measurements.csv");
    for level in ["A", "E", "F", "G"] {
        assert!(text.contains(&format!("left,{level},,,,,,,absent,,\r\n")), "{text}");
    }
    let (plain, without) = (file(&MEASURED.0, "legs.svg"), file(&extraction, "legs.svg"));
    for mark in [">G ", ">≈ E ", ">≈ F ", "≈ A "] {
        assert!(plain.contains(mark) && !without.contains(mark), "{mark}");
    }
}
