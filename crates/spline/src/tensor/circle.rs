//! The direction around in equal pieces, where every matrix of the basis is a circulant: waves around are
//! its eigenvectors (Davis, Circulant Matrices, 1979).

use std::f64::consts::{PI, TAU};

use nalgebra::DMatrix;

use crate::basis::{Basis, BasisFault, DEGREE};
use crate::integrals::roughness;

/// The derivative whose square is penalised.
pub const PENALISED: usize = 2;

/// Added to the diagonal of a Gram matrix, relative to its mean, so that a range without cells does
/// not make it singular.
pub const RIDGE: f64 = 1e-9;

/// The products of a basis function with itself and the three after it, averaged over pieces: moments of
/// the cubic B-spline, 151/315, 397/1680, 1/42 and 1/5040.
const MASS: Neighbours = [2416.0 / 5040.0, 1191.0 / 5040.0, 120.0 / 5040.0, 1.0 / 5040.0];

/// Entries of a symmetric circulant: of a function with itself and with the three after it.
type Neighbours = [f64; DEGREE + 1];

/// The direction around.
#[derive(Debug, Clone)]
pub struct Circle {
    /// The basis, periodic over the angles from −π on.
    pub basis: Basis,
    /// Gram matrix of the values in the middles of the pieces, with its ridge.
    pub gram: Neighbours,
    /// Roughness matrix.
    pub roughness: Neighbours,
    /// Orthonormal waves by rows: cosines at the first half of the places around, and sines.
    cosines: DMatrix<f64>,
    sines: DMatrix<f64>,
    /// The same by columns, because products with a transposed matrix are slow.
    cosines_transposed: DMatrix<f64>,
    sines_transposed: DMatrix<f64>,
}

impl Circle {
    /// A circle of equal pieces, at least 7, so that a function meets each neighbour once.
    ///
    /// # Errors
    /// A [`BasisFault`] if there are fewer.
    pub fn new(pieces: usize) -> Result<Circle, BasisFault> {
        let needed = 2 * DEGREE + 2;
        if pieces + 1 < needed {
            return Err(BasisFault::TooFewBreakpoints { found: pieces + 1, needed });
        }
        let basis = Basis::uniform_periodic(-PI, TAU, pieces)?;
        let middle = basis.row(PI / pieces as f64).values;
        let shared = |apart: usize| (apart..=DEGREE).map(|i| middle[i] * middle[i - apart]).sum();
        let mut gram: Neighbours = std::array::from_fn(shared);
        gram[0] += RIDGE * gram[0];
        let rough = roughness(&basis, PENALISED);
        let roughness = std::array::from_fn(|apart| rough.entry(DEGREE + apart, DEGREE));
        let phase =
            |wave: usize, place: usize| TAU * (wave * place % pieces) as f64 / pieces as f64;
        let size = |wave: usize| {
            let is_single = wave == 0 || 2 * wave == pieces;
            (if is_single { 1.0 } else { 2.0 } / pieces as f64).sqrt()
        };
        let (even, odd) = (pieces / 2 + 1, (pieces - 1) / 2);
        let cosines = DMatrix::from_fn(even, even, |k, j| size(k) * phase(k, j).cos());
        let sines = DMatrix::from_fn(odd, odd, |k, j| size(k + 1) * phase(k + 1, j + 1).sin());
        let (cosines_transposed, sines_transposed) = (cosines.transpose(), sines.transpose());
        Ok(Circle { basis, gram, roughness, cosines, sines, cosines_transposed, sines_transposed })
    }

    /// Number of pieces, of functions, and of waves.
    pub fn count(&self) -> usize {
        self.basis.count()
    }

    /// Number of different wave numbers, from 0 on: all but the first and, of an even number of pieces, the
    /// last have a cosine and a sine.
    pub fn frequencies(&self) -> usize {
        self.cosines.nrows()
    }

    /// How often a wave number occurs among the waves.
    pub fn multiplicity(&self, frequency: usize) -> usize {
        if (1..=self.sines.nrows()).contains(&frequency) { 2 } else { 1 }
    }

    /// The eigenvalue of a symmetric circulant for each wave number.
    pub fn eigenvalues(&self, of: &Neighbours) -> Vec<f64> {
        let turn = |frequency: usize, apart: usize| {
            (TAU * (frequency * apart) as f64 / self.count() as f64).cos()
        };
        let others =
            |k: usize| (1..=DEGREE).map(|apart| 2.0 * of[apart] * turn(k, apart)).sum::<f64>();
        (0..self.frequencies()).map(|frequency| of[0] + others(frequency)).collect()
    }

