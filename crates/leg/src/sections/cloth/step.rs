//! A step or a furrow within a piece of a cubic, by least squares.

use nalgebra::{SMatrix, SVector};

use super::rows::{BELOW_MIN, Mean};

/// A pivot below this share of its diagonal is none: the shapes cannot be distinguished.
const PIVOT_MIN_SHARE: f64 = 1e-9;

/// Scales of the steps that are compared, mm.
const SCALES_MM: [f64; 9] = [0.6, 1.2, 1.8, 2.1, 2.5, 3.3, 4.2, 5.5, 7.5];

/// Places of the step that are compared, mm from where it was found.
const OFFSETS_MM: [f64; 9] = [-6.0, -4.5, -3.0, -1.5, 0.0, 1.5, 3.0, 4.5, 6.0];

/// A furrow or a bulge has the shape exp(−|x/scale|^power), with these scales in mm and powers, at these places. The
/// last is the bend of an outline.
const FURROWS: [(f64, i32); 13] = [
    (3.0, 2),
    (4.5, 2),
    (6.5, 2),
    (9.0, 2),
    (13.0, 2),
    (18.0, 2),
    (3.0, 6),
    (4.5, 6),
    (6.5, 6),
    (9.0, 6),
    (13.0, 6),
    (18.0, 6),
    (60.0, 1),
];
const FURROW_OFFSETS_MM: [f64; 13] =
    [-15.0, -12.5, -10.0, -7.5, -5.0, -2.5, 0.0, 2.5, 5.0, 7.5, 10.0, 12.5, 15.0];

/// Scales of a step that has a furrow beside it, mm.
const BOTH_SCALES_MM: [f64; 3] = [1.2, 2.5, 4.2];

/// A step up to this scale, mm, is not wide.
const NARROW_SCALE_MAX_MM: f64 = 4.2;

/// From this scale on, mm, a step is round; a sharp edge must fit better than any round one by this sum of squared
/// standard errors: 2.8 of them.
pub(super) const ROUND_SCALE_MIN_MM: f64 = 4.0;
pub(super) const BETTER_MIN: f64 = 8.0;

/// A step of some width within a cubic.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    pub(super) scale_mm: f64,
    /// Distance from the border, mm.
    pub(super) at_mm: f64,
    pub(super) height_mm: f64,
    /// Standard error of the height per scatter of the points.
    pub(super) sd: f64,
    /// Weighted sum of squares that remains, mm².
    pub(super) misfit: f64,
}

impl Step {
    /// The step of a width at a place; `None` if there are too few means on a side.
    pub(super) fn at(means: &[Mean], scale_mm: f64, at_mm: f64) -> Option<Step> {
        let below = means.iter().filter(|mean| mean.from_border_mm < at_mm).count();
        if below < BELOW_MIN - 1 || means.len() - below < BELOW_MIN - 1 {
            return None;
        }
        let shape = |x: f64| with_cubic(x, [logistic(x, scale_mm)]);
        let Solution::<5> { coefficients, variances, misfit } = solve(means, at_mm, shape)?;
        let (height_mm, sd) = (coefficients[4], variances[4].sqrt());
        Some(Step { scale_mm, at_mm, height_mm, sd, misfit })
    }

    /// The best step of each width.
    pub(super) fn all(means: &[Mean]) -> Vec<Step> {
        SCALES_MM.into_iter().filter_map(|scale_mm| Step::best(means, scale_mm)).collect()
    }

    /// The one that fits best; a wide one only if it fits much better, because the wider a step, the more it
    /// resembles the cubic.
    pub(super) fn clearest(steps: &[Step], count: usize, noise_mm: f64) -> Option<Step> {
        let least = |steps: &mut dyn Iterator<Item = &Step>| {
            steps.min_by(|a, b| a.misfit.total_cmp(&b.misfit)).copied()
        };
        let best = least(&mut steps.iter())?;
        let narrow = least(&mut steps.iter().filter(|step| step.scale_mm <= NARROW_SCALE_MAX_MM));
        let gain = BETTER_MIN * best.scatter_mm(count, noise_mm).powi(2);
        Some(narrow.filter(|narrow| narrow.misfit - best.misfit < gain).unwrap_or(best))
    }

    /// How single points scatter about it, mm, which is the noise at least.
    pub(super) fn scatter_mm(&self, count: usize, noise_mm: f64) -> f64 {
        let freedom = count.saturating_sub(6).max(1) as f64;
        (self.misfit / freedom).sqrt().max(noise_mm)
    }

    /// The step of a width where it fits best.
    pub(super) fn best(means: &[Mean], scale_mm: f64) -> Option<Step> {
        let steps = OFFSETS_MM.iter().filter_map(|at_mm| Step::at(means, scale_mm, *at_mm));
        steps.min_by(|a, b| a.misfit.total_cmp(&b.misfit))
    }
}

