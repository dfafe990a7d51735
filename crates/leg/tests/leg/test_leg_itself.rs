//! The closed-form test leg (`support::test_leg`) as a mesh, through sections, girth curve,
//! levels and surface, against its reference figures.

#![allow(clippy::unwrap_used)]

use std::f64::consts::TAU;

use gaiter_leg::Level;
use gaiter_leg::levels::girth::{GirthCurve, girth_curve};
use gaiter_leg::levels::landmark::Landmark;
use gaiter_leg::levels::search;
use gaiter_leg::method::{B1, SectionFit};
use gaiter_leg::parting::segment::Leg;
use gaiter_leg::sections::axis::LegAxis;
use gaiter_leg::sections::equidistant::{Sections, sections};
use gaiter_leg::sections::slice::Mesh;
use gaiter_leg::side::Side;
use gaiter_leg::surface::nurbs::{LegSurface, Wanted, surface};
use nalgebra::{Point3, Vector3};
use support::test_leg;

/// The stature that goes with the leg: levels are looked for from 0.045 of it.
const STATURE_MM: f64 = 1500.0;

/// The mesh goes on beyond both ends of the leg, so that their sections close, mm.
const BEYOND_MM: f64 = 40.0;

/// The printed leg looks to +y and gaiter's to −y.
fn turned(p: Point3<f64>) -> Point3<f64> {
    Point3::new(-p.x, -p.y, p.z)
}

