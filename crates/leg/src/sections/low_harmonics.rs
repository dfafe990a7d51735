//! Restores what a fit of the whole skin smooths away along the leg: its mean radius and its
//! slowest waves around, each with its own smoothing.
//!
//! The smoothing of the skin suits single points, where all of the noise remains. The mean and the
//! slow waves are averages over all points around, in which the noise cancels, and need far less
//! smoothing along the leg. The girth depends on them: a wave of number n and amplitude a adds n² π
//! a² / 2r to it, so an ankle whose oval is smoothed by a tenth is 2 mm too small. They are fitted
//! one after the other to the residuals of the skin (backfitting; Hastie and Tibshirani,
//! Generalized Additive Models, 1990).

use std::f64::consts::TAU;

use nalgebra::Complex;

use gaiter_spline::{Basis, Smoothing, Spline, fit};

/// Highest wave number around: a ridge of 20°, such as the Achilles tendon's, is a half of its period.
/// With 8 waves, as fine as the paper's curve of order 15, girths over sharp tendons were 0.5 mm smaller
/// (docs/accuracy.md). The skin's 48 pieces around hold 24 waves at most.
const WAVES: usize = 16;

/// Waves finer than the paper's curve of order 15, which has 8, are noise on most of a leg. They are kept
/// where they stand out of it.
const COARSE_WAVES: usize = 8;

/// Noise alone has less than this many times its mean energy over [`REACH_MM`] in 9 of 10 places (χ² with
/// three to four degrees of freedom).
const NOISE_ENERGY: f64 = 2.0;

/// Whether a fine wave stands out is judged over this distance along the leg to each side, mm: the length of
/// a tendon's ridge.
const REACH_MM: f64 = 30.0;

/// Points are averaged over bins of a length that is this fraction of a piece of the basis along;
/// within a bin the slow waves hardly change.
const BINS_PER_PIECE: usize = 4;

/// The mean is fitted in this many times as many pieces: it is the average over the most points, and a fold
/// of swollen skin is 15 mm long. More would leave less than two bins a piece, from which cross-validation
/// cannot choose.
const MEAN_PIECES_PER_PIECE: usize = 2;

/// The slow part of the skin, which is added to its fit.
#[derive(Debug, Clone)]
pub struct Waves {
    waves: Vec<Wave>,
}

/// One wave around; its height is a function of the distance along.
#[derive(Debug, Clone)]
struct Wave {
    /// Wave number around; 0 is the mean.
    count: usize,
    height: Spline,
    /// Its contribution to the coefficients of a curve around where its height is 1.
    shares: Vec<f64>,
}

/// The residuals of the skin's fit; all slices have the same length.
#[derive(Debug, Clone, Copy)]
pub struct Left<'a> {
    /// Distances along, within the basis.
    pub along: &'a [f64],
    /// Angles, radians.
    pub angle: &'a [f64],
    /// Residuals of the radius.
    pub value: &'a [f64],
    /// Weights, not negative.
    pub weight: &'a [f64],
    /// Standard deviation of a residual of weight 1.
    pub sigma: f64,
}

/// The contribution of a wave of height 1 to the coefficients of a curve around in uniform pieces.
fn shares(count: usize, is_sine: bool, around: &Basis) -> Vec<f64> {
    // A cubic spline whose coefficients are a wave is that wave at the knots, reduced by this
    // factor (de Boor, A Practical Guide to Splines, 2001).
    let turn = TAU * count as f64 / around.count() as f64;
    let lowered = (2.0 + turn.cos()) / 3.0;
    let shape = |angle: f64| {
        let phase = count as f64 * angle;
        if is_sine { phase.sin() } else { phase.cos() }
    };
    around.greville().into_iter().map(|centre| shape(centre) / lowered).collect()
}

/// Bins of equal length along the leg over which points are averaged.
struct Bins {
    from: f64,
    length: f64,
    count: usize,
}

impl Bins {
    fn over(along: &Basis) -> Bins {
        let (from, to) = along.domain();
        let count = BINS_PER_PIECE * (along.breakpoints().len() - 1);
        Bins { from, length: (to - from) / count as f64, count }
    }

