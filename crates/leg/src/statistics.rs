//! Quantiles and ranges of values, and gaps between directions.

use std::f64::consts::TAU;

/// A section is not measured if its points have a gap wider than this, degrees, because bridging
/// more is a guess.
pub(crate) const GAP_MAX_DEG: f64 = 60.0;

/// The value below which this share of the values lies, of 0 to less than 1; `None` if there are none.
pub(crate) fn quantile(mut values: Vec<f64>, share: f64) -> Option<f64> {
    let index = (share * values.len() as f64) as usize;
    (index < values.len()).then(|| *values.select_nth_unstable_by(index, f64::total_cmp).1)
}

/// The middle value; `None` if there are none.
pub(crate) fn median(values: Vec<f64>) -> Option<f64> {
    quantile(values, 0.5)
}

/// The least and the largest value; infinities, the least above the largest, if there are none.
pub(crate) fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    values.fold(none, |[low, high], value| [low.min(value), high.max(value)])
}

/// Widest difference between neighbouring angles, given in radians, in degrees; 360 if there are none.
pub(crate) fn largest_gap_deg(angles: &[f64]) -> f64 {
    let mut seen = angles.to_vec();
    seen.sort_unstable_by(f64::total_cmp);
    let (Some(first), Some(last)) = (seen.first(), seen.last()) else {
        return 360.0;
    };
    let across_the_seam = first + TAU - last;
    let gaps = seen.windows(2).map(|pair| pair[1] - pair[0]);
    gaps.fold(across_the_seam, f64::max).to_degrees()
}
