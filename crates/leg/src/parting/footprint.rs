//! The position of a leg at one height: the smallest polygon around its points with 16 fixed edge
//! directions (a discrete oriented polytope). It exceeds the convex hull by at most 2 % of the
//! radius and is evaluated for every point of the next slice, so it must be fast.

use std::f64::consts::FRAC_1_SQRT_2 as C45;

use nalgebra::{Point2, Vector2};

/// Cosine of 22.5°.
const C22: f64 = 0.923_879_532_511_286_7;

/// Sine of 22.5°.
const S22: f64 = 0.382_683_432_365_089_8;

/// Directions of the first half of the polygon's edges, unit vectors at equal angles; the others are
/// opposite to them.
const DIRECTIONS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [C22, S22],
    [C45, C45],
    [S22, C22],
    [0.0, 1.0],
    [-S22, C22],
    [-C45, C45],
    [-C22, S22],
];

/// A leg's extent at one height.
#[derive(Debug, Clone, PartialEq)]
pub struct Footprint {
    /// Mean of the points, mm.
    pub middle: Point2<f64>,
    /// Maximum extent of the points in each direction, mm.
    ahead: [f64; DIRECTIONS.len()],
    /// … and in the opposite ones.
    back: [f64; DIRECTIONS.len()],
}

impl Footprint {
    /// The footprint of points; `None` if there are fewer than three.
    pub fn from_points(points: &[Point2<f64>]) -> Option<Footprint> {
        const POINTS_MIN: usize = 3;
        if points.len() < POINTS_MIN {
            return None;
        }
        let mut ahead = [f64::NEG_INFINITY; DIRECTIONS.len()];
        let mut back = ahead;
        for point in points {
            for (index, [x, y]) in DIRECTIONS.into_iter().enumerate() {
                let along = x * point.x + y * point.y;
                ahead[index] = larger(ahead[index], along);
                back[index] = larger(back[index], -along);
            }
        }
        let sum: Vector2<f64> = points.iter().map(|point| point.coords).sum();
        Some(Footprint { middle: (sum / points.len() as f64).into(), ahead, back })
    }

    /// This footprint, but nowhere further than `narrowing_mm` inside the one before it.
    pub fn after(&self, before: &Footprint, narrowing_mm: f64) -> Footprint {
        let wider = |own: &[f64; 8], before: &[f64; 8]| {
            std::array::from_fn(|i| larger(own[i], before[i] - narrowing_mm))
        };
        let (ahead, back) = (wider(&self.ahead, &before.ahead), wider(&self.back, &before.back));
        Footprint { middle: self.middle, ahead, back }
    }

    /// Its largest extent, mm.
    pub fn size_mm(&self) -> f64 {
        self.ahead.iter().zip(&self.back).map(|(ahead, back)| ahead + back).fold(0.0, larger)
    }

    /// Distance of a point beyond the polygon, mm; negative inside.
    pub fn beyond_mm(&self, point: &Point2<f64>) -> f64 {
        let mut beyond = [f64::NEG_INFINITY; DIRECTIONS.len()];
        for (index, [x, y]) in DIRECTIONS.into_iter().enumerate() {
            let along = x * point.x + y * point.y;
            beyond[index] = larger(along - self.ahead[index], -along - self.back[index]);
        }
        beyond.into_iter().fold(f64::NEG_INFINITY, larger)
    }

    /// The share of points that lie at most `margin_mm` beyond the polygon.
    pub fn share_of(&self, points: &[Point2<f64>], margin_mm: f64) -> f64 {
        let held = points.iter().filter(|point| self.beyond_mm(point) <= margin_mm).count();
        held as f64 / points.len().max(1) as f64
    }
}

/// The larger of two numbers that are not NaN: `f64::max`, which checks both for NaN, takes three
/// times as long.
fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_holds_what_is_inside_and_a_margin_around_it() {
        let ring: Vec<_> = (0..90)
            .map(|i| f64::from(4 * i).to_radians())
            .map(|t| Point2::new(100.0 + 50.0 * t.cos(), 50.0 * t.sin()))
            .collect();
        let footprint = Footprint::from_points(&ring).unwrap();
        let holds = |x, y| footprint.beyond_mm(&Point2::new(x, y)) <= 10.0;
        assert!(holds(100.0, 0.0));
        assert!(holds(159.9, 0.0));
        assert!(!holds(162.0, 0.0));
        assert!(!holds(100.0, -62.0));
        assert_eq!(footprint.share_of(&ring, 0.0), 1.0);
        assert_eq!(footprint.share_of(&[Point2::new(0.0, 0.0), ring[0]], 10.0), 0.5);
    }

    #[test]
    fn half_a_ring_still_holds_the_other_half_for_a_while() {
        let ring = |from: i32, to: i32| -> Vec<Point2<f64>> {
            let turns = (from..to).map(|i| f64::from(4 * i).to_radians());
            turns.map(|t| Point2::new(50.0 * t.cos(), 50.0 * t.sin())).collect()
        };
        let whole = Footprint::from_points(&ring(0, 90)).unwrap();
        let half = Footprint::from_points(&ring(0, 45)).unwrap();
        let unseen = Point2::new(0.0, -39.0);
        assert!(half.beyond_mm(&unseen) > 30.0);
        assert!(half.after(&whole, 10.0).beyond_mm(&unseen) < 0.0);
    }

    #[test]
    fn the_edges_have_equal_angles() {
        for (index, [x, y]) in DIRECTIONS.iter().enumerate() {
            let (sin, cos) = (22.5 * index as f64).to_radians().sin_cos();
            assert!((cos - x).abs() < 1e-15 && (sin - y).abs() < 1e-15, "{index}");
        }
    }

    #[test]
    fn two_points_make_no_footprint() {
        assert_eq!(Footprint::from_points(&[Point2::origin(); 2]), None);
    }
}
