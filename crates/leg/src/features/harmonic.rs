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

/// Number of sums computed side by side.
const LANES: usize = 4;

/// The harmonics at equal angles all around, reusable for any number of outlines.
///
/// Cosines are the same at an angle and at its opposite, sines differ in sign: half of the angles and half
/// of the products suffice.
pub struct Harmonics {
    count: usize,
    /// For each angle up to half a turn the cosines and the sines of all harmonics; 0 for harmonics that
    /// are too fine for the number of angles.
    waves: Vec<[[f64; FINEST]; 2]>,
}

impl Harmonics {
    /// The harmonics at `count` angles.
    pub fn at(count: usize) -> Harmonics {
        let turn: Vec<(f64, f64)> =
            (0..count).map(|step| (TAU * step as f64 / count as f64).sin_cos()).collect();
        let waves = |index: usize| {
            let [mut cosines, mut sines] = [[0.0; FINEST]; 2];
            for harmonic in 1..=FINEST.min(count / 2) {
                (sines[harmonic - 1], cosines[harmonic - 1]) = turn[harmonic * index % count];
            }
            [cosines, sines]
        };
        Harmonics { count, waves: (0..=count / 2).map(waves).collect() }
    }

    /// The opposite of an angle up to half a turn; `None` of an angle that is its own.
    fn opposite(&self, index: usize) -> Option<usize> {
        Some(self.count - index).filter(|other| index > 0 && *other != index)
    }

    /// Smooths one value per angle: each harmonic keeps its share.
    pub fn smoothed(&self, values: &[f64]) -> Vec<f64> {
        let [mut even, mut odd] = [[0.0; FINEST]; 2];
        for (index, [cosines, sines]) in self.waves.iter().enumerate() {
            let own = values[index];
            let (sum, difference) = match self.opposite(index) {
                Some(other) => (own + values[other], own - values[other]),
                None => (own, 0.0),
            };
            even.iter_mut().zip(cosines).for_each(|(size, wave)| *size += sum * wave);
            odd.iter_mut().zip(sines).for_each(|(size, wave)| *size += difference * wave);
        }
        for (index, (even, odd)) in even.iter_mut().zip(&mut odd).enumerate() {
            let share = 2.0 * kept(index + 1) / self.count as f64;
            (*even, *odd) = (*even * share, *odd * share);
        }
        let mean = values.iter().sum::<f64>() / self.count as f64;
        let mut smooth = vec![0.0; self.count];
        for (index, [cosines, sines]) in self.waves.iter().enumerate() {
            let (same, opposed) = (mean + product(&even, cosines), product(&odd, sines));
            smooth[index] = same + opposed;
            if let Some(other) = self.opposite(index) {
                smooth[other] = same - opposed;
            }
        }
        smooth
    }

    /// The direction of each angle, as cosine and sine.
    pub fn directions(&self) -> impl Iterator<Item = (f64, f64)> {
        (0..self.count).map(|index| {
            let is_beyond = index >= self.waves.len();
            let [cosines, sines] = &self.waves[if is_beyond { self.count - index } else { index }];
            (cosines[0], if is_beyond { -sines[0] } else { sines[0] })
        })
    }
}

/// The sum of products, in several sums side by side.
fn product(sizes: &[f64; FINEST], waves: &[f64; FINEST]) -> f64 {
    let mut sums = [0.0; LANES];
    for (sizes, waves) in sizes.chunks_exact(LANES).zip(waves.chunks_exact(LANES)) {
        let parts = sums.iter_mut().zip(sizes).zip(waves);
        parts.for_each(|((sum, size), wave)| *sum += size * wave);
    }
    sums.iter().sum()
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
