//! The point of a surface nearest to a given point: safeguarded Newton steps from a first guess.

use nalgebra::{Matrix2, Point3, Vector2};

use super::surface::{Derivatives, Surface};

/// The point where a surface is closest to a given point, near an initial guess.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Parameter along, within the domain.
    pub u: f64,
    /// Parameter around, within one period from the start of the domain.
    pub v: f64,
    /// Distance from the point, mm, not negative.
    pub distance_mm: f64,
}

/// Newton needs 3 to 6 steps from a guess within a knot interval.
const MOST_STEPS: usize = 50;

/// A step that would move the foot by less than this counts as converged. Coordinates are millimetres.
const REST_MM: f64 = 1e-9;

/// A step need not be taken to know the distance after it, to 5e-5 mm, a twentieth of the last digit of a
/// record, if it is this short, mm …
const FORESEEN_MM: f64 = 1e-2;

/// … or if its square is less than this times the distance, mm, because what is not known of the squared
/// distance grows with the fourth power of the step …
const FORESEEN_PER_DISTANCE_MM: f64 = 0.1;

/// … up to this length, mm.
const FORESEEN_MOST_MM: f64 = 0.1;

/// Distances closer than this are equal: the rounding error for coordinates of some metres.
const ROUNDING_MM: f64 = 1e-12;

impl Surface {
    /// The point of the surface nearest to `point`, mm, searched downhill from `u0`, `v0`: a local
    /// minimum of the distance. Steps wrap across the seam and stop at the end rows. Source: The
    /// NURBS Book 6.1, with inverted negative curvatures and step halving.
    pub fn closest(&self, point: &Point3<f64>, u0: f64, v0: f64) -> Foot {
        let (first, last) = self.along().domain();
        let start = SurfacePosition::at(self, point, u0.clamp(first, last), v0);
        let (here, _) = self.downhill(point, start, |_| REST_MM);
        let v = self.around().wrapped(here.v);
        Foot { u: here.u, v, distance_mm: here.distance_mm }
    }

    /// Only the distance that [`Surface::closest`] finds, to 5e-5 mm, in half the time. `derivatives` are
    /// the surface's at `u0`, within the domain, and `v0`, where the search begins.
    pub fn distance_mm(
        &self,
        point: &Point3<f64>,
        [u0, v0]: [f64; 2],
        derivatives: Derivatives,
    ) -> f64 {
        let (first, last) = self.along().domain();
        let start = SurfacePosition::new(point, u0, v0, derivatives);
        let (here, step) = self.downhill(point, start, SurfacePosition::foreseen_mm);
        match step {
            Some(step) if (first..=last).contains(&(here.u + step.x)) => {
                here.distance_after_mm(step)
            }
            _ => self.closest(point, here.u, here.v).distance_mm,
        }
    }

    /// The position from which the next step would move the foot by less than `rest_mm` of it, and that
    /// step, which is not taken; if the steps do not converge, the best position found, and `None`.
    fn downhill(
        &self,
        point: &Point3<f64>,
        start: SurfacePosition,
        rest_mm: impl Fn(&SurfacePosition) -> f64,
    ) -> (SurfacePosition, Option<Vector2<f64>>) {
        let (first, last) = self.along().domain();
        let mut here = start;
        for _ in 0..MOST_STEPS {
            let step = here.step(first, last);
            let Derivatives { du, dv, .. } = here.derivatives;
            if (du * step.x + dv * step.y).norm() < rest_mm(&here) {
                return (here, Some(step));
            }
            let Some(next) = self.improved(point, &here, step) else { break };
            here = next;
        }
        (here, None)
    }

    /// The first of ever shorter steps that does not lead away from the point.
    fn improved(
        &self,
        point: &Point3<f64>,
        here: &SurfacePosition,
        step: Vector2<f64>,
    ) -> Option<SurfacePosition> {
        let (first, last) = self.along().domain();
        (0..30).map(|halvings| 0.5_f64.powi(halvings)).find_map(|share| {
            let u = (here.u + share * step.x).clamp(first, last);
            let place = SurfacePosition::at(self, point, u, here.v + share * step.y);
            (place.distance_mm <= here.distance_mm + ROUNDING_MM).then_some(place)
        })
    }
}

