//! Area, volume and girth of a surface against closed forms, and their laws.
#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};

use gaiter_spline::{Basis, GridData, Surface, fit_grid};
use nalgebra::{Isometry3, Point3, Vector3};
use proptest::prelude::*;
use support::test_leg;

/// A surface of revolution about z through `points` many samples a side, u and v from 0 to 1.
fn revolved(profile: impl Fn(f64) -> (f64, f64), spans: usize) -> Surface {
    let (rows, columns) = (4 * spans, 4 * spans);
    let along: Vec<f64> = (0..rows).map(|i| i as f64 / (rows - 1) as f64).collect();
    let around: Vec<f64> = (0..columns).map(|j| j as f64 / columns as f64).collect();
    let at = |u: &f64, v: &f64| {
        let (radius, z) = profile(*u);
        Point3::new(radius * (TAU * v).cos(), radius * (TAU * v).sin(), z)
    };
    let points: Vec<_> = along.iter().flat_map(|u| around.iter().map(|v| at(u, v))).collect();
    let data = GridData { along: &along, around: &around, points: &points };
    let bases = (Basis::uniform_clamped(0.0, 1.0, spans), Basis::uniform_periodic(0.0, 1.0, spans));
    fit_grid(&data, bases.0.unwrap(), bases.1.unwrap()).unwrap().surface
}

fn near(found: f64, expected: f64, relative: f64) {
    assert!((found / expected - 1.0).abs() < relative, "{found} is not {expected}");
}

#[test]
fn a_cylinder_has_the_measures_of_its_closed_forms() {
    let surface = revolved(|u| (40.0, 300.0 * u), 48);
    near(surface.girth_mm(0.3), TAU * 40.0, 1e-6);
    near(surface.area_mm2(), TAU * 40.0 * 300.0, 1e-6);
    near(surface.volume_mm3(), PI * 40.0 * 40.0 * 300.0, 1e-6);
}

#[test]
fn a_zone_of_a_sphere_has_the_measures_of_its_closed_forms() {
    // From 30° south to 50° north.
    let latitude = |u: f64| (-30.0 + 80.0 * u).to_radians();
    let surface = revolved(|u| (60.0 * latitude(u).cos(), 60.0 * latitude(u).sin()), 48);
    let [south, north] = [0.0, 1.0].map(|u| latitude(u).sin());
    near(surface.area_mm2(), TAU * 60.0 * 60.0 * (north - south), 1e-6);
    let zone = |s: f64| s - s * s * s / 3.0;
    near(surface.volume_mm3(), PI * 60.0_f64.powi(3) * (zone(north) - zone(south)), 1e-6);
}

#[test]
fn a_surface_shrunk_to_a_point_has_no_measure() {
    let (along, around) = (Basis::clamped(&[0.0, 1.0]), Basis::uniform_periodic(0.0, 1.0, 4));
    let shrunk = Surface::new(along.unwrap(), around.unwrap(), vec![Point3::origin(); 16]).unwrap();
    assert_eq!((shrunk.area_mm2(), shrunk.volume_mm3(), shrunk.girth_mm(0.5)), (0.0, 0.0, 0.0));
}

#[test]
fn a_lid_of_a_slanting_plane_end_is_the_plane() {
    // A cylinder whose ends lie on slanting planes: the volume is that between the ends' centres.
    let around = Basis::uniform_periodic(0.0, 1.0, 64).unwrap();
    let along = Basis::uniform_clamped(0.0, 1.0, 2).unwrap();
    let radius = 30.0 / ((2.0 + (TAU / 64.0).cos()) / 3.0);
    let heights = along.greville();
    let control = |k: usize| {
        let angle = TAU * (k % 64) as f64 / 64.0;
        let (x, y) = (radius * angle.cos(), radius * angle.sin());
        let (low, high) = (0.3 * x - 0.1 * y, 100.0 - 0.2 * x + 0.4 * y);
        Point3::new(x, y, low + (high - low) * heights[k / 64])
    };
    let surface = Surface::new(along, around, (0..5 * 64).map(control).collect()).unwrap();
    near(surface.volume_mm3(), PI * 30.0 * 30.0 * 100.0, 1e-5);
}

