//! What the residuals of neighbouring data share.
//!
//! The first, smoothest fit cuts off ridges and folds. Their data are far from it, but together; an
//! outlier is far from its neighbours too.

use super::{Scatter, place};
use crate::robust::{TUKEY, scale};

/// Neighbours share at most this much, in the unit of the values: a ridge that the smooth fit cuts off.
/// What lies further off is something else.
const SHARED_MAX: f64 = 5.0;

/// Data within this many cells of each other are neighbours.
const REACH_CELLS: f64 = 1.2;

/// Fewer neighbours than this, the datum among them, share nothing.
const NEIGHBOURS_MIN: usize = 5;

/// Residuals below this share of what makes an outlier are left as they are.
const SUSPECT_SHARE: f64 = 0.8;

/// Scattered data by cells of about one width.
pub struct Neighbours<'a> {
    data: &'a Scatter<'a>,
    /// Breakpoints of the cells along, and around.
    along: &'a [f64],
    around: &'a [f64],
    /// The cell of each datum: cells around, rows of them along.
    pub cells: Vec<usize>,
    /// Indices of the data, by cells.
    members: Vec<usize>,
    /// Where the members of each cell begin, and the end of the last.
    starts: Vec<usize>,
}

impl<'a> Neighbours<'a> {
    /// Puts the data into the cells between these breakpoints; those around are a whole period.
    pub fn new(data: &'a Scatter, along: &'a [f64], around: &'a [f64]) -> Neighbours<'a> {
        let (start, end) = ends(around);
        let [rows, columns] = [along, around].map(|points| points.len() - 1);
        let cell = |(u, v): (&f64, &f64)| {
            let turned = start + (v - start).rem_euclid(end - start);
            place(along, *u) * columns + place(around, turned)
        };
        let cells: Vec<usize> = data.u.iter().zip(data.v).map(cell).collect();
        let mut starts = vec![0_usize; rows * columns + 1];
        cells.iter().for_each(|cell| starts[cell + 1] += 1);
        (0..rows * columns).for_each(|cell| starts[cell + 1] += starts[cell]);
        let (mut members, mut next) = (vec![0; cells.len()], starts.clone());
        for (index, cell) in cells.iter().enumerate() {
            members[next[*cell]] = index;
            next[*cell] += 1;
        }
        Neighbours { data, along, around, cells, members, starts }
    }

    /// The residuals without what their neighbours share. Residuals of `least_scale` are no outliers.
    pub fn beside(&self, residuals: &[f64], least_scale: f64) -> Vec<f64> {
        let suspect = SUSPECT_SHARE * TUKEY * scale(residuals, least_scale);
        let beside = |(index, residual): (usize, &f64)| {
            let shared = if residual.abs() > suspect { self.shared(index, residuals) } else { 0.0 };
            residual - shared
        };
        residuals.iter().enumerate().map(beside).collect()
    }

    /// The median residual of a datum and its neighbours, within limits.
    fn shared(&self, index: usize, residuals: &[f64]) -> f64 {
        let [(bottom, top), (start, end)] = [self.along, self.around].map(ends);
        let [rows, columns] = [self.along, self.around].map(|points| points.len() - 1);
        let (long, wide) = ((top - bottom) / rows as f64, (end - start) / columns as f64);
        let (row, column) = (self.cells[index] / columns, self.cells[index] % columns);
        let rows = row.saturating_sub(1)..(row + 2).min(rows);
        let cells = rows.flat_map(|row| {
            [columns - 1, 0, 1].map(|turn| {
                let cell = row * columns + (column + turn) % columns;
                &self.members[self.starts[cell]..self.starts[cell + 1]]
            })
        });
        let is_near = |other: &&usize| {
            let up = (self.data.u[**other] - self.data.u[index]) / long;
            let turn = (self.data.v[**other] - self.data.v[index]).rem_euclid(end - start);
            let aside = turn.min(end - start - turn) / wide;
            up.hypot(aside) <= REACH_CELLS
        };
        let near = cells.flatten().filter(is_near);
        let mut near: Vec<f64> = near.map(|other| residuals[*other]).collect();
        if near.len() < NEIGHBOURS_MIN {
            return 0.0;
        }
        let middle = near.len() / 2;
        let (_, median, _) = near.select_nth_unstable_by(middle, f64::total_cmp);
        median.clamp(-SHARED_MAX, SHARED_MAX)
    }
}

/// First and last of at least one breakpoint.
fn ends(breakpoints: &[f64]) -> (f64, f64) {
    (breakpoints[0], breakpoints[breakpoints.len() - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 20;

    /// Residuals on a square lattice of unit cells, with two data a cell.
    fn beside(residual: impl Fn(f64, f64) -> f64) -> Vec<(f64, f64, f64)> {
        let lattice = (0..2 * SIDE * SIDE).map(|i| {
            let (row, column) = (i / (2 * SIDE), i % (2 * SIDE));
            (row as f64 + 0.5, column as f64 / 2.0 + 0.25)
        });
        let (u, v): (Vec<f64>, Vec<f64>) = lattice.unzip();
        let residuals: Vec<f64> = u.iter().zip(&v).map(|(u, v)| residual(*u, *v)).collect();
        let breakpoints: Vec<f64> = (0..=SIDE).map(|i| i as f64).collect();
        let data = Scatter { u: &u, v: &v, value: &residuals };
        let left = Neighbours::new(&data, &breakpoints, &breakpoints).beside(&residuals, 0.3);
        u.into_iter().zip(v).zip(left).map(|((u, v), left)| (u, v, left)).collect()
    }

    #[test]
    fn a_ridge_that_runs_over_the_seam_is_no_outlier() {
        // Two cells wide, across the whole period.
        for (u, v, left) in beside(|u, _| if (8.0..10.0).contains(&u) { 3.0 } else { 0.0 }) {
            assert!(left.abs() < 1e-12, "{u} {v}: {left}");
        }
    }

    #[test]
    fn a_single_datum_keeps_its_residual() {
        let far = |u: f64, v: f64| if u == 5.5 && v == 7.25 { 3.0 } else { 0.0 };
        let left: Vec<f64> = beside(far).into_iter().map(|(_, _, left)| left).collect();
        assert_eq!(left.iter().filter(|left| **left == 3.0).count(), 1);
        assert_eq!(left.iter().filter(|left| **left == 0.0).count(), left.len() - 1);
    }

    #[test]
    fn a_hand_far_from_the_skin_stays_an_outlier() {
        let hand = |u: f64, v: f64| if u < 6.0 && v < 6.0 { 25.0 } else { 0.0 };
        let hand_left = beside(hand).into_iter().filter(|(u, v, _)| hand(*u, *v) > 0.0);
        for (u, v, left) in hand_left {
            assert!(left >= 20.0, "{u} {v}: {left}");
        }
    }
}
