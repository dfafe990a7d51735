//! Moves breakpoints to minimise the plain fit's residual: variable projection.
//!
//! The unknowns are the logarithms of the changes of the spans, so that breakpoints never cross,
//! and, for a closed domain without marks, a shift of all of them. The coefficients are not
//! unknowns: for each set of breakpoints the least-squares fit determines them (Golub, Pereyra
//! 1973).

use nalgebra::{DMatrix, SymmetricEigen};

use super::marks::Marked;
use super::marquardt::least_squares;
use super::profiles::{Domain, Profiles};
use crate::least_squares::LeastSquares;
use crate::normal::RIDGE;

/// Maximum change of the logarithm of a span's length, before the spans are scaled to fill their
/// range again.
const REACH: f64 = 1.2;

/// Maximum shift of all breakpoints, as a share of the mean span.
const SHIFT: f64 = 0.5;

/// Sets the cost of a span that grows by a factor of e: a hundredth of the squared residual at the
/// start. With a tenth of that cost, spans on the test leg become shorter than the distance between
/// sections, and the surface bulges between the sections.
const STIFFNESS: f64 = 0.1;

/// Columns of the data that are smaller than this share of the largest are dropped.
const NEGLIGIBLE: f64 = 1e-6;

/// Maximum number of steps. On the test leg, further steps reduce the residual by less than 1 %.
const STEPS: usize = 16;

/// The breakpoints that minimise the residual of `profiles`. The fixed ones stay in place.
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

/// The breakpoints after changing the logarithms of their spans by the unknowns; an additional last
/// unknown is the shift.
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

/// Rotates the data in the space of their columns, so that few columns contain everything.
fn compressed(profiles: &Profiles) -> Profiles {
    let rows = profiles.places.len();
    let mut values = DMatrix::from_row_slice(rows, profiles.values.len() / rows, &profiles.values);
    for mut column in values.column_iter_mut() {
        // Every basis contains the constants, whose size would hide the shape.
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
