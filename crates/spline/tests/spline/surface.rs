//! The surface: derivatives, the seam, the nearest point, and the form in which it is exported.
#![allow(clippy::unwrap_used)]

use std::f64::consts::{FRAC_PI_3, TAU};

use gaiter_spline::{Basis, Surface, SurfaceFault};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;

/// Breakpoints along, 8 control rows; and around, 9 control columns, from 0.2 with period 1.
const ALONG: [f64; 6] = [0.0, 0.1, 0.35, 0.5, 0.8, 1.0];
const AROUND: [f64; 10] = [0.2, 0.3, 0.45, 0.5, 0.6, 0.75, 0.8, 0.9, 1.1, 1.2];

fn bases() -> (Basis, Basis) {
    (Basis::clamped(&ALONG).unwrap(), Basis::periodic(&AROUND).unwrap())
}

/// A leg-sized tube with bumps: no symmetry, no two control points alike.
fn tube() -> Surface {
    let (along, around) = bases();
    let (heights, turns) = (along.greville(), around.greville());
    let control = |i: usize, j: usize| {
        let bump = 4.0 * ((3 * i * i + 5 * j + i * j) as f64).sin();
        let (radius, angle) = (50.0 + 8.0 * heights[i] + bump, TAU * turns[j]);
        let wave = 3.0 * (2.0 * angle).sin();
        Point3::new(radius * angle.cos(), radius * angle.sin(), 400.0 * heights[i] + wave)
    };
    let columns = around.count();
    let points = (0..along.count() * columns).map(|k| control(k / columns, k % columns)).collect();
    Surface::new(along, around, points).unwrap()
}

#[test]
fn derivatives_agree_with_differences_across_the_seam_too() {
    let surface = tube();
    let h = 1e-4;
    for (u, v) in [(0.2, 0.4), (0.6, 1.19999), (0.85, 0.2), (0.45, 0.7)] {
        let at = |du: f64, dv: f64| surface.point(u + h * du, v + h * dv).coords;
        let found = surface.derivatives(u, v);
        assert!((found.point.coords - at(0.0, 0.0)).norm() < 1e-12);
        let differences = [
            (found.du, (at(1.0, 0.0) - at(-1.0, 0.0)) / (2.0 * h)),
            (found.dv, (at(0.0, 1.0) - at(0.0, -1.0)) / (2.0 * h)),
            (found.duu, (at(1.0, 0.0) - 2.0 * at(0.0, 0.0) + at(-1.0, 0.0)) / (h * h)),
            (found.dvv, (at(0.0, 1.0) - 2.0 * at(0.0, 0.0) + at(0.0, -1.0)) / (h * h)),
            (
                found.duv,
                (at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0)) / (4.0 * h * h),
            ),
        ];
        for (found, expected) in differences {
            assert!((found - expected).norm() < 1e-3 * expected.norm(), "{found} {expected}");
        }
    }
}

#[test]
fn a_line_of_constant_u_has_the_derivatives_of_the_surface() {
    let surface = tube();
    for u in [-0.3, 0.0, 0.2, 0.35, 0.66, 1.0, 1.4] {
        let line = surface.line(u);
        for v in [0.2, 0.31, 0.9, 1.19, 1.5, -0.4] {
            let (found, expected) = (line.derivatives(v), surface.derivatives(u, v));
            assert!((found.point - expected.point).norm() < 1e-11);
            let pairs = [
                (found.du, expected.du),
                (found.dv, expected.dv),
                (found.duu, expected.duu),
                (found.duv, expected.duv),
                (found.dvv, expected.dvv),
            ];
            for (found, expected) in pairs {
                assert!((found - expected).norm() < 1e-12 * (1.0 + expected.norm()), "{u} {v}");
            }
        }
    }
}

