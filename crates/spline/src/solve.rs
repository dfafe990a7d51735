//! Cholesky factors of the symmetric matrices of a cubic basis, in their native sparsity pattern.
//!
//! A clamped basis gives half-bandwidth 3. A periodic one adds the two corners, which lie in the
//! last 3 rows; factorising fills only those rows. So one skyline, a band plus some full rows at
//! the bottom, is sufficient for both.

use std::ops::Range;

use nalgebra::DMatrix;

use super::basis::{Basis, DEGREE, Row};

mod band;
pub(super) mod trial;

/// A symmetric matrix with a row and column for each function of a basis. Only pairs of overlapping
/// functions have an entry; the lower triangle is stored, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Skyline {
    /// Start of row `i` in `entries`; one additional value marks the end.
    starts: Vec<usize>,
    /// The rows from here on extend to column 0.
    full_from: usize,
    entries: Vec<f64>,
}

/// A matrix that is not positive definite in double precision.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("row {row} of the equations keeps only {relative_pivot:e} of its diagonal: singular")]
pub struct Singular {
    /// 0-based row (that is, coefficient) at which the factorisation stopped.
    pub row: usize,
    /// The remainder of that row's diagonal entry after elimination, as a fraction of the entry.
    pub relative_pivot: f64,
}

/// A pivot below this fraction of its diagonal entry consists of rounding errors.
const SMALLEST_RELATIVE_PIVOT: f64 = 16.0 * f64::EPSILON;

impl Skyline {
    /// The zero matrix for the functions of `basis`.
    pub fn zero(basis: &Basis) -> Skyline {
        let count = basis.count();
        let full_from = if basis.is_periodic() { count - DEGREE } else { count };
        let mut starts = vec![0];
        let mut end = 0;
        for row in 0..count {
            end += row + 1 - first_column(row, full_from);
            starts.push(end);
        }
        Skyline { starts, full_from, entries: vec![0.0; end] }
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.starts.len() - 1
    }

    /// The entry at `i`, `j`, for two functions that overlap.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        self.entries[self.place(i.max(j), i.min(j))]
    }

    /// Adds `weight · row rowᵀ`: one datum to a Gram matrix, or one quadrature node to a penalty.
    pub fn add_square(&mut self, row: &Row, weight: f64) {
        for (i, a) in row.indices.into_iter().zip(row.values) {
            for (j, b) in row.indices.into_iter().zip(row.values) {
                if j <= i {
                    let place = self.place(i, j);
                    self.entries[place] += weight * a * b;
                }
            }
        }
    }

    /// `self + factor · other`, for two matrices of the same basis.
    pub fn plus(&self, factor: f64, other: &Skyline) -> Skyline {
        let entries = self.entries.iter().zip(&other.entries).map(|(a, b)| a + factor * b);
        let (starts, full_from) = (self.starts.clone(), self.full_from);
        Skyline { starts, full_from, entries: entries.collect() }
    }

    /// The matrix in dense form.
    pub fn dense(&self) -> DMatrix<f64> {
        let size = self.size();
        let mut dense = DMatrix::zeros(size, size);
        for i in 0..size {
            let (first, left) = self.left_of(i);
            for (j, value) in (first..).zip(left) {
                (dense[(i, j)], dense[(j, i)]) = (*value, *value);
            }
            dense[(i, i)] = self.entry(i, i);
        }
        dense
    }

    /// The sum of the diagonal.
    pub fn trace(&self) -> f64 {
        self.diagonal().sum()
    }

    /// The trace of `self · other`, for two matrices of the same basis.
    pub fn trace_of_product(&self, other: &Skyline) -> f64 {
        let all: f64 = self.entries.iter().zip(&other.entries).map(|(a, b)| a * b).sum();
        let diagonal: f64 = self.diagonal().zip(other.diagonal()).map(|(a, b)| a * b).sum();
        2.0 * all - diagonal
    }

    /// The Cholesky factor.
    ///
    /// # Errors
    /// [`Singular`] if the matrix is not positive definite beyond rounding.
    pub fn factor(self) -> Result<Cholesky, Singular> {
        let mut lower = self;
        let mut above = [[0.0, 0.0, 0.0, 1.0]; DEGREE];
        for i in 0..lower.full_from {
            let (start, end) = (lower.starts[i], lower.starts[i + 1]);
            let (row, relative_pivot) = band::factored(lower.band_row(i), above);
            large_enough(i, relative_pivot)?;
            lower.entries[start..end].copy_from_slice(&row[DEGREE + 1 - (end - start)..]);
            above = [row, above[0], above[1]];
        }
        for i in lower.full_from..lower.size() {
            large_enough(i, lower.factor_row(i))?;
        }
        Ok(Cholesky { lower })
    }

    /// Turns a full row into that of the Cholesky factor, whose rows above are known. Returns the share of
    /// its diagonal entry that is left.
    fn factor_row(&mut self, i: usize) -> f64 {
        let (starts, full_from) = (&self.starts, self.full_from);
        let (above, row) = self.entries.split_at_mut(starts[i]);
        for j in 0..i {
            let first = first_column(j, full_from);
            let column = &above[starts[j]..starts[j + 1]];
            let (left, diagonal) = (&column[..j - first], column[j - first]);
            row[j] = (row[j] - dot(left, &row[first..j])) / diagonal;
        }
        let diagonal = row[i];
        let pivot = diagonal - row[..i].iter().map(|value| value * value).sum::<f64>();
        row[i] = pivot.max(0.0).sqrt();
        if diagonal > 0.0 { pivot / diagonal } else { 0.0 }
    }

    fn diagonal(&self) -> impl Iterator<Item = f64> {
        self.starts[1..].iter().map(|end| self.entries[end - 1])
    }

    /// The index of the entry at row `i` and column `j ≤ i`.
    fn place(&self, i: usize, j: usize) -> usize {
        self.starts[i + 1] - 1 - (i - j)
    }

    /// Row `i` of the band, with zeros for columns that do not exist.
    #[inline]
    fn band_row(&self, i: usize) -> band::Row {
        band::row(&self.entries[self.starts[i]..self.starts[i + 1]])
    }

    /// Row `i` left of the diagonal: its first column and its entries.
    fn left_of(&self, i: usize) -> (usize, &[f64]) {
        let first = first_column(i, self.full_from);
        (first, &self.entries[self.starts[i]..self.starts[i + 1] - 1])
    }

    /// The rows below `i` that have an entry in column `i`: some of the band, then the full ones.
    fn rows_below(&self, i: usize) -> impl Iterator<Item = usize> + Clone {
        let band_end = (i + 1 + DEGREE).min(self.size());
        let full: Range<usize> = self.full_from.max(band_end)..self.size();
        (i + 1..band_end).chain(full)
    }
}

