//! The distance of skin from a surface.

use nalgebra::Point3;
use rayon::prelude::*;

use crate::spline::Surface;

/// Shortest distances of skin from a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitError {
    /// Mean of |distance| / local radius, weighted by area; 1 is 100 %.
    pub mean_relative: f64,
    /// Root mean square, weighted by area, mm.
    pub rms_mm: f64,
    /// 95 % of the area are within this distance, mm.
    pub p95_mm: f64,
    /// Largest, mm.
    pub max_mm: f64,
}

/// A point of the skin to be compared.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// The point itself.
    pub point: Point3<f64>,
    /// Its expected position on the surface: distance along the axis, mm, and column.
    pub at: (f64, f64),
    /// Its angle around the middle of the leg, radians.
    pub angle: f64,
    /// Its distance from the middle of the leg, mm.
    pub radius_mm: f64,
    /// The area that it represents, in any unit.
    pub area: f64,
}

impl FitError {
    /// Distances of points from a surface; `None` if there are no points. The order of summation is
    /// fixed, so the results do not depend on threads.
    pub fn of(surface: &Surface, places: &[Place]) -> Option<FitError> {
        let distance_mm =
            |place: &Place| (surface.distance_mm(&place.point, place.at.0, place.at.1), place.area);
        let mut distances: Vec<(f64, f64)> = places.par_iter().map(distance_mm).collect();
        let (mut area, mut relative, mut squares) = (0.0, 0.0, 0.0);
        for (place, (distance_mm, own)) in places.iter().zip(&distances) {
            area += own;
            relative += own * distance_mm / place.radius_mm;
            squares += own * distance_mm * distance_mm;
        }
        distances.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (max_mm, _) = *distances.last()?;
        let mut passed = 0.0;
        let within = distances.iter().find(|(_, own)| {
            passed += own;
            passed >= 0.95 * area
        });
        Some(FitError {
            mean_relative: relative / area,
            rms_mm: (squares / area).sqrt(),
            p95_mm: within.map_or(max_mm, |(distance_mm, _)| *distance_mm),
            max_mm,
        })
    }
}
