//! How long each stage of an extraction takes, and how long tobj alone takes to read the scan:
//! `cargo bench --bench stages`.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

use std::io::Read;

use divan::Bencher;
use flate2::read::GzDecoder;
use gaiter_leg::frame::body::{Body, body};
use gaiter_leg::levels::girth::girth_curve;
use gaiter_leg::method::{SectionFit, Tape};
use gaiter_leg::parting::segment::{Leg, Legs, segment};
use gaiter_leg::sections::axis_fit;
use gaiter_leg::sections::equidistant::{Sections, sections};
use gaiter_leg::surface::nurbs;
use gaiter_leg::surface::nurbs::Wanted;
use gaiter_leg::{Method, extract};
use gaiter_scan::{Format, Scan, read};

fn main() {
    divan::main();
}

/// A woman of 160 cm, 56 000 points, as OBJ text.
fn obj() -> Vec<u8> {
    let gzip = include_bytes!("../../../fixtures/scans/f_average_tc2.obj.gz");
    let mut bytes = Vec::new();
    GzDecoder::new(&gzip[..]).read_to_end(&mut bytes).unwrap_or_default();
    bytes
}

fn scan() -> Scan {
    read(&obj(), Format::Obj).unwrap_or_else(|fault| stop(&fault))
}

fn standing() -> Body {
    body(&scan(), &Method::default()).unwrap_or_else(|fault| stop(&fault))
}

/// The left leg with the stature and the crotch's height, mm.
fn left_leg() -> (Leg, f64, f64) {
    let body = standing();
    let Legs { legs, crotch } = segment(&body).unwrap_or_else(|fault| stop(&fault));
    (legs.left.unwrap_or_else(|| stop(&"no leg")), body.scale_mm, crotch.height_mm)
}

fn left_sections() -> (Leg, f64, Sections) {
    let (leg, stature_mm, crotch_height_mm) = left_leg();
    let found = axis_fit::find(&leg, stature_mm, crotch_height_mm, Tape::Shank);
    let axis = found.unwrap_or_else(|fault| stop(&fault)).axis;
    let sections = sections(&leg, axis, [60.0, crotch_height_mm], SectionFit::Skin)
        .unwrap_or_else(|| stop(&"no sections"));
    (leg, stature_mm, sections)
}

/// A benchmark without its input is worth nothing.
fn stop(fault: &dyn std::fmt::Display) -> ! {
    std::process::exit(fault.to_string().len().clamp(1, 100) as i32)
}

#[divan::bench]
fn a_tobj_alone(bencher: Bencher) {
    let bytes = obj();
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    bencher.bench(|| {
        let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
        tobj::load_obj_buf(&mut bytes.as_slice(), &options, no_materials)
    });
}

#[divan::bench]
fn b_read(bencher: Bencher) {
    let bytes = obj();
    bencher.bench(|| read(&bytes, Format::Obj));
}

#[divan::bench]
fn c_body_frame(bencher: Bencher) {
    let scan = scan();
    bencher.bench(|| body(&scan, &Method::default()));
}

#[divan::bench]
fn d_segmentation(bencher: Bencher) {
    let body = standing();
    bencher.bench(|| segment(&body));
}

#[divan::bench]
fn e_axis_of_one_leg(bencher: Bencher) {
    let (leg, stature_mm, crotch_height_mm) = left_leg();
    bencher.bench(|| axis_fit::find(&leg, stature_mm, crotch_height_mm, Tape::Shank));
}

#[divan::bench]
fn f_sections_of_one_leg(bencher: Bencher) {
    let (_, _, crotch_height_mm) = left_leg();
    let (leg, _, found) = left_sections();
    bencher.bench(|| {
        let axis = found.axis.clone();
        sections(&leg, axis, [60.0, crotch_height_mm], SectionFit::Skin)
    });
}

#[divan::bench]
fn g_girth_curve_of_one_leg(bencher: Bencher) {
    let (_, stature_mm, sections) = left_sections();
    bencher.bench(|| girth_curve(&sections, stature_mm));
}

#[divan::bench]
fn h_surface_of_one_leg_with_its_error(bencher: Bencher) {
    let (leg, _, sections) = left_sections();
    let wanted = Wanted { height_mm: [95.0, 465.0], levels_mm: &[], control_points: None };
    bencher.bench(|| nurbs::surface(&leg, &sections, &wanted));
}

#[divan::bench]
fn i_whole_extraction(bencher: Bencher) {
    let bytes = obj();
    bencher.bench(|| extract(&bytes, Format::Obj, &Method::default()));
}
