//! The signed distance of the skin from the surface, position by position: the map behind the
//! figures of [`FitError`](super::fit_error::FitError).

use std::f64::consts::{PI, TAU};

use super::fit_error::SurfacePoint;
use super::hole::Coverage;
use super::ridge_parametrization::Columns;

/// Maximum distance between the map's rows along the axis, mm; reduced so that the rows reach both
/// ends.
pub(crate) const ROW_MM: f64 = 10.0;

/// Number of the map's angles around, −180° first: 8 mm apart on a calf.
pub const ANGLES: usize = 48;

/// A node counts as not seen if the points around it have less than this total weight.
const WEIGHT_MIN: f64 = 0.05;

/// Mean distances of the scan's points from a surface, on rows along and equal angles around.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorMap {
    /// Distances of the rows along the axis, mm, ascending.
    pub along_mm: Vec<f64>,
    /// Row by row, [`ANGLES`] each: distance of the skin outside the surface, mm; `None` where it
    /// was not seen.
    pub outside_mm: Vec<Option<f64>>,
}

/// The angle of an index within a row, radians from −π on.
pub(crate) fn angle(index: usize) -> f64 {
    -PI + TAU * index as f64 / ANGLES as f64
}

impl ErrorMap {
    /// The map of points on a surface between two distances along the axis, each with its distance outside
    /// the surface, mm. A point counts for the four nodes around it, with bilinear weights, so that noise is
    /// averaged without a shift.
    pub fn new<'p>(
        [low, high]: [f64; 2],
        columns: &Columns,
        coverage: &Coverage,
        points: impl Iterator<Item = (&'p SurfacePoint, f64)>,
    ) -> ErrorMap {
        let pieces = ((high - low) / ROW_MM).ceil().max(1.0);
        let along_mm: Vec<f64> =
            (0..=pieces as usize).map(|row| low + (high - low) * row as f64 / pieces).collect();
        let mut sums = vec![[0.0; 2]; along_mm.len() * ANGLES];
        for (place, off_mm) in points {
            let up = (place.at.0 - low) / (high - low) * pieces;
            let around = (place.angle + PI) / TAU * ANGLES as f64;
            for (row, of_row) in shares(up) {
                for (column, of_column) in shares(around) {
                    let node = row.min(along_mm.len() - 1) * ANGLES + column % ANGLES;
                    let weight = of_row * of_column;
                    sums[node][0] += weight;
                    sums[node][1] += weight * off_mm;
                }
            }
        }
        let mut outside_mm = Vec::with_capacity(sums.len());
        for (along_mm, row) in along_mm.iter().zip(sums.chunks_exact(ANGLES)) {
            let column = columns.at(*along_mm);
            for (index, [weight, sum]) in row.iter().enumerate() {
                let is_seen =
                    *weight > WEIGHT_MIN && !coverage.is_in_hole(*along_mm, column(angle(index)));
                outside_mm.push(is_seen.then(|| sum / weight));
            }
        }
        ErrorMap { along_mm, outside_mm }
    }
}

