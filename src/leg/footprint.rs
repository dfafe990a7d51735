//! Where a leg lies at one height: the smallest polygon around its points with 16 fixed directions
//! of edges (a discrete oriented polytope). It exceeds the convex hull by 2 % of the radius at
//! most and is asked for every point of the next slice, so it must be quick.

use nalgebra::{Point2, Vector2};

/// Edges of the polygon.
const DIRECTIONS: usize = 16;

/// A leg's extent at one height.
#[derive(Debug, Clone, PartialEq)]
pub struct Footprint {
    /// The height, mm.
    pub height_mm: f64,
    /// Mean of the points, mm.
    pub middle: Point2<f64>,
    /// Furthest reach of the points in each direction, mm.
    reach: [f64; DIRECTIONS],
}

/// Unit vectors at equal angles.
fn directions() -> [Vector2<f64>; DIRECTIONS] {
    std::array::from_fn(|index| {
        let (sin, cos) = (std::f64::consts::TAU * index as f64 / DIRECTIONS as f64).sin_cos();
        Vector2::new(cos, sin)
    })
}

impl Footprint {
    /// The footprint of points; none where there are fewer than three.
    pub fn of(points: &[Point2<f64>], height_mm: f64) -> Option<Footprint> {
        const POINTS_MIN: usize = 3;
        if points.len() < POINTS_MIN {
            return None;
        }
        let directions = directions();
        let mut reach = [f64::NEG_INFINITY; DIRECTIONS];
        for point in points {
            for (reach, direction) in reach.iter_mut().zip(&directions) {
                *reach = reach.max(direction.dot(&point.coords));
            }
        }
        let sum: Vector2<f64> = points.iter().map(|point| point.coords).sum();
        Some(Footprint { height_mm, middle: (sum / points.len() as f64).into(), reach })
    }

    /// A test whether points lie within the polygon or at most `margin_mm` beyond it.
    pub fn holds(&self, margin_mm: f64) -> impl Fn(&Point2<f64>) -> bool + '_ {
        let directions = directions();
        move |point| {
            let mut edges = self.reach.iter().zip(&directions);
            edges.all(|(reach, direction)| direction.dot(&point.coords) <= reach + margin_mm)
        }
    }
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
        let footprint = Footprint::of(&ring, 300.0).unwrap();
        let holds = footprint.holds(10.0);
        assert!(holds(&Point2::new(100.0, 0.0)));
        assert!(holds(&Point2::new(159.9, 0.0)));
        assert!(!holds(&Point2::new(162.0, 0.0)));
        assert!(!holds(&Point2::new(100.0, -62.0)));
    }

    #[test]
    fn two_points_make_no_footprint() {
        assert_eq!(Footprint::of(&[Point2::origin(); 2], 0.0), None);
    }
}
