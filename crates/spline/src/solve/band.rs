//! The rows of a band of half-bandwidth 3, written out: loops over three entries would cost several
//! times what the entries do.

use super::{DEGREE, Skyline};

/// A row of the lower triangle: the entries of three columns and of the diagonal. Columns that do not exist
/// have 0.
pub(super) type Row = [f64; DEGREE + 1];

/// A row of the band from its stored entries, of which there are fewer in the first rows.
#[inline]
pub(super) fn row(entries: &[f64]) -> Row {
    if let Ok(row) = <Row>::try_from(entries) {
        return row;
    }
    let mut row = [0.0; DEGREE + 1];
    row[DEGREE + 1 - entries.len()..].copy_from_slice(entries);
    row
}

/// A row of the Cholesky factor from the three rows above, nearest first, and the share of its diagonal
/// entry that is left; a row above the first is that of the identity.
#[inline]
pub(super) fn factored([third, second, first, diagonal]: Row, above: [Row; DEGREE]) -> (Row, f64) {
    let [near, next, far] = above;
    let third = third / far[3];
    let second = (second - third * next[2]) / next[3];
    let first = (first - (third * near[1] + second * near[2])) / near[3];
    let pivot = diagonal - (third * third + second * second + first * first);
    let relative_pivot = if diagonal > 0.0 { pivot / diagonal } else { 0.0 };
    ([third, second, first, pivot.max(0.0).sqrt()], relative_pivot)
}

/// The value of a row in the solution of L x = b; `before` are the three values above, nearest first.
#[inline]
pub(super) fn solved_down(row: Row, value: f64, [near, next, far]: [f64; DEGREE]) -> f64 {
    (value - (row[0] * far + row[1] * next + row[2] * near)) / row[3]
}

/// The inverse, within the band, of the matrix of which this is the Cholesky factor (Takahashi, Fagan, Chin
/// 1973).
pub(super) fn invert(factor: &mut Skyline) {
    // The inverse among the three rows below, and the factor's entries of the next column in each of
    // them. Rows below the last are those of the identity, and have no entry.
    let [mut z11, mut z21, mut z31, mut z22, mut z32, mut z33] = [0.0; 6];
    let mut below = [[0.0; DEGREE + 1]; DEGREE];
    for i in (0..factor.size()).rev() {
        let own = factor.band_row(i);
        let [l1, l2, l3] = [below[0][2], below[1][1], below[2][0]];
        let per_pivot = 1.0 / own[3];
        let v1 = -(l1 * z11 + l2 * z21 + l3 * z31) * per_pivot;
        let v2 = -(l1 * z21 + l2 * z22 + l3 * z32) * per_pivot;
        let v3 = -(l1 * z31 + l2 * z32 + l3 * z33) * per_pivot;
        let v0 = (per_pivot - l1 * v1 - l2 * v2 - l3 * v3) * per_pivot;
        for (back, value) in [v0, v1, v2, v3].into_iter().enumerate() {
            // The entry of row i + back in column i lies as far before that row's end.
            if let Some(end) = factor.starts.get(i + back + 1) {
                factor.entries[end - 1 - back] = value;
            }
        }
        [z33, z32, z31, z22, z21, z11] = [z22, z21, v2, z11, v1, v0];
        below = [own, below[0], below[1]];
    }
}
