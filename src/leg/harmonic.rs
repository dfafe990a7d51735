//! The outline of a section without what is finer than the shape of a leg: radius over angle, in
//! which each harmonic keeps the more the coarser it is.
//!
//! Curvature grows with the square of the harmonic, and noise with it: what the scanner scatters
//! by 0.3 mm would make more peaks than the leg has. The paper's curve of order 15 leaves the fine
//! harmonics out as well, all at once; that lets the outline swing beside every corner.

use std::f64::consts::TAU;

/// The harmonic that keeps half of its size: the paper's curve of order 15 has 16 coefficients, a
/// mean and as many pairs as 7.5 harmonics.
const HALVED_HARMONIC: f64 = 7.5;

/// A harmonic keeps 1 / (1 + (n / 7.5)⁶): four waves around keep 98 %. With a higher power a flat
/// side between two corners would be given a swing of its own.
const POWER: i32 = 6;

/// The finest harmonic that is kept at all; it keeps 0.1 %.
pub const FINEST: usize = 24;

/// The share of its size that a harmonic keeps, 0 to 1.
pub fn kept(harmonic: usize) -> f64 {
    1.0 / (1.0 + (harmonic as f64 / HALVED_HARMONIC).powi(POWER))
}

/// The values, at equal angles all around, with each of their harmonics kept by its share.
pub fn smoothed(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    let turn: Vec<(f64, f64)> =
        (0..count).map(|step| (TAU * step as f64 / count as f64).sin_cos()).collect();
    let mut smooth = vec![values.iter().sum::<f64>() / count as f64; count];
    for harmonic in 1..=FINEST.min(count / 2) {
        let place = |index: usize| turn[harmonic * index % count];
        let (mut sine, mut cosine) = (0.0, 0.0);
        for (index, value) in values.iter().enumerate() {
            let (sin, cos) = place(index);
            sine += value * sin;
            cosine += value * cos;
        }
        let share = 2.0 * kept(harmonic) / count as f64;
        for (index, value) in smooth.iter_mut().enumerate() {
            let (sin, cos) = place(index);
            *value += share * (sine * sin + cosine * cos);
        }
    }
    smooth
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_harmonic_keeps_its_share_and_its_place() {
        let at = |index: usize| TAU * index as f64 / 360.0;
        for harmonic in [1, 2, 4, 7, 15, 24, 30] {
            let wave = |index: usize| (harmonic as f64 * (at(index) - 0.4)).cos();
            let values: Vec<f64> = (0..360).map(|index| 50.0 + wave(index)).collect();
            let share = if harmonic <= FINEST { kept(harmonic) } else { 0.0 };
            for (index, value) in smoothed(&values).iter().enumerate() {
                assert!((value - 50.0 - share * wave(index)).abs() < 1e-12, "{harmonic}, {index}");
            }
        }
    }

    #[test]
    fn coarse_harmonics_are_kept_and_fine_ones_fade() {
        assert!(kept(0) == 1.0 && kept(2) > 0.999 && kept(4) > 0.97);
        assert!((0.5..0.65).contains(&kept(7)) && (0.4..0.5).contains(&kept(8)));
        assert!(kept(FINEST) < 0.001);
    }
}
