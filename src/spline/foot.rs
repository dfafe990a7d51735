//! The point of a surface nearest to a given point: safeguarded Newton steps from a first guess.

use nalgebra::{Matrix2, Point3, Vector2};

use super::surface::{Derivatives, Surface};

/// Where a surface comes closest to a point, near a first guess.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Parameter along, within the domain.
    pub u: f64,
    /// Parameter around, within one period from the start of the domain.
    pub v: f64,
    /// Distance from the point, mm, not negative.
    pub distance_mm: f64,
    /// Whether the steps came to rest; otherwise the foot is merely the best place found.
    pub converged: bool,
    /// Whether the foot lies on the first or last row, so that the distance need not be square to
    /// the surface.
    pub at_end: bool,
}

/// Newton needs 3 to 6 steps from a guess within a knot interval.
const MOST_STEPS: usize = 50;

/// A step that would move the foot by less than this is rest. Coordinates are millimetres.
const REST_MM: f64 = 1e-9;

/// Distances closer than this are equal: what rounding leaves of coordinates of some metres.
const ROUNDING_MM: f64 = 1e-12;

/// The longest step, as a fraction of the domain in either direction, so that the search does not
/// leap into another valley.
const LONGEST_STEP: f64 = 0.125;

impl Surface {
    /// The point of the surface nearest to `point`, mm, searched downhill from `u0`, `v0`: a local
    /// minimum of the distance. Steps wrap across the seam and stop at the end rows. Source: The
    /// NURBS Book 6.1, with Gauss-Newton where the Hessian is not positive and step halving.
    pub fn closest(&self, point: &Point3<f64>, u0: f64, v0: f64) -> Foot {
        let (first, last) = self.along().domain();
        let mut here = Place::at(self, point, u0.clamp(first, last), v0);
        let mut converged = false;
        for _ in 0..MOST_STEPS {
            let step = here.step(first, last);
            let Some(next) = self.improved(point, &here, step) else { break };
            let Derivatives { du, dv, .. } = here.derivatives;
            converged = (du * step.x + dv * step.y).norm() < REST_MM;
            here = next;
            if converged {
                break;
            }
        }
        let (start, end) = self.around().domain();
        let v = start + (here.v - start).rem_euclid(end - start);
        let at_end = here.u <= first || here.u >= last;
        Foot { u: here.u, v, distance_mm: here.distance_mm, converged, at_end }
    }

    /// The first of ever shorter steps that does not lead away from the point.
    fn improved(&self, point: &Point3<f64>, here: &Place, step: Vector2<f64>) -> Option<Place> {
        let (first, last) = self.along().domain();
        let (start, end) = self.around().domain();
        let clip =
            |step: f64, domain: f64| step.clamp(-LONGEST_STEP * domain, LONGEST_STEP * domain);
        let (du, dv) = (clip(step.x, last - first), clip(step.y, end - start));
        (0..30).map(|halvings| 0.5_f64.powi(halvings)).find_map(|share| {
            let u = (here.u + share * du).clamp(first, last);
            let place = Place::at(self, point, u, here.v + share * dv);
            (place.distance_mm <= here.distance_mm + ROUNDING_MM).then_some(place)
        })
    }
}

/// A place on the surface, seen from the point.
struct Place {
    u: f64,
    v: f64,
    distance_mm: f64,
    derivatives: Derivatives,
    /// Half the gradient of the squared distance.
    gradient: Vector2<f64>,
    /// Half its Hessian.
    hessian: Matrix2<f64>,
    /// The part of the Hessian that is never negative.
    gauss_newton: Matrix2<f64>,
}

impl Place {
    fn at(surface: &Surface, point: &Point3<f64>, u: f64, v: f64) -> Place {
        let derivatives = surface.derivatives(u, v);
        let Derivatives { du, dv, duu, duv, dvv, .. } = derivatives;
        let away = derivatives.point - point;
        let gradient = Vector2::new(away.dot(&du), away.dot(&dv));
        let mixed = du.dot(&dv);
        let gauss_newton = Matrix2::new(du.norm_squared(), mixed, mixed, dv.norm_squared());
        let bend = Matrix2::new(away.dot(&duu), away.dot(&duv), away.dot(&duv), away.dot(&dvv));
        let hessian = gauss_newton + bend;
        Place { u, v, distance_mm: away.norm(), derivatives, gradient, hessian, gauss_newton }
    }

    /// The step downhill; along an end row where the way down leads out of the domain.
    fn step(&self, first: f64, last: f64) -> Vector2<f64> {
        let leaves = |du: f64| (self.u <= first && du < 0.0) || (self.u >= last && du > 0.0);
        let free = newton(&self.hessian, &self.gauss_newton, &self.gradient);
        if !leaves(free.x) {
            return free;
        }
        let curvature = self.hessian.m22;
        let curvature = if curvature > 0.0 { curvature } else { self.gauss_newton.m22 };
        Vector2::new(0.0, -self.gradient.y / curvature.max(f64::MIN_POSITIVE))
    }
}

/// The Newton step, or the Gauss-Newton step where Newton would climb.
fn newton(
    hessian: &Matrix2<f64>,
    gauss_newton: &Matrix2<f64>,
    gradient: &Vector2<f64>,
) -> Vector2<f64> {
    let positive = |matrix: &&Matrix2<f64>| {
        matrix.m11 > 0.0 && matrix.determinant() > 1e-12 * matrix.m11 * matrix.m22.abs()
    };
    let usable = [hessian, gauss_newton].into_iter().find(positive);
    let inverse = usable.and_then(|matrix| matrix.try_inverse());
    // Where the tangents are parallel there is no better guess than straight downhill.
    inverse.map_or(-gradient / gauss_newton.trace().max(f64::MIN_POSITIVE), |inverse| {
        -(inverse * gradient)
    })
}
