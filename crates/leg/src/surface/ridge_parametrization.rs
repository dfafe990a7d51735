//! The grid's columns: one sequence for all sections, bent along the leg so that a ridge keeps its
//! column (the open problem of paper 2: "a common sequence of angles").
//!
//! Column v lies at the angle v + δ(along, v). On a ridge δ is the ridge's own angle minus its mean
//! angle; between ridges, and above and below them, it fades smoothly. Because δ is as smooth as
//! the surface, bending the columns adds no kinks.

use std::f64::consts::{PI, TAU};

use gaiter_spline::solve::Singular;
use gaiter_spline::{Basis, FitFault, Row, Tensor};
use nalgebra::{DMatrix, DVector};

use super::ridge::Ridge;

/// Length of the pieces of δ along the leg, mm: ridges keep their slope for longer than that.
const INTERVAL_MM: f64 = 60.0;

/// Pieces of δ around, 30° each: ridges are further apart.
const INTERVALS_AROUND: usize = 12;

/// Weights of δ's curvature along, of its change around and of its size, from one coefficient to
/// the next. Each point of a ridge has weight 1 and there are about ten per coefficient, so a ridge
/// is followed, and its influence fades over some 60° and 100 mm.
const BEND: f64 = 1.0;
const CHANGE: f64 = 0.3;
const SIZE: f64 = 0.1;

/// The distance between neighbouring columns may change by at most this share; if ridges would
/// change it more, all of δ is reduced.
const STRAIN_MAX: f64 = 0.5;

/// Factor by which δ is reduced per step if it strains the columns too much.
const LESSENED: f64 = 0.8;

/// Number of positions along and around at which the strain is evaluated.
const STRAIN_PLACES: [usize; 2] = [20, 72];

/// Maximum number of steps, enough for any columns even if each step only halves the error …
const INVERSE_STEPS: usize = 24;

/// … and the step size, in radians, that ends the iteration early: 5 nm on the skin.
const INVERSE_REST: f64 = 1e-7;

/// The positions of the columns of a leg.
#[derive(Debug, Clone)]
pub struct Columns {
    /// δ in radians over (along in mm, v in radians).
    bend: Tensor,
}

impl Columns {
    /// Columns over a range along the axis that follow the ridges.
    ///
    /// # Errors
    /// A [`FitFault`] if the range is empty.
    pub fn following(ridges: &[Ridge], from_mm: f64, to_mm: f64) -> Result<Columns, FitFault> {
        let intervals = ((to_mm - from_mm) / INTERVAL_MM).ceil().max(1.0) as usize;
        let along = Basis::uniform_clamped(from_mm, to_mm, intervals)?;
        let around = Basis::uniform_periodic(-PI, TAU, INTERVALS_AROUND)?;
        let [rows, columns] = [along.count(), around.count()];
        let mut system = Equations::new(rows * columns);
        let at = |i: usize, j: usize| i * columns + j % columns;
        for i in 0..rows {
            for j in 0..columns {
                system.add(&[(at(i, j), SIZE)], 0.0);
                system.add(&[(at(i, j), -CHANGE), (at(i, j + 1), CHANGE)], 0.0);
                if (1..rows - 1).contains(&i) {
                    let bend =
                        [(at(i - 1, j), BEND), (at(i, j), -2.0 * BEND), (at(i + 1, j), BEND)];
                    system.add(&bend, 0.0);
                }
            }
        }
        for ridge in ridges {
            let v = around.row(ridge.angle());
            for place in &ridge.places {
                let u = along.row(place.along_mm);
                let mut terms = [(0, 0.0); 16];
                let shares = u.indices.into_iter().zip(u.values).flat_map(|(i, a)| {
                    v.indices.into_iter().zip(v.values).map(move |(j, b)| (at(i, j), a * b))
                });
                terms.iter_mut().zip(shares).for_each(|(term, share)| *term = share);
                system.add(&terms, place.angle - ridge.angle());
            }
        }
        let mut coefficients = system.solved()?;
        let columns = |coefficients: &[f64]| Columns {
            bend: Tensor::new(along.clone(), around.clone(), coefficients.to_vec()),
        };
        let mut bent = columns(&coefficients);
        while bent.strain() > STRAIN_MAX {
            coefficients.iter_mut().for_each(|value| *value *= LESSENED);
            bent = columns(&coefficients);
        }
        Ok(bent)
    }