#[test]
fn the_distance_alone_is_that_of_the_nearest_point() {
    let surface = tube();
    for i in 0..400 {
        let wave = |turn: f64| (f64::from(i) * turn).sin();
        let (u, v) = (0.5 + 0.55 * wave(1.7), 0.7 + 0.6 * wave(2.9));
        // A parameter that is off by up to 0.3 mm, as that of a section is, or by far more.
        let off = if i % 4 == 0 { 10.0 } else { 1.0 };
        let start = [(u + 2e-4 * off * wave(0.3)).clamp(0.0, 1.0), v + 3e-4 * off * wave(5.1)];
        let normal = surface.derivatives(u, v).normal().unwrap().into_inner();
        for offset_mm in [0.0, 0.01, -0.2, 1.5, -4.0] {
            let point = surface.point(u, v) + normal * offset_mm;
            let here = surface.derivatives(start[0], start[1]);
            let found = surface.distance_mm(&point, start, here);
            let expected = surface.closest(&point, start[0], start[1]).distance_mm;
            // On the surface itself the root of a tiny square is largest.
            let most_mm = if offset_mm == 0.0 { 5e-5 } else { 1e-6 };
            assert!((found - expected).abs() < most_mm, "{i} {offset_mm}: {found} {expected}");
        }
    }
}

#[test]
fn the_seam_is_c2_to_rounding() {
    let surface = tube();
    for i in 0..=20 {
        let u = f64::from(i) / 20.0;
        let right = surface.derivatives(u, 0.2);
        // Within the last interval the surface is a cubic of v: Taylor's series reaches its end.
        let h = 0.05;
        let left = surface.derivatives(u, 1.2 - h);
        let before = surface.derivatives(u, 1.2 - 1.5 * h);
        let third = (left.dvv - before.dvv) / (0.5 * h);
        let point = left.point + h * (left.dv + h * (left.dvv / 2.0 + h / 6.0 * third));
        assert!((point - right.point).norm() < 1e-11);
        let dv = left.dv + h * (left.dvv + h / 2.0 * third);
        assert!((dv - right.dv).norm() < 1e-10 * right.dv.norm());
        let dvv = left.dvv + h * third;
        assert!((dvv - right.dvv).norm() < 1e-10 * right.dvv.norm());
        assert!((surface.point(u, 1.2) - right.point).norm() == 0.0);
    }
}

#[test]
fn normals_are_square_to_the_surface_and_point_outward() {
    let surface = tube();
    for i in 0..60 {
        let (u, v) = (f64::from(i) / 59.0, 0.2 + f64::from(i * 7 % 60) / 60.0);
        let normal = surface.derivatives(u, v).normal().unwrap();
        let found = surface.derivatives(u, v);
        assert!(normal.dot(&found.du).abs() < 1e-10 * found.du.norm());
        assert!(normal.dot(&found.dv).abs() < 1e-10 * found.dv.norm());
        assert!(normal.dot(&Vector3::new(found.point.x, found.point.y, 0.0)) > 30.0);
    }
    let (along, around) = bases();
    let count = along.count() * around.count();
    let shrunk = Surface::new(along, around, vec![Point3::origin(); count]).unwrap();
    assert_eq!(shrunk.derivatives(0.5, 0.5).normal(), None);
}

#[test]
fn a_grid_of_points_is_the_points_one_by_one() {
    let surface = tube();
    let (u, v) = ([0.0, 0.33, 1.0], [0.2, 0.77, 1.15, 3.4]);
    let grid = surface.grid(&u, &v);
    assert_eq!(grid.len(), 12);
    for (k, found) in grid.iter().enumerate() {
        assert!((found - surface.point(u[k / 4], v[k % 4])).norm() < 1e-12);
    }
}

