//! The distance of skin from a surface.

use nalgebra::{Point3, Vector3};

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

/// The distance of a place from a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Off {
    /// To the nearest point of the surface, mm.
    pub distance_mm: f64,
    /// Outside the surface along the normal at the place's expected position, mm; `None` where the surface
    /// has no normal.
    pub outside_mm: Option<f64>,
}

impl Off {
    /// The distance of a place within the surface's domain; `outward` is the direction out of the leg there,
    /// of any length.
    pub fn of(surface: &Surface, place: &Place, outward: &Vector3<f64>) -> Off {
        let (u, v) = place.at;
        let here = surface.derivatives(u, v);
        let distance_mm = surface.distance_mm(&place.point, [u, v], here);
        let outside_mm = here.normal().map(|normal| {
            let off_mm = (place.point - here.point).dot(&normal);
            if normal.dot(outward) < 0.0 { -off_mm } else { off_mm }
        });
        Off { distance_mm, outside_mm }
    }
}

impl FitError {
    /// The error at places with these distances from a surface, mm; `None` if there are none. The order of
    /// summation is fixed, so the results do not depend on threads.
    pub fn of(places: &[Place], distances_mm: &[f64]) -> Option<FitError> {
        let areas = places.iter().map(|place| place.area);
        let mut distances: Vec<(f64, f64)> = distances_mm.iter().copied().zip(areas).collect();
        let (mut area, mut relative, mut squares) = (0.0, 0.0, 0.0);
        for (place, (distance_mm, own)) in places.iter().zip(&distances) {
            area += own;
            relative += own * distance_mm / place.radius_mm;
            squares += own * distance_mm * distance_mm;
        }
        distances.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
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
