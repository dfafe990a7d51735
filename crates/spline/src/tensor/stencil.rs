//! A symmetric matrix between coefficients and their 7 × 7 neighbours, arranged for fast multiplication.

use nalgebra::DMatrix;

use crate::basis::DEGREE;

/// Number of functions in one direction that overlap with a given one: itself and three on each side.
pub const REACH: usize = 2 * DEGREE + 1;

/// Number of coefficients that a product processes in parallel: as many as fit in the registers.
const LANES: usize = 8;

/// The matrix.
pub struct System {
    height: usize,
    width: usize,
    /// For each run of [`LANES`] coefficients around, and each neighbour, their factors; 0 for
    /// neighbours outside the matrix and for the padding of the last run.
    factors: Vec<[[f64; LANES]; REACH * REACH]>,
}

impl System {
    /// The zero matrix for this many coefficients along and around.
    pub fn zero(height: usize, width: usize) -> System {
        let factors = vec![[[0.0; LANES]; REACH * REACH]; height * width.div_ceil(LANES)];
        System { height, width, factors }
    }

    /// Sets the entry of a coefficient, along and around, and its neighbour this many ahead along and, from
    /// three behind on, around; and the mirrored entry.
    #[inline]
    pub fn set(&mut self, [i, j]: [usize; 2], [ahead, b]: [usize; 2], value: f64) {
        let runs = self.width.div_ceil(LANES);
        self.factors[i * runs + j / LANES][(DEGREE + ahead) * REACH + b][j % LANES] = value;
        let aside = j + b + self.width - DEGREE;
        let other = if aside >= 2 * self.width {
            aside - 2 * self.width
        } else if aside >= self.width {
            aside - self.width
        } else {
            aside
        };
        let back = (DEGREE - ahead) * REACH + REACH - 1 - b;
        self.factors[(i + ahead) * runs + other / LANES][back][other % LANES] = value;
    }

    /// The entries of each coefficient with itself, around × along.
    pub fn diagonal(&self) -> DMatrix<f64> {
        let runs = self.width.div_ceil(LANES);
        let own = |j: usize, i: usize| {
            self.factors[i * runs + j / LANES][DEGREE * REACH + DEGREE][j % LANES]
        };
        DMatrix::from_fn(self.width, self.height, own)
    }

    /// The product with coefficients, around × along.
    pub fn product(&self, of: &DMatrix<f64>) -> DMatrix<f64> {
        let (height, width) = (self.height, self.width);
        let runs = width.div_ceil(LANES);
        // With lines of zeros before and after, and each line padded by its wrapped neighbours, every
        // run of neighbours exists and needs no bounds check.
        let length = runs * LANES + 2 * DEGREE;
        let mut padded = vec![0.0; (height + 2 * DEGREE) * length];
        let lines = padded[DEGREE * length..].chunks_exact_mut(length);
        for (line, own) in lines.zip(of.as_slice().chunks_exact(width)) {
            line[..DEGREE].copy_from_slice(&own[width - DEGREE..]);
            line[DEGREE..DEGREE + width].copy_from_slice(own);
            line[DEGREE + width..2 * DEGREE + width].copy_from_slice(&own[..DEGREE]);
        }
        let mut product = DMatrix::zeros(width, height);
        for (index, factors) in self.factors.iter().enumerate() {
            let (i, from) = (index / runs, index % runs * LANES);
            let mut sums = [0.0; LANES];
            for (a, line_of_factors) in factors.chunks_exact(REACH).enumerate() {
                let start = (i + a) * length + from;
                let values = &padded[start..start + REACH - 1 + LANES];
                for (factors, values) in line_of_factors.iter().zip(values.windows(LANES)) {
                    for ((sum, factor), value) in sums.iter_mut().zip(factors).zip(values) {
                        *sum += factor * value;
                    }
                }
            }
            let places = &mut product.as_mut_slice()[i * width..(i + 1) * width][from..];
            places.iter_mut().zip(sums).for_each(|(product, sum)| *product = sum);
        }
        product
    }
}
