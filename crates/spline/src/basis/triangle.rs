//! The Cox-de Boor triangle: functions of each degree from those of the degree below.

use super::DEGREE;

/// The degrees of the columns of the Cox-de Boor triangle, in order.
pub(super) const COLUMNS: [usize; DEGREE] = [1, 2, 3];

/// The data of the Cox-de Boor triangle of one interval.
pub(super) struct Triangle {
    /// The knots around the interval, which lies between the middle two.
    pub knots: [f64; 2 * DEGREE],
    /// See [`Basis`](super::Basis).
    pub reciprocals: [f64; 6],
}

/// The function of degree 0 on its interval.
pub(super) const ONE: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

/// The `TO + 1` functions of degree `TO` on the interval in the middle of a triangle's knots, or
/// their slopes, from the functions `lower` of the next lower degree: one column of the Cox-de Boor
/// triangle (The NURBS Book, equations 2.5 and 2.7).
#[inline]
pub(super) fn raised<const TO: usize>(
    triangle: &Triangle,
    lower: [f64; 4],
    step: Raise,
) -> [f64; 4] {
    let mut values = [0.0; 4];
    for r in 0..TO {
        // The interval itself lies between the two knots, so their distance is not 0.
        let per_distance = triangle.reciprocals[TO * (TO - 1) / 2 + r];
        let (falling, rising) = match step {
            Raise::Value(x) => {
                let falling = (triangle.knots[DEGREE + r] - x) * per_distance;
                (falling, 1.0 - falling)
            }
            Raise::Slope => {
                let rising = TO as f64 * per_distance;
                (-rising, rising)
            }
        };
        let fallen = falling * lower[r];
        values[r] = if r == 0 { fallen } else { values[r] + fallen };
        values[r + 1] = rising * lower[r];
    }
    values
}

/// How one column of the Cox-de Boor triangle is computed from the previous one.
#[derive(Clone, Copy)]
pub(super) enum Raise {
    /// The values at this abscissa.
    Value(f64),
    /// The derivative of the functions of the next lower degree.
    Slope,
}