/// The two nodes next to a position in a row of nodes, with its weight for each.
fn shares(place: f64) -> [(usize, f64); 2] {
    let below = place.floor().max(0.0);
    let share = place - below;
    [(below as usize, 1.0 - share), (below as usize + 1, share)]
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point2, Point3, Vector3};

    use super::*;
    use crate::sections::axis::LegAxis;
    use crate::side::Side;
    use crate::surface::fit_error::Off;
    use gaiter_spline::{Basis, GridData, Surface, fit_grid};

    const RADIUS_MM: f64 = 50.0;
    const LENGTH_MM: f64 = 190.0;

    fn axis() -> LegAxis {
        LegAxis::straight(Point3::origin(), &Vector3::z(), Side::Left)
    }

    fn place(along_mm: f64, angle: f64, radius_mm: f64) -> SurfacePoint {
        let across = Point2::new(radius_mm * angle.cos(), radius_mm * angle.sin());
        let point = axis().at(along_mm, &across);
        SurfacePoint { point, at: (along_mm, angle), angle, radius_mm, area: 1.0 }
    }

    fn tube() -> Surface {
        let along: Vec<f64> = (0..20).map(|i| 10.0 * f64::from(i)).collect();
        let around: Vec<f64> = (0..72).map(|j| TAU * f64::from(j) / 72.0 - PI).collect();
        let places = along.iter().flat_map(|u| around.iter().map(move |v| (*u, *v)));
        let points: Vec<Point3<f64>> = places.map(|(u, v)| place(u, v, RADIUS_MM).point).collect();
        let bases =
            [Basis::uniform_clamped(0.0, LENGTH_MM, 14), Basis::uniform_periodic(-PI, TAU, 36)];
        let [rows, columns] = bases.map(Result::unwrap);
        let data = GridData { along: &along, around: &around, points: &points };
        fit_grid(&data, rows, columns).unwrap().surface
    }

    /// Points 4 mm apart, this far outside the tube; `None` where the tube was not seen.
    fn map(outside_mm: impl Fn(f64, f64) -> Option<f64>) -> ErrorMap {
        let rows = (0..48).map(|i| 4.0 * f64::from(i) + 1.0);
        let places: Vec<SurfacePoint> = rows
            .flat_map(|u| (0..78).map(move |j| (u, TAU * f64::from(j) / 78.0 - PI)))
            .filter_map(|(u, v)| Some(place(u, v, RADIUS_MM + outside_mm(u, v)?)))
            .collect();
        let columns = Columns::following(&[], 0.0, LENGTH_MM).unwrap();
        let at: Vec<(f64, f64)> = places.iter().map(|place| place.at).collect();
        let coverage = Coverage::find([0.0, LENGTH_MM], &at, |_| RADIUS_MM);
        let tube = tube();
        let outward = |place: &SurfacePoint| place.point.coords - Vector3::z() * place.point.z;
        let off =
            |place: &SurfacePoint| Off::measure(&tube, place, &outward(place)).outside_mm.unwrap();
        let points = places.iter().map(|place| (place, off(place)));
        ErrorMap::new([0.0, LENGTH_MM], &columns, &coverage, points)
    }

    #[test]
    fn skin_outside_is_positive_inside_negative_and_each_at_its_place() {
        let found = map(|_, angle| Some(if angle < 0.0 { 0.8 } else { -0.3 }));
        for (node, outside_mm) in found.outside_mm.iter().enumerate() {
            let angle = angle(node % ANGLES);
            // Nodes between the two halves contain parts of both.
            let edge = angle.sin().abs() < 0.2;
            let expected = if angle < 0.0 { 0.8 } else { -0.3 };
            let near = (outside_mm.unwrap() - expected).abs() < 0.01;
            assert!(edge || near, "{angle}: {outside_mm:?}");
        }
    }

    #[test]
    fn a_point_weighs_most_at_the_node_next_to_it() {
        assert_eq!(shares(3.0), [(3, 1.0), (4, 0.0)]);
        let [(below, least), (above, most)] = shares(7.75);
        assert_eq!((below, above), (7, 8));
        assert!((least - 0.25).abs() < 1e-12 && (most - 0.75).abs() < 1e-12);
    }

    #[test]
    fn rows_reach_from_end_to_end_and_a_hole_is_not_seen() {
        let hole = |u: f64, v: f64| (u - 90.0).hypot(RADIUS_MM * v) < 25.0;
        let found = map(|u, v| (!hole(u, v)).then_some(0.0));
        assert_eq!((found.along_mm[0], found.along_mm[19]), (0.0, LENGTH_MM));
        assert_eq!(found.outside_mm.len(), found.along_mm.len() * ANGLES);
        for (node, outside_mm) in found.outside_mm.iter().enumerate() {
            let (u, v) = (found.along_mm[node / ANGLES], angle(node % ANGLES));
            let from_middle_mm = (u - 90.0).hypot(RADIUS_MM * v);
            // The edge of a hole is as sharp as the spacing of the points.
            assert!(from_middle_mm > 15.0 || outside_mm.is_none(), "{u} {v}");
            assert!(from_middle_mm < 35.0 || outside_mm.is_some(), "{u} {v}");
        }
    }
}
