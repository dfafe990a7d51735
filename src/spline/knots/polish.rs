//! Breakpoints moved to where the plain fit's residual is least: variable projection.
//!
//! The unknowns are the logarithms of the spans' changes, so that breakpoints never cross, and of a
//! closed domain without marks a shift of the whole. The coefficients are not unknowns: for each
//! set of breakpoints the least-squares fit gives them (Golub, Pereyra 1973). Source: nurbs.md
//! 6.10.

use nalgebra::{DMatrix, SymmetricEigen};

use super::marks::Marked;
use super::marquardt::least_squares;
use super::profiles::{Domain, Profiles};
use crate::spline::least_squares::LeastSquares;
use crate::spline::normal::RIDGE;

/// A span's length may change by this factor's logarithm before the spans are scaled to fill their
/// stretch again; nurbs.md 6.10.
const REACH: f64 = 1.2;

/// The shift of the whole is at most this share of the mean span.
const SHIFT: f64 = 0.5;

/// What a span that is e times as long costs: a hundredth of the squared residual at the start.
/// With a tenth of that spans on the test leg become shorter than the distance of the sections, and
/// the surface bulges between them.
const STIFFNESS: f64 = 0.1;

/// Columns of the data that are this much smaller than the largest are left out.
const NEGLIGIBLE: f64 = 1e-6;

/// Steps at most. On the test leg the residual falls by less than 1 % afterwards.
const STEPS: usize = 16;

/// The breakpoints moved to where the residual of `profiles` is least. The fixed ones stay.
pub fn polished(profiles: &Profiles, domain: &Domain, start: &Marked) -> Vec<f64> {
    let profiles = compressed(profiles);
    let spans = start.breakpoints.len() - 1;
    let squares = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
    let left = |breakpoints: &[f64]| {
        let basis = domain.basis(breakpoints).ok()?;
        let fit = LeastSquares::new(&basis, &profiles.places, RIDGE).ok()?;
        Some(fit.residuals(&profiles.values))
    };
    let Some(first) = left(&start.breakpoints).map(|left| squares(&left).sqrt()) else {
        return start.breakpoints.clone();
    };
    let residuals = |unknowns: &[f64]| {
        let mut left = left(&changed(start, domain, unknowns))?;
        left.iter_mut().for_each(|value| *value /= first);
        left.extend(unknowns.iter().map(|unknown| STIFFNESS * unknown));
        Some(left)
    };
    let unknowns = spans + usize::from(start.fixed.is_empty());
    let found = least_squares(residuals, &vec![REACH; unknowns], STEPS);
    changed(start, domain, &found)
}

/// The breakpoints with the logarithms of their spans changed by the first unknowns, the last one,
/// if there is one more, being the shift.
fn changed(start: &Marked, domain: &Domain, unknowns: &[f64]) -> Vec<f64> {
    let Marked { breakpoints, fixed, .. } = start;
    let last = breakpoints.len() - 1;
    let shift = unknowns
        .get(last)
        .map_or(0.0, |shift| SHIFT * shift / REACH * (domain.to - domain.from) / last as f64);
    let mut changed: Vec<f64> = breakpoints.iter().map(|place| place + shift).collect();
    let ends = if fixed.is_empty() { &[0, last][..] } else { fixed };
    for (low, high) in ends.iter().zip(&ends[1..]) {
        let span = |i: usize| (breakpoints[i + 1] - breakpoints[i]) * unknowns[i].exp();
        let whole: f64 = (*low..*high).map(span).sum();
        let scale = (breakpoints[*high] - breakpoints[*low]) / whole;
        for i in low + 1..*high {
            changed[i] = changed[i - 1] + scale * span(i - 1);
        }
    }
    changed
}

/// The data turned in the space of their columns so that few columns hold all there is.
fn compressed(profiles: &Profiles) -> Profiles {
    let rows = profiles.places.len();
    let mut values = DMatrix::from_row_slice(rows, profiles.values.len() / rows, &profiles.values);
    for mut column in values.column_iter_mut() {
        // Every basis holds the constants, whose size would hide the shape.
        let mean = column.mean();
        column.add_scalar_mut(-mean);
    }
    let eigen = SymmetricEigen::new(&values * values.transpose());
    let largest = eigen.eigenvalues.max();
    let kept: Vec<usize> =
        (0..rows).filter(|i| eigen.eigenvalues[*i] > NEGLIGIBLE.powi(2) * largest).collect();
    let sizes: Vec<f64> = kept.iter().map(|i| eigen.eigenvalues[*i].sqrt()).collect();
    let row = |row: usize| {
        let columns = kept.iter().zip(&sizes);
        columns.map(move |(column, size)| (row, *column, *size))
    };
    let values = (0..rows).flat_map(row).map(|(i, j, size)| eigen.eigenvectors[(i, j)] * size);
    Profiles { places: profiles.places.clone(), values: values.collect() }
}
