//! Gaps between the directions in which the skin was seen.

use std::f64::consts::TAU;

/// A section is not measured if its points have a gap wider than this, degrees, because bridging
/// more is a guess.
pub const GAP_MAX_DEG: f64 = 60.0;

/// Widest difference between neighbouring angles, given in radians, in degrees; 360 if there are none.
pub fn largest_gap_deg(angles: &[f64]) -> f64 {
    let mut seen = angles.to_vec();
    seen.sort_unstable_by(f64::total_cmp);
    let (Some(first), Some(last)) = (seen.first(), seen.last()) else {
        return 360.0;
    };
    let across_the_seam = first + TAU - last;
    let gaps = seen.windows(2).map(|pair| pair[1] - pair[0]);
    gaps.fold(across_the_seam, f64::max).to_degrees()
}
