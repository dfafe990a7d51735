//! Volumes: closed forms of tubes, the volume inside the recorded bodies' own meshes, and laws.

#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};

use gaiter_leg::comparison::volume::{AreaCurve, LegVolume, area_mm2, leg_volume};
use gaiter_leg::method::SectionFit;
use gaiter_leg::sections::axis::LegAxis;
use gaiter_leg::sections::slice::Mesh;
use gaiter_leg::side::Side;
use gaiter_leg::{Extraction, LegReport, Level, Method, extract};
use gaiter_scan::{Format, Scan};
use nalgebra::{Point3, Vector3};
use support::recorded::{export, extract_scan, scan};
use support::solids;
use support::solids::{Tube, all, curve_of, ellipse, near, off_deg};

const FITS: [SectionFit; 3] = [SectionFit::Skin, SectionFit::Periodic, SectionFit::Paper];

/// A regular mesh of 5 mm leaves 0.01 mm of a girth of 314 mm, and twice that share of an area.
const REGULAR_SHARE: f64 = 7e-5;

/// Two distances along the axis that lie on no section plane.
const SPAN_MM: [f64; 2] = [123.4, 567.8];

fn areas(tube: &Tube, fit: SectionFit) -> AreaCurve {
    let sections = tube.sections(fit);
    AreaCurve::new(&sections, &curve_of(&sections))
}

fn volumes(tube: &Tube) -> LegVolume {
    let sections = tube.sections(SectionFit::Skin);
    leg_volume(&sections, &curve_of(&sections), &[])
}

/// Volume between two distances, mL.
#[track_caller]
fn ml(areas: &AreaCurve, [from_mm, to_mm]: [f64; 2]) -> f64 {
    areas.volume(from_mm, to_mm).unwrap().ml
}

#[track_caller]
fn near_share(found: f64, expected: f64, share: f64, what: &str) {
    near(found, expected, share * expected, what);
}

#[test]
fn a_cylinder_holds_the_area_of_its_circle_times_its_length() {
    for fit in FITS {
        let areas = areas(&Tube::upright(&|_, _| 50.0), fit);
        let expected = PI * 2500.0 * (SPAN_MM[1] - SPAN_MM[0]) / 1000.0;
        near_share(ml(&areas, SPAN_MM), expected, REGULAR_SHARE, &format!("{fit:?}"));
    }
}

#[test]
fn a_cone_holds_the_frustum_of_its_two_girths() {
    let radius = |_: f64, along: f64| 30.0 + 0.05 * along;
    for fit in FITS {
        let areas = areas(&Tube::upright(&radius), fit);
        let [c1, c2] = SPAN_MM.map(|along| TAU * radius(0.0, along));
        let length = SPAN_MM[1] - SPAN_MM[0];
        let expected = length / (12.0 * PI) * (c1 * c1 + c1 * c2 + c2 * c2) / 1000.0;
        near_share(ml(&areas, SPAN_MM), expected, REGULAR_SHARE, &format!("{fit:?}"));
    }
}

#[test]
fn an_elliptic_tube_of_a_tilted_leg_holds_pi_a_b_times_its_length_along_its_axis() {
    let shape = ellipse(60.0, 40.0);
    for (side, direction) in
        [(Side::Left, Vector3::new(0.14, -0.08, 1.0)), (Side::Right, Vector3::new(0.2, 0.1, 1.0))]
    {
        let foot = Point3::new(90.0, -20.0, 0.0);
        let tube = Tube { side, foot, direction, ..Tube::upright(&shape) };
        let expected = PI * 60.0 * 40.0 * (SPAN_MM[1] - SPAN_MM[0]) / 1000.0;
        let found = ml(&areas(&tube, SectionFit::Skin), SPAN_MM);
        // The axis is found to 0.05°, and an end of the span to 0.2 mm of 444.
        near_share(found, expected, 5e-4, &format!("{side:?}"));
    }
}

#[test]
fn the_area_of_a_section_is_the_integral_of_half_its_squared_radius() {
    let radius = |t: f64| 50.0 + 6.0 * (3.0 * (t - 0.35)).cos() + 4.0 * (2.0 * t).sin();
    // π (a² + b²/2 + c²/2) for a + b cos + c sin of whole multiples.
    let expected = PI * (2500.0 + 18.0 + 8.0);
    for fit in FITS {
        for section in all(&Tube::upright(&|angle, _| radius(angle)).sections(fit)) {
            near_share(area_mm2(&section.curve), expected, 2e-4, &format!("{fit:?}"));
        }
    }
    // The curve's own area, by half a million chords.
    let sections = Tube::upright(&|angle, _| radius(angle)).sections(SectionFit::Periodic);
    let curve = &all(&sections)[20].curve;
    let points = curve.points(500_000);
    let next = points.iter().cycle().skip(1);
    let chords = points.iter().zip(next).map(|(p, q)| p.coords.perp(&q.coords) / 2.0);
    near(area_mm2(curve), chords.sum::<f64>(), 1e-6, "exact for the spline");
}

