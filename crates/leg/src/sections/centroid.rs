//! The middle of an outline that may have gaps.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector2};

use super::hull::Hull;

/// Between neighbouring points of an outline up to this far apart, radians, it is straight: 20°, several
/// edges of a usual export.
const GAP: f64 = TAU / 18.0;

/// Across a wider gap it has pieces of this length, radians.
const PIECE: f64 = TAU / 48.0;

/// The centroid moves the middle, and with it the angles and radii: after three rounds by nothing.
const MIDDLE_ROUNDS: usize = 3;

/// Centroid of the area inside an outline given as unordered points, ordered by their angle about
/// its middle. Across a gap the radius goes from one edge to the other: a chord would pull the centroid
/// of a shank whose inner side was not seen aside by millimetres.
pub fn outline_centroid(points: &[Point2<f64>]) -> Option<Point2<f64>> {
    let ring = ring(points);
    let mut middle = Hull::of_ring(&ring)?.centroid();
    if let Some(centroid) = centroid_of_closed(&ring, middle) {
        return Some(centroid);
    }
    for _ in 0..MIDDLE_ROUNDS {
        let (centroid, has_gap) = centroid_about(points, middle)?;
        middle = centroid;
        if !has_gap {
            break;
        }
    }
    Some(middle)
}

/// The points by their angle about their mean, which lies inside their hull.
fn ring(points: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let sum: Vector2<f64> = points.iter().map(|point| point.coords).sum();
    let mean = sum / points.len().max(1) as f64;
    // Bits of positive numbers are in the order of the numbers, and sorted faster.
    let key = |point: &Point2<f64>| quick_turn(point.coords - mean).to_bits();
    let mut by_turn: Vec<(u64, u32)> = points.iter().map(key).zip(0..).collect();
    by_turn.sort_unstable();
    by_turn.into_iter().map(|(_, index)| points[index as usize]).collect()
}

/// A number that grows with the angle of an arm from −180° to 180°, from 1 to 5: ten times faster than the
/// angle.
fn quick_turn(arm: Vector2<f64>) -> f64 {
    let share = arm.x / (arm.x.abs() + arm.y.abs()).max(f64::MIN_POSITIVE);
    if arm.y < 0.0 { 2.0 + share } else { 4.0 - share }
}

/// The centroid of an outline whose points lie in order about a point inside, without a gap; `None` of any
/// other.
fn centroid_of_closed(ring: &[Point2<f64>], middle: Point2<f64>) -> Option<Point2<f64>> {
    let gap = GAP.tan();
    let mut from = ring.last()? - middle;
    let (mut moment, mut twice_area) = (Vector2::zeros(), 0.0);
    for point in ring {
        let to = point - middle;
        let (cross, dot) = (from.perp(&to), from.dot(&to));
        if cross < 0.0 || cross >= gap * dot {
            return None;
        }
        moment += (from + to) * cross;
        twice_area += cross;
        from = to;
    }
    (twice_area > 0.0).then(|| middle + moment / (3.0 * twice_area))
}

/// The centroid, for angles and radii about a point inside, and whether there was a gap to bridge.
fn centroid_about(points: &[Point2<f64>], middle: Point2<f64>) -> Option<(Point2<f64>, bool)> {
    let arms = points.iter().map(|p| p - middle);
    let mut outline: Vec<(f64, Vector2<f64>)> = arms.map(|arm| (arm.y.atan2(arm.x), arm)).collect();
    outline.sort_by(|p, q| p.0.total_cmp(&q.0));
    let last = *outline.last()?;
    let (mut moment, mut twice_area, mut has_gap) = (Vector2::zeros(), 0.0, false);
    let mut add = |p: Vector2<f64>, q: Vector2<f64>| {
        let cross = p.perp(&q);
        moment += (p + q) * cross;
        twice_area += cross;
    };
    let mut from = (last.0 - TAU, last.1);
    for to in outline {
        if to.0 - from.0 > GAP {
            has_gap = true;
            bridge(from, to).for_each(|[p, q]| add(p, q));
        } else {
            add(from.1, to.1);
        }
        from = to;
    }
    (twice_area > 0.0).then(|| (middle + moment / (3.0 * twice_area), has_gap))
}

/// Pieces across a gap between two points, each given by its angle and its arm.
fn bridge(
    from: (f64, Vector2<f64>),
    to: (f64, Vector2<f64>),
) -> impl Iterator<Item = [Vector2<f64>; 2]> {
    let (turn, radii) = (to.0 - from.0, [from.1.norm(), to.1.norm()]);
    let pieces = (turn / PIECE).ceil();
    let at = move |piece: f64| {
        let share = piece / pieces;
        let (angle, radius) = (from.0 + share * turn, radii[0] + share * (radii[1] - radii[0]));
        Vector2::new(radius * angle.cos(), radius * angle.sin())
    };
    (0..pieces as usize).map(move |piece| [at(piece as f64), at((piece + 1) as f64)])
}
