//! What may leave a clinic: a crop is measured as the whole body was, to the last bit, and holds nothing from above.
//!
//! `GAITER_SCANS=FOLDER` has this hold for every `.obj` of a folder too.

#![allow(clippy::unwrap_used)]

use std::path::PathBuf;
use std::{env, fs};

use gaiter_leg::method::{Scope, Up};
use gaiter_leg::{Extraction, Method, Side, WholeBody, extract, extract_crop};
use gaiter_scan::{Format, Scan, read};
use support::mesh::Mesh;
use support::recorded::{coarse_body, export, extract_scan, scan};
use support::writers::Writer;

use crate::found::extraction_of;

/// Where the crotch of the recorded woman is, mm.
const CROTCH_MM: f64 = 744.0;

/// What is measured on the legs, to the last bit.
fn figures(found: &Extraction) -> String {
    format!("{:?}", (&found.legs, &found.differences, &found.findings))
}

/// The crop of a body, measured with nothing but its own bytes and what the body told.
#[track_caller]
fn crop_is_measured_as(whole: &Extraction, method: &Method, name: &str) -> Scan {
    let told = |of: &Extraction| serde_json::to_vec(&WholeBody::from_extraction(of)).unwrap();
    let body: WholeBody = serde_json::from_slice(&told(whole)).unwrap();
    let bytes = whole.crop().to_ply();
    let read = read(&bytes, Format::Ply).unwrap();
    let top_mm = whole.crotch.height_mm + 100.0;
    assert!(read.points.iter().all(|point| point.z < top_mm), "{name}: above");
    let crop = extract_crop(&bytes, &body, method).unwrap();
    assert!(told(&crop) == told(whole), "{name}: what the body told");
    assert!(figures(&crop) == figures(whole), "{name}: figures");
    assert!(crop.crop().to_ply() == bytes, "{name}: the crop of the crop");
    read
}

#[test]
fn the_crop_of_a_recorded_body_is_measured_as_the_whole() {
    let method = Method::default();
    for name in ["f_average_clean", "f_average_tc2", "m_average_clean"] {
        let whole = extraction_of(&export(name), &method);
        let crop = crop_is_measured_as(&whole, &method, name);
        let kept = crop.points.len() as f64 / whole.export.points as f64;
        assert!((0.3..0.8).contains(&kept), "{name}: {kept}");
    }
    crop_is_measured_as(&extraction_of(&coarse_body(1), &method), &method, "coarse");
}

#[test]
fn the_crop_of_a_bare_cloud_is_measured_as_the_whole() {
    let Scan { points, .. } = scan("f_average_clean");
    for writer in [Writer::Xyz, Writer::PlyLittle] {
        let bytes = writer.write(&Scan { points: points.clone(), triangles: vec![] });
        let whole = extract(&bytes, writer.format(), &Method::default()).unwrap();
        crop_is_measured_as(&whole, &Method::default(), whole.export.format.ending());
    }
}

#[test]
fn what_was_not_seen_of_the_whole_is_missing_on_the_crop_in_the_same_way() {
    let body = Mesh::body("f_average_clean");
    let headless = body.clone().kept(|[_, y, _]| y < 1300.0);
    let one_legged = body.clone().kept(|[x, y, _]| y > 450.0 || x > 0.0);
    let leg = body.kept(|[x, y, _]| y < 720.0 && x > 0.0 && x < 260.0);
    for (name, mesh, scope) in [
        ("headless", headless, Scope::Body),
        ("one-legged", one_legged, Scope::Body),
        ("lone leg", leg, Scope::Leg(Side::Left)),
    ] {
        let method = Method { scope, ..Method::default() };
        crop_is_measured_as(&extract_scan(&mesh.scan(), &method).unwrap(), &method, name);
    }
}

/// Bridges from the thigh to the trunk, which the crop cuts, change nothing below.
#[test]
fn facets_across_the_crop_have_no_part_in_the_measurement() {
    let mut bridged = Mesh::body("f_average_clean");
    let near = |above_mm: f64, mesh: &Mesh| {
        let is_near = |point: &[f64; 3]| (point[1] - CROTCH_MM - above_mm).abs() < 4.0;
        mesh.points.iter().position(is_near).unwrap()
    };
    for above_mm in [20.0, 35.0, 50.0, 65.0, 80.0] {
        let corners = [above_mm, above_mm + 40.0, above_mm + 120.0];
        let corners = corners.map(|above_mm| near(above_mm, &bridged));
        bridged.triangles.push(corners);
    }
    let whole = extract_scan(&bridged.scan(), &Method::default()).unwrap();
    crop_is_measured_as(&whole, &Method::default(), "bridged");
}

#[test]
fn the_crops_of_a_folder_are_measured_as_the_wholes() {
    let Some(folder) = env::var_os("GAITER_SCANS") else { return };
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "obj"));
    for path in paths {
        let name = path.display().to_string();
        let up = if name.contains("zup") { Up::Z } else { Method::default().up };
        let method = Method { up, ..Method::default() };
        // A body that is refused has no record, and no crop.
        if let Ok(whole) = extract(&fs::read(&path).unwrap(), Format::Obj, &method) {
            crop_is_measured_as(&whole, &method, &name);
        }
    }
}
