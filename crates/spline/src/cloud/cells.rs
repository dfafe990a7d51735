//! Scattered points sorted by knot cell.
//!
//! Within one cell every basis function is a cubic of the local position, so all sums over points
//! that a fit needs are sums of powers. A point costs some 80 products, and its basis functions are
//! never evaluated.

use nalgebra::Point3;

use crate::basis::{Basis, DEGREE};

/// The four functions on one interval of a basis, as cubics.
#[derive(Debug, Clone, Copy)]
pub struct Piece {
    /// The indices of the functions, as in [`crate::Row::indices`].
    pub indices: [usize; 4],
    /// The coefficients of each function in powers of the local position, −1 to 1 over the interval.
    pub cubics: [[f64; 4]; 4],
    middle: f64,
    half: f64,
}

/// One piece for each interval of the basis.
pub fn pieces(basis: &Basis) -> Vec<Piece> {
    let piece = |pair: &[f64]| {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        let rows = basis.rows(middle);
        // Taylor series about the middle.
        let scales = [1.0, half, half * half / 2.0, half * half * half / 6.0];
        let cubic = |function: usize| [0, 1, 2, 3].map(|p| rows[p].values[function] * scales[p]);
        Piece { indices: rows[0].indices, cubics: [0, 1, 2, 3].map(cubic), middle, half }
    };
    basis.breakpoints().windows(2).map(piece).collect()
}

/// A point of a cloud in the local coordinates of its cell.
#[derive(Debug, Clone, Copy)]
pub struct Sited {
    /// Local position along, −1 to 1.
    pub s: f64,
    /// Local position around, −1 to 1.
    pub t: f64,
    /// x and y of the point.
    pub value: [f64; 2],
}

/// A cloud sorted by cell; rows of cells along, columns around.
#[derive(Debug, Clone)]
pub struct Cells {
    /// The pieces along and around.
    pub pieces: [Vec<Piece>; 2],
    /// Where each cell's points start in `points`; one more value marks the end.
    starts: Vec<usize>,
    points: Vec<Sited>,
    /// The index in the cloud of each of `points`.
    order: Vec<usize>,
}

impl Cells {
    /// Sorts `points`, whose z is the position along, with their positions `around`.
    pub fn new(points: &[Point3<f64>], around: &[f64], bases: [&Basis; 2]) -> Cells {
        let pieces = bases.map(pieces);
        let columns = pieces[1].len();
        let mut starts = vec![0; pieces[0].len() * columns + 1];
        let homes = points.iter().zip(around).map(|(point, v)| {
            let (u, v) = (bases[0].wrapped(point.z), bases[1].wrapped(*v));
            (bases[0].span(u) * columns + bases[1].span(v), u, v)
        });
        let homes: Vec<(usize, f64, f64)> = homes.collect();
        homes.iter().for_each(|(cell, ..)| starts[cell + 1] += 1);
        (1..starts.len()).for_each(|cell| starts[cell] += starts[cell - 1]);
        let mut next = starts.clone();
        let nowhere = Sited { s: 0.0, t: 0.0, value: [0.0; 2] };
        let (mut sited, mut order) = (vec![nowhere; points.len()], vec![0; points.len()]);
        for (index, ((cell, u, v), point)) in homes.into_iter().zip(points).enumerate() {
            let (along, around) = (&pieces[0][cell / columns], &pieces[1][cell % columns]);
            let place = next[cell];
            next[cell] += 1;
            order[place] = index;
            let (s, t) = ((u - along.middle) / along.half, (v - around.middle) / around.half);
            sited[place] = Sited { s, t, value: [point.x, point.y] };
        }
        Cells { pieces, starts, points: sited, order }
    }

    /// The cells, row by row: row, column and point range of each.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize, std::ops::Range<usize>)> {
        let columns = self.pieces[1].len();
        let ranges = self.starts.windows(2).map(|pair| pair[0]..pair[1]).enumerate();
        ranges.map(move |(cell, range)| (cell / columns, cell % columns, range))
    }

    /// All points, cell by cell.
    pub fn points(&self) -> &[Sited] {
        &self.points
    }

    /// Reorders one value per point from the cells' order to the cloud's.
    pub fn in_cloud_order(&self, values: &[f64]) -> Vec<f64> {
        let mut ordered = vec![0.0; values.len()];
        self.order.iter().zip(values).for_each(|(index, value)| ordered[*index] = *value);
        ordered
    }

    /// Squared distance of each point from the surface with these coefficients (rows of `columns`,
    /// x and y) at the point's own parameters.
    pub fn squares(&self, coefficients: &[[f64; 2]], columns: usize) -> Vec<f64> {
        let mut squares = Vec::with_capacity(self.points.len());
        for (row, column, range) in self.iter() {
            if range.is_empty() {
                continue;
            }
            let [x, y] = self.patch(row, column, coefficients, columns);
            for point in &self.points[range] {
                let (dx, dy) = (point.value[0] - at(&x, point), point.value[1] - at(&y, point));
                squares.push(dx * dx + dy * dy);
            }
        }
        squares
    }

    /// The bicubics of one cell for x and y: coefficients of powers along × around.
    fn patch(
        &self,
        row: usize,
        column: usize,
        coefficients: &[[f64; 2]],
        columns: usize,
    ) -> [[[f64; 4]; 4]; 2] {
        let (along, around) = (&self.pieces[0][row], &self.pieces[1][column]);
        let mut patch = [[[0.0; 4]; 4]; 2];
        for (i, cubic_a) in along.indices.into_iter().zip(&along.cubics) {
            for (j, cubic_b) in around.indices.into_iter().zip(&around.cubics) {
                let own = coefficients[i * columns + j];
                for p in 0..=DEGREE {
                    for q in 0..=DEGREE {
                        let share = cubic_a[p] * cubic_b[q];
                        patch[0][p][q] += share * own[0];
                        patch[1][p][q] += share * own[1];
                    }
                }
            }
        }
        patch
    }
}

/// A bicubic at a point, by Horner's method.
fn at(bicubic: &[[f64; 4]; 4], point: &Sited) -> f64 {
    let line = |c: &[f64; 4]| c[0] + point.t * (c[1] + point.t * (c[2] + point.t * c[3]));
    let [a, b, c, d] = bicubic.each_ref().map(line);
    a + point.s * (b + point.s * (c + point.s * d))
}