/// A furrow or a bulge within a cubic.
pub(super) struct Furrow {
    pub(super) scale_mm: f64,
    power: i32,
    pub(super) at_mm: f64,
    pub(super) misfit: f64,
}

impl Furrow {
    fn shape(x: f64, scale_mm: f64, power: i32) -> f64 {
        (-(x / scale_mm).abs().powi(power)).exp()
    }

    /// The one that fits best.
    pub(super) fn best(means: &[Mean]) -> Option<Furrow> {
        let places = FURROWS
            .into_iter()
            .flat_map(|(scale_mm, power)| FURROW_OFFSETS_MM.map(|at_mm| (scale_mm, power, at_mm)));
        let furrows = places.filter_map(|(scale_mm, power, at_mm)| {
            let shape = |x: f64| with_cubic(x, [Furrow::shape(x, scale_mm, power)]);
            let solution: Solution<5> = solve(means, at_mm, shape)?;
            Some(Furrow { scale_mm, power, at_mm, misfit: solution.misfit })
        });
        furrows.min_by(|a, b| a.misfit.total_cmp(&b.misfit))
    }

    /// The step that remains at a place or at the flanks and the middle of the furrow, and its misfit.
    pub(super) fn step_beside(&self, means: &[Mean], at_mm: f64) -> Option<(f64, f64)> {
        let flanks = [self.at_mm, self.at_mm - self.scale_mm, self.at_mm + self.scale_mm];
        let places = [at_mm].into_iter().chain(flanks);
        let steps = places
            .flat_map(|at_mm| BOTH_SCALES_MM.map(|scale_mm| (at_mm, scale_mm)))
            .filter_map(|(step_at_mm, scale_mm)| {
                let shape = |x: f64| {
                    let furrow_x = x + step_at_mm - self.at_mm;
                    let furrow = Furrow::shape(furrow_x, self.scale_mm, self.power);
                    with_cubic(x, [furrow, logistic(x, scale_mm)])
                };
                let solution: Solution<6> = solve(means, step_at_mm, shape)?;
                Some((solution.coefficients[5], solution.misfit))
            });
        steps.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// A step of height 1 around zero.
pub(super) fn logistic(x_mm: f64, scale_mm: f64) -> f64 {
    0.5 * (x_mm / scale_mm / 2.0).tanh()
}

/// The values of a cubic's parts at a place (mm, in units of 25 mm so that they are alike), and others after them.
pub(super) fn with_cubic<const MORE: usize, const ALL: usize>(
    x_mm: f64,
    more: [f64; MORE],
) -> SVector<f64, ALL> {
    let x = x_mm / 25.0;
    let cubic = [1.0, x, x * x, x * x * x];
    SVector::from_fn(|part, _| match part {
        0..4 => cubic[part],
        _ => more[part - 4],
    })
}

/// A solution of least squares.
struct Solution<const N: usize> {
    coefficients: SVector<f64, N>,
    /// Of the coefficients, for values of variance 1 per weight.
    variances: SVector<f64, N>,
    pub(super) misfit: f64,
}

/// Least squares of shapes, given at distances from a place, through means; `None` if the shapes cannot be
/// distinguished.
fn solve<const N: usize>(
    means: &[Mean],
    at_mm: f64,
    shape: impl Fn(f64) -> SVector<f64, N>,
) -> Option<Solution<N>> {
    let shapes: Vec<SVector<f64, N>> =
        means.iter().map(|mean| shape(mean.from_border_mm - at_mm)).collect();
    let inverse = inverse(shapes.iter().zip(means).map(|(shape, mean)| (*shape, mean.count)))?;
    let rows = || shapes.iter().zip(means);
    let moments: SVector<f64, N> =
        rows().map(|(shape, mean)| shape * (mean.count * mean.radius_mm)).sum();
    let coefficients = inverse * moments;
    let misfit = |(shape, mean): (&SVector<f64, N>, &Mean)| {
        mean.count * (mean.radius_mm - shape.dot(&coefficients)).powi(2)
    };
    let misfit = rows().map(misfit).sum();
    Some(Solution { coefficients, variances: inverse.diagonal(), misfit })
}

/// The inverse of the normal matrix of weighted shapes; `None` if they cannot be distinguished.
pub(super) fn inverse<const N: usize>(
    shapes: impl Iterator<Item = (SVector<f64, N>, f64)>,
) -> Option<SMatrix<f64, N, N>> {
    let normal: SMatrix<f64, N, N> =
        shapes.map(|(shape, weight)| shape * shape.transpose() * weight).sum();
    let factor = normal.cholesky()?;
    let pivots = factor.l_dirty().diagonal().component_mul(&factor.l_dirty().diagonal());
    let is_apart =
        pivots.iter().zip(&normal.diagonal()).all(|(pivot, own)| *pivot > PIVOT_MIN_SHARE * own);
    is_apart.then(|| factor.inverse())
}
