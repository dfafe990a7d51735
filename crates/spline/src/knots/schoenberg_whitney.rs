//! Whether data determine every function of a basis: the Schoenberg-Whitney conditions.

use crate::basis::{Basis, DEGREE};

/// Positions closer than this share of the domain count as one.
const ONE_PLACE: f64 = 1e-9;

/// The functions that remain without a datum of their own within their support when as many as possible have one,
/// ascending. Order does not matter; periodic positions are wrapped.
///
/// On a clamped basis none does exactly if a least-squares fit has a unique solution (Schoenberg, Whitney 1953; The
/// NURBS Book 9.4). On a periodic basis it is only necessary: uniform knots with the same, even number of data in the
/// middles of the spans are still singular.
pub fn undetermined(basis: &Basis, places: &[f64]) -> Vec<usize> {
    let places = distinct(basis, places);
    let supports = Supports::new(basis);
    if !basis.is_periodic() {
        return supports.left_over(0, &places);
    }
    // The cycle must be cut open somewhere: any function that has data at all can come first, but
    // the datum that it takes determines what is left for the last functions.
    let (from, to) = basis.domain();
    let period = to - from;
    let unrolled: Vec<f64> = [-1.0, 0.0, 1.0]
        .iter()
        .flat_map(|turn| places.iter().map(move |x| x + turn * period))
        .collect();
    let data = |function: usize| {
        let [from, to] = supports.at(function);
        let first = unrolled.partition_point(|x| *x <= from);
        first..first.max(unrolled.partition_point(|x| *x < to))
    };
    let Some(start) = (0..basis.count()).find(|function| !data(*function).is_empty()) else {
        return (0..basis.count()).collect();
    };
    let mut fewest: Option<Vec<usize>> = None;
    for first in data(start) {
        let end = (first + places.len()).min(unrolled.len());
        let left = supports.left_over(start, &unrolled[first..end]);
        if fewest.as_ref().is_none_or(|fewest| left.len() < fewest.len()) {
            let done = left.is_empty();
            fewest = Some(left);
            if done {
                break;
            }
        }
    }
    fewest.unwrap_or_default()
}

/// The distinct positions, wrapped and in order.
fn distinct(basis: &Basis, places: &[f64]) -> Vec<f64> {
    let (from, to) = basis.domain();
    let mut places: Vec<f64> = places.iter().map(|x| basis.wrapped(*x)).collect();
    places.sort_by(f64::total_cmp);
    places.dedup_by(|next, last| *next - *last < ONE_PLACE * (to - from));
    places
}

/// The supports of the functions.
struct Supports<'a> {
    knots: &'a [f64],
    count: usize,
    /// The period; 0 if clamped.
    period: f64,
}

impl Supports<'_> {
    fn new(basis: &Basis) -> Supports<'_> {
        let (from, to) = basis.domain();
        let period = if basis.is_periodic() { to - from } else { 0.0 };
        Supports { knots: basis.knots(), count: basis.count(), period }
    }

    /// The open support of a function; indices beyond the last function continue one period later.
    fn at(&self, function: usize) -> [f64; 2] {
        let (turn, function) = (function / self.count, function % self.count);
        let shift = turn as f64 * self.period;
        [self.knots[function] + shift, self.knots[function + DEGREE + 1] + shift]
    }

    /// The functions, from `start` once around, that get none of the ascending `places` when each
    /// takes the first one left.
    fn left_over(&self, start: usize, places: &[f64]) -> Vec<usize> {
        let mut left = Vec::new();
        let mut free = places.iter().copied().peekable();
        for function in start..start + self.count {
            let [from, to] = self.at(function);
            // At a clamped end the outermost function is nonzero.
            let first = self.period == 0.0 && function == 0;
            let last = self.period == 0.0 && function + 1 == self.count;
            while free.next_if(|x| *x < from || (*x == from && !first)).is_some() {}
            if free.next_if(|x| *x < to || (*x == to && last)).is_none() {
                left.push(function % self.count);
            }
        }
        left.sort_unstable();
        left
    }
}
