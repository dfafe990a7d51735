//! The long axis of a foot.

use nalgebra::{Rotation2, Vector2};

use crate::statistics::range;

/// The long axis of points seen from above, and their extents.
pub struct LongAxis {
    /// Unit vector along it, of arbitrary sign.
    pub direction: Vector2<f64>,
    /// Extent along it, in the unit of the points.
    pub length: f64,
    /// Extent across it.
    pub width: f64,
}

/// The first principal axis of points seen from above.
pub fn long_axis(of: &[[f64; 3]]) -> LongAxis {
    let points: Vec<Vector2<f64>> = of.iter().map(|p| Vector2::new(p[0], p[1])).collect();
    let middle = points.iter().sum::<Vector2<f64>>() / points.len().max(1) as f64;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for d in points.iter().map(|p| p - middle) {
        (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
    }
    let direction = Rotation2::new((2.0 * xy).atan2(xx - yy) / 2.0) * Vector2::x();
    let [length, width] = [direction, Vector2::new(-direction.y, direction.x)].map(|axis| {
        let [low, high] = range(points.iter().map(|p| p.dot(&axis)));
        high - low
    });
    LongAxis { direction, length, width }
}