    /// The angle of column `v` at a distance along the axis, radians.
    pub fn angle(&self, along_mm: f64, v: f64) -> f64 {
        v + self.bend.value(along_mm, v)
    }

    /// The column at an angle, radians in [−π, π).
    pub fn column(&self, along_mm: f64, angle: f64) -> f64 {
        self.at(along_mm)(angle)
    }

    /// The function from an angle to its column, radians in [−π, π), at one distance along the axis.
    pub fn at(&self, along_mm: f64) -> impl Fn(f64) -> f64 {
        let bend = self.bend_at(along_mm);
        let around = self.bend.around();
        move |angle| {
            let mut v = angle;
            for _ in 0..INVERSE_STEPS {
                let [value, slope] = around.value_and_slope(v, &bend);
                // δ changes by at most half of v's change, so the slope of the angle is at least a half.
                let step = (v + value - angle) / (1.0 + slope);
                v -= step;
                if step.abs() < INVERSE_REST {
                    break;
                }
            }
            home(v)
        }
    }

    /// The function from a column to its angle, radians, at one distance along the axis.
    pub(super) fn angles_at(&self, along_mm: f64) -> impl Fn(f64) -> f64 {
        let bend = self.bend_at(along_mm);
        let around = self.bend.around();
        move |v| v + around.row(v).dot(&bend)
    }

    /// The coefficients of δ at one distance along the axis.
    fn bend_at(&self, along_mm: f64) -> [f64; INTERVALS_AROUND] {
        let mut bend = [0.0; INTERVALS_AROUND];
        self.bend.add_around_at(along_mm, &mut bend);
        bend
    }

    /// The largest relative change of the distance between neighbouring columns.
    fn strain(&self) -> f64 {
        let (from_mm, to_mm) = self.bend.along().domain();
        let [rows, columns] = STRAIN_PLACES;
        let step = TAU / columns as f64;
        let places: Vec<Row> =
            (0..=columns).map(|j| self.bend.around().row(-PI + step * j as f64)).collect();
        let strain = |i: usize| {
            let bend = self.bend_at(from_mm + (to_mm - from_mm) * i as f64 / rows as f64);
            let change = |pair: &[Row]| ((pair[1].dot(&bend) - pair[0].dot(&bend)) / step).abs();
            places.windows(2).map(change).fold(0.0, f64::max)
        };
        (0..=rows).map(strain).fold(0.0, f64::max)
    }
}

/// The equivalent angle in [−π, π).
fn home(angle: f64) -> f64 {
    // Most are there already, and a remainder takes as long as a column.
    if (-PI..PI).contains(&angle) { angle } else { (angle + PI).rem_euclid(TAU) - PI }
}

/// Normal equations of a small least-squares problem, accumulated term by term.
struct Equations {
    gram: DMatrix<f64>,
    moments: DVector<f64>,
}

impl Equations {
    fn new(unknowns: usize) -> Equations {
        Equations { gram: DMatrix::zeros(unknowns, unknowns), moments: DVector::zeros(unknowns) }
    }

    /// Adds one equation: the sum of the terms equals `value`.
    fn add(&mut self, terms: &[(usize, f64)], value: f64) {
        for (i, a) in terms {
            self.moments[*i] += a * value;
            for (j, b) in terms {
                self.gram[(*i, *j)] += a * b;
            }
        }
    }

    fn solved(self) -> Result<Vec<f64>, Singular> {
        let singular = Singular { row: 0, relative_pivot: 0.0 };
        let factor = self.gram.cholesky().ok_or(singular)?;
        Ok(factor.solve(&self.moments).as_slice().to_vec())
    }
}
