//! Bare point clouds: the recorded bodies without their triangles are measured as with them.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeMap;
use std::sync::LazyLock;

use gaiter_leg::{Method, extract};
use gaiter_record::schema::LegFigures;
use gaiter_record::{Provenance, Record, record, sha256};
use gaiter_scan::Scan;
use nalgebra::Point3;
use serde_json::Value;
use support::chance::Chance;
use support::recorded::{export, scan, truth};
use support::records::record_of;
use support::writers::Writer;

/// The bodies and the noise of their points, mm.
const BODIES: [(&str, f64); 3] =
    [("f_average_clean", 0.0), ("m_average_clean", 0.0), ("f_average_tc2", 0.5)];

/// Half of the girths at B, C and D are this near to the true ones, mm, and 0.8 times the noise …
const GIRTH_MM: f64 = 0.3;

/// … and all of them within this many times that.
const WORST: f64 = 2.5;

/// Girths of a cloud and of its mesh, mm.
const CLOUD_TO_MESH_MM: f64 = 0.3;

/// Heights, mm, or the truth's `flat_mm` where that is more.
const HEIGHT_MM: f64 = 6.0;

/// Each body's cloud measured once.
static CLOUDS: LazyLock<BTreeMap<&str, Record>> = LazyLock::new(|| {
    let one = |(name, _)| (name, measured(&points(name), Writer::Xyz));
    BODIES.into_iter().map(one).collect()
});

/// The points of a body, in the order of its export.
fn points(name: &str) -> Vec<Point3<f64>> {
    scan(name).points
}

/// What is measured on a bare cloud, written to a file of its own format.
#[track_caller]
fn measured(points: &[Point3<f64>], writer: Writer) -> Record {
    let bytes = writer.write(&Scan { points: points.to_vec(), triangles: vec![] });
    let method = Method::default();
    let found = extract(&bytes, writer.format(), &method).unwrap();
    let provenance = Provenance::of_scan(sha256(&bytes));
    record(&found, &provenance, &method)
}

/// What was measured, without what is the file's own.
fn figures(record: &Record) -> String {
    let mut record = serde_json::to_value(record).unwrap();
    record.as_object_mut().unwrap().remove("scan").unwrap();
    record.to_string()
}

/// Girth and height of B, C and D of both legs beside the truth of the same leg.
fn levels<'a>(record: &'a Record, truth: &'a Value) -> Vec<([f64; 2], &'a Value)> {
    let sides: Vec<&str> = record.legs.iter().map(|leg| leg.side.as_str()).collect();
    assert_eq!(sides, ["left", "right"]);
    let of_leg = |leg: &'a LegFigures| {
        ["B", "C", "D"].map(|level| {
            let at = &leg.landmarks[level];
            let own = &truth["legs"][&leg.side]["landmarks"][level];
            ([at.girth_tape_mm, at.height_mm], own)
        })
    };
    record.legs.iter().flat_map(of_leg).collect()
}

/// How far each girth is off the true one, mm, smallest first.
fn girths_off(record: &Record, truth: &Value) -> Vec<f64> {
    let off = |([girth_mm, _], own): &([f64; 2], &Value)| {
        (girth_mm - own["tape_mm"].as_f64().unwrap()).abs()
    };
    let mut off: Vec<f64> = levels(record, truth).iter().map(off).collect();
    off.sort_by(f64::total_cmp);
    off
}

/// Fails where a height is further off the true one than the limit or the level is flat.
#[track_caller]
fn check_heights(name: &str, record: &Record, truth: &Value, limit_mm: f64) {
    for ([_, height_mm], own) in levels(record, truth) {
        let limit_mm = limit_mm.max(own["flat_mm"].as_f64().unwrap_or(0.0));
        let off = height_mm - own["height_mm"].as_f64().unwrap();
        assert!(off.abs() <= limit_mm, "{name}: {height_mm} mm, {off:+.1}, within {limit_mm}");
    }
}

#[test]
fn b_c_and_d_of_a_cloud_are_the_true_ones() {
    for (name, noise_mm) in BODIES {
        let (record, truth) = (&CLOUDS[name], truth(name));
        let off = girths_off(record, &truth);
        let limit_mm = GIRTH_MM + 0.8 * noise_mm;
        assert!(off[off.len() / 2] <= limit_mm, "{name}: {off:?}");
        assert!(off[off.len() - 1] <= WORST * limit_mm, "{name}: {off:?}");
        check_heights(name, record, &truth, HEIGHT_MM);
        assert!(record.legs.iter().all(|leg| leg.landmarks.contains_key("B1")), "{name}");
    }
}

