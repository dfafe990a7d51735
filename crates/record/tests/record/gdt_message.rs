//! GDT messages: the worked example byte by byte, every message past an independent checker, and
//! figures that come out as they went in.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;

use gaiter_leg::What;
use gaiter_record::Record;
use gaiter_record::chart::VolumeFigures;
use gaiter_record::gdt::rules::{COUNTER_MOST, FileName};
use gaiter_record::gdt::{
    Attachment, AttachmentFields, Charset, GdtRules, Product, ResultFault, WriteFault, message,
    result,
};
use gaiter_record::schema::{FindingNote, LandmarkFigures};
use gaiter_record::shape::ShapeFigures;
use gaiter_record::statement::Statement;
use gaiter_sizes::Garment;
use jiff::civil::{DateTime, date};
use proptest::prelude::*;
use serde_json::json;
use support::gdt_check::{check, checked, contents};

/// The worked example of the reference: 400 bytes in code page 1252.
const WORKED: &[u8] = b"01380006310\r\n014810000400\r\n0178315PRAX_EDV\r\n0178316LEGSCAN1\r\n\
01092063\r\n014921802.10\r\n01330004711\r\n0153101Test\xc4\xd6\r\n0133102Vor\xdc\r\n\
017310303021960\r\n017620021112026\r\n0156201091400\r\n0158402ALLG00\r\n0138410LB_L\r\n\
0238411Umfang B links\r\n013842022.4\r\n0118421cm\r\n017843221112026\r\n0158439091400\r\n\
0316228Strecke  links  rechts\r\n0166302LEG0001\r\n0126303PDF\r\n0236304Beinvermessung\r\n\
0366305\\\\srv\\gdt\\4711_20261121.pdf\r\n";

/// The rules of the worked example, with this character set.
pub fn rules(charset: Charset) -> GdtRules {
    GdtRules {
        receiver: "PRAX_EDV".into(),
        sender: "LEGSCAN1".into(),
        version: "02.10".into(),
        charset,
        procedure: "ALLG00".into(),
        attachment_fields: AttachmentFields::default(),
    }
}

fn noon() -> DateTime {
    date(2026, 11, 21).at(9, 14, 0, 0)
}

fn record(legs: serde_json::Value) -> Record {
    let columns = json!({"height_mm": [], "along_axis_mm": [], "tape_mm": [], "contour_mm": [],
                         "slope": [], "r2": 1.0, "rms_mm": 0.0});
    let none = vec![0.0; 3];
    let axis = json!({"foot_mm": none, "direction": none, "front": none, "lateral": none});
    let legs: Vec<serde_json::Value> = legs
        .as_object()
        .unwrap()
        .iter()
        .map(|(side, landmarks)| {
            json!({"side": side, "tilt_deg": 0.0, "axis": axis, "landmarks": landmarks,
                   "estimates": {}, "girth_curve": columns, "sections": [], "features": [],
                   "surface": null, "volume": VolumeFigures::default(), "at": [], "profile": [],
                   "along": [], "shape": ShapeFigures::default()})
        })
        .collect();
    serde_json::from_value(json!({
        "schema": "gaiter.leg-record/1", "revision": 1, "station": "booth-1",
        "patient": {"id": "4711", "sources": [{"kind": "order"}]}, "acquired": null,
        "made_by": {"gaiter": "0.1.0", "method": {}},
        "scan": {"sha256": "0123456789abcdef", "format": "obj", "unit": "cm",
                 "unit_inferred": true, "points": 1, "triangles": 1},
        "body": {"stature_mm": null, "crotch_height_mm": null, "crotch_from": "saddle",
                 "facing_deg": 0.0,
                 "facing_from": "feet", "from_export": vec![0.0; 16]},
        "legs": legs, "differences": null, "findings": []
    }))
    .unwrap()
}

