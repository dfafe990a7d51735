//! The cubic functions among knots at equal distances, in closed form.

/// The values of the four functions at a share of an interval among knots at distances of 1 (The NURBS
/// Book, 2.2; de Boor, A Practical Guide to Splines, chapter IX).
#[inline]
pub(super) fn values(t: f64) -> [f64; 4] {
    let (u, square, cube) = (1.0 - t, t * t, t * t * t);
    let sixth = 1.0 / 6.0;
    [
        sixth * (u * u * u),
        sixth * (3.0 * cube - 6.0 * square + 4.0),
        sixth * (3.0 * (square - cube) + 3.0 * t + 1.0),
        sixth * cube,
    ]
}

/// Their slopes.
#[inline]
pub(super) fn slopes(t: f64) -> [f64; 4] {
    let (u, square) = (1.0 - t, t * t);
    [-0.5 * (u * u), 1.5 * square - 2.0 * t, 0.5 + t - 1.5 * square, 0.5 * square]
}

/// Their second derivatives.
#[inline]
pub(super) fn bends(t: f64) -> [f64; 4] {
    [1.0 - t, 3.0 * t - 2.0, 1.0 - 3.0 * t, t]
}
