//! The normal equations of a cloud's x and y in a tensor-product basis.

use super::banded::Banded;
use super::cells::{Cells, Piece};

/// Number of powers in a product of two cubics.
const POWERS: usize = 7;

/// The pairs of the four functions of an interval, smaller index first.
const PAIRS: [(usize, usize); 10] =
    [(0, 0), (1, 1), (2, 2), (3, 3), (0, 1), (1, 2), (2, 3), (0, 2), (1, 3), (0, 3)];

/// BᵀWB and BᵀWy; coefficients row by row along.
pub struct CloudEquations {
    /// BᵀWB.
    pub gram: Banded,
    /// BᵀWx and BᵀWy.
    pub moments: Vec<[f64; 2]>,
    /// Sum of the weights.
    pub weight: f64,
}

impl CloudEquations {
    /// The equations of a sorted cloud with a weight for each of its points, in the cells' order,
    /// in bases with these numbers of functions.
    pub fn new(cells: &Cells, weights: &[f64], [rows, columns]: [usize; 2]) -> CloudEquations {
        let squares = cells.pieces.each_ref().map(|all| {
            all.iter().map(|piece| PAIRS.map(|pair| multiplied(piece, pair))).collect::<Vec<_>>()
        });
        let mut gram = Banded::zero(rows * columns, band_width(columns));
        let mut moments = vec![[0.0; 2]; rows * columns];
        for (row, column, range) in cells.iter() {
            if range.is_empty() {
                continue;
            }
            let sums = Sums::new(cells, weights, range);
            let (along, around) = (&cells.pieces[0][row], &cells.pieces[1][column]);
            sums.add_moments(along, around, columns, &mut moments);
            let indices = [along.indices, around.indices];
            sums.add_gram([&squares[0][row], &squares[1][column]], indices, columns, &mut gram);
        }
        CloudEquations { gram, moments, weight: weights.iter().sum() }
    }
}

/// Entries stored per row of the equations: functions that overlap are at most three rows apart,
/// and anywhere within those rows, because the rows are closed.
fn band_width(columns: usize) -> usize {
    4 * columns
}

/// The product of two functions of an interval, in powers of the local position.
fn multiplied(piece: &Piece, (a, b): (usize, usize)) -> [f64; POWERS] {
    let mut product = [0.0; POWERS];
    for (p, left) in piece.cubics[a].iter().enumerate() {
        for (q, right) in piece.cubics[b].iter().enumerate() {
            product[p + q] += left * right;
        }
    }
    product
}

/// Weighted sums of powers over the points of one cell.
struct Sums {
    /// Σ w sᵖ tᵠ; one power more than needed around, for runs of even length.
    powers: [[f64; POWERS + 1]; POWERS],
    /// Σ w sᵖ tᵠ x, and y.
    values: [[[f64; 4]; 4]; 2],
}

impl Sums {
    fn new(cells: &Cells, weights: &[f64], range: std::ops::Range<usize>) -> Sums {
        let mut powers = [[0.0; POWERS + 1]; POWERS];
        let mut values = [[[0.0; 4]; 4]; 2];
        for (point, weight) in cells.points()[range.clone()].iter().zip(&weights[range]) {
            let (t, tt) = (point.t, point.t * point.t);
            let cube = tt * t;
            let around = [1.0, t, tt, cube, tt * tt, tt * cube, cube * cube, cube * tt * tt];
            let mut share = *weight;
            for (p, sums) in powers.iter_mut().enumerate() {
                sums.iter_mut().zip(around).for_each(|(sum, power)| *sum += share * power);
                if p < 4 {
                    for (sums, value) in values.iter_mut().zip(point.value) {
                        let moment = share * value;
                        let sums = sums[p].iter_mut().zip(around);
                        sums.for_each(|(sum, power)| *sum += moment * power);
                    }
                }
                share *= point.s;
            }
        }
        Sums { powers, values }
    }

    fn add_moments(&self, along: &Piece, around: &Piece, columns: usize, moments: &mut [[f64; 2]]) {
        for (axis, sums) in self.values.iter().enumerate() {
            for (i, cubic) in along.indices.into_iter().zip(&along.cubics) {
                let mut line = [0.0; 4];
                for (share, sums) in cubic.iter().zip(sums) {
                    line.iter_mut().zip(sums).for_each(|(line, sum)| *line += share * sum);
                }
                for (j, cubic) in around.indices.into_iter().zip(&around.cubics) {
                    let sum = cubic.iter().zip(&line).map(|(share, sum)| share * sum).sum::<f64>();
                    moments[i * columns + j][axis] += sum;
                }
            }
        }
    }

    fn add_gram(
        &self,
        [along, around]: [&[[f64; POWERS]; 10]; 2],
        indices: [[usize; 4]; 2],
        columns: usize,
        gram: &mut Banded,
    ) {
        for ((a, c), product) in PAIRS.into_iter().zip(along) {
            let mut line = [0.0; POWERS];
            for (share, sums) in product.iter().zip(&self.powers) {
                line.iter_mut().zip(sums).for_each(|(line, sum)| *line += share * sum);
            }
            let (upper, lower) = (indices[0][a] * columns, indices[0][c] * columns);
            for ((b, d), product) in PAIRS.into_iter().zip(around) {
                let sum = product.iter().zip(&line).map(|(share, sum)| share * sum).sum::<f64>();
                let (left, right) = (indices[1][b], indices[1][d]);
                let (near, far) = (left.min(right), left.max(right));
                gram.add(lower + far, upper + near, sum);
                if a != c && b != d {
                    gram.add(lower + near, upper + far, sum);
                }
            }
        }
    }
}