#[test]
fn clamped_knots_around_describe_the_same_surface() {
    let surface = tube();
    let (knots, points) = surface.clamped_around();
    let clamped = Basis::clamped(surface.around().breakpoints()).unwrap();
    assert_eq!(knots, clamped.knots());
    let columns = clamped.count();
    assert_eq!(points.len(), surface.along().count() * columns);
    assert!(points.chunks(columns).all(|row| row[0] == row[columns - 1]), "not closed");
    let mut worst = 0.0_f64;
    for i in 0..=40 {
        let along = surface.along().row(f64::from(i) / 40.0);
        for j in 0..=200 {
            let v = 0.2 + f64::from(j) / 200.0;
            let around = clamped.row(v);
            let mut found = Vector3::zeros();
            for (i, a) in along.indices.into_iter().zip(along.values) {
                for (j, b) in around.indices.into_iter().zip(around.values) {
                    found += a * b * points[i * columns + j].coords;
                }
            }
            worst = worst.max((found - surface.point(f64::from(i) / 40.0, v).coords).norm());
        }
    }
    assert!(worst < 3.4e-13, "{worst}");
}

#[test]
fn the_foot_is_found_across_the_seam() {
    let surface = tube();
    for (v, v0) in [(1.17, 0.23), (0.23, 1.17), (0.2, 1.19), (1.16, 1.3)] {
        let normal = surface.derivatives(0.4, v).normal().unwrap();
        let point = surface.point(0.4, v) + 6.0 * normal.into_inner();
        let foot = surface.closest(&point, 0.43, v0);
        // At the seam itself both of its ends are the same place.
        let around = (foot.v - v).abs();
        let off = around.min((around - 1.0).abs());
        assert!((foot.u - 0.4).abs() < 1e-9 && off < 1e-9, "{v}: {foot:?}");
        assert!((foot.distance_mm - 6.0).abs() < 1e-10);
    }
}

#[test]
fn beyond_an_end_the_foot_stops_on_the_end_row() {
    let surface = tube();
    for (u, away, u0) in [(0.0, -30.0, 0.2), (1.0, 30.0, 0.8)] {
        let point = surface.point(u, 0.62) + Vector3::new(0.0, 0.0, away);
        let foot = surface.closest(&point, u0, 0.6);
        assert!(foot.u == u, "{foot:?}");
        assert!(foot.distance_mm <= 30.0 + 1e-12);
        let nearest = (0..4000).map(|i| (surface.point(u, f64::from(i) / 4000.0) - point).norm());
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!((foot.distance_mm - nearest).abs() < 1e-3, "{foot:?} {nearest}");
    }
}

#[test]
fn a_cylinder_gives_distances_in_closed_form() {
    let around = Basis::uniform_periodic(0.0, TAU, 60).unwrap();
    let along = Basis::uniform_clamped(0.0, 1.0, 3).unwrap();
    let heights = along.greville();
    // Control radius so that the cubic B-spline of the regular polygon has radius 40 at its knots.
    let radius = 40.0 / ((2.0 + (TAU / 60.0).cos()) / 3.0);
    let control = |k: usize| {
        let angle = TAU * (k % 60) as f64 / 60.0;
        Point3::new(radius * angle.cos(), radius * angle.sin(), 300.0 * heights[k / 60])
    };
    let surface = Surface::new(along, around, (0..360).map(control).collect()).unwrap();
    for (distance, angle, z) in [(45.0, 0.0, 120.0), (15.0, FRAC_PI_3, 30.0), (300.0, 4.0, 250.0)] {
        let point = Point3::new(distance * f64::cos(angle), distance * f64::sin(angle), z);
        // From beyond a quarter turn Newton's own step leads to the far side.
        for start in [0.0, 1.0, 2.0, 3.0, -2.5] {
            let foot = surface.closest(&point, 0.5, angle + start);
            assert!((foot.distance_mm - (distance - 40.0_f64).abs()).abs() < 2e-5, "{foot:?}");
            assert!((foot.u - z / 300.0).abs() < 1e-6, "{foot:?}");
        }
    }
}