#[test]
fn volumes_of_neighbouring_ranges_add_up_and_slices_are_ranges_of_4_cm() {
    let radius = |_: f64, along: f64| 45.0 + 12.0 * (along / 90.0).sin();
    let volume = volumes(&Tube::upright(&radius));
    let [low, middle, high] = [101.0, 333.3, 612.5];
    let sum = ml(&volume.areas, [low, middle]) + ml(&volume.areas, [middle, high]);
    near(sum, ml(&volume.areas, [low, high]), 1e-9, "a range in two");
    // ∫ π (a + b sin(s/c))² ds
    let integral = |s: f64| {
        let (a, b, c) = (45.0_f64, 12.0_f64, 90.0_f64);
        let wave = (b * b) * (s / 2.0 - c / 4.0 * (2.0 * s / c).sin());
        PI * (a * a * s - 2.0 * a * b * c * (s / c).cos() + wave) / 1000.0
    };
    near_share(sum, integral(high) - integral(low), 1e-4, "the closed form");

    let whole = volume.whole.unwrap();
    near(whole.from_mm, 40.0, 1e-9, "the lowest section of the tube");
    assert!(whole.to_mm > 710.0, "{}", whole.to_mm);
    assert_eq!(volume.whole_height_mm.map(|h| h.map(f64::round)), Some([40.0, 715.0]));
    let ends: Vec<f64> = volume.slices.iter().map(|slice| slice.from_mm).collect();
    assert_eq!(ends, (0..18).map(|i| 40.0 * f64::from(i)).collect::<Vec<_>>());
    for slice in &volume.slices {
        near(slice.to_mm - slice.from_mm, 40.0, 0.0, "4 cm");
        // Sections lie between 40 and 715 mm: the first slice and the last are not measured whole.
        let is_whole = (40.0..=680.0).contains(&slice.from_mm) && slice.to_mm <= 715.0;
        assert_eq!(slice.volume.is_some(), is_whole, "{}", slice.from_mm);
        if let Some(found) = slice.volume {
            near_share(found.ml, integral(slice.to_mm) - integral(slice.from_mm), 2e-4, "slice");
        }
    }
    let sum: f64 = volume.slices.iter().filter_map(|slice| slice.volume).map(|v| v.ml).sum();
    near(sum, ml(&volume.areas, [40.0, 680.0]), 1e-9, "the slices make the range");
}

#[test]
fn nothing_is_guessed_across_what_was_not_seen() {
    let hole = |angle: f64, along: f64| {
        (300.0..380.0).contains(&along) && off_deg(angle.to_degrees(), 30.0) < 85.0
    };
    let volume = volumes(&Tube { hole: &hole, ..Tube::upright(&|_, _| 50.0) });
    assert_eq!(volume.whole, None);
    assert_eq!(volume.whole_height_mm, None);
    let unseen: Vec<f64> =
        volume.slices.iter().filter(|s| s.volume.is_none()).map(|s| s.from_mm).collect();
    assert_eq!(unseen, [0.0, 280.0, 320.0, 360.0, 680.0]);
    for [from_mm, to_mm] in [[120.0, 500.0], [310.0, 370.0], [30.0, 120.0], [600.0, 800.0]] {
        assert_eq!(volume.areas.volume(from_mm, to_mm), None, "{from_mm} to {to_mm}");
    }
    for [from_mm, to_mm] in [[500.0, 400.0], [500.0, 500.0], [f64::NAN, 500.0], [100.0, f64::NAN]] {
        assert_eq!(volume.areas.volume(from_mm, to_mm), None, "{from_mm} to {to_mm} is no range");
    }
    near_share(ml(&volume.areas, [120.0, 280.0]), PI * 2.5 * 160.0, 1e-4, "below the hole");
}

#[test]
fn the_standard_error_is_that_of_the_girths_as_if_all_erred_alike_and_holds_the_true_volume() {
    for (seed, noise_mm) in [(1, 0.5), (2, 0.5), (3, 1.5)] {
        let tube = Tube { noise_mm, seed, is_scattered: true, ..Tube::upright(&|_, _| 50.0) };
        let sections = tube.sections(SectionFit::Skin);
        let curve = curve_of(&sections);
        let found = AreaCurve::new(&sections, &curve).volume(SPAN_MM[0], SPAN_MM[1]).unwrap();
        let expected = PI * 2.5 * (SPAN_MM[1] - SPAN_MM[0]);
        near(found.ml, expected, 2.0 * found.sd_ml, "two standard errors");
        let girth_share = curve.tape_sd(350.0, 0) / (TAU * 50.0);
        near_share(found.sd_ml / found.ml, 2.0 * girth_share, 0.2, "twice the girths' share");
    }
}