/// The factor `L` of a matrix `L Lᵀ`.
#[derive(Debug, Clone)]
pub struct Cholesky {
    lower: Skyline,
}

impl Cholesky {
    /// Solves in place for `width` right-hand sides at once. `rows` is row-major, one row of
    /// `width` values per row of the matrix.
    pub fn solve(&self, rows: &mut [f64], width: usize) {
        if width == 1 {
            return self.solve_one(rows);
        }
        let ends = &self.lower.starts[1..];
        for (i, end) in ends.iter().enumerate() {
            let (above, row) = rows.split_at_mut(i * width);
            let row = &mut row[..width];
            let (first, entries) = self.lower.left_of(i);
            for (entry, known) in entries.iter().zip(above[first * width..].chunks_exact(width)) {
                subtract(row, *entry, known);
            }
            divide(row, self.lower.entries[end - 1]);
        }
        for (i, end) in ends.iter().enumerate().rev() {
            let (above, row) = rows.split_at_mut(i * width);
            let row = &mut row[..width];
            divide(row, self.lower.entries[end - 1]);
            let (first, entries) = self.lower.left_of(i);
            for (entry, open) in entries.iter().zip(above[first * width..].chunks_exact_mut(width))
            {
                subtract(open, *entry, row);
            }
        }
    }

    /// Solves in place for one right-hand side, which has no rows to vectorise over.
    fn solve_one(&self, values: &mut [f64]) {
        let (lower, ends) = (&self.lower, &self.lower.starts[1..]);
        let mut before = [0.0; DEGREE];
        for (i, value) in values.iter_mut().enumerate().take(lower.full_from) {
            *value = band::solved_down(lower.band_row(i), *value, before);
            before = [*value, before[0], before[1]];
        }
        for i in lower.full_from..lower.size() {
            let (first, entries) = lower.left_of(i);
            let known = dot(entries, &values[first..i]);
            values[i] = (values[i] - known) / lower.entries[ends[i] - 1];
        }
        for i in (lower.full_from..lower.size()).rev() {
            let value = values[i] / lower.entries[ends[i] - 1];
            values[i] = value;
            let (first, entries) = lower.left_of(i);
            subtract(&mut values[first..i], value, entries);
        }
        // What the rows below take off the three values above a row, nearest first.
        let mut taken = [0.0; DEGREE];
        for i in (0..lower.full_from).rev() {
            let [far, next, near, diagonal] = lower.band_row(i);
            values[i] = (values[i] - taken[0]) / diagonal;
            let value = values[i];
            taken = [taken[1] + near * value, taken[2] + next * value, far * value];
        }
    }

    /// The entries of the inverse for every pair of overlapping functions, at the cost of one more
    /// factorisation. Source: Takahashi, Fagan, Chin 1973; Hutchinson, de Hoog 1985.
    pub fn into_inverse(self) -> Skyline {
        if self.lower.full_from == self.lower.size() {
            let mut inverse = self.lower;
            band::invert(&mut inverse);
            return inverse;
        }
        let lower = &self.lower;
        let mut inverse = lower.clone();
        for i in (0..lower.size()).rev() {
            let pivot = lower.entry(i, i);
            // The rows below with an entry in this column (a few band rows and full ones), with
            // that entry.
            let mut below = [(0, 0.0); 2 * DEGREE];
            let rows = lower.rows_below(i);
            let filled = below.iter_mut().zip(rows).map(|(own, k)| *own = (k, lower.entry(k, i)));
            let count = filled.count();
            let below = &below[..count];
            let mut diagonal = 1.0 / pivot;
            for &(j, own) in below {
                let known = below.iter().map(|&(k, entry)| entry * inverse.entry(k, j));
                let value = -known.sum::<f64>() / pivot;
                let place = inverse.place(j, i);
                inverse.entries[place] = value;
                diagonal -= own * value;
            }
            let place = inverse.place(i, i);
            inverse.entries[place] = diagonal / pivot;
        }
        inverse
    }
}

/// Refuses a pivot, relative to its diagonal entry, that consists of rounding errors.
fn large_enough(row: usize, relative_pivot: f64) -> Result<(), Singular> {
    let is_none = relative_pivot.is_nan() || relative_pivot <= SMALLEST_RELATIVE_PIVOT;
    if is_none { Err(Singular { row, relative_pivot }) } else { Ok(()) }
}

fn first_column(row: usize, full_from: usize) -> usize {
    if row >= full_from { 0 } else { row.saturating_sub(DEGREE) }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn subtract(from: &mut [f64], factor: f64, values: &[f64]) {
    for (target, value) in from.iter_mut().zip(values) {
        *target -= factor * value;
    }
}

fn divide(values: &mut [f64], divisor: f64) {
    for value in values {
        *value /= divisor;
    }
}
