//! Triangles of a tube: how far they lie from it, that they close, and which way they face.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use gaiter_spline::{
    Basis, Ends, Facets, GridData, Surface, TessellationFault, facets, fit_grid, tessellate,
};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;

/// The cylinder; a fit with 24 spans around shows its normals to 1e-3.
const RADIUS_MM: f64 = 40.0;
const LENGTH_MM: f64 = 300.0;

fn surface_of(place: impl Fn(f64, f64) -> Point3<f64>, spans: [usize; 2]) -> Surface {
    let along: Vec<f64> = (0..60).map(|i| f64::from(i) / 59.0).collect();
    let around: Vec<f64> = (0..96).map(|j| f64::from(j) / 96.0).collect();
    let pairs = along.iter().flat_map(|u| around.iter().map(move |v| (*u, *v)));
    let points: Vec<_> = pairs.map(|(u, v)| place(u, v)).collect();
    let data = GridData { along: &along, around: &around, points: &points };
    let bases = (
        Basis::uniform_clamped(0.0, 1.0, spans[0]).unwrap(),
        Basis::uniform_periodic(0.0, 1.0, spans[1]).unwrap(),
    );
    fit_grid(&data, bases.0, bases.1).unwrap().surface
}

/// `turn`: +1 counter-clockwise seen from above, −1 the other way round.
fn cylinder(turn: f64) -> Surface {
    let place = |u: f64, v: f64| {
        let (sin, cos) = (turn * v * TAU).sin_cos();
        Point3::new(RADIUS_MM * cos, RADIUS_MM * sin, LENGTH_MM * u)
    };
    surface_of(place, [4, 24])
}

/// A leg-sized tube with bumps of every length that its bases can hold, its axis leaning.
fn bumpy(seed: [f64; 4]) -> Surface {
    let place = |u: f64, v: f64| {
        let [a, b, c, d] = seed;
        let swell = 8.0 * (PI * u * (1.0 + 3.0 * a)).sin() + 5.0 * b * (2.0 * TAU * v + u).cos();
        let ripple = 3.0 * c * (5.0 * TAU * v).sin() * (9.0 * u).cos() + 2.0 * d;
        let (sin, cos) = (v * TAU).sin_cos();
        let radius = 45.0 + swell + ripple;
        Point3::new(radius * cos + 50.0 * u, radius * sin - 20.0 * u, 350.0 * u)
    };
    surface_of(place, [16, 18])
}

/// The largest distance of sampled places of the triangles from the surface, and of sampled places
/// of the surface from the plane of the triangle over the same parameters.
fn farthest_mm(surface: &Surface, facets: &Facets) -> f64 {
    let shares = [[1.0, 1.0, 1.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0]];
    // Parameters of the nearest place: a rough guess is enough, and a grid of guesses gives one.
    let (low, high) = surface.along().domain();
    let (first, last) = surface.around().domain();
    let u: Vec<f64> = (0..=100).map(|i| low + (high - low) * f64::from(i) / 100.0).collect();
    let v: Vec<f64> = (0..120).map(|j| first + (last - first) * f64::from(j) / 120.0).collect();
    let guesses = surface.grid(&u, &v);
    let mut farthest = 0.0_f64;
    for triangle in facets.triangles.iter().step_by(17) {
        let corners = facets.places(triangle);
        for weights in shares {
            let sum: f64 = weights.iter().sum();
            let place: Vector3<f64> =
                corners.iter().zip(weights).map(|(p, w)| p.coords * (w / sum)).sum();
            let place = Point3::from(place);
            let near = |p: &Point3<f64>| (p - place).norm_squared();
            let nearest = (0..guesses.len())
                .min_by(|a, b| near(&guesses[*a]).total_cmp(&near(&guesses[*b])))
                .unwrap();
            let foot = surface.closest(&place, u[nearest / v.len()], v[nearest % v.len()]);
            farthest = farthest.max(foot.distance_mm);
        }
    }
    farthest
}

/// How often each edge is run along in its one way and in the other.
fn edges(facets: &Facets) -> BTreeMap<(u32, u32), [usize; 2]> {
    let mut edges = BTreeMap::new();
    for triangle in &facets.triangles {
        let [a, b, c] = triangle.map(|corner| corner.point);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let ways: &mut [usize; 2] = edges.entry((from.min(to), from.max(to))).or_default();
            ways[usize::from(from > to)] += 1;
        }
    }
    edges
}

fn volume_mm3(facets: &Facets) -> f64 {
    let six = |t: &_| {
        let [a, b, c] = facets.places(t).map(|p| p.coords);
        a.dot(&b.cross(&c))
    };
    facets.triangles.iter().map(six).sum::<f64>() / 6.0
}

#[test]
fn a_cylinder_is_divided_as_its_sagitta_asks_for() {
    for tolerance_mm in [0.5, 0.05, 0.01] {
        let surface = cylinder(1.0);
        let made = facets(&surface, tolerance_mm, Ends::Open).unwrap();
        let columns = made.points.iter().filter(|p| p.z < 1e-6).count() as f64;
        // A chord over the angle a leaves an arc of radius r by r (1 − cos(a/2)).
        let needed = PI / (1.0 - tolerance_mm / RADIUS_MM).acos();
        assert!(columns >= needed, "{columns} {needed}");
        // Half of the tolerance is kept for the direction along, hence √2; a whole number of steps
        // in each of 24 spans, hence up to 24 more.
        assert!(columns <= 1.5 * needed + 24.0, "{columns} {needed}");
        let chord = (0.5 * TAU / columns).cos();
        let found = farthest_mm(&surface, &made);
        assert!(found <= tolerance_mm && found >= 0.9 * RADIUS_MM * (1.0 - chord), "{found}");
    }
}

