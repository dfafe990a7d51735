//! The outline of a section without detail finer than the shape of a leg: radius over angle, in
//! which coarse harmonics keep more of their size than fine ones.
//!
//! Curvature grows with the square of the harmonic, and so does its noise: scanner scatter of 0.3
//! mm would produce more peaks than the leg has. The paper's curve of order 15 also drops the fine
//! harmonics, but abruptly, which makes the outline oscillate beside every corner.

use std::f64::consts::TAU;

/// The harmonic that keeps half of its size: the paper's curve of order 15 has 16 coefficients, a
/// mean and as many pairs as 7.5 harmonics.
const HALVED_HARMONIC: f64 = 7.5;

/// A harmonic keeps 1 / (1 + (n / 7.5)⁶): four waves around keep 98 %. A higher power would add an
/// oscillation to a flat side between two corners.
const POWER: i32 = 6;

/// The finest harmonic that is kept at all; it keeps 0.1 %.
pub const FINEST: usize = 24;

/// The share of its size that a harmonic keeps, 0 to 1.
pub fn kept(harmonic: usize) -> f64 {
    1.0 / (1.0 + (harmonic as f64 / HALVED_HARMONIC).powi(POWER))
}

/// Sine and cosine of each harmonic.
const WAVES: usize = 2 * FINEST;

/// Number of sums computed side by side.
const LANES: usize = 4;

/// The harmonics at equal angles all around, reusable for any number of outlines.
pub struct Harmonics {
    /// For each angle the cosines of all harmonics, then their sines; 0 for harmonics that are too
    /// fine for the number of angles.
    waves: Vec<[f64; WAVES]>,
}

impl Harmonics {
    /// The harmonics at `count` angles.
    pub fn at(count: usize) -> Harmonics {
        let turn: Vec<(f64, f64)> =
            (0..count).map(|step| (TAU * step as f64 / count as f64).sin_cos()).collect();
        let waves = |index: usize| {
            let mut waves = [0.0; WAVES];
            for harmonic in 1..=FINEST.min(count / 2) {
                let (sin, cos) = turn[harmonic * index % count];
                (waves[harmonic - 1], waves[FINEST + harmonic - 1]) = (cos, sin);
            }
            waves
        };
        Harmonics { waves: (0..count).map(waves).collect() }
    }

    /// Smooths one value per angle: each harmonic keeps its share.
    pub fn smoothed(&self, values: &[f64]) -> Vec<f64> {
        let count = values.len() as f64;
        let mut sizes = [0.0; WAVES];
        for (value, waves) in values.iter().zip(&self.waves) {
            sizes.iter_mut().zip(waves).for_each(|(size, wave)| *size += value * wave);
        }
        for (index, size) in sizes.iter_mut().enumerate() {
            *size *= 2.0 * kept(index % FINEST + 1) / count;
        }
        let mean = values.iter().sum::<f64>() / count;
        let smooth = |waves: &[f64; WAVES]| {
            let mut sums = [0.0; LANES];
            for (sizes, waves) in sizes.chunks_exact(LANES).zip(waves.chunks_exact(LANES)) {
                let parts = sums.iter_mut().zip(sizes).zip(waves);
                parts.for_each(|((sum, size), wave)| *sum += size * wave);
            }
            mean + sums.iter().sum::<f64>()
        };
        self.waves.iter().map(smooth).collect()
    }

    /// The direction of each angle, as cosine and sine.
    pub fn directions(&self) -> impl Iterator<Item = (f64, f64)> {
        self.waves.iter().map(|waves| (waves[0], waves[FINEST]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_harmonic_keeps_its_share_and_its_place() {
        let at = |index: usize| TAU * index as f64 / 360.0;
        let harmonics = Harmonics::at(360);
        for harmonic in [1, 2, 4, 7, 15, 24, 30] {
            let wave = |index: usize| (harmonic as f64 * (at(index) - 0.4)).cos();
            let values: Vec<f64> = (0..360).map(|index| 50.0 + wave(index)).collect();
            let share = if harmonic <= FINEST { kept(harmonic) } else { 0.0 };
            for (index, value) in harmonics.smoothed(&values).iter().enumerate() {
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
