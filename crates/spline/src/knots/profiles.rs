//! Data of one direction; for a grid, all points of the other direction side by side.

use crate::basis::{Basis, BasisFault, equidistant};
use crate::least_squares::LeastSquares;
use crate::normal::RIDGE;
use crate::solve::Singular;

/// Data of one direction.
#[derive(Debug, Clone)]
pub struct Profiles {
    /// The positions of the rows of `values`.
    pub places: Vec<f64>,
    /// Row-major, one row per position; for a grid, the coordinates of all its points there, mm.
    pub values: Vec<f64>,
}

impl Profiles {
    /// Sum of the squared residuals of the plain fit in a basis.
    ///
    /// # Errors
    /// [`Singular`] if the data leave a coefficient undetermined.
    pub fn rss(&self, basis: &Basis) -> Result<f64, Singular> {
        let left = LeastSquares::new(basis, &self.places, RIDGE)?.residuals(&self.values);
        Ok(left.iter().map(|value| value * value).sum())
    }
}

/// The domain of a direction's parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Domain {
    /// Its start.
    pub from: f64,
    /// Its end; if periodic, the start one period later.
    pub to: f64,
    /// Whether it is closed.
    pub periodic: bool,
}

impl Domain {
    /// The basis of these breakpoints.
    ///
    /// # Errors
    /// As [`Basis::clamped`] and [`Basis::periodic`].
    pub fn basis(&self, breakpoints: &[f64]) -> Result<Basis, BasisFault> {
        if self.periodic { Basis::periodic(breakpoints) } else { Basis::clamped(breakpoints) }
    }

    /// Breakpoints of `spans` equal spans.
    pub fn equal(&self, spans: usize) -> Vec<f64> {
        equidistant(self.from, self.to, spans)
    }

    /// Positions in ascending order; if periodic, within one period from `start`.
    pub fn wrapped(&self, places: &[f64], start: f64) -> Vec<f64> {
        let mut places: Vec<f64> = places.iter().map(|place| self.wrap(*place, start)).collect();
        places.sort_by(f64::total_cmp);
        places
    }

    /// A position; if periodic, within one period from `start`.
    pub fn wrap(&self, place: f64, start: f64) -> f64 {
        let period = self.to - self.from;
        if self.periodic { start + (place - start).rem_euclid(period) } else { place }
    }

    /// The ranges at the ends of a clamped domain beyond all positions.
    pub fn open_ends(&self, places: &[f64]) -> Vec<[f64; 2]> {
        let first = places.iter().copied().fold(self.to, f64::min);
        let last = places.iter().copied().fold(self.from, f64::max);
        if self.periodic { Vec::new() } else { vec![[self.from, first], [last, self.to]] }
    }

    /// The two ends of the widest range without a position.
    pub fn widest_gap(&self, places: &[f64]) -> [f64; 2] {
        let mut ends = self.wrapped(places, self.from);
        let next_turn = ends.first().map(|first| first + (self.to - self.from));
        ends.extend(next_turn.filter(|_| self.periodic));
        let inner = ends.windows(2).map(|pair| [pair[0], pair[1]]);
        let wider = |a: &[f64; 2], b: &[f64; 2]| (a[1] - a[0]).total_cmp(&(b[1] - b[0]));
        let stretches = inner.chain(self.open_ends(places));
        stretches.max_by(wider).unwrap_or([self.from, self.to])
    }
}
