//! Where the skin lies off the surface and to which side: the map behind the figures of
//! [`FitError`](super::fit_error::FitError).

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;

use super::columns::Columns;
use super::fit_error::Place;
use super::hole::Coverage;
use crate::spline::Surface;

/// Distance of the map's rows along the axis, mm, made a little smaller to reach both ends.
pub const ROW_MM: f64 = 10.0;

/// The map's angles around, −180° first: 8 mm apart on a calf.
pub const ANGLES: usize = 48;

/// A node with less than this share of one point around it was not seen.
const WEIGHT_MIN: f64 = 0.05;

/// Mean distances of the scan's points from a surface, on rows along and equal angles around.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorMap {
    /// Distances of the rows along the axis, mm, ascending.
    pub along_mm: Vec<f64>,
    /// Row by row, [`ANGLES`] each: how far the skin lies outside the surface, mm; none where it was
    /// not seen.
    pub outside_mm: Vec<Option<f64>>,
}

/// The angle of a place in a row, radians from −π on.
pub fn angle(index: usize) -> f64 {
    -PI + TAU * index as f64 / ANGLES as f64
}

impl ErrorMap {
    /// The map of points on a surface. Each counts for the four nodes around it, the nearer the more,
    /// so that noise is averaged and nothing is moved. `outward` is the direction out of the leg at a
    /// place, of any length.
    pub fn of(
        surface: &Surface,
        columns: &Columns,
        coverage: &Coverage,
        points: impl Iterator<Item = Place>,
        outward: impl Fn(&Place) -> Vector3<f64>,
    ) -> ErrorMap {
        let (low, high) = surface.along().domain();
        let pieces = ((high - low) / ROW_MM).ceil().max(1.0);
        let along_mm: Vec<f64> =
            (0..=pieces as usize).map(|row| low + (high - low) * row as f64 / pieces).collect();
        let mut sums = vec![[0.0; 2]; along_mm.len() * ANGLES];
        for place in points.filter(|place| (low..=high).contains(&place.at.0)) {
            let Some(off_mm) = off_mm(surface, &place, &outward(&place)) else { continue };
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
        let node = |(node, [weight, sum]): (usize, &[f64; 2])| {
            let (along_mm, angle) = (along_mm[node / ANGLES], angle(node % ANGLES));
            let is_seen = *weight > WEIGHT_MIN
                && !coverage.is_in_hole(along_mm, columns.column(along_mm, angle));
            is_seen.then(|| sum / weight)
        };
        let outside_mm = sums.iter().enumerate().map(node).collect();
        ErrorMap { along_mm, outside_mm }
    }
}

/// How far a point lies outside the surface along the surface's normal, mm; none at a singular place.
fn off_mm(surface: &Surface, place: &Place, outward: &Vector3<f64>) -> Option<f64> {
    let (u, v) = place.at;
    let normal = surface.normal(u, v)?;
    let off_mm = (place.point - surface.point(u, v)).dot(&normal);
    Some(if normal.dot(outward) < 0.0 { -off_mm } else { off_mm })
}

/// The two nodes about a place of a row of nodes, and its share in each.
fn shares(place: f64) -> [(usize, f64); 2] {
    let below = place.floor().max(0.0);
    let share = place - below;
    [(below as usize, 1.0 - share), (below as usize + 1, share)]
}
