//! Where the mean radius steps: every height, every lean, by one sum over a window.

use nalgebra::{SMatrix, SVector};

use super::rows::{BELOW_MIN, Lean, ROW_MM, Rows, WINDOW_ROWS};
use super::step::{inverse, logistic, with_cubic};

/// No edge is looked for within these distances of the ends of the span, mm: instep and groin.
const ENDS_MM: [f64; 2] = [15.0, 30.0];

/// Edges of one kind are at least this many rows apart, 25 mm.
pub(super) const APART: usize = 10;

/// This many places are looked at closely, the clearest: nobody wears more than a few edges, but folds of a scan
/// without noise have dozens.
const PLACES_MAX: usize = 8;

/// How an edge is looked for.
pub(super) struct Search {
    /// Scale of the step's logistic curve, mm: from 10 to 90 % it takes 4.4 of them.
    pub(super) scale_mm: f64,
    /// Rows on each side.
    pub(super) half: usize,
    /// The least step, mm: smooth bodies without noise show up to 0.3 and 1.1 mm.
    pub(super) step_min_mm: f64,
    /// … and in its standard errors: there are some 4 000 places and leans on a leg.
    pub(super) step_min_sds: f64,
}

/// A sharp edge: up to 8 mm wide.
pub(super) const SHARP: Search =
    Search { scale_mm: 1.2, half: 12, step_min_mm: 1.2, step_min_sds: 6.0 };

/// A soft one, such as that of padding, or one that waves.
pub(super) const SOFT: Search =
    Search { scale_mm: 4.0, half: WINDOW_ROWS, step_min_mm: 1.2, step_min_sds: 4.5 };

impl Rows {
    /// Where the mean radius steps, as the row above and the lean of the plane, clearest first.
    pub(super) fn places(
        &self,
        search: &Search,
        means: &[(Lean, Vec<(f64, f64)>)],
    ) -> Vec<(usize, Lean)> {
        let filters = Filter::all(search);
        let [lowest, from_top] = ENDS_MM.map(|mm| (mm / ROW_MM) as usize);
        let highest = self.cells.len().saturating_sub(from_top.max(search.half));
        // The clearest lean at each row.
        let mut best: Vec<(f64, Lean)> = vec![(0.0, [0.0; 2]); highest];
        for (lean, means) in means {
            for (border, best) in best.iter_mut().enumerate().skip(lowest) {
                let below = border.min(search.half);
                let window = &means[border - below..border + search.half];
                let Some(filter) = filters.get(below.saturating_sub(BELOW_MIN)) else { continue };
                let sds = filter.sds(window, self.noise_mm, search);
                if sds > best.0 {
                    *best = (sds, *lean);
                }
            }
        }
        clearest(best)
    }
}

/// The clearest rows and their leans, apart from each other.
fn clearest(mut best: Vec<(f64, Lean)>) -> Vec<(usize, Lean)> {
    let mut places = Vec::new();
    loop {
        let rows = best.iter().enumerate().filter(|(_, (sds, _))| *sds > 0.0);
        let Some((row, &(_, lean))) = rows.max_by(|(_, a), (_, b)| a.0.total_cmp(&b.0)) else {
            return places;
        };
        places.push((row, lean));
        if places.len() == PLACES_MAX {
            return places;
        }
        let near = row.saturating_sub(APART)..(row + APART + 1).min(best.len());
        best[near].iter_mut().for_each(|(sds, _)| *sds = 0.0);
    }
}

/// A fixed sum of the means of a window that is the height of the step between their halves, in least squares of a
/// cubic and a step.
struct Filter {
    factors: Vec<f64>,
    shapes: Vec<SVector<f64, 5>>,
    /// The inverse of the normal matrix.
    inverse: SMatrix<f64, 5, 5>,
}

impl Filter {
    /// Filters with ever more rows below, from the fewest.
    fn all(search: &Search) -> Vec<Filter> {
        let filter = |below: usize| {
            let rows = 0..below + search.half;
            let at_mm = |row: usize| (row as f64 + 0.5 - below as f64) * ROW_MM;
            let shapes: Vec<SVector<f64, 5>> = rows
                .map(|row| with_cubic(at_mm(row), [logistic(at_mm(row), search.scale_mm)]))
                .collect();
            let inverse = inverse(shapes.iter().map(|shape| (*shape, 1.0)))?;
            let factor = |shape: &SVector<f64, 5>| (inverse * shape)[4];
            Some(Filter { factors: shapes.iter().map(factor).collect(), shapes, inverse })
        };
        (BELOW_MIN..=search.half).filter_map(filter).collect()
    }

    /// How many standard errors the step of a window of (mean, count) has; 0 if that is no step to look for.
    fn sds(&self, window: &[(f64, f64)], noise_mm: f64, search: &Search) -> f64 {
        let (mut step_mm, mut variance) = (0.0, 0.0);
        for (factor, (mean, count)) in self.factors.iter().zip(window) {
            step_mm += factor * mean;
            // A row without points is as uncertain as half a point.
            variance += factor * factor / count.max(0.5);
        }
        let sds = |scatter_mm: f64| step_mm.abs() / (scatter_mm * variance.sqrt());
        if step_mm.abs() < search.step_min_mm || sds(noise_mm) < search.step_min_sds {
            return 0.0;
        }
        // The cubic may describe the leg worse than noise allows.
        let sds = sds(self.scatter_mm(window).max(noise_mm));
        if sds < search.step_min_sds { 0.0 } else { sds }
    }

    /// How far single points would scatter if the description were right, mm.
    fn scatter_mm(&self, window: &[(f64, f64)]) -> f64 {
        let rows = || self.shapes.iter().zip(window);
        let moments: SVector<f64, 5> = rows().map(|(shape, (mean, _))| shape * *mean).sum();
        let coefficients = self.inverse * moments;
        let misfit =
            rows().map(|(shape, (mean, count))| count * (mean - shape.dot(&coefficients)).powi(2));
        let freedom = window.len().saturating_sub(5).max(1) as f64;
        (misfit.sum::<f64>() / freedom).sqrt()
    }
}
