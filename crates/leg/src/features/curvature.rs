//! Three-point curvature (paper 1.3, fig. 4a): of the parabola in the chord lengths through three
//! neighbouring points. Convex is positive.
//!
//! The paper's determinant is negative for a convex curve traversed counter-clockwise; here the
//! sign is inverted. On a circle the result is κ / cos²(φ/2), with φ the angle between neighbours:
//! 0.2 % too much at 5°.

use nalgebra::Point2;

/// Curvature at `middle`, per unit of length, positive where the curve before → middle → after
/// turns left. `None` if two of the points coincide.
pub fn three_point(before: &Point2<f64>, middle: &Point2<f64>, after: &Point2<f64>) -> Option<f64> {
    let (ta, tb) = ((middle - before).norm(), (after - middle).norm());
    if ta <= 0.0 || tb <= 0.0 {
        return None;
    }
    // x(t) = x2 + a2 t + a3 t² through x(−ta) = x1 and x(tb) = x3; the same for y.
    let (back, ahead) = ((before - middle) / -ta, (after - middle) / tb);
    let quadratic = (ahead - back) / (ta + tb);
    let linear = (back * tb + ahead * ta) / (ta + tb);
    let speed = linear.norm();
    (speed > 0.0).then(|| 2.0 * linear.perp(&quadratic) / speed.powi(3))
}

/// Curvature at each point of a closed curve traversed counter-clockwise; 0 where neighbours
/// coincide. The curve must be smooth between neighbours: noise of σ in points h apart adds √6 σ/h²
/// to the curvature.
pub fn around(points: &[Point2<f64>]) -> Vec<f64> {
    let count = points.len();
    let at = |index: usize| {
        let (before, after) = ((index + count - 1) % count, (index + 1) % count);
        three_point(&points[before], &points[index], &points[after]).unwrap_or(0.0)
    };
    (0..count).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_circle(radius: f64, degrees: f64) -> Point2<f64> {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Point2::new(radius * cos, radius * sin)
    }

    #[test]
    fn on_a_circle_it_is_the_curvature_over_the_squared_cosine_of_half_the_step() {
        for step in [1.0_f64, 5.0, 20.0] {
            let [a, b, c] = [-step, 0.0, step].map(|t| on_circle(50.0, 30.0 + t));
            let expected = 0.02 / (step / 2.0).to_radians().cos().powi(2);
            assert!((three_point(&a, &b, &c).unwrap() - expected).abs() < 1e-12);
            assert!((three_point(&c, &b, &a).unwrap() + expected).abs() < 1e-12);
        }
    }

    #[test]
    fn a_straight_line_has_none_and_coinciding_points_have_no_curvature() {
        let [a, b, c] = [0.0, 1.0, 5.0].map(|x| Point2::new(x, 2.0 * x));
        assert!(three_point(&a, &b, &c).unwrap().abs() < 1e-15);
        assert_eq!(three_point(&a, &a, &c), None);
    }

    #[test]
    fn around_an_ellipse_it_is_that_of_the_ellipse() {
        let (long, short) = (60.0, 40.0);
        let points: Vec<_> = (0..720)
            .map(|i| f64::from(i).to_radians() / 2.0)
            .map(|t| Point2::new(long * t.cos(), short * t.sin()))
            .collect();
        let curvatures = around(&points);
        let (tip, side) = (long / short.powi(2), short / long.powi(2));
        assert!((curvatures[0] / tip - 1.0).abs() < 1e-4, "{}", curvatures[0]);
        assert!((curvatures[180] / side - 1.0).abs() < 1e-4, "{}", curvatures[180]);
    }
}
