//! Finds the points of a grid that do not belong to the surface, and moves them onto it.
//!
//! A point is judged by the difference of its residual from its neighbours' residuals: where a
//! surface is too stiff for a malleolus, all residuals are large but similar. The reference fit
//! always uses the same equations: points that stand out are moved towards the surface and fitted
//! again, first with Huber's weights, which work from any start, then with Tukey's
//! (Huber, Robust Statistics, 1981); the neighbours and the last step are our own.

use nalgebra::{Point3, Vector3};

use super::given::{GridData, surface};
use crate::basis::Basis;
use crate::least_squares::LeastSquares;
use crate::robust::{biweights, scale};
use crate::surface::SurfaceFault;

/// Huber's weights begin to decrease beyond this many standard deviations; 96 % efficiency with
/// normal errors (Huber, Robust Statistics, 1981).
const HUBER: f64 = 1.5;

/// The minimum standard deviation, as a share of the grid's extent: the size of rounding errors.
const LEAST_SCALE: f64 = 1e-12;

/// Maximum number of rounds with each of the weightings.
const ROUNDS_MAX: usize = 30;

/// Points that move by less than this share of a standard deviation have converged.
const SETTLED: f64 = 1e-2;

/// A grid without its outliers.
#[derive(Debug, Clone)]
pub struct Cleaned {
    /// The points; the outliers lie on the surface.
    pub points: Vec<Point3<f64>>,
    /// Indices of the outliers in the grid, ascending.
    pub outliers: Vec<usize>,
}

/// Weights of residuals, given a minimum for their standard deviation.
type Weighing = fn(&[f64], f64) -> Vec<f64>;

/// The grid without the points that deviate by more than 4.7 standard deviations from the surface
/// of these equations. `start` are the initial points: the data or an earlier result.
///
/// # Errors
/// As [`crate::Surface::new`].
pub fn cleaned(
    data: &GridData,
    solver: &[LeastSquares; 2],
    bases: [&Basis; 2],
    start: &[Point3<f64>],
) -> Result<Cleaned, SurfaceFault> {
    let grid = Neighbours::new(data, bases[1]);
    let least = LEAST_SCALE * extent(data.points);
    let mut points = start.to_vec();
    let mut last = (Vec::new(), Vec::new());
    for weigh in [hubers as Weighing, biweights] {
        for _ in 0..ROUNDS_MAX {
            let surface = surface(solver, &points, bases[0].clone(), bases[1].clone())?;
            let fitted = surface.grid(data.along, data.around);
            let out = grid.standing_out(data.points, &fitted);
            let weights = weigh(&out, least);
            let next = drawn(data.points, &fitted, &weights);
            let moved = points.iter().zip(&next).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
            (points, last) = (next, (fitted, weights));
            if moved < SETTLED * scale(&out, least) {
                break;
            }
        }
    }
    // Points with some weight count fully, because partly moved points would make the noise appear
    // smaller.
    let (fitted, weights) = last;
    let whole: Vec<f64> = weights.iter().map(|w| if *w > 0.0 { 1.0 } else { 0.0 }).collect();
    let outliers = (0..whole.len()).filter(|i| whole[*i] == 0.0).collect();
    Ok(Cleaned { points: drawn(data.points, &fitted, &whole), outliers })
}

/// Moves the points towards the surface according to their missing weight.
fn drawn(points: &[Point3<f64>], fitted: &[Point3<f64>], weights: &[f64]) -> Vec<Point3<f64>> {
    let pairs = points.iter().zip(fitted).zip(weights);
    pairs.map(|((point, fit), weight)| fit + *weight * (point - fit)).collect()
}

/// The neighbours of the points of a grid.
struct Neighbours {
    /// Rows and columns in ascending order of their parameters.
    rows: Vec<usize>,
    columns: Vec<usize>,
}

impl Neighbours {
    fn new(data: &GridData, around: &Basis) -> Neighbours {
        let order = |places: &[f64]| {
            let mut order: Vec<usize> = (0..places.len()).collect();
            order.sort_by(|a, b| places[*a].total_cmp(&places[*b]));
            order
        };
        let home: Vec<f64> = data.around.iter().map(|v| around.wrapped(*v)).collect();
        Neighbours { rows: order(data.along), columns: order(&home) }
    }

    /// Distance of each point's residual from the median of its neighbours' residuals, mm.
    fn standing_out(&self, points: &[Point3<f64>], fitted: &[Point3<f64>]) -> Vec<f64> {
        let left: Vec<Vector3<f64>> = points.iter().zip(fitted).map(|(a, b)| a - b).collect();
        let (rows, columns) = (self.rows.len(), self.columns.len());
        let place = |i: usize, j: usize| self.rows[i] * columns + self.columns[j % columns];
        let mut out = vec![0.0; left.len()];
        for i in 0..rows {
            for j in 0..columns {
                let near = (i.saturating_sub(1)..(i + 2).min(rows))
                    .flat_map(|a| [(a, j + columns - 1), (a, j), (a, j + 1)]);
                let near = near.filter(|at| *at != (i, j)).map(|(a, b)| left[place(a, b)]);
                out[place(i, j)] = (left[place(i, j)] - median(&near.collect::<Vec<_>>())).norm();
            }
        }
        out
    }
}

/// The median of each coordinate.
fn median(vectors: &[Vector3<f64>]) -> Vector3<f64> {
    Vector3::from_fn(|axis, _| {
        let mut values: Vec<f64> = vectors.iter().map(|vector| vector[axis]).collect();
        values.sort_by(f64::total_cmp);
        let (low, high) = ((values.len() - 1) / 2, values.len() / 2);
        0.5 * (values[low] + values[high])
    })
}

/// Huber's weights: the weight decreases as a residual exceeds the limit.
fn hubers(sizes: &[f64], least: f64) -> Vec<f64> {
    let reach = HUBER * scale(sizes, least);
    sizes.iter().map(|size| (reach / size).min(1.0)).collect()
}

/// The longest edge of the points' bounding box.
fn extent(points: &[Point3<f64>]) -> f64 {
    let lowest = points.iter().fold(Vector3::repeat(f64::MAX), |low, p| low.inf(&p.coords));
    let highest = points.iter().fold(Vector3::repeat(f64::MIN), |high, p| high.sup(&p.coords));
    (highest - lowest).max()
}