/// Whether no place around the foot is closer, up to what a quadratic can hide.
fn is_nearest(surface: &Surface, point: &Point3<f64>, u: f64, v: f64) -> bool {
    let here = (surface.point(u, v) - point).norm();
    let around = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (0.7, 0.7), (0.7, -0.7)];
    let near = around.map(|(a, b)| surface.point(u + 1e-3 * a, v + 1e-3 * b));
    near.iter().all(|near| (near - point).norm() >= here - 1e-9)
}

proptest! {
    #[test]
    fn no_point_nearby_is_closer_than_the_foot(
        u in 0.0..1.0, v in 0.2..1.2, du in -0.05..0.05, dv in -0.04..0.04, out in -15.0..40.0,
    ) {
        let surface = tube();
        let point = surface.point(u, v) + out * surface.derivatives(u, v).normal().unwrap().into_inner();
        let foot = surface.closest(&point, u + du, v + dv);
        prop_assert!(((surface.point(foot.u, foot.v) - point).norm() - foot.distance_mm).abs() < 1e-10);
        prop_assert!((0.2..1.2).contains(&foot.v) && (0.0..=1.0).contains(&foot.u));
        prop_assert!(is_nearest(&surface, &point, foot.u, foot.v));
    }

    #[test]
    fn a_start_anywhere_comes_to_rest_no_farther_away(
        x in -150.0..150.0, y in -150.0..150.0, z in -100.0..500.0, u in -0.3..1.3, v in 0.2..1.2,
    ) {
        let (surface, point) = (tube(), Point3::new(x, y, z));
        let foot = surface.closest(&point, u, v);
        prop_assert!(foot.distance_mm <= (surface.point(u, v) - point).norm() + 1e-9);
        prop_assert!(is_nearest(&surface, &point, foot.u, foot.v), "{foot:?}");
    }
}

#[test]
fn kept_starts_come_to_rest_too() {
    // Found by the property above while the search lacked a part: full Newton steps only, bends
    // across the tangents ignored, steps against negative curvature too short.
    for (x, y, z, u, v) in [
        (7.814597314, 6.064952582, -76.372070389, 0.0, 0.481078757),
        (-4.334150241, -2.643140278, 0.0, 0.0, 1.000526369),
        (-0.486495270, 9.996628236, 466.303872194, 0.138496675, 0.448253893),
        (4.453056993, 8.099323442, 23.596236623, 0.125068802, 0.642803002),
        (-103.831969270, -127.036930174, -80.817940135, 1.0, 0.482605024),
        (-122.589947087, -33.390487533, -41.445379448, 1.0, 1.099843799),
        (-32.186779593, 22.290856040, -81.218714640, 0.067681148, 0.785758566),
    ] {
        let (surface, point) = (tube(), Point3::new(x, y, z));
        let foot = surface.closest(&point, u, v);
        assert!(is_nearest(&surface, &point, foot.u, foot.v), "{foot:?}");
    }
}

#[test]
fn parts_that_make_no_surface_are_refused() {
    let (along, around) = bases();
    let points = vec![Point3::origin(); along.count() * around.count()];
    let refused = |along: &Basis, around: &Basis, points: &[Point3<f64>]| {
        Surface::new(along.clone(), around.clone(), points.to_vec()).unwrap_err()
    };
    assert_eq!(
        refused(&around, &around, &points),
        SurfaceFault::WrongBasis { direction: "along", needed: "clamped" }
    );
    assert_eq!(
        refused(&along, &along, &points),
        SurfaceFault::WrongBasis { direction: "around", needed: "periodic" }
    );
    assert_eq!(
        refused(&along, &around, &points[1..]),
        SurfaceFault::WrongCount { found: 71, along: 8, around: 9 }
    );
    let mut holed = points.clone();
    holed[20].y = f64::NAN;
    assert_eq!(refused(&along, &around, &holed), SurfaceFault::NotFinite { row: 2, column: 2 });
}