/// The leg as a mesh of rings. Its lateral side is now −x: a right leg.
fn leg(columns: usize, ring_mm: f64) -> Leg {
    let rings = ((test_leg::HEIGHT_MM + 2.0 * BEYOND_MM) / ring_mm) as usize + 1;
    let places = (0..rings).flat_map(|ring| (0..columns).map(move |column| (ring, column)));
    let point = |(ring, column): (usize, usize)| {
        let angle = TAU * column as f64 / columns as f64;
        turned(test_leg::point(angle, ring_mm * ring as f64 - BEYOND_MM))
    };
    let number = |ring: usize, column: usize| (ring * columns + column % columns) as u32;
    let pair = |(ring, column): (usize, usize)| {
        let [a, b] = [number(ring - 1, column), number(ring - 1, column + 1)];
        let [c, d] = [number(ring, column + 1), number(ring, column)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = places.clone().filter(|(ring, _)| *ring > 0).flat_map(pair).collect();
    Leg { side: Side::Right, mesh: Mesh::new(places.map(point).collect(), triangles), cut_mm: None }
}

/// The sections at whole heights, as the printed figures are.
fn horizontal(leg: &Leg, fit: SectionFit) -> Sections {
    let axis = LegAxis::straight(Point3::origin(), &Vector3::z(), Side::Right);
    sections(leg, axis, [40.0, test_leg::HEIGHT_MM], fit).unwrap()
}

fn curve(leg: &Leg, fit: SectionFit) -> GirthCurve {
    girth_curve(&horizontal(leg, fit), STATURE_MM).unwrap()
}

fn levels(leg: &Leg, fit: SectionFit) -> Vec<Landmark> {
    let sections = horizontal(leg, fit);
    let curve = girth_curve(&sections, STATURE_MM).unwrap();
    search::levels(&curve, STATURE_MM, test_leg::HEIGHT_MM, B1::Steepest, &sections).found
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64, what: &str) {
    let off = found - expected;
    assert!(off.abs() <= tolerance, "{what}: {found} for {expected}, {off:.6} off");
}

#[test]
fn girths_at_the_printed_heights_are_the_printed_ones() {
    let printed = [
        (0.0, 264.895),
        (100.0, 222.321),
        (200.0, 282.160),
        (300.0, 424.431),
        (350.0, 399.528),
        (400.0, 354.644),
        (430.0, 370.213),
        (500.0, 393.677),
        (600.0, 450.888),
        (700.0, 513.872),
        (800.0, 525.744),
    ];
    for (columns, ring_mm) in [(180, 2.5), (72, 5.0)] {
        let leg = leg(columns, ring_mm);
        let found = horizontal(&leg, SectionFit::Periodic).at(&leg, &printed.map(|(z, _)| z));
        for (section, (z, girth)) in found.into_iter().zip(printed) {
            let section = section.unwrap();
            near(section.girth.contour_mm, girth, 0.05, &format!("{columns} columns, {z} mm"));
            assert_eq!(section.height_mm, z);
            assert!(section.r2 > 0.9999, "{z} mm: R² {}", section.r2);
        }
    }
}

#[test]
fn the_levels_are_the_printed_extrema_with_every_fit() {
    // Height, girth, and how far the height may be off: D's valley is the narrowest bend of all.
    let printed = [
        (Level::B, 112.8, 221.33, 0.5),
        (Level::C, 308.8, 425.64, 0.5),
        (Level::D, 398.0, 354.56, 1.0),
    ];
    let leg = leg(120, 4.0);
    for fit in [SectionFit::Skin, SectionFit::Periodic, SectionFit::Paper] {
        let found = levels(&leg, fit);
        let levels: Vec<Level> = found.iter().map(|landmark| landmark.level).collect();
        assert_eq!(levels, Level::SOUGHT, "{fit:?}");
        for (level, height, girth, tolerance) in printed {
            let landmark = found.iter().find(|landmark| landmark.level == level).unwrap();
            let what = format!("{fit:?} {level:?}");
            near(landmark.height_mm, height, tolerance, &what);
            // The skin is smoothed along the leg as well, which costs a little at the sharpest
            // bumps; the paper's lines are chords there.
            let reach = if fit == SectionFit::Periodic { 0.05 } else { 0.1 };
            near(landmark.girth_tape_mm, girth, reach, &what);
            assert_eq!(landmark.doubts, [], "{what}");
        }
    }
}

#[test]
fn the_extrema_of_the_knee_are_in_the_girth_curve() {
    let curve = curve(&leg(120, 4.0), SectionFit::Periodic);
    let slope = |z: f64| curve.tape(z)[1];
    let turns = |z: &f64| slope(*z) * slope(z + 0.1) < 0.0;
    let found: Vec<f64> = (4200..6000).map(|i| f64::from(i) / 10.0).filter(turns).collect();
    assert_eq!(found.len(), 2, "{found:?}");
    for (z, (height, girth)) in found.into_iter().zip([(474.6, 394.82), (497.2, 393.63)]) {
        near(z, height, 0.5, "height");
        near(curve.tape(z)[0], girth, 0.05, "girth");
    }
}

#[test]
fn the_girth_grows_at_b1_as_fast_as_anywhere_between_b_and_c() {
    let found = levels(&leg(120, 4.0), SectionFit::Skin);
    let b1 = found.iter().find(|landmark| landmark.level == Level::B1).unwrap();
    let slope =
        |z: f64| (test_leg::circumference(z + 0.5) - test_leg::circumference(z - 0.5)).abs();
    let largest = (56..155).map(|i| slope(2.0 * f64::from(i))).fold(0.0, f64::max);
    assert!(slope(b1.height_mm) > 0.99 * largest, "{} of {largest}", slope(b1.height_mm));
}

/// Mean relative, mean and largest distance of a surface from the true skin: horizontally from the
/// centre line, which on this leg exceeds the distance proper by 5 % at most.
fn true_error(leg: &LegSurface) -> [f64; 3] {
    let (low, high) = leg.surface.along().domain();
    let (mut weight, mut relative, mut sum, mut max) = (0.0, 0.0, 0.0, 0.0_f64);
    for (row, column) in (0..=250).flat_map(|row| (0..200).map(move |column| (row, column))) {
        let along = low + (high - low) * f64::from(row) / 250.0;
        let point = turned(leg.surface.point(along, TAU * f64::from(column) / 200.0));
        let (x, y) = test_leg::center(point.z);
        let (radius, off) = ((point.x - x).hypot(point.y - y), test_leg::outside_mm(&point).abs());
        weight += radius;
        relative += off;
        sum += radius * off;
        max = max.max(off);
    }
    [relative / weight, sum / weight, max]
}

/// The surface from 80 mm up.
fn surface_with(control_points: Option<[usize; 2]>) -> LegSurface {
    let leg = leg(180, 2.5);
    let sections = horizontal(&leg, SectionFit::Periodic);
    let levels_mm = &[112.8, 308.8, 398.0];
    let wanted = Wanted { height_mm: [40.0, 440.0], levels_mm, control_points };
    surface(&leg, &sections, &wanted).unwrap()
}

#[test]
fn the_surface_of_the_whole_leg_meets_the_limits_of_the_reference() {
    let found = surface_with(None);
    // The limits of the reference for the clean test leg and the larger net.
    let [relative, _, max_mm] = true_error(&found);
    assert!(relative <= 0.000_05 && max_mm <= 0.15, "{relative} {max_mm}");
    assert!(found.to_points.mean_relative <= 0.000_05, "{:?}", found.to_points);
    assert!(found.to_points.max_mm <= 0.15, "{:?}", found.to_points);
    // The levels are knots.
    for level_mm in [112.8, 308.8, 398.0] {
        let far = found.surface.along().breakpoints().iter().map(|knot| (knot - level_mm).abs());
        near(far.fold(f64::INFINITY, f64::min), 0.0, 1e-9, "knot at a level");
        near(found.surface.girth_mm(level_mm), test_leg::circumference(level_mm), 0.05, "girth");
    }
}

#[test]
fn a_surface_of_few_control_points_says_how_far_off_it_is() {
    let found = surface_with(Some([30, 24]));
    assert_eq!([found.surface.along().count(), found.surface.around().count()], [30, 24]);
    let [relative, ..] = true_error(&found);
    assert!(relative <= 0.000_9, "{relative}");
    // The error that the surface states of itself is the true one.
    near(found.to_sections.mean_relative / relative, 1.0, 0.1, "stated over true error");
}
