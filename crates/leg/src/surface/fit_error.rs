//! The distance of skin from a surface.

use nalgebra::{Point3, Vector3};

use gaiter_spline::Surface;

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
pub struct SurfacePoint {
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
    pub fn measure(surface: &Surface, place: &SurfacePoint, outward: &Vector3<f64>) -> Off {
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
    pub fn from_distances(places: &[SurfacePoint], distances_mm: &[f64]) -> Option<FitError> {
        let (mut area, mut relative, mut squares, mut max_mm) = (0.0, 0.0, 0.0, 0.0_f64);
        for (place, distance_mm) in places.iter().zip(distances_mm) {
            area += place.area;
            relative += place.area * distance_mm / place.radius_mm;
            squares += place.area * distance_mm * distance_mm;
            max_mm = max_mm.max(*distance_mm);
        }
        let areas = places.iter().map(|place| place.area);
        let distances = distances_mm.iter().copied().zip(areas).collect();
        let p95_mm = reached(distances, 0.95 * area)?;
        Some(FitError {
            mean_relative: relative / area,
            rms_mm: (squares / area).sqrt(),
            p95_mm,
            max_mm,
        })
    }
}

/// The smallest value at which the weights of all values up to it reach a sum; the largest value if they never
/// do. Values come with their weights. `None` if there are none.
fn reached(mut values: Vec<(f64, f64)>, sum: f64) -> Option<f64> {
    let mut open = values.as_mut_slice();
    let mut missing = sum;
    while open.len() > 1 {
        let middle = open.len() / 2;
        open.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0));
        let (low, high) = open.split_at_mut(middle);
        let of_low: f64 = low.iter().map(|(_, weight)| weight).sum();
        open = if of_low >= missing {
            low
        } else {
            missing -= of_low;
            high
        };
    }
    open.first().map(|(value, _)| *value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_value_that_reaches_a_sum_is_that_of_the_sorted_values() {
        let values: Vec<(f64, f64)> =
            (0..400_u32).map(|i| (f64::from(i * 181 % 397), f64::from(1 + i % 7))).collect();
        let mut sorted = values.clone();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let all: f64 = values.iter().map(|(_, weight)| weight).sum();
        for share in [0.0, 0.2, 0.5, 0.95, 1.0] {
            let mut passed = 0.0;
            let expected = sorted.iter().find(|(_, weight)| {
                passed += weight;
                passed >= share * all
            });
            assert_eq!(reached(values.clone(), share * all), expected.map(|(value, _)| *value));
        }
        assert_eq!(reached(values, 2.0 * all), Some(396.0));
        assert_eq!(reached(Vec::new(), 1.0), None);
    }
}
