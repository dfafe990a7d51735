//! Bare point clouds: the recorded bodies without their triangles are measured as with them.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeMap;
use std::sync::LazyLock;

use gaiter_leg::{Extraction, FacingFrom, LegReport, Level, Method, Side, extract};
use gaiter_scan::Scan;
use nalgebra::Point3;
use serde_json::Value;
use support::chance::Chance;
use support::recorded::{export, scan, truth};
use support::writers::Writer;

use crate::found::{self, B_C_D, extraction_of, features, landmark};

/// The bodies and the noise of their points, mm.
const BODIES: [(&str, f64); 3] =
    [("f_average_clean", 0.0), ("m_average_clean", 0.0), ("f_average_tc2", 0.5)];

/// Half of the girths at B, C and D are this near to the true ones, mm, and 0.8 times the noise …
const GIRTH_MM: f64 = 0.3;

/// … and all of them within this many times that.
const WORST: f64 = 2.5;

/// Girths of a cloud and of its mesh, mm.
const CLOUD_TO_MESH_MM: f64 = 0.35;

/// Heights, mm, or the truth's `flat_mm` where that is more.
const HEIGHT_MM: f64 = 6.0;

/// Each body's cloud measured once.
static CLOUDS: LazyLock<BTreeMap<&str, Extraction>> = LazyLock::new(|| {
    let one = |(name, _)| (name, measured(&points(name), Writer::Xyz));
    BODIES.into_iter().map(one).collect()
});

/// The points of a body, in the order of its export.
fn points(name: &str) -> Vec<Point3<f64>> {
    scan(name).points
}

/// What is measured on a bare cloud, written to a file of its own format.
#[track_caller]
fn measured(points: &[Point3<f64>], writer: Writer) -> Extraction {
    let bytes = writer.write(&Scan { points: points.to_vec(), triangles: vec![] });
    extract(&bytes, writer.format(), &Method::default()).unwrap()
}

/// What was measured, to the last bit, without what is the file's own.
fn figures(found: &Extraction) -> String {
    let Extraction { body, crotch, legs, differences, findings, .. } = found;
    let findings: Vec<_> = findings.iter().filter(|f| f.code() != "no-faces").collect();
    format!("{:?}", (body, crotch, legs, differences, findings))
}

/// Girth and height of B, C and D of both legs beside the truth of the same leg.
fn levels<'a>(found: &Extraction, truth: &'a Value) -> Vec<([f64; 2], &'a Value)> {
    let sides: Vec<Side> = found.legs.iter().map(|leg| leg.side).collect();
    assert_eq!(sides, Side::BOTH);
    let of_leg = |leg: &LegReport| {
        let truth = &truth["legs"][leg.side.word()]["landmarks"];
        B_C_D.map(|level| {
            let at = landmark(leg, level);
            ([at.girth_tape_mm, at.height_mm], &truth[level.name()])
        })
    };
    found.legs.iter().flat_map(of_leg).collect()
}

/// How far each girth is off the true one, mm, smallest first.
fn girths_off(found: &Extraction, truth: &Value) -> Vec<f64> {
    let off = |([girth_mm, _], own): &([f64; 2], &Value)| {
        (girth_mm - own["tape_mm"].as_f64().unwrap()).abs()
    };
    let mut off: Vec<f64> = levels(found, truth).iter().map(off).collect();
    off.sort_by(f64::total_cmp);
    off
}

/// Fails where a height is further off the true one than the limit or the level is flat.
#[track_caller]
fn check_heights(name: &str, found: &Extraction, truth: &Value, limit_mm: f64) {
    for ([_, height_mm], own) in levels(found, truth) {
        let limit_mm = limit_mm.max(own["flat_mm"].as_f64().unwrap_or(0.0));
        let off = height_mm - own["height_mm"].as_f64().unwrap();
        assert!(off.abs() <= limit_mm, "{name}: {height_mm} mm, {off:+.1}, within {limit_mm}");
    }
}

#[test]
fn b_c_and_d_of_a_cloud_are_the_true_ones() {
    for (name, noise_mm) in BODIES {
        let (found, truth) = (&CLOUDS[name], truth(name));
        let off = girths_off(found, &truth);
        let limit_mm = GIRTH_MM + 0.8 * noise_mm;
        assert!(off[off.len() / 2] <= limit_mm, "{name}: {off:?}");
        assert!(off[off.len() - 1] <= WORST * limit_mm, "{name}: {off:?}");
        check_heights(name, found, &truth, HEIGHT_MM);
        let has_b1 = |leg: &LegReport| found::levels(leg).contains(&Level::B1);
        assert!(found.legs.iter().all(has_b1), "{name}");
    }
}