fn landmark(height_mm: f64, girth_tape_mm: f64) -> LandmarkFigures {
    serde_json::from_value(json!({
        "by": "turn", "rule": {"is": "turning-point"},
        "height_mm": height_mm, "along_axis_mm": height_mm, "girth_tape_mm": girth_tape_mm,
        "girth_contour_mm": girth_tape_mm, "height_sd_mm": null, "girth_sd_mm": null, "doubts": []
    }))
    .unwrap()
}

#[test]
fn the_worked_example_comes_out_byte_by_byte() {
    let fields = [
        (8315, "PRAX_EDV"),
        (8316, "LEGSCAN1"),
        (9206, "3"),
        (9218, "02.10"),
        (3000, "4711"),
        (3101, "TestÄÖ"),
        (3102, "VorÜ"),
        (3103, "03021960"),
        (6200, "21112026"),
        (6201, "091400"),
        (8402, "ALLG00"),
        (8410, "LB_L"),
        (8411, "Umfang B links"),
        (8420, "22.4"),
        (8421, "cm"),
        (8432, "21112026"),
        (8439, "091400"),
        (6228, "Strecke  links  rechts"),
        (6302, "LEG0001"),
        (6303, "PDF"),
        (6304, "Beinvermessung"),
        (6305, r"\\srv\gdt\4711_20261121.pdf"),
    ];
    let fields = fields.map(|(field, content)| (field, content.to_owned()));
    let written = message(6310, Charset::Cp1252, &fields).unwrap();
    assert_eq!(written.len(), 400);
    assert_eq!(written, WORKED);
    checked(WORKED);
}

/// What of the worked example a result of ours holds: all but names, which we do not know.
#[test]
fn a_result_holds_the_fields_of_the_worked_example_in_their_order() {
    let record = record(json!({"left": {"B": landmark(118.0, 224.4)}}));
    let attachment = Attachment {
        name: "LEG0001".into(),
        format: "PDF".into(),
        description: "Beinvermessung".into(),
        path: r"\\srv\gdt\4711_20261121.pdf".into(),
    };
    let bytes =
        result(&record, &Garment::default(), &rules(Charset::Cp1252), noon(), &[attachment])
            .unwrap();
    let lines = checked(&bytes);
    let mut rest = lines.iter();
    let worked = checked(WORKED).into_iter();
    let ours = |field: &str| !["8100", "3101", "3102", "3103", "6228"].contains(&field);
    for line in worked.filter(|(field, _)| ours(field)) {
        assert!(rest.any(|its| *its == line), "{line:?} is missing or out of order: {lines:?}");
    }
}

#[test]
fn both_legs_are_blocks_and_columns_in_centimetres_with_one_decimal() {
    let left = json!({"B": landmark(118.04, 223.5), "C": landmark(301.0, 365.449)});
    let record = record(json!({"left": left, "right": {"B": landmark(117.96, 219.95)}}));
    let bytes = result(&record, &Garment::default(), &rules(Charset::Utf8), noon(), &[]).unwrap();
    let lines = checked(&bytes);
    assert_eq!(contents(&lines, "8410"), ["LB_R", "HB_R", "LC_L", "HC_L", "LB_L", "HB_L"]);
    assert_eq!(contents(&lines, "8420"), ["22.0", "11.8", "36.5", "30.1", "22.4", "11.8"]);
    assert_eq!(contents(&lines, "8421"), ["cm"; 6]);
    assert_eq!(contents(&lines, "8411")[1], "Höhe B rechts");
    assert_eq!(
        contents(&lines, "6228")[2..],
        [
            "[cm]              rechts               links",
            "        Umfang      Höhe    Umfang      Höhe",
            "G         nicht gefunden      nicht gefunden",
            "F         nicht gefunden      nicht gefunden",
            "E         nicht gefunden      nicht gefunden",
            "D         nicht gefunden      nicht gefunden",
            "C         nicht gefunden      36,5      30,1",
            "B1        nicht gefunden      nicht gefunden",
            "B         22,0      11,8      22,4      11,8",
            "Y         nicht gefunden      nicht gefunden",
            "A         nicht gefunden      nicht gefunden",
        ]
    );
    assert_eq!(contents(&lines, "9206"), [""; 0]);
}

