//! Conical tubes of oval sections.

// Each test crate uses its own part.
#![allow(clippy::unwrap_used)]

use std::f64::consts::TAU;

use gaiter_spline::{Basis, GridData, Surface, fit_grid};
use nalgebra::{Point3, Rotation3, Vector3};

/// A conical tube of oval sections about an axis that leans and does not pass through the origin:
/// 10 × 12 control points, plane ends; and the axis. `turn` is +1 where v runs counter-clockwise
/// seen from above, −1 for the mirror image.
pub fn tube(turn: f64) -> (Surface, impl Fn(f64, f64) -> Point3<f64>) {
    let lean = Rotation3::from_axis_angle(&Vector3::x_axis(), 0.2)
        * Rotation3::from_axis_angle(&Vector3::y_axis(), 0.15);
    let on_skin = move |share: f64, round: f64, radius: f64| {
        let (angle, radius) = (round * TAU - TAU / 4.0, radius * (30.0 + 25.0 * share));
        let upright = Vector3::new(1.1 * radius * angle.cos(), radius * angle.sin(), 340.0 * share);
        let placed = lean * upright + Vector3::new(150.0, -40.0, 98.0);
        Point3::new(turn * placed.x, placed.y, placed.z)
    };
    let along: Vec<f64> = (0..20).map(|i| f64::from(i) / 19.0).collect();
    let around: Vec<f64> = (0..36).map(|j| f64::from(j) / 36.0).collect();
    let places = along.iter().flat_map(|u| around.iter().map(move |v| (*u, *v)));
    let points: Vec<_> = places.map(|(u, v)| on_skin(u, v, 1.0)).collect();
    let data = GridData { along: &along, around: &around, points: &points };
    let bases = (
        Basis::uniform_clamped(0.0, 1.0, 7).unwrap(),
        Basis::uniform_periodic(0.0, 1.0, 12).unwrap(),
    );
    let surface = fit_grid(&data, bases.0, bases.1).unwrap().surface;
    (surface, move |u, v| on_skin(u, v, 0.0))
}

/// The surface with one control point moved.
pub fn dented(surface: &Surface, point: usize, by: Vector3<f64>) -> Surface {
    let mut points = surface.control_points().to_vec();
    points[point] += by;
    Surface::new(surface.along().clone(), surface.around().clone(), points).unwrap()
}
