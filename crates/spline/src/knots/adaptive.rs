//! Breakpoints where the data bend most: a fine fit shows how the third derivative changes, and
//! every span gets an equal share of that change.
//!
//! A cubic spline's error on a span of length h grows with h⁴ times the fourth derivative f⁗, so
//! the best density of breakpoints is proportional to |f⁗|^(1/4) (de Boor, A Practical Guide to
//! Splines, chapter XII). `crates/spline/tests/spline/knots.rs` compares the result with reference figures.

use super::profiles::{Domain, Profiles};
use crate::fit::FitFault;
use crate::least_squares::LeastSquares;

/// Spans of the fine fit per position, and their maximum.
const FINE_SHARE: f64 = 0.7;
const FINE_MOST: usize = 80;

/// Minimum density, relative to the mean, even on the straightest stretch. No span is longer than
/// 1.35 / 0.35 = 3.9 mean ones.
const FLOOR: f64 = 0.35;

/// Weights of a cell's neighbours when the density is smoothed.
const SMOOTHING: [(isize, f64); 5] =
    [(-2, 1.0 / 9.0), (-1, 2.0 / 9.0), (0, 3.0 / 9.0), (1, 2.0 / 9.0), (2, 1.0 / 9.0)];

/// The lambda of the fine fit (see [`LeastSquares::new`]), whose data have no noise, or none left.
const FINE_LAMBDA: f64 = 1e-9;

/// The equal spans of the fine fit for this number of positions.
fn fine(places: usize, domain: &Domain) -> Vec<f64> {
    let spans = (FINE_SHARE * places as f64) as usize;
    domain.equal(spans.clamp(4, FINE_MOST))
}

/// Breakpoints of `spans` spans with equal shares of the data's bending.
///
/// # Errors
/// A [`FitFault`] if the data leave the fine fit undetermined.
pub fn adaptive(profiles: &Profiles, domain: &Domain, spans: usize) -> Result<Vec<f64>, FitFault> {
    let fine = fine(profiles.places.len(), domain);
    let cells = fine.len() - 1;
    let jumps = jumps(profiles, domain, &fine)?;
    let at = |jumps: &[f64], cell: isize| {
        let wrapped = cell.rem_euclid(cells as isize);
        let held = cell.clamp(0, cells as isize - 1);
        jumps[if domain.periodic { wrapped } else { held } as usize]
    };
    let bending: Vec<f64> = (0..cells as isize)
        .map(|cell| (0.5 * (at(&jumps, cell - 1) + at(&jumps, cell))).powf(0.25))
        .collect();
    let smooth = |cell| SMOOTHING.iter().map(|(step, w)| w * at(&bending, cell + step)).sum();
    let smooth: Vec<f64> = (0..cells as isize).map(smooth).collect();
    let mean = smooth.iter().sum::<f64>() / cells as f64;
    // Data without any bending get equal spans.
    let relative = |value: f64| if mean > 0.0 { value / mean } else { 1.0 };
    let density: Vec<f64> = smooth.into_iter().map(|value| relative(value) + FLOOR).collect();
    Ok(equal_shares(&fine, &density, spans))
}

/// The change of the fine fit's third derivative at the end of each cell, over all columns together.
fn jumps(profiles: &Profiles, domain: &Domain, fine: &[f64]) -> Result<Vec<f64>, FitFault> {
    let basis = domain.basis(fine)?;
    let fit = LeastSquares::new(&basis, &profiles.places, FINE_LAMBDA)?;
    let coefficients = fit.coefficients(&profiles.values);
    let width = coefficients.len() / basis.count();
    let third = |pair: &[f64]| {
        let mut sums = vec![0.0; width];
        basis.rows(0.5 * (pair[0] + pair[1]))[3].add_to(&mut sums, &coefficients);
        sums
    };
    let thirds: Vec<Vec<f64>> = fine.windows(2).map(third).collect();
    let change =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (b - a).powi(2)).sum::<f64>().sqrt();
    let mut jumps: Vec<f64> = thirds.windows(2).map(|pair| change(&pair[0], &pair[1])).collect();
    // At a clamped end there is no next cell, so the last change is repeated.
    let (first, last) = (&thirds[0], &thirds[thirds.len() - 1]);
    let held = jumps[jumps.len() - 1];
    jumps.push(if domain.periodic { change(last, first) } else { held });
    Ok(jumps)
}

/// Breakpoints of `spans` spans with equal integrals of a density that is constant on the cells
/// between `edges`.
fn equal_shares(edges: &[f64], density: &[f64], spans: usize) -> Vec<f64> {
    let mut cumulative = vec![0.0];
    for (pair, density) in edges.windows(2).zip(density) {
        cumulative.push(cumulative[cumulative.len() - 1] + density * (pair[1] - pair[0]));
    }
    let whole = cumulative[cumulative.len() - 1];
    let place = |level: f64| {
        let cell = cumulative.partition_point(|heap| *heap <= level).clamp(1, density.len()) - 1;
        edges[cell] + (level - cumulative[cell]) / density[cell]
    };
    let inner = (1..spans).map(|i| place(whole * i as f64 / spans as f64));
    [edges[0]].into_iter().chain(inner).chain([edges[edges.len() - 1]]).collect()
}