#[test]
fn doubts_and_findings_are_told_and_what_is_only_information_is_not() {
    let mut landmark = landmark(118.0, 224.0);
    landmark.doubts = vec!["shallow".into(), "never-heard-of".into()];
    let mut record = record(json!({"left": {"B": landmark}}));
    let note = |severity: &str, message: &str| FindingNote {
        says: None,
        code: "level-absent".into(),
        severity: severity.into(),
        leg: Some("right".into()),
        level: Some("D".into()),
        message: message.into(),
    };
    record.findings = vec![note("warning", "D was not found"), note("info", "secret of the info")];
    let lines = checked(
        &result(&record, &Garment::default(), &rules(Charset::Ascii), noon(), &[]).unwrap(),
    );
    let twice = ["Hebt sich kaum ab", "never-heard-of"].repeat(2);
    assert_eq!(contents(&lines, "8470"), twice);
    assert_eq!(
        contents(&lines, "6227"),
        ["gaiter 0.1.0, Scan 01234567", "rechts D: D was not found"]
    );
    assert_eq!(contents(&lines, "8411")[1], "Hoehe B links");
    // What the character set cannot write is told by its code.
    record.findings = vec![note("error", "5° – wrong")];
    let lines = checked(
        &result(&record, &Garment::default(), &rules(Charset::Cp437), noon(), &[]).unwrap(),
    );
    assert_eq!(contents(&lines, "6227")[1], "rechts D: level-absent");
    // A statement is told in German, with umlauts as far as there are any.
    let mut said = note("warning", "the thighs touch from 702 mm on");
    said.says = Some(Statement::of_finding(&What::ThighsTouch { from_mm: 702.0 }));
    record.findings = vec![said];
    let lines = checked(
        &result(&record, &Garment::default(), &rules(Charset::Ascii), noon(), &[]).unwrap(),
    );
    let told = contents(&lines, "6227")[1..].join(" ");
    assert!(told.starts_with("rechts D: Ab 702 mm Hoehe sind die Beine eins"), "{told}");
}

#[test]
fn fields_of_attachments_are_the_product_s_in_the_order_of_their_numbers() {
    let attachment = Attachment {
        name: "n".into(),
        format: "SVG".into(),
        description: "d".into(),
        path: "p".into(),
    };
    let mut rules = rules(Charset::Cp1252);
    rules.attachment_fields = Product::FormatFirst.attachment_fields();
    let lines = checked(
        &result(&record(json!({})), &Garment::default(), &rules, noon(), &[attachment]).unwrap(),
    );
    let tail: Vec<String> = lines[lines.len() - 3..]
        .iter()
        .map(|(field, content)| format!("{field} {}", String::from_utf8_lossy(content)))
        .collect();
    assert_eq!(tail, ["6302 SVG", "6303 p", "6304 d"]);
}

#[test]
fn unassigned_record_and_an_id_that_cannot_be_written_make_no_message() {
    let mut record = record(json!({}));
    record.patient.as_mut().unwrap().id = "Ł4711".into();
    let fault =
        result(&record, &Garment::default(), &rules(Charset::Cp1252), noon(), &[]).unwrap_err();
    let unwritable =
        matches!(fault, ResultFault::Write(WriteFault::Unwritable { field: 3000, .. }));
    assert!(unwritable, "{fault}");
    record.patient = None;
    let fault =
        result(&record, &Garment::default(), &rules(Charset::Cp1252), noon(), &[]).unwrap_err();
    assert_eq!(fault, ResultFault::NoPatient);
}

#[test]
fn profiles_differ_in_version_and_character_set() {
    let of = |product: Product| (product.version(), product.charset());
    assert_eq!(of(Product::Default), ("02.10", Charset::Cp1252));
    assert_eq!(of(Product::Medistar), ("02.10", Charset::Cp1252));
    assert_eq!(of(Product::Turbomed), ("02.00", Charset::Cp1252));
    assert_eq!(of(Product::Tomedo), ("02.10", Charset::Utf8));
    assert_eq!(of(Product::FormatFirst), ("02.10", Charset::Cp1252));
}

