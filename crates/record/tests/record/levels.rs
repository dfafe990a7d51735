//! What a record, its spreadsheet and its drawing say about each level.

#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use gaiter_cad::Output;
use gaiter_language::Language;
use gaiter_leg::method::{B1, LevelChoices};
use gaiter_leg::{Extraction, Level, Method};
use gaiter_record::{Provenance, Record, ReportChoice, ScanFile, record_files, sha256};
use gaiter_scan::Format;
use support::recorded::export;
use support::records::{measured, record_of};

static BYTES: LazyLock<Vec<u8>> = LazyLock::new(|| export("f_average_clean"));

static MEASURED: LazyLock<&(Extraction, Record)> = LazyLock::new(|| measured("f_average_clean"));

/// A text file of the record folder.
fn file(extraction: &Extraction, name: &str) -> String {
    file_in(Language::En, extraction, name)
}

fn file_in(language: Language, extraction: &Extraction, name: &str) -> String {
    let sha256 = sha256(&BYTES);
    let provenance = Provenance::of_scan(sha256);
    let output = Output::default();
    let choice = ReportChoice { language, ..ReportChoice::default() };
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

/// The cells of the lines after the head and the verdict, which has commas of its own.
fn cells(text: &str) -> Vec<Vec<&str>> {
    text.split("\r\n")
        .skip(2)
        .filter(|line| !line.is_empty())
        .map(|l| l.split(',').collect())
        .collect()
}

#[test]
fn the_spreadsheet_begins_with_the_verdict_and_has_a_line_for_every_level_in_the_order_of_the_sheet()
 {
    let text = file(&MEASURED.0, "measurements.csv");
    let mut lines = text.split("\r\n");
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let verdict = lines.next().unwrap();
    let said = "\"Complete: all measures for a calf stocking (AD) were taken.\"";
    assert_eq!(verdict, format!(",verdict,complete,,,,,,,,,{said},,"));
    let rows = cells(&text);
    let levels = ["G", "F", "E", "D", "C", "B1", "B", "Y", "A"];
    let places: Vec<[&str; 2]> = rows.iter().map(|row| [row[0], row[1]]).collect();
    let expected = ["right", "left"].map(|leg| levels.map(|level| [leg, level])).concat();
    assert_eq!(places, expected);
    let at = |name: &str| head.iter().position(|its| *its == name).unwrap();
    for row in rows {
        assert_eq!(row.len(), head.len(), "{row:?}");
        let is_estimate = ["A", "E", "F"].contains(&row[1]);
        assert_eq!(row[at("state")], if is_estimate { "estimated" } else { "measured" }, "{row:?}");
        assert_eq!(row[at("girth_contour_mm")].is_empty(), is_estimate, "{row:?}");
        let is_on_foot = ["A", "Y"].contains(&row[1]);
        assert_eq!(row[at("height_cm")].is_empty(), is_on_foot, "{row:?}");
    }
}

#[test]
fn the_table_for_people_has_the_headings_decimal_sign_and_separator_of_their_language() {
    let exact = file_in(Language::De, &MEASURED.0, "measurements.csv");
    assert!(exact.starts_with("leg,level,state,girth_cm,"), "{exact}");
    let german = file_in(Language::De, &MEASURED.0, "measurements-spreadsheet.csv");
    assert!(german.starts_with("\u{feff}Bein;Messpunkt;Stand;Umfang in cm;"), "{german}");
    let rows = german.split("\r\n").skip(2).filter(|line| !line.is_empty());
    let rows: Vec<Vec<&str>> = rows.map(|line| line.split(';').collect()).collect();
    let exact = cells(&exact);
    assert_eq!(exact.len(), rows.len());
    let mut figures = 0;
    for (exact, told) in exact.concat().into_iter().zip(rows.concat()) {
        match exact.parse::<f64>() {
            Ok(_) => assert_eq!(told, exact.replace('.', ",")),
            Err(_) => assert_eq!(told, exact),
        }
        figures += usize::from(exact.parse::<f64>().is_ok());
    }
    assert!(figures > 50, "{figures}");
    let english = file(&MEASURED.0, "measurements-spreadsheet.csv");
    let (head, lines) = english.split_once("\r\n").unwrap();
    assert!(head.starts_with("\u{feff}Leg,Level,State,Girth in cm,"), "{head}");
    let exact = file(&MEASURED.0, "measurements.csv");
    assert_eq!(Some(lines), exact.split_once("\r\n").map(|(_, lines)| lines));
    assert_eq!(head.split(',').count(), exact.lines().next().unwrap().split(',').count());
}

#[test]
fn a_level_that_was_not_found_says_so_in_the_spreadsheet_and_is_not_in_the_drawing() {
    let mut extraction = MEASURED.0.clone();
    for leg in &mut extraction.legs {
        leg.landmarks.retain(|landmark| landmark.level != Level::G);
        leg.estimates.clear();
        leg.foot = None;
    }
    let text = file(&extraction, "measurements.csv");
    for level in ["A", "E", "F", "G"] {
        assert!(text.contains(&format!("left,{level},not found,,,,,,,,,,,\r\n")), "{text}");
    }
    let (plain, without) = (file(&MEASURED.0, "legs.svg"), file(&extraction, "legs.svg"));
    for mark in [">R G ", ">R ≈ E ", ">L ≈ F ", "≈ A "] {
        assert!(plain.contains(mark) && !without.contains(mark), "{mark}");
    }
}