    fn place(&self, along: f64) -> usize {
        (((along - self.from) / self.length).max(0.0) as usize).min(self.count - 1)
    }

    /// A fine wave where it stands out of the noise: less of it is kept the nearer its energy is to that of
    /// noise, as by the positive-part estimator of James and Stein (1961).
    fn above_noise(&self, mut height: Spline, weights: &[f64], sigma: f64) -> Spline {
        let middles = self.middles();
        let energy = |(at, weight): (&f64, &f64)| weight * height.value(*at).powi(2);
        let energies: Vec<f64> = middles.iter().zip(weights).map(energy).collect();
        let noise = NOISE_ENERGY * sigma * sigma * height.edf / self.count as f64;
        let kept = |at: f64| {
            let from = middles.partition_point(|middle| *middle < at - REACH_MM);
            let near = middles[from..].iter().take_while(|middle| **middle <= at + REACH_MM);
            let near = &energies[from..from + near.count()];
            let energy: f64 = near.iter().sum();
            if energy > 0.0 { (1.0 - noise * near.len() as f64 / energy).max(0.0) } else { 0.0 }
        };
        let kept: Vec<f64> = height.basis.greville().into_iter().map(kept).collect();
        height.coefficients.iter_mut().zip(kept).for_each(|(height, kept)| *height *= kept);
        height
    }

    fn middles(&self) -> Vec<f64> {
        (0..self.count).map(|index| self.from + (index as f64 + 0.5) * self.length).collect()
    }
}

/// The basis of the mean.
fn finer(along: &Basis) -> Option<Basis> {
    let (from, to) = along.domain();
    let pieces = MEAN_PIECES_PER_PIECE * (along.breakpoints().len() - 1);
    Basis::uniform_clamped(from, to, pieces).ok()
}

impl Waves {
    /// Fits the waves for curves around in uniform pieces, and returns them with the remaining
    /// residuals; `None` if the data do not determine them.
    // A function of its own in every build: tests/instructions counts it as a stage.
    #[inline(never)]
    pub fn fit(left: &Left, along: &Basis, around: &Basis) -> Option<(Waves, Vec<f64>)> {
        let bins = Bins::over(along);
        let fine = finer(along)?;
        let places: Vec<usize> = left.along.iter().map(|along| bins.place(*along)).collect();
        let mut rest = left.value.to_vec();
        let mut waves = Vec::new();
        // At each point, wave n follows from wave n − 1 by a complex multiplication.
        let turns: Vec<Complex<f64>> =
            left.angle.iter().map(|angle| Complex::from_polar(1.0, *angle)).collect();
        let mut shapes = vec![Complex::new(1.0, 0.0); turns.len()];
        let parts = (0..=WAVES).flat_map(|count| [(count, false), (count, true)]);
        for (count, is_sine) in parts.filter(|part| *part != (0, true)) {
            if count > 0 && !is_sine {
                shapes.iter_mut().zip(&turns).for_each(|(shape, turn)| *shape *= turn);
            }
            let shapes = shapes.iter().map(|at| if is_sine { at.im } else { at.re });
            // Least squares for the height alone: Σ w s r / Σ w s² in each bin.
            let (mut moments, mut weights) = (vec![0.0; bins.count], vec![0.0; bins.count]);
            for (((place, weight), rest), shape) in
                places.iter().zip(left.weight).zip(&rest).zip(shapes.clone())
            {
                moments[*place] += weight * shape * rest;
                weights[*place] += weight * shape * shape;
            }
            let sums = moments.iter().zip(&weights);
            let heights: Vec<f64> =
                sums.map(|(sum, weight)| if *weight > 0.0 { sum / weight } else { 0.0 }).collect();
            let along = if count == 0 { &fine } else { along };
            let height = fit(along, &bins.middles(), &heights, &weights, Smoothing::Gcv).ok()?;
            let is_fine = count > COARSE_WAVES;
            let height =
                if is_fine { bins.above_noise(height, &weights, left.sigma) } else { height };
            let at_bins: Vec<f64> =
                bins.middles().into_iter().map(|along| height.value(along)).collect();
            for ((rest, shape), place) in rest.iter_mut().zip(shapes).zip(&places) {
                *rest -= shape * at_bins[*place];
            }
            waves.push(Wave { count, height, shares: shares(count, is_sine, around) });
        }
        Some((Waves { waves }, rest))
    }

