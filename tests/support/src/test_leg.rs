//! The closed-form test leg: an infinitely smooth leg whose every figure is known. *The reference* in
//! tests that use it is a set of figures for this leg that were computed without gaiter; the document
//! they come from is not in this repository.
//!
//! Millimetres; theta counter-clockwise seen from above, 0 lateral, 90° anterior; z from 0 (above
//! the foot) to 800 (top of the thigh).

// Each test crate uses its own part of the leg.

use std::f64::consts::PI;

use nalgebra::Point3;

/// Height of the leg, mm.
pub const HEIGHT_MM: f64 = 800.0;

/// Rows of [`grid`].
pub const GRID_ROWS: usize = 80;

/// Columns of [`grid`].
pub const GRID_COLUMNS: usize = 72;

fn g(z: f64, centre: f64, width: f64) -> f64 {
    (-((z - centre) / width).powi(2) / 2.0).exp()
}

fn sg(z: f64, centre: f64, width: f64) -> f64 {
    (1.0 + ((z - centre) / width).tanh()) / 2.0
}

/// The leg's centre line at height z: x and y, mm.
pub fn center(z: f64) -> (f64, f64) {
    let x = 6.0 * (PI * z / 800.0).sin() + 4.0 * g(z, 300.0, 80.0);
    let y = -10.0 * g(z, 300.0, 90.0) + 8.0 * g(z, 470.0, 70.0) + 0.012 * (z - 400.0);
    (x, y)
}

/// The radius about the centre line, mm.
pub fn radius_mm(theta_rad: f64, z_mm: f64) -> f64 {
    let z = z_mm;
    let w = |degrees: f64, k: f64| (k * ((theta_rad - degrees.to_radians()).cos() - 1.0)).exp();
    let round = 34.0 + 8.0 * g(z, 0.0, 45.0) + 22.0 * sg(z, 215.0, 55.0) + 9.0 * g(z, 305.0, 60.0)
        - 5.0 * g(z, 395.0, 30.0)
        + 3.0 * g(z, 450.0, 35.0)
        + 26.0 * sg(z, 590.0, 95.0);
    let oval = 1.0 + 0.05 * (2.0 * (theta_rad - 80.0_f64.to_radians())).cos() * sg(z, 120.0, 50.0)
        - 0.04 * (2.0 * theta_rad).cos() * g(z, 60.0, 60.0);
    // Height in mm, direction in degrees, narrowness, height of the centre, width.
    let bumps = [
        (9.0, 235.0, 3.5, 290.0, 55.0),
        (6.0, 305.0, 4.5, 318.0, 48.0),
        (3.0, 100.0, 14.0, 230.0, 95.0),
        (-2.5, 140.0, 7.0, 240.0, 90.0),
        (5.0, 270.0, 16.0, 70.0, 55.0),
        (-3.0, 235.0, 12.0, 75.0, 45.0),
        (-3.0, 305.0, 12.0, 75.0, 45.0),
        (7.0, 185.0, 14.0, 62.0, 13.0),
        (7.5, 352.0, 16.0, 52.0, 13.0),
        (3.5, 92.0, 14.0, 405.0, 13.0),
        (6.0, 90.0, 5.0, 462.0, 24.0),
        (-5.5, 270.0, 8.0, 445.0, 30.0),
        (3.5, 238.0, 9.0, 470.0, 45.0),
        (3.5, 302.0, 9.0, 470.0, 45.0),
        (5.0, 150.0, 6.0, 520.0, 38.0),
        (5.0, 75.0, 3.0, 660.0, 90.0),
    ];
    let bump =
        |(height, degrees, k, c, s): (f64, f64, f64, f64, f64)| height * w(degrees, k) * g(z, c, s);
    round * oval
        + bumps.into_iter().map(bump).sum::<f64>()
        + 6.0 * w(200.0, 3.0) * sg(z, 700.0, 60.0)
}

/// The point of the skin in direction theta at height z, mm.
pub fn point(theta_rad: f64, z_mm: f64) -> Point3<f64> {
    let ((cx, cy), r) = (center(z_mm), radius_mm(theta_rad, z_mm));
    Point3::new(cx + r * theta_rad.cos(), cy + r * theta_rad.sin(), z_mm)
}

/// How far outside the skin a point lies, measured horizontally from the centre line, mm.
pub fn outside_mm(point: &Point3<f64>) -> f64 {
    let (cx, cy) = center(point.z);
    let (x, y) = (point.x - cx, point.y - cy);
    x.hypot(y) - radius_mm(y.atan2(x), point.z)
}

/// The clean samples of the reference: 80 rows from the bottom, each of 72 points from 200° on.
pub fn grid() -> Vec<Point3<f64>> {
    let columns = |z: f64| (0..GRID_COLUMNS).map(move |j| (z, 200.0 + 5.0 * j as f64));
    let rows = (0..GRID_ROWS).map(|i| HEIGHT_MM * i as f64 / (GRID_ROWS - 1) as f64);
    rows.flat_map(columns).map(|(z, degrees)| point(degrees.to_radians(), z)).collect()
}

/// The girth at height z, mm, as a polygon of 2880 sides.
pub fn circumference(z_mm: f64) -> f64 {
    let corner = |i: usize| point(2.0 * PI * i as f64 / 2880.0, z_mm);
    (0..2880).map(|i| (corner(i + 1) - corner(i)).norm()).sum()
}