fn measured(scan: &Scan) -> Extraction {
    extract_scan(scan, &Method::default()).unwrap()
}

fn at(leg: &LegReport, level: Level) -> f64 {
    leg.landmarks.iter().find(|landmark| landmark.level == level).unwrap().along_mm
}

/// The part of a triangle between two distances along the axis (Sutherland and Hodgman).
fn clipped(triangle: [Point3<f64>; 3], axis: &LegAxis, span_mm: [f64; 2]) -> Vec<Point3<f64>> {
    let mut polygon = triangle.to_vec();
    for (limit, sign) in [(span_mm[0], 1.0), (span_mm[1], -1.0)] {
        let depth = |p: &Point3<f64>| sign * (axis.along(p) - limit);
        let next = polygon.iter().cycle().skip(1);
        let mut kept = Vec::new();
        for (p, q) in polygon.iter().zip(next) {
            let (a, b) = (depth(p), depth(q));
            kept.extend((a >= 0.0).then_some(*p));
            kept.extend(((a >= 0.0) != (b >= 0.0)).then(|| p + (q - p) * (a / (a - b))));
        }
        polygon = kept;
    }
    polygon
}

/// Unit normals of a mesh's points, weighted by area, oriented as its triangles are.
fn normals(mesh: &Mesh) -> Vec<Vector3<f64>> {
    let mut sums = vec![Vector3::zeros(); mesh.points().len()];
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|corner| mesh.points()[corner as usize]);
        triangle.iter().for_each(|&corner| sums[corner as usize] += (b - a).cross(&(c - a)));
    }
    sums.iter().map(|sum: &Vector3<f64>| sum.normalize()).collect()
}

/// The volume inside the mesh around an axis between two planes across it, mL: by the flat facets,
/// and with the skin's rise over each of them.
///
/// By the divergence theorem for a field of divergence 1 without flux through the planes. The rise over a
/// facet is the quadratic that the normals at its corners describe: the sum of the sagittas e·Δn/8 of its
/// edges, a third of it in the mean.
fn enclosed_ml(mesh: &Mesh, axis: &LegAxis, span_mm: [f64; 2]) -> [f64; 2] {
    let normals = normals(mesh);
    let field = field(axis, span_mm);
    let [mut flat, mut rise] = [0.0; 2];
    for triangle in mesh.triangles() {
        let corners = triangle.map(|corner| mesh.points()[corner as usize]);
        // The other leg, and hands, are further than that.
        if corners.iter().any(|corner| axis.place(corner).1.coords.norm() > 130.0) {
            continue;
        }
        let polygon = clipped(corners, axis, span_mm);
        if polygon.len() < 3 {
            continue;
        }
        let mut area = 0.0;
        for pair in polygon[1..].windows(2) {
            let part = [polygon[0], pair[0], pair[1]];
            let normal = (part[1] - part[0]).cross(&(part[2] - part[0])) / 2.0;
            let middle = part.iter().map(|p| p.coords).sum::<Vector3<f64>>() / 3.0;
            flat += field(&middle.into()).dot(&normal);
            area += normal.norm();
        }
        let sagitta = |i: usize, j: usize| {
            let turn = normals[triangle[j] as usize] - normals[triangle[i] as usize];
            (corners[j] - corners[i]).dot(&turn) / 8.0
        };
        rise += area * (sagitta(0, 1) + sagitta(1, 2) + sagitta(2, 0)) / 3.0;
    }
    [flat / 1000.0, (flat + rise) / 1000.0]
}

/// A field of divergence 1 without flux through two planes across an axis: along a direction that lies in
/// both.
fn field(axis: &LegAxis, span_mm: [f64; 2]) -> impl Fn(&Point3<f64>) -> Vector3<f64> {
    let [low, high] = span_mm.map(|along_mm| axis.plane(along_mm));
    let meets = low.normal.cross(&high.normal);
    let direction = meets.try_normalize(1e-9).unwrap_or(low.front.into_inner());
    move |point: &Point3<f64>| direction * direction.dot(&(point - low.origin))
}

#[test]
fn a_tube_s_mesh_holds_its_closed_form_with_the_rise_of_its_skin() {
    let leg = Tube::upright(&|_, _| 50.0).leg();
    let axis = solids::axis(&leg, solids::STATURE_MM, solids::CROTCH_MM).unwrap();
    let [flat, curved] = enclosed_ml(&leg.mesh, &axis, SPAN_MM);
    let expected = PI * 2.5 * (SPAN_MM[1] - SPAN_MM[0]);
    near_share(curved.abs(), expected, 1e-5, "with the rise");
    assert!(flat.abs() < 0.999 * expected, "{flat}: facets alone hold less");
}