#[test]
fn a_cloud_s_girths_are_those_of_its_mesh() {
    for (name, _) in BODIES {
        let mesh = extraction_of(&export(name), &Method::default());
        for (own, whole) in CLOUDS[name].legs.iter().zip(&mesh.legs) {
            let side = own.side.word();
            assert_eq!(found::levels(own), found::levels(whole), "{name} {side}");
            for level in B_C_D {
                let [own_mm, mesh_mm] = [own, whole].map(|leg| landmark(leg, level).girth_tape_mm);
                let off = own_mm - mesh_mm;
                let what = format!("{name} {side} {}: {off:+.3}", level.name());
                assert!(off.abs() <= CLOUD_TO_MESH_MM, "{what}");
            }
        }
    }
}

#[test]
fn sides_unit_and_facing_of_a_cloud_are_the_body_s() {
    for (name, _) in BODIES {
        let (Extraction { body, legs, .. }, truth) = (&CLOUDS[name], truth(name));
        assert_eq!(body.unit.word(), truth["unit"], "{name}");
        assert!(body.unit_inferred && body.facing_from == FacingFrom::Feet, "{name}");
        let off_deg = body.facing_deg - truth["facing_deg"].as_f64().unwrap();
        assert!(off_deg.abs() <= 3.0, "{name}: {off_deg}");
        for leg in legs {
            let girths = |side: &str| {
                ["B", "C"].map(|l| truth["legs"][side]["landmarks"][l]["tape_mm"].as_f64().unwrap())
            };
            let found = [Level::B, Level::C].map(|level| landmark(leg, level).girth_tape_mm);
            let differ = |side| {
                let pairs = girths(side).into_iter().zip(found);
                pairs.map(|(a, b): (f64, f64)| (a - b).abs()).fold(0.0, f64::max)
            };
            let is_left = leg.side == Side::Left;
            let [own, other] = if is_left { ["left", "right"] } else { ["right", "left"] };
            assert!(differ(own) < differ(other) / 2.0, "{name} {own}");
            let sign = if is_left { 1.0 } else { -1.0 };
            assert!(features(leg).count() > 0);
            assert!(features(leg).all(|feature| feature.position.x * sign > 0.0), "{name}");
        }
    }
}

#[test]
fn a_cloud_is_the_same_in_text_and_binary_shuffled_and_with_points_repeated() {
    for (name, _) in BODIES {
        let plain = figures(&CLOUDS[name]);
        // Both as text are too long to be told.
        let is_plain = |points: &[Point3<f64>], writer: Writer, how: &str| {
            assert!(figures(&measured(points, writer)) == plain, "{name} {how}");
        };
        let mut points = points(name);
        is_plain(&points, Writer::PlyLittle, "binary");
        let mut chance = Chance(7);
        for last in (1..points.len()).rev() {
            points.swap(last, chance.below(last + 1));
        }
        is_plain(&points, Writer::Xyz, "shuffled");
        // Corners of triangles, as a list of points made of an STL file has them.
        points.extend_from_within(..points.len() / 3);
        points.extend_from_within(..points.len() / 2);
        is_plain(&points, Writer::PlyLittle, "repeated");
    }
}

#[test]
fn a_cloud_of_every_third_point_is_measured_to_a_millimetre() {
    for (name, noise_mm) in BODIES {
        let third: Vec<Point3<f64>> = points(name).into_iter().step_by(3).collect();
        let (found, truth) = (measured(&third, Writer::PlyLittle), truth(name));
        let off = girths_off(&found, &truth);
        assert!(off[off.len() - 1] <= 1.0, "{name}: {off:?}");
        // Points 11 mm apart with noise leave a flat calf's height less certain.
        check_heights(name, &found, &truth, HEIGHT_MM + 8.0 * noise_mm);
    }
}

#[test]
fn a_mesh_format_without_faces_is_named_and_no_cloud_shows_whether_it_is_mirrored() {
    let points = points("f_average_clean");
    let codes = |writer| -> Vec<&'static str> {
        measured(&points, writer).findings.iter().map(|finding| finding.code()).collect()
    };
    for writer in [Writer::Obj, Writer::PlyLittle, Writer::Vrml1, Writer::Vrml2] {
        assert_eq!(codes(writer), ["no-faces", "mirror-unchecked"], "{writer:?}");
    }
    assert_eq!(codes(Writer::Xyz), ["mirror-unchecked"]);
}