    /// The contribution of the waves to the coefficients of a curve around.
    pub fn coefficients(&self, along: f64) -> Vec<f64> {
        let mut added = vec![0.0; self.waves.first().map_or(0, |wave| wave.shares.len())];
        for wave in &self.waves {
            let height = wave.height.value(along);
            added.iter_mut().zip(&wave.shares).for_each(|(sum, share)| *sum += height * share);
        }
        added
    }

    /// Standard error of the height of the least certain wave.
    pub fn sd(&self, along: f64) -> f64 {
        let waves = self.waves.iter().filter(|wave| wave.count > 0);
        waves.map(|wave| wave.height.sd(along, 0)).fold(0.0, f64::max)
    }

    /// Standard error of the mean radius, or of one of its derivatives along.
    pub fn mean_sd(&self, along: f64, derivative: usize) -> f64 {
        let mean = self.waves.iter().find(|wave| wave.count == 0);
        mean.map_or(0.0, |mean| mean.height.sd(along, derivative))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// A mean, an oval and a tendon that vary along the leg.
    fn skin(along: f64, angle: f64) -> f64 {
        let swell = (along / 50.0).sin();
        0.3 * swell + 0.8 * swell * (2.0 * angle).cos() - 0.2 * (7.0 * angle).sin()
    }

    /// Points all around, rotated from ring to ring, so that no wave is sampled at the same phases
    /// everywhere.
    fn places(is_seen: impl Fn(f64, f64) -> bool) -> (Vec<f64>, Vec<f64>) {
        let grid = (0..400).flat_map(|i| (0..60).map(move |j| (f64::from(i), f64::from(j))));
        let at = |(i, j): (f64, f64)| (i, TAU * (j + 0.37 * i) / 60.0 - PI);
        grid.map(at).filter(|(along, angle)| is_seen(*along, *angle)).unzip()
    }

    fn around() -> Basis {
        Basis::uniform_periodic(-PI, TAU, 48).unwrap()
    }

    fn fitted(is_seen: impl Fn(f64, f64) -> bool) -> (Waves, Vec<f64>) {
        let (along, angle) = places(is_seen);
        let value: Vec<f64> = along.iter().zip(&angle).map(|(u, v)| skin(*u, *v)).collect();
        let weight = vec![1.0; value.len()];
        let sigma = 0.0;
        let left = Left { along: &along, angle: &angle, value: &value, weight: &weight, sigma };
        Waves::fit(&left, &Basis::uniform_clamped(0.0, 399.0, 33).unwrap(), &around()).unwrap()
    }

    #[test]
    fn slow_waves_that_come_and_go_along_the_leg_are_found_whole() {
        let (_, rest) = fitted(|_, _| true);
        let worst = rest.iter().fold(0.0, |worst: f64, rest| worst.max(rest.abs()));
        // Points are averaged over 3 mm, in which the oval changes by 0.03 mm to either side.
        assert!(worst < 0.05, "{worst}");
    }

    #[test]
    fn what_they_add_to_a_curve_is_their_sum_at_every_angle() {
        let (waves, _) = fitted(|_, _| true);
        for along in [20.0, 133.0, 390.0] {
            let coefficients = waves.coefficients(along);
            for angle in (0..90).map(|i| TAU * f64::from(i) / 90.0 - PI) {
                let added = around().row(angle).dot(&coefficients);
                assert!((added - skin(along, angle)).abs() < 0.03, "{along} {angle}: {added}");
            }
        }
    }

    #[test]
    fn a_hole_in_the_skin_invents_no_wave() {
        let is_seen =
            |along: f64, angle: f64| !(150.0..190.0).contains(&along) || angle.abs() > 0.6;
        let (waves, rest) = fitted(is_seen);
        assert!(rest.iter().all(|rest| rest.abs() < 0.25));
        let added = around().row(0.0).dot(&waves.coefficients(170.0));
        assert!((added - skin(170.0, 0.0)).abs() < 0.3, "{added}");
    }
}
