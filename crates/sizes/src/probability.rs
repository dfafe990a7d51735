//! The probability that a length lies between two limits.

use std::f64::consts::SQRT_2;

/// The probability that a length with this value and standard uncertainty lies from `low_mm` to `high_mm`:
/// Φ((b − x)/u) − Φ((a − x)/u). All in mm; the uncertainty is positive.
///
/// With a normal distribution no single value has a probability of its own, so open and closed limits give
/// the same.
pub fn within(value_mm: f64, uncertainty_mm: f64, [low_mm, high_mm]: [f64; 2]) -> f64 {
    let [low, high] = [low_mm, high_mm].map(|limit| (limit - value_mm) / uncertainty_mm);
    // In the upper tail both shares are close to 1 and their difference loses its digits; mirrored it does not.
    match low > 0.0 {
        true => share_below(-low) - share_below(-high),
        false => share_below(high) - share_below(low),
    }
}

/// Φ: the share of a normal distribution below this many standard deviations.
fn share_below(deviations: f64) -> f64 {
    0.5 * libm::erfc(-deviations / SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shares_are_those_of_the_printed_tables() {
        // Abramowitz and Stegun, Handbook of Mathematical Functions (1964), table 26.1.
        for (deviations, share) in [
            (0.0, 0.5),
            (0.5, 0.691_462_461_274_013),
            (1.0, 0.841_344_746_068_543),
            (1.96, 0.975_002_104_851_780),
            (2.0, 0.977_249_868_051_821),
            (3.0, 0.998_650_101_968_370),
        ] {
            assert!((share_below(deviations) - share).abs() < 1e-14, "{deviations}");
            assert!((share_below(-deviations) - (1.0 - share)).abs() < 1e-14, "-{deviations}");
        }
    }

    #[test]
    fn at_a_limit_far_from_the_other_it_is_one_half() {
        assert!((within(200.0, 1.0, [200.0, 300.0]) - 0.5).abs() < 1e-15);
        assert!((within(300.0, 1.0, [200.0, 300.0]) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn far_tails_keep_their_digits_on_both_sides() {
        let below = within(190.0, 1.0, [200.0, 300.0]);
        let above = within(310.0, 1.0, [200.0, 300.0]);
        // Φ(−10).
        assert!((below / 7.619_853_024_160_527e-24 - 1.0).abs() < 1e-12, "{below}");
        assert!((above / below - 1.0).abs() < 1e-12);
    }
}