    /// The eigenvalues of the Gram matrix of data that are spread evenly around, one per piece.
    pub fn mass(&self) -> Vec<f64> {
        self.eigenvalues(&MASS)
    }

    /// The waves in each column: first the cosines by wave number, then the sines from wave number 1 on.
    pub fn waves(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let (count, width) = columns.shape();
        let (half, odd) = (count / 2, self.sines.nrows());
        let mut sums = columns.rows(0, half + 1).into_owned();
        let mut differences = columns.rows(1, odd).into_owned();
        for column in 0..width {
            let all = &columns.as_slice()[column * count..(column + 1) * count];
            let mirrored = all[count - odd..].iter().rev();
            let sums = &mut sums.as_mut_slice()[column * (half + 1)..][1..=odd];
            sums.iter_mut().zip(mirrored.clone()).for_each(|(sum, other)| *sum += other);
            let differences = &mut differences.as_mut_slice()[column * odd..][..odd];
            differences.iter_mut().zip(mirrored).for_each(|(own, other)| *own -= other);
        }
        let mut waves = DMatrix::zeros(count, width);
        waves.rows_mut(0, half + 1).gemm(1.0, &self.cosines, &sums, 0.0);
        waves.rows_mut(half + 1, odd).gemm(1.0, &self.sines, &differences, 0.0);
        waves
    }

    /// The columns that have these waves.
    pub fn columns(&self, waves: &DMatrix<f64>) -> DMatrix<f64> {
        let (count, width) = waves.shape();
        let (half, odd) = (count / 2, self.sines.nrows());
        let even = &self.cosines_transposed * waves.rows(0, half + 1);
        let uneven = &self.sines_transposed * waves.rows(half + 1, odd);
        let mut columns = DMatrix::zeros(count, width);
        for column in 0..width {
            let even = &even.as_slice()[column * (half + 1)..][..half + 1];
            let uneven = &uneven.as_slice()[column * odd..][..odd];
            let own = &mut columns.as_mut_slice()[column * count..][..count];
            own[..=half].copy_from_slice(even);
            let pairs = even[1..=odd].iter().zip(uneven);
            for ((own, even), uneven) in own[1..=odd].iter_mut().zip(&even[1..]).zip(uneven) {
                *own = even + uneven;
            }
            let mirrored = own[count - odd..].iter_mut().rev();
            mirrored.zip(pairs).for_each(|(own, (even, uneven))| *own = even - uneven);
        }
        columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circles() -> impl Iterator<Item = Circle> {
        [7, 8, 15, 48].into_iter().map(|pieces| Circle::new(pieces).unwrap())
    }

    fn some(count: usize, width: usize) -> DMatrix<f64> {
        DMatrix::from_fn(count, width, |i, j| ((7 * i * i + 3 * j) % 11) as f64 - 4.0)
    }

    #[test]
    fn waves_keep_lengths_and_lead_back() {
        for circle in circles() {
            let columns = some(circle.count(), 5);
            let waves = circle.waves(&columns);
            assert!((waves.norm() - columns.norm()).abs() < 1e-12 * columns.norm());
            assert!((circle.columns(&waves) - columns).amax() < 1e-12);
        }
    }

    #[test]
    fn a_circulant_multiplies_each_wave_by_its_eigenvalue() {
        for circle in circles() {
            let count = circle.count();
            let of = circle.roughness;
            let dense = DMatrix::from_fn(count, count, |i, j| {
                let apart = (i + count - j) % count;
                of.get(apart.min(count - apart)).copied().unwrap_or(0.0)
            });
            let columns = some(count, 3);
            let mut expected = circle.waves(&columns);
            let eigenvalues = circle.eigenvalues(&of);
            for (row, mut waves) in expected.row_iter_mut().enumerate() {
                let frequency = if row <= count / 2 { row } else { row - count / 2 };
                waves *= eigenvalues[frequency];
            }
            let found = circle.waves(&(dense * columns));
            assert!((found - &expected).amax() < 1e-12 * expected.amax());
        }
    }

    #[test]
    fn the_mass_is_that_of_the_basis_by_quadrature() {
        let circle = Circle::new(48).unwrap();
        let whole = crate::integrals::mass(&circle.basis);
        for (apart, share) in MASS.into_iter().enumerate() {
            let expected = whole.entry(DEGREE + apart, DEGREE) * 48.0 / TAU;
            assert!((share - expected).abs() < 1e-14, "{apart}: {share} {expected}");
        }
    }
}