#[test]
fn a_body_s_legs_hold_what_their_own_mesh_encloses_to_half_a_thousandth() {
    for name in ["f_average_clean", "m_average_clean"] {
        let extraction = extract(&export(name), Format::Obj, &Method::default()).unwrap();
        for leg in &extraction.legs {
            let [b, d] = [at(leg, Level::B), at(leg, Level::D)];
            let whole = leg.volume.whole.unwrap();
            let spans = [[b, d], [b, 600.0], [whole.from_mm + 20.0, b], [600.0, 640.0]];
            for span_mm in spans {
                let what = format!("{name} {} {span_mm:.0?}", leg.side.word());
                let [flat, curved] = enclosed_ml(&extraction.body.mesh, &leg.axis, span_mm);
                let found = ml(&leg.volume.areas, span_mm);
                near_share(found, curved.abs(), 5e-4, &what);
                assert!(flat.abs() < found, "{what}: {flat} and {found}");
            }
            assert_eq!(leg.volume.b_to_d.unwrap().ml, ml(&leg.volume.areas, [b, d]));
        }
    }
}

#[test]
fn a_body_scaled_by_a_factor_holds_the_cube_of_it_between_scaled_planes() {
    let body = scan("f_average_clean");
    let factor = 1.2;
    let points = body.points.iter().map(|p| Point3::from(p.coords * factor)).collect();
    let larger = measured(&Scan { points, triangles: body.triangles.clone() });
    for (leg, larger) in measured(&body).legs.iter().zip(&larger.legs) {
        for [from_mm, to_mm] in [[80.0, 640.0], [112.0, 436.0], [300.0, 340.0]] {
            let span_mm = [from_mm * factor, to_mm * factor];
            let expected = ml(&leg.volume.areas, [from_mm, to_mm]) * factor.powi(3);
            // The floor, from which the planes are counted, is told by a fixed radius of the
            // foot's edge and so is not scaled: by 0.6 mm.
            near_share(ml(&larger.volume.areas, span_mm), expected, 3.5e-3, "scaled");
        }
    }
}

#[test]
fn a_mirrored_body_has_the_opposite_differences() {
    let body = scan("f_average_tc2");
    let mirrored = Scan {
        points: body.points.iter().map(|p| Point3::new(-p.x, p.y, p.z)).collect(),
        triangles: body.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    };
    let [plain, mirrored] = [&body, &mirrored].map(|scan| measured(scan).differences.unwrap());
    let (whole, other) = (plain.whole.unwrap(), mirrored.whole.unwrap());
    assert!(whole.ml.value > 300.0 && whole.percent > 4.0, "the left leg is the larger: {whole:?}");
    near(other.ml.value, -whole.ml.value, 1.0, "whole");
    near(other.percent, -whole.percent, 0.02, "percent");
    near(other.ml.sd, whole.ml.sd, 0.1 * whole.ml.sd, "its error");
    assert!(plain.levels.len() >= 4);
    assert_eq!(plain.slices.len(), mirrored.slices.len());
    for (at, other) in plain.levels.iter().zip(&mirrored.levels) {
        assert_eq!(at.level, other.level);
        near(other.girth_mm.value, -at.girth_mm.value, 0.1, at.level.name());
    }
    for (slice, other) in plain.slices.iter().zip(&mirrored.slices) {
        near(other.ml.value, -slice.ml.value, 0.2, "slice");
    }
}

#[test]
fn a_larger_calf_is_told_and_percentages_are_of_the_smaller_leg() {
    let extraction = extract(&export("f_average_tc2"), Format::Obj, &Method::default()).unwrap();
    let found = extraction.differences.as_ref().unwrap();
    let [left, right] = [0, 1].map(|leg: usize| &extraction.legs[leg]);
    let whole = found.whole.unwrap();
    let span_mm = [whole.from_mm, whole.to_mm];
    let [l, r] = [left, right].map(|leg| ml(&leg.volume.areas, span_mm));
    near(whole.ml.value, l - r, 1e-9, "left minus right");
    near(whole.percent, 100.0 * (l - r) / l.min(r), 1e-9, "of the smaller");
    let [l, r] = [left, right].map(|leg| leg.volume.areas.volume(span_mm[0], span_mm[1]).unwrap());
    near(whole.ml.sd, (l.sd_ml.powi(2) + r.sd_ml.powi(2)).sqrt(), 1e-9, "independent errors");
    let codes: Vec<_> = extraction.findings.iter().filter(|f| f.code() == "legs-differ").collect();
    // The left calf is 46 mm larger; B1 of either leg is where its muscle begins.
    assert_eq!(codes.iter().map(|f| f.level).collect::<Vec<_>>(), [Some(Level::C)]);
    assert_eq!(codes[0].severity(), gaiter_leg::finding::Severity::Info);
}