#[test]
fn the_test_leg_has_the_published_area_volume_and_girths() {
    let (rows, columns) = (320, 288);
    let along: Vec<f64> = (0..rows).map(|i| i as f64 / (rows - 1) as f64).collect();
    let around: Vec<f64> = (0..columns).map(|j| j as f64 / columns as f64).collect();
    let at = |u: &f64, v: &f64| test_leg::point(TAU * v, test_leg::HEIGHT_MM * u);
    let points: Vec<_> = along.iter().flat_map(|u| around.iter().map(|v| at(u, v))).collect();
    let data = GridData { along: &along, around: &around, points: &points };
    let bases = (Basis::uniform_clamped(0.0, 1.0, 128), Basis::uniform_periodic(0.0, 1.0, 128));
    let surface = fit_grid(&data, bases.0.unwrap(), bases.1.unwrap()).unwrap().surface;
    // The reference, to the digits given.
    assert!((surface.area_mm2() - 307_913.62).abs() < 0.01, "{}", surface.area_mm2());
    assert!((surface.volume_mm3() - 9_784_676.35).abs() < 0.05, "{}", surface.volume_mm3());
    for (z, girth) in [(0.0, 264.895), (200.0, 282.160), (430.0, 370.213), (800.0, 525.744)] {
        assert!((surface.girth_mm(z / test_leg::HEIGHT_MM) - girth).abs() < 1e-3, "{z}");
    }
}

/// A tube with bumps: no symmetry.
fn tube(bump: f64, lean: f64) -> Surface {
    let along = Basis::clamped(&[0.0, 0.1, 0.35, 0.5, 0.8, 1.0]).unwrap();
    let around = Basis::periodic(&[0.2, 0.3, 0.45, 0.5, 0.6, 0.75, 0.8, 0.9, 1.1, 1.2]).unwrap();
    let (heights, turns) = (along.greville(), around.greville());
    let control = |k: usize| {
        let (i, j) = (k / 9, k % 9);
        let bump = bump * ((3 * i * i + 5 * j + i * j) as f64).sin();
        let (radius, angle) = (50.0 + 8.0 * heights[i] + bump, TAU * turns[j]);
        let wave = lean * (2.0 * angle).sin();
        Point3::new(radius * angle.cos(), radius * angle.sin(), 400.0 * heights[i] + wave)
    };
    let points = (0..along.count() * 9).map(control).collect();
    Surface::new(along, around, points).unwrap()
}

fn changed(surface: &Surface, change: impl Fn(&Point3<f64>) -> Point3<f64>) -> Surface {
    let control = surface.control_points().iter().map(change).collect();
    Surface::new(surface.along().clone(), surface.around().clone(), control).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn motion_changes_no_measure(
        bump in 0.0..6.0, lean in -5.0..5.0, x in -500.0..500.0_f64, z in -500.0..500.0, turn in -3.0..3.0_f64,
    ) {
        let surface = tube(bump, lean);
        let motion = Isometry3::new(Vector3::new(x, -x, z), Vector3::new(turn, 0.4, -turn / 2.0));
        let moved = changed(&surface, |point| motion * point);
        prop_assert!((moved.area_mm2() / surface.area_mm2() - 1.0).abs() < 1e-12);
        prop_assert!((moved.volume_mm3() / surface.volume_mm3() - 1.0).abs() < 1e-12);
        prop_assert!((moved.girth_mm(0.4) / surface.girth_mm(0.4) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn scale_and_mirror_change_each_measure_by_its_law(
        bump in 0.0..6.0, lean in -5.0..5.0, scale in 0.1..10.0_f64,
    ) {
        let surface = tube(bump, lean);
        let scaled = changed(&surface, |point| Point3::from(scale * point.coords));
        prop_assert!((scaled.area_mm2() / surface.area_mm2() / scale.powi(2) - 1.0).abs() < 1e-12);
        prop_assert!((scaled.volume_mm3() / surface.volume_mm3() / scale.powi(3) - 1.0).abs() < 1e-12);
        prop_assert!((scaled.girth_mm(0.7) / surface.girth_mm(0.7) / scale - 1.0).abs() < 1e-12);

        // A mirror turns the surface inside out: its normals look inward, its volume is negative.
        let mirrored = changed(&surface, |point| Point3::new(-point.x, point.y, point.z));
        prop_assert!((mirrored.area_mm2() / surface.area_mm2() - 1.0).abs() < 1e-12);
        prop_assert!((mirrored.volume_mm3() / surface.volume_mm3() + 1.0).abs() < 1e-12);
    }
    #[test]
    fn the_side_that_rings_see_is_that_of_the_volume(bump in 0.0..25.0, lean in -90.0..90.0) {
        let surface = tube(bump, lean);
        let mirrored = changed(&surface, |point| Point3::new(-point.x, point.y, point.z));
        for tube in [surface, mirrored] {
            prop_assert_eq!(tube.along_cross_around_is_outward(), tube.volume_mm3() < 0.0);
        }
    }
}
