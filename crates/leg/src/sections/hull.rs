//! Convex hulls in the plane: the shape that a tape measure follows.

use nalgebra::{Point2, Rotation2, Vector2};

/// A convex polygon, counter-clockwise, without repeated or collinear corners.
#[derive(Debug, Clone, PartialEq)]
pub struct Hull {
    corners: Vec<Point2<f64>>,
}

impl Hull {
    /// The convex hull of points, by Andrew's monotone chain (1979). `None` if the points do not
    /// span an area.
    pub fn from_points(points: &[Point2<f64>]) -> Option<Hull> {
        let mut sorted = points.to_vec();
        sorted.sort_by(|p, q| p.x.total_cmp(&q.x).then_with(|| p.y.total_cmp(&q.y)));
        sorted.dedup();
        let mut corners = half_hull(sorted.iter());
        let upper = half_hull(sorted.iter().rev());
        corners.pop();
        corners.extend_from_slice(&upper[..upper.len().saturating_sub(1)]);
        (corners.len() >= 3).then_some(Hull { corners })
    }

    /// The hull of points that lie in order around a point inside of it, after Graham (1972), in a
    /// single pass. `None` if they do not span an area.
    pub fn of_ring(points: &[Point2<f64>]) -> Option<Hull> {
        let mut first = 0;
        for (index, point) in points.iter().enumerate() {
            let least = points[first];
            if point.x < least.x || (point.x == least.x && point.y < least.y) {
                first = index;
            }
        }
        // Once around, from a corner of the hull to the same corner.
        let mut corners = Vec::with_capacity(points.len() + 1);
        points[first..].iter().for_each(|point| extend(&mut corners, *point));
        points.iter().take(first + 1).for_each(|point| extend(&mut corners, *point));
        corners.pop();
        (corners.len() >= 3).then_some(Hull { corners })
    }

    /// Length of the outline, in the unit of the points.
    pub fn perimeter(&self) -> f64 {
        self.edges().map(|(from, to)| (to - from).norm()).sum()
    }

    /// Whether a point lies within.
    pub fn contains(&self, point: &Point2<f64>) -> bool {
        self.edges().all(|(from, to)| (to - from).perp(&(point - from)) >= 0.0)
    }

    /// Centroid of the enclosed area.
    pub fn centroid(&self) -> Point2<f64> {
        let first = self.corners[0];
        let mut moment = Vector2::zeros();
        let mut twice_area = 0.0;
        for (p, q) in self.edges() {
            let (p, q) = (p - first, q - first);
            let cross = p.perp(&q);
            moment += (p + q) * cross;
            twice_area += cross;
        }
        first + moment / (3.0 * twice_area)
    }

    /// The direction in which the enclosed area is longest, of arbitrary sign: the principal axis
    /// of its second moments.
    pub fn long_axis(&self) -> Vector2<f64> {
        let centre = self.centroid();
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for (p, q) in self.edges() {
            let (p, q) = (p - centre, q - centre);
            let cross = p.perp(&q);
            xx += (p.x * p.x + p.x * q.x + q.x * q.x) * cross / 12.0;
            yy += (p.y * p.y + p.y * q.y + q.y * q.y) * cross / 12.0;
            xy += (p.x * q.y + 2.0 * p.x * p.y + 2.0 * q.x * q.y + q.x * p.y) * cross / 24.0;
        }
        Rotation2::new((2.0 * xy).atan2(xx - yy) / 2.0) * Vector2::x()
    }

    fn edges(&self) -> impl Iterator<Item = (Point2<f64>, Point2<f64>)> + '_ {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().copied().zip(next.copied())
    }
}

/// One chain of the hull; both chains contain both end points.
fn half_hull<'a>(points: impl Iterator<Item = &'a Point2<f64>>) -> Vec<Point2<f64>> {
    let mut chain: Vec<Point2<f64>> = Vec::new();
    points.for_each(|point| extend(&mut chain, *point));
    chain
}

/// Adds a point to a chain that turns left only.
#[inline]
fn extend(chain: &mut Vec<Point2<f64>>, point: Point2<f64>) {
    while let [.., before, last] = chain.as_slice() {
        if (last - before).perp(&(point - last)) > 0.0 {
            break;
        }
        chain.pop();
    }
    chain.push(point);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Point2<f64>> {
        vec![
            Point2::new(0.0, 0.0),
            Point2::new(2.0, 0.0),
            Point2::new(1.0, 1.0),
            Point2::new(2.0, 2.0),
            Point2::new(0.0, 2.0),
            Point2::new(1.0, 0.0),
        ]
    }

    #[test]
    fn a_square_with_points_inside_and_on_its_edges_is_the_square() {
        let hull = Hull::from_points(&square()).unwrap();
        assert_eq!(hull.perimeter(), 8.0);
        assert_eq!(hull.centroid(), Point2::new(1.0, 1.0));
    }

    #[test]
    fn a_rectangle_is_longest_along_its_long_side_wherever_its_points_are() {
        let turn = Rotation2::new(0.7);
        let mut points: Vec<_> = [(0.0, 0.0), (5.0, 0.0), (5.0, 2.0), (0.0, 2.0)]
            .map(|(x, y)| turn * Point2::new(x, y))
            .to_vec();
        // Many points on one side would shift the axis of the points.
        points.extend((0..50).map(|i| turn * Point2::new(5.0, 0.04 * f64::from(i))));
        let axis = Hull::from_points(&points).unwrap().long_axis();
        assert!((axis.perp(&(turn * Vector2::x()))).abs() < 1e-12, "{axis}");
    }

    #[test]
    fn the_hull_of_a_ring_is_that_of_its_points() {
        for turn in [0.0, 0.3, 2.9] {
            let star = (0..720).map(|i| f64::from(i).to_radians() / 2.0 + turn);
            let ring: Vec<_> = star
                .map(|angle| {
                    let radius = 50.0 + 9.0 * (3.0 * angle).sin() + 2.0 * (17.0 * angle).cos();
                    Point2::new(radius * angle.cos(), radius * angle.sin())
                })
                .collect();
            let (found, expected) =
                (Hull::of_ring(&ring).unwrap(), Hull::from_points(&ring).unwrap());
            assert_eq!(found.corners.len(), expected.corners.len());
            assert!((found.perimeter() - expected.perimeter()).abs() < 1e-10);
            assert!((found.centroid() - expected.centroid()).norm() < 1e-10);
        }
        assert_eq!(Hull::of_ring(&[Point2::origin(); 5]), None);
        assert_eq!(Hull::of_ring(&[]), None);
    }

    #[test]
    fn points_on_a_line_have_no_hull() {
        let line: Vec<_> = (0..5).map(|i| Point2::new(f64::from(i), 1.0)).collect();
        assert_eq!(Hull::from_points(&line), None);
        assert_eq!(Hull::from_points(&[]), None);
    }
}