#[test]
fn the_checker_sees_each_kind_of_damage() {
    let damaged = |at: usize, byte: u8| {
        let mut bytes = WORKED.to_vec();
        bytes[at] = byte;
        check(&bytes).is_err()
    };
    assert!(damaged(2, b'4'), "a length");
    assert!(damaged(25, b'1'), "the total");
    assert!(damaged(11, b' '), "an end");
    assert!(check(&WORKED[..WORKED.len() - 2]).is_err(), "cut short");
    let mut in_437 = WORKED.to_vec();
    let umlaut = in_437.iter().position(|byte| *byte == 0xc4).unwrap();
    in_437[umlaut] = 0x8d;
    assert!(check(&in_437).is_err(), "the character set");
}

fn charset() -> impl Strategy<Value = Charset> {
    prop::sample::select(vec![Charset::Ascii, Charset::Cp437, Charset::Cp1252, Charset::Utf8])
}

fn landmarks() -> impl Strategy<Value = BTreeMap<String, LandmarkFigures>> {
    let level = prop::sample::select(vec!["A", "Y", "B", "B1", "C", "D", "E", "F", "G"]);
    let figures = (0.0..1200.0_f64, 0.0..1500.0_f64).prop_map(|(h, g)| landmark(h, g));
    prop::collection::btree_map(level.prop_map(str::to_owned), figures, 0..9)
}

proptest! {
    #[test]
    fn every_record_s_message_passes_the_checker_and_holds_its_figures(
        left in landmarks(),
        right in landmarks(),
        messages in prop::collection::vec(".{0,300}", 0..5),
        charset in charset(),
    ) {
        let mut record = record(json!({"left": left, "right": right}));
        record.findings = messages.into_iter().map(|message| FindingNote { says: None,
            code: "code".into(),
            severity: "warning".into(),
            leg: None,
            level: None,
            message,
        }).collect();
        let bytes = result(&record, &Garment::default(), &rules(charset), noon(), &[]).unwrap();
        let lines = check(&bytes).map_err(TestCaseError::fail)?;
        prop_assert_eq!(bytes, result(&record, &Garment::default(), &rules(charset), noon(), &[]).unwrap());
        let figures: BTreeMap<String, f64> = contents(&lines, "8410")
            .into_iter()
            .zip(contents(&lines, "8420").iter().map(|figure| figure.parse().unwrap()))
            .collect();
        let heights = |levels: &BTreeMap<String, LandmarkFigures>| {
            levels.keys().filter(|level| !["A", "Y"].contains(&level.as_str())).count()
        };
        let all = left.len() + heights(&left) + right.len() + heights(&right);
        prop_assert_eq!(figures.len(), all);
        for (letter, landmarks) in [("L", &left), ("R", &right)] {
            for (level, found) in landmarks {
                let girth = figures[&format!("L{level}_{letter}")] * 10.0;
                prop_assert!((girth - found.girth_tape_mm).abs() <= 0.5 + 1e-9);
                if let Some(height) = figures.get(&format!("H{level}_{letter}")) {
                    prop_assert!((height * 10.0 - found.height_mm).abs() <= 0.5 + 1e-9);
                }
            }
        }
        let longest = lines.iter().filter(|(field, _)| field.starts_with("622"));
        let text = |content: &[u8]| String::from_utf8_lossy(content).chars().count();
        prop_assert!(longest.map(|(_, content)| text(content)).all(|length| length <= 60));
    }

    #[test]
    fn file_names_of_numbers_differ(a in 1..=COUNTER_MOST, b in 1..=COUNTER_MOST) {
        let name = FileName::new("{receiver}{sender}.{counter}", "PRAX_EDV", "LEGSCAN1").unwrap();
        prop_assert_eq!(a == b, name.of(a) == name.of(b));
    }
}
