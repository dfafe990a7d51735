//! Curvature of a surface.

use super::surface::{Derivatives, Surface};

/// The curvature of a surface at one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvatures {
    /// Product of the principal curvatures, 1/mm²: positive on a bump or in a hollow, negative on a
    /// saddle, 0 on a cylinder.
    pub gauss: f64,
    /// Mean of the principal curvatures, 1/mm, positive where the surface is convex as seen from
    /// outside: 1 / (2 r) on a cylinder of radius r.
    pub mean: f64,
}

impl Surface {
    /// The curvatures at `u`, clamped to the domain, and `v`, wrapped, with respect to
    /// [`Surface::normal`]. `None` if there is no normal. Source: do Carmo, Differential Geometry
    /// of Curves and Surfaces, 3-3.
    pub fn curvatures(&self, u: f64, v: f64) -> Option<Curvatures> {
        let at = self.derivatives(u, v);
        let normal = at.normal()?;
        let Derivatives { du, dv, duu, duv, dvv, .. } = at;
        let (e, f, g) = (du.dot(&du), du.dot(&dv), dv.dot(&dv));
        // Negated, so that convex as seen from outside is positive.
        let [l, m, n] = [duu, duv, dvv].map(|second| -second.dot(&normal));
        let area = e * g - f * f;
        let mean = (e * n - 2.0 * f * m + g * l) / (2.0 * area);
        Some(Curvatures { gauss: (l * n - m * m) / area, mean })
    }
}
