//! Curvature, area, volume and girth of a surface against closed forms, and their laws.
#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};

use gaiter_spline::{Basis, Curvatures, GridData, Surface, fit_grid};
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

/// Places off the breakpoints, away from the ends.
fn places() -> impl Iterator<Item = (f64, f64)> {
    (0..40).map(|i| (0.1 + 0.8 * f64::from(i) / 39.0, f64::from(i * 7 % 40) / 40.0 + 0.01))
}

#[test]
fn a_cylinder_has_no_gauss_curvature_and_half_the_reciprocal_of_its_radius() {
    let surface = revolved(|u| (40.0, 300.0 * u), 48);
    for (u, v) in places() {
        let Curvatures { gauss, mean } = surface.curvatures(u, v).unwrap();
        assert!(gauss.abs() < 1e-9, "{gauss}");
        near(mean, 1.0 / 80.0, 2e-3);
    }
    near(surface.girth_mm(0.3), TAU * 40.0, 1e-6);
    near(surface.area_mm2(), TAU * 40.0 * 300.0, 1e-6);
    near(surface.volume_mm3(), PI * 40.0 * 40.0 * 300.0, 1e-6);
}

#[test]
fn a_sphere_bends_alike_everywhere() {
    // From 30° south to 50° north.
    let latitude = |u: f64| (-30.0 + 80.0 * u).to_radians();
    let surface = revolved(|u| (60.0 * latitude(u).cos(), 60.0 * latitude(u).sin()), 48);
    for (u, v) in places() {
        let Curvatures { gauss, mean } = surface.curvatures(u, v).unwrap();
        near(gauss, 1.0 / 3600.0, 4e-3);
        near(mean, 1.0 / 60.0, 2e-3);
    }
    let [south, north] = [0.0, 1.0].map(|u| latitude(u).sin());
    near(surface.area_mm2(), TAU * 60.0 * 60.0 * (north - south), 1e-6);
    let zone = |s: f64| s - s * s * s / 3.0;
    near(surface.volume_mm3(), PI * 60.0_f64.powi(3) * (zone(north) - zone(south)), 1e-6);
}

#[test]
fn the_waist_of_a_torus_is_a_saddle() {
    // The inner half of a ring: radius 90 to the tube's middle, the tube's own radius 30.
    let turn = |u: f64| PI * (u - 0.5);
    let surface = revolved(|u| (90.0 - 30.0 * turn(u).cos(), 30.0 * turn(u).sin()), 64);
    for (u, v) in places() {
        let around = turn(u).cos() / (90.0 - 30.0 * turn(u).cos());
        let Curvatures { gauss, mean } = surface.curvatures(u, v).unwrap();
        // Seen from outside the waist is hollow along and convex around.
        assert!((gauss + around / 30.0).abs() < 1e-5, "{gauss}");
        assert!((mean - (around - 1.0 / 30.0) / 2.0).abs() < 1e-4, "{mean}");
    }
}

/// The surface that is, on its middle spans, the graph z = a x² + b x y + c y² with y = −v and
/// x = u, so that the normal looks up; exact, from the polar forms of the monomials.
fn graph([a, b, c]: [f64; 3]) -> Surface {
    let along = Basis::clamped(&[-3.0, -1.9, -1.0, -0.4, 0.3, 1.0, 2.1, 3.0]).unwrap();
    let knots = [-3.0, -2.4, -1.7, -1.0, -0.3, 0.6, 1.0, 1.7, 2.5, 3.0];
    let around = Basis::periodic(&knots).unwrap();
    let forms = |basis: &Basis| {
        let inner = |i: usize| <[f64; 3]>::try_from(&basis.knots()[i + 1..i + 4]).unwrap();
        let form = |[p, q, r]: [f64; 3]| [(p + q + r) / 3.0, (p * q + q * r + r * p) / 3.0];
        (0..basis.count()).map(|i| form(inner(i))).collect::<Vec<_>>()
    };
    let (rows, columns) = (forms(&along), forms(&around));
    let control =
        |[x, xx]: &[f64; 2], [v, vv]: &[f64; 2]| Point3::new(*x, -v, a * xx - b * x * v + c * vv);
    let points = rows.iter().flat_map(|row| columns.iter().map(|column| control(row, column)));
    Surface::new(along, around, points.collect()).unwrap()
}

proptest! {
    #[test]
    fn a_quadratic_graph_bends_as_its_closed_form(
        a in -0.5..0.5, b in -0.5..0.5, c in -0.5..0.5, x in -0.9..0.9, v in -0.9..0.5_f64,
    ) {
        let surface = graph([a, b, c]);
        let y = -v;
        let at = surface.point(x, v);
        prop_assert!((at - Point3::new(x, y, a * x * x + b * x * y + c * y * y)).norm() < 1e-12);
        let (p, q) = (2.0 * a * x + b * y, b * x + 2.0 * c * y);
        let (r, s, t) = (2.0 * a, b, 2.0 * c);
        let slope = 1.0 + p * p + q * q;
        let gauss = (r * t - s * s) / (slope * slope);
        let up = ((1.0 + q * q) * r - 2.0 * p * q * s + (1.0 + p * p) * t) / (2.0 * slope.powf(1.5));
        let found = surface.curvatures(x, v).unwrap();
        prop_assert!(surface.normal(x, v).unwrap().z > 0.0);
        prop_assert!((found.gauss - gauss).abs() < 1e-11, "{found:?} {gauss}");
        // A hollow seen from above is concave.
        prop_assert!((found.mean + up).abs() < 1e-11, "{found:?} {up}");
    }
}

#[test]
fn a_point_without_tangents_has_no_curvature() {
    let (along, around) = (Basis::clamped(&[0.0, 1.0]), Basis::uniform_periodic(0.0, 1.0, 4));
    let shrunk = Surface::new(along.unwrap(), around.unwrap(), vec![Point3::origin(); 16]).unwrap();
    assert_eq!(shrunk.curvatures(0.5, 0.5), None);
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
        let (before, after) = (surface.curvatures(0.4, 0.9), moved.curvatures(0.4, 0.9));
        let (before, after) = (before.unwrap(), after.unwrap());
        prop_assert!((before.gauss - after.gauss).abs() < 1e-12);
        prop_assert!((before.mean - after.mean).abs() < 1e-12);
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
        let (one, many) = (surface.curvatures(0.7, 0.3).unwrap(), scaled.curvatures(0.7, 0.3).unwrap());
        prop_assert!((many.gauss * scale.powi(2) - one.gauss).abs() < 1e-12);
        prop_assert!((many.mean * scale - one.mean).abs() < 1e-12);

        // A mirror turns the surface inside out: its normals look inward, its volume is negative.
        let mirrored = changed(&surface, |point| Point3::new(-point.x, point.y, point.z));
        prop_assert!((mirrored.area_mm2() / surface.area_mm2() - 1.0).abs() < 1e-12);
        prop_assert!((mirrored.volume_mm3() / surface.volume_mm3() + 1.0).abs() < 1e-12);
        let mirror = mirrored.curvatures(0.7, 0.3).unwrap();
        prop_assert!((mirror.gauss - one.gauss).abs() < 1e-12);
        prop_assert!((mirror.mean + one.mean).abs() < 1e-12);
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