#[test]
fn a_cloud_s_girths_are_those_of_its_mesh() {
    for (name, _) in BODIES {
        let (_, mesh) = record_of(&export(name), &Method::default());
        for (own, whole) in CLOUDS[name].legs.iter().zip(&mesh.legs) {
            assert!(own.landmarks.keys().eq(whole.landmarks.keys()), "{name} {}", own.side);
            for level in ["B", "C", "D"] {
                let [own_mm, mesh_mm] = [own, whole].map(|leg| leg.landmarks[level].girth_tape_mm);
                let off = own_mm - mesh_mm;
                assert!(off.abs() <= CLOUD_TO_MESH_MM, "{name} {} {level}: {off:+.3}", own.side);
            }
        }
    }
}

#[test]
fn sides_unit_and_facing_of_a_cloud_are_the_body_s() {
    for (name, _) in BODIES {
        let (record, truth) = (&CLOUDS[name], truth(name));
        assert_eq!(record.scan.unit, truth["unit"], "{name}");
        assert!(record.scan.unit_inferred && record.body.facing_from == "feet", "{name}");
        let off_deg = record.body.facing_deg - truth["facing_deg"].as_f64().unwrap();
        assert!(off_deg.abs() <= 3.0, "{name}: {off_deg}");
        for leg in &record.legs {
            let girths = |side: &str| {
                ["B", "C"].map(|l| truth["legs"][side]["landmarks"][l]["tape_mm"].as_f64().unwrap())
            };
            let found = ["B", "C"].map(|level| leg.landmarks[level].girth_tape_mm);
            let differ = |side| {
                let pairs = girths(side).into_iter().zip(found);
                pairs.map(|(a, b): (f64, f64)| (a - b).abs()).fold(0.0, f64::max)
            };
            let other = if leg.side == "left" { "right" } else { "left" };
            assert!(differ(&leg.side) < differ(other) / 2.0, "{name} {}", leg.side);
            let sign = if leg.side == "left" { 1.0 } else { -1.0 };
            assert!(!leg.features.is_empty());
            assert!(leg.features.iter().all(|f| f.position_mm[0] * sign > 0.0), "{name}");
        }
    }
}

#[test]
fn a_cloud_is_the_same_in_text_and_binary_shuffled_and_with_points_repeated() {
    for (name, _) in BODIES {
        let plain = figures(&CLOUDS[name]);
        let mut points = points(name);
        assert_eq!(figures(&measured(&points, Writer::PlyLittle)), plain, "{name} binary");
        let mut chance = Chance(7);
        for last in (1..points.len()).rev() {
            points.swap(last, chance.below(last + 1));
        }
        assert_eq!(figures(&measured(&points, Writer::Xyz)), plain, "{name} shuffled");
        // Corners of triangles, as a list of points made of an STL file has them.
        points.extend_from_within(..points.len() / 3);
        points.extend_from_within(..points.len() / 2);
        assert_eq!(figures(&measured(&points, Writer::PlyLittle)), plain, "{name} repeated");
    }
}

#[test]
fn a_cloud_of_every_third_point_is_measured_to_a_millimetre() {
    for (name, noise_mm) in BODIES {
        let third: Vec<Point3<f64>> = points(name).into_iter().step_by(3).collect();
        let (record, truth) = (measured(&third, Writer::PlyLittle), truth(name));
        let off = girths_off(&record, &truth);
        assert!(off[off.len() - 1] <= 1.0, "{name}: {off:?}");
        // Points 11 mm apart with noise leave a flat calf's height less certain.
        check_heights(name, &record, &truth, HEIGHT_MM + 8.0 * noise_mm);
    }
}

#[test]
fn an_obj_without_faces_is_named_because_its_cut_would_not_show() {
    let points = points("f_average_clean");
    let codes = |writer| -> Vec<String> {
        measured(&points, writer).findings.into_iter().map(|finding| finding.code).collect()
    };
    assert_eq!(codes(Writer::Obj), ["no-faces"]);
    assert_eq!(codes(Writer::Xyz), [""; 0]);
}