/// A position on the surface relative to the point. Gradient and Hessian are those of half the squared
/// distance, for steps in mm along the tangents, so that the units of u and v do not matter.
struct SurfacePosition {
    u: f64,
    v: f64,
    distance_mm: f64,
    derivatives: Derivatives,
    /// The tangents' lengths.
    lengths: Vector2<f64>,
    gradient: Vector2<f64>,
    hessian: Matrix2<f64>,
}

impl SurfacePosition {
    fn at(surface: &Surface, point: &Point3<f64>, u: f64, v: f64) -> SurfacePosition {
        SurfacePosition::new(point, u, v, surface.derivatives(u, v))
    }

    fn new(point: &Point3<f64>, u: f64, v: f64, derivatives: Derivatives) -> SurfacePosition {
        let Derivatives { du, dv, duu, duv, dvv, .. } = derivatives;
        let lengths = Vector2::new(du.norm(), dv.norm()).map(|length| length.max(REST_MM));
        let away = derivatives.point - point;
        let gradient = Vector2::new(away.dot(&du), away.dot(&dv)).component_div(&lengths);
        let mixed = du.dot(&dv) + away.dot(&duv);
        let (first, second) = (du.dot(&du) + away.dot(&duu), dv.dot(&dv) + away.dot(&dvv));
        let hessian = Matrix2::new(first, mixed, mixed, second);
        let hessian = hessian.component_div(&(lengths * lengths.transpose()));
        SurfacePosition { u, v, distance_mm: away.norm(), derivatives, lengths, gradient, hessian }
    }

    /// The length below which a step from here need not be taken, mm.
    fn foreseen_mm(&self) -> f64 {
        let in_square = FORESEEN_PER_DISTANCE_MM * self.distance_mm;
        in_square.sqrt().clamp(FORESEEN_MM, FORESEEN_MOST_MM)
    }

    /// The distance after a Newton step within the domain, mm. The step reduces half the squared distance by
    /// half of the gradient along it; the surface's bend along the step adds the term of third order. Not
    /// counted is the third derivative of the surface, times the distance, and all of fourth order.
    fn distance_after_mm(&self, step: Vector2<f64>) -> f64 {
        let Derivatives { du, dv, duu, duv, dvv, .. } = self.derivatives;
        let gain = self.gradient.dot(&step.component_mul(&self.lengths));
        let along = du * step.x + dv * step.y;
        let bend = (duu * step.x + duv * (2.0 * step.y)) * step.x + dvv * (step.y * step.y);
        (self.distance_mm * self.distance_mm + gain + along.dot(&bend)).max(0.0).sqrt()
    }

    /// The downhill step in u and v; along the end row if it would leave the domain.
    fn step(&self, first: f64, last: f64) -> Vector2<f64> {
        let free = newton(&self.hessian, &self.gradient);
        let leaves = (self.u <= first && free.x < 0.0) || (self.u >= last && free.x > 0.0);
        let step = if leaves {
            Vector2::new(0.0, -self.gradient.y / steepness(self.hessian.m22))
        } else {
            free
        };
        step.component_div(&self.lengths)
    }
}

/// The Newton step with negative curvatures inverted, so that it always leads downhill.
fn newton(hessian: &Matrix2<f64>, gradient: &Vector2<f64>) -> Vector2<f64> {
    let (trace, determinant) = (hessian.trace(), hessian.determinant());
    // The smaller of two positive curvatures exceeds their product divided by their sum: if that is
    // steep enough, no curvature needs to be inverted.
    if trace > 0.0 && determinant > FLAT * trace {
        return Vector2::new(
            hessian.m12 * gradient.y - hessian.m22 * gradient.x,
            hessian.m12 * gradient.x - hessian.m11 * gradient.y,
        ) / determinant;
    }
    let eigen = hessian.symmetric_eigen();
    let along_axes = eigen.eigenvectors.transpose() * gradient;
    -(eigen.eigenvectors * along_axes.component_div(&eigen.eigenvalues.map(steepness)))
}

/// The minimum curvature to divide by. The tangents' own contribution to a curvature is 1, so this
/// only excludes curvatures that are too flat to be useful.
const FLAT: f64 = 1e-9;

fn steepness(curvature: f64) -> f64 {
    curvature.abs().max(FLAT)
}
