//! Cholesky factor of a banded symmetric matrix, for the equations of a tensor-product surface.
//!
//! Coefficients are numbered row by row, so functions that overlap are at most four rows' width
//! apart. The factor fills up that band completely, so a plain band is sufficient.

use crate::solve::{SMALLEST_RELATIVE_PIVOT, Singular};

/// A symmetric matrix in which only the diagonal and some columns left of it are nonzero.
#[derive(Debug, Clone)]
pub struct Banded {
    size: usize,
    /// Entries stored per row: the diagonal and the entries left of it.
    width: usize,
    /// Row-major; the diagonal entry is the last of each row. Positions left of column 0 are stored
    /// as zero.
    entries: Vec<f64>,
}

impl Banded {
    /// The zero matrix with `size` rows, each storing `width` entries, including the diagonal.
    pub fn zero(size: usize, width: usize) -> Banded {
        Banded { size, width, entries: vec![0.0; size * width] }
    }

    /// Adds to the entry at `row` and `column`, where `row ≥ column > row − width`.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        let place = self.place(row, column);
        self.entries[place] += value;
    }

    /// Product with `pairs`, two values per row.
    pub fn product(&self, pairs: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut product = vec![[0.0; 2]; self.size];
        for row in 0..self.size {
            let (first, left) = self.left_of(row);
            let own = pairs[row];
            let diagonal = self.entries[self.place(row, row)];
            let mut sum = own.map(|value| diagonal * value);
            for ((entry, pair), target) in
                left.iter().zip(&pairs[first..]).zip(&mut product[first..])
            {
                for k in 0..2 {
                    sum[k] += entry * pair[k];
                    target[k] += entry * own[k];
                }
            }
            (0..2).for_each(|k| product[row][k] += sum[k]);
        }
        product
    }

    /// The Cholesky factor.
    ///
    /// # Errors
    /// [`Singular`] if the matrix is not positive definite beyond rounding.
    pub fn factor(mut self) -> Result<BandedCholesky, Singular> {
        let width = self.width;
        for i in 0..self.size {
            let first = (i + 1).saturating_sub(width);
            let (above, rest) = self.entries.split_at_mut(i * width);
            let row = &mut rest[..width];
            // Column `j` of this row is stored at `j + shift`.
            let shift = width - 1 - i.min(width - 1);
            for j in first..i {
                let other = &above[j * width..(j + 1) * width];
                let begin = first.max((j + 1).saturating_sub(width));
                let ours = begin - first + shift;
                let theirs = begin + width - 1 - j;
                let length = j - begin;
                let done = dot(&row[ours..ours + length], &other[theirs..theirs + length]);
                let place = j - first + shift;
                row[place] = (row[place] - done) / other[width - 1];
            }
            let diagonal = row[width - 1];
            let pivot = diagonal - dot(&row[..width - 1], &row[..width - 1]);
            let relative_pivot = if diagonal > 0.0 { pivot / diagonal } else { 0.0 };
            if relative_pivot.is_nan() || relative_pivot <= SMALLEST_RELATIVE_PIVOT {
                return Err(Singular { row: i, relative_pivot });
            }
            row[width - 1] = pivot.sqrt();
        }
        Ok(BandedCholesky { lower: self })
    }

    fn place(&self, row: usize, column: usize) -> usize {
        row * self.width + self.width - 1 - (row - column)
    }

    /// Row `row` left of the diagonal: its first column and its entries.
    fn left_of(&self, row: usize) -> (usize, &[f64]) {
        let first = (row + 1).saturating_sub(self.width);
        (first, &self.entries[self.place(row, first)..self.place(row, row)])
    }
}

/// The factor `L` of a matrix `L Lᵀ`.
#[derive(Debug, Clone)]
pub struct BandedCholesky {
    lower: Banded,
}

impl BandedCholesky {
    /// Solves in place for two right-hand sides, one pair of values per row.
    pub fn solve(&self, pairs: &mut [[f64; 2]]) {
        let lower = &self.lower;
        for row in 0..lower.size {
            let (first, entries) = lower.left_of(row);
            let mut own = pairs[row];
            for (entry, known) in entries.iter().zip(&pairs[first..row]) {
                (0..2).for_each(|k| own[k] -= entry * known[k]);
            }
            let diagonal = lower.entries[lower.place(row, row)];
            pairs[row] = own.map(|value| value / diagonal);
        }
        for row in (0..lower.size).rev() {
            let (first, entries) = lower.left_of(row);
            let diagonal = lower.entries[lower.place(row, row)];
            let own = pairs[row].map(|value| value / diagonal);
            pairs[row] = own;
            for (entry, open) in entries.iter().zip(&mut pairs[first..row]) {
                (0..2).for_each(|k| open[k] -= entry * own[k]);
            }
        }
    }
}

/// Number of independent sums, so that products need not wait for one another.
const LANES: usize = 8;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (a_lanes, b_lanes) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = a_lanes.remainder().iter().zip(b_lanes.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_lanes.zip(b_lanes) {
        (0..LANES).for_each(|lane| sums[lane] += a[lane] * b[lane]);
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_product_is_that_of_the_whole_matrix() {
        // Rows (4 1 2 0), (1 5 3 1), (2 3 6 2), (0 1 2 7).
        let mut matrix = Banded::zero(4, 3);
        let entries = [
            (0, 0, 4.0),
            (1, 0, 1.0),
            (1, 1, 5.0),
            (2, 0, 2.0),
            (2, 1, 3.0),
            (2, 2, 6.0),
            (3, 1, 1.0),
            (3, 2, 2.0),
            (3, 3, 7.0),
        ];
        entries.into_iter().for_each(|(row, column, value)| matrix.add(row, column, value));
        let pairs = [[1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [4.0, 1.0]];
        let product = [[12.0, 0.0], [24.0, 1.0], [34.0, 2.0], [36.0, 7.0]];
        assert_eq!(matrix.product(&pairs), product);
        let mut solved = product;
        matrix.factor().unwrap().solve(&mut solved);
        let missed = solved.iter().zip(&pairs).flat_map(|(a, b)| [a[0] - b[0], a[1] - b[1]]);
        assert!(missed.into_iter().all(|missed| missed.abs() < 1e-12), "{solved:?}");
    }
}
