//! A preconditioner for conjugate gradients: what the equations would be if the data were spread evenly
//! around, with the same weight along as they have. Each wave around then has equations of its own, a narrow
//! band along the leg. Where the data are denser or sparser, rows and columns are scaled so that the
//! diagonal is the true one; that saves a third of the steps.

use nalgebra::DMatrix;

use super::circle::Circle;
use super::kronecker::Direction;
use crate::basis::DEGREE;

/// Added to the equations of each wave, as a share of the Gram matrix of even data, so that a range without
/// data leaves no wave undetermined.
const RIDGE: f64 = 1e-9;

/// The equations of all waves, factored.
pub struct Preconditioner<'a> {
    circle: &'a Circle,
    /// For each function along and each of the band's four entries, the factors of all wave numbers: first
    /// one over the diagonal, then those of the three functions after it.
    factors: Vec<[Vec<f64>; DEGREE + 1]>,
    /// The square root of the even diagonal over the true one, around × along.
    scale: DMatrix<f64>,
}

/// The equations to be approximated.
pub struct Evenly<'a> {
    /// The direction along.
    pub along: &'a Direction,
    /// The direction around.
    pub circle: &'a Circle,
    /// Gram matrix of the data along, for each function itself and the three after it, divided by the number
    /// of pieces around.
    pub data: Vec<[f64; DEGREE + 1]>,
    /// Weight of the data per cell.
    pub density: f64,
    /// Smoothing along and around.
    pub lambdas: [f64; 2],
}

impl<'a> Preconditioner<'a> {
    /// The Cholesky factors of the equations of each wave; `diagonal` is that of the true equations,
    /// around × along.
    pub fn new(of: Evenly<'a>, diagonal: &DMatrix<f64>) -> Preconditioner<'a> {
        let Evenly { along, circle, data, density, lambdas } = of;
        let (mass, gram) = (circle.mass(), circle.eigenvalues(&circle.gram));
        let rough = circle.eigenvalues(&circle.roughness);
        let mut factors: Vec<[Vec<f64>; DEGREE + 1]> = Vec::with_capacity(data.len());
        let mut scale = diagonal.clone();
        for (i, own) in data.iter().enumerate() {
            let mut row: [Vec<f64>; DEGREE + 1] = std::array::from_fn(|ahead| {
                let Some(rough_along) = along.roughness.get((i + ahead, i)) else {
                    return vec![0.0; mass.len()];
                };
                let bend = density * lambdas[0] * rough_along;
                let even = density * along.gram[(i + ahead, i)];
                let waves = mass.iter().zip(&gram).zip(&rough);
                let entry = |((mass, gram), rough): ((&f64, &f64), &f64)| {
                    own[ahead] * mass + bend * gram + even * (lambdas[1] * rough + RIDGE)
                };
                waves.map(entry).collect()
            });
            let even = mean(circle, &row[0]);
            scale.column_mut(i).apply(|own| *own = (even / own.max(f64::MIN_POSITIVE)).sqrt());
            for back in 1..=DEGREE.min(i) {
                let before = &factors[i - back];
                for ahead in 0..=DEGREE - back {
                    let known = before[back].iter().zip(&before[back + ahead]);
                    row[ahead].iter_mut().zip(known).for_each(|(own, (a, b))| *own -= a * b);
                }
            }
            let [diagonal, others @ ..] = &mut row;
            diagonal.iter_mut().for_each(|own| *own = 1.0 / own.max(f64::MIN_POSITIVE).sqrt());
            for other in others {
                other.iter_mut().zip(diagonal.iter()).for_each(|(own, per)| *own *= per);
            }
            factors.push(row);
        }
        Preconditioner { circle, factors, scale }
    }

    /// The solution of these equations; around × along.
    pub fn solved(&self, of: &DMatrix<f64>) -> DMatrix<f64> {
        let mut waves = self.circle.waves(&of.component_mul(&self.scale));
        let (count, height) = waves.shape();
        let values = waves.as_mut_slice();
        for i in 0..height {
            let (done, own) = values.split_at_mut(i * count);
            let own = &mut own[..count];
            for back in 1..=DEGREE.min(i) {
                let before = &done[(i - back) * count..(i - back + 1) * count];
                self.subtract(own, before, &self.factors[i - back][back]);
            }
            self.multiply(own, &self.factors[i][0]);
        }
        for i in (0..height).rev() {
            let (own, after) = values.split_at_mut((i + 1) * count);
            let own = &mut own[i * count..];
            for ahead in 1..=DEGREE.min(height - 1 - i) {
                let next = &after[(ahead - 1) * count..ahead * count];
                self.subtract(own, next, &self.factors[i][ahead]);
            }
            self.multiply(own, &self.factors[i][0]);
        }
        let mut columns = self.circle.columns(&waves);
        columns.component_mul_assign(&self.scale);
        columns
    }

    /// Subtracts the products of waves with the factors of their wave numbers.
    fn subtract(&self, own: &mut [f64], waves: &[f64], factors: &[f64]) {
        let (cosines, sines) = own.split_at_mut(factors.len());
        let (other_cosines, other_sines) = waves.split_at(factors.len());
        for (own, (wave, factor)) in cosines.iter_mut().zip(other_cosines.iter().zip(factors)) {
            *own -= factor * wave;
        }
        for (own, (wave, factor)) in sines.iter_mut().zip(other_sines.iter().zip(&factors[1..])) {
            *own -= factor * wave;
        }
    }

    /// Multiplies waves by the factors of their wave numbers.
    fn multiply(&self, own: &mut [f64], factors: &[f64]) {
        let (cosines, sines) = own.split_at_mut(factors.len());
        cosines.iter_mut().zip(factors).for_each(|(own, factor)| *own *= factor);
        sines.iter_mut().zip(&factors[1..]).for_each(|(own, factor)| *own *= factor);
    }
}

/// The mean of what the wave numbers have, over all waves: a circulant's diagonal, from its eigenvalues.
fn mean(circle: &Circle, of: &[f64]) -> f64 {
    let sum: f64 = of.iter().enumerate().map(|(k, of)| circle.multiplicity(k) as f64 * of).sum();
    sum / circle.count() as f64
}