#[test]
fn a_solid_cylinder_is_closed_and_encloses_its_polygon_s_volume() {
    for turn in [1.0, -1.0] {
        let made = facets(&cylinder(turn), 0.05, Ends::Fans).unwrap();
        assert!(edges(&made).values().all(|ways| *ways == [1, 1]), "an edge is open or doubled");
        let columns = made.points.iter().filter(|p| p.z < 1e-6).count() - 1;
        let polygon = 0.5 * columns as f64 * (TAU / columns as f64).sin();
        let expected = polygon * RADIUS_MM * RADIUS_MM * LENGTH_MM;
        assert!((volume_mm3(&made) / expected - 1.0).abs() < 1e-5, "turned inside out, or open");
    }
}

#[test]
fn an_open_tube_is_closed_at_its_seam_and_open_at_its_two_rims_alone() {
    let made = facets(&bumpy([0.4, 0.9, 0.2, 0.5]), 0.1, Ends::Open).unwrap();
    let columns = {
        let open = edges(&made).into_values().filter(|ways| *ways != [1, 1]).collect::<Vec<_>>();
        assert!(open.iter().all(|ways| ways.iter().sum::<usize>() == 1));
        open.len() / 2
    };
    let rows = made.points.len() / columns;
    assert_eq!(made.points.len(), rows * columns);
    assert_eq!(made.triangles.len(), 2 * (rows - 1) * columns);
    assert_eq!(made.normals.len(), made.points.len());
}

#[test]
fn normals_stand_out_of_the_tube_and_lids_out_of_their_ends() {
    for turn in [1.0, -1.0] {
        let made = facets(&cylinder(turn), 0.05, Ends::Fans).unwrap();
        let (lids, tube) = (&made.normals[made.normals.len() - 2..], made.points.len() - 2);
        for (point, normal) in made.points[..tube].iter().zip(&made.normals) {
            let outward = Vector3::new(point.x, point.y, 0.0).normalize();
            assert!((normal.into_inner() - outward).norm() < 1e-3, "{point} {normal:?}");
        }
        assert!((lids[0].into_inner() + Vector3::z()).norm() < 1e-9);
        assert!((lids[1].into_inner() - Vector3::z()).norm() < 1e-9);
        for triangle in &made.triangles {
            let [a, b, c] = made.places(triangle);
            let flat = (b - a).cross(&(c - a)).normalize();
            let off = triangle.map(|corner| made.normals[corner.normal as usize].dot(&flat));
            assert!(off.iter().all(|cos| *cos > 0.99), "{triangle:?} {off:?}");
        }
    }
}

#[test]
fn an_absurd_tolerance_is_refused_by_name() {
    let surface = cylinder(1.0);
    for tolerance_mm in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let fault = facets(&surface, tolerance_mm, Ends::Open).unwrap_err();
        assert!(matches!(fault, TessellationFault::NoTolerance { .. }), "{fault}");
    }
    for tolerance_mm in [1e-9, f64::MIN_POSITIVE] {
        let fault = facets(&surface, tolerance_mm, Ends::Open).unwrap_err();
        let TessellationFault::TooFine { triangles, .. } = fault else { panic!("{fault}") };
        assert!(triangles > tessellate::TRIANGLES_MAX as f64);
    }
}

#[test]
fn a_surface_without_a_tangent_plane_is_refused_by_its_place() {
    let surface = cylinder(1.0);
    let flat = surface.control_points().iter().map(|p| Point3::new(0.0, 0.0, p.z)).collect();
    let line = Surface::new(surface.along().clone(), surface.around().clone(), flat).unwrap();
    let fault = facets(&line, 0.1, Ends::Open).unwrap_err();
    assert_eq!(fault, TessellationFault::Degenerate { u: 0.0, v: 0.0 });
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_triangle_leaves_the_surface_by_more_than_the_tolerance(
        seed in proptest::array::uniform4(-1.0..1.0_f64), tolerance_mm in 0.02..2.0_f64,
    ) {
        let surface = bumpy(seed);
        let made = facets(&surface, tolerance_mm, Ends::Open).unwrap();
        let found = farthest_mm(&surface, &made);
        prop_assert!(found <= tolerance_mm, "{found} {tolerance_mm}");
    }

    /// Twice the size within twice the tolerance is the same division.
    #[test]
    fn scaling_surface_and_tolerance_scales_the_triangles(seed in proptest::array::uniform4(-1.0..1.0_f64)) {
        let surface = bumpy(seed);
        let twice = surface.control_points().iter().map(|p| p * 2.0).collect();
        let twice = Surface::new(surface.along().clone(), surface.around().clone(), twice).unwrap();
        let [one, two] = [(&surface, 0.1), (&twice, 0.2)]
            .map(|(surface, tolerance_mm)| facets(surface, tolerance_mm, Ends::Fans).unwrap());
        prop_assert_eq!(one.triangles, two.triangles);
        for (one, two) in one.points.iter().zip(&two.points) {
            prop_assert!((one * 2.0 - two).norm() < 1e-9);
        }
    }
}
