//! Area, volume and girths of a tube.

use nalgebra::{Point3, Vector3};

use super::basis::Row;
use super::gauss::composite;
use super::surface::{Surface, combined};

impl Surface {
    /// The area of the tube without lids, mm². Gauss-Legendre quadrature of |dv × du|, five nodes
    /// per span in each direction: on a leg whose spans are as wide as a bump, accurate to 1e-7.
    pub fn area_mm2(&self) -> f64 {
        self.integral(|_, du, dv| dv.cross(du).norm())
    }

    /// The volume of the tube closed by a lid at each end, mm³; positive if normals point outward.
    /// Exact except for rounding: the lids are cones from the middle of the end curve's control
    /// points, which equals the plane lid if the curve is planar. Source: divergence theorem.
    pub fn volume_mm3(&self) -> f64 {
        let (_, last) = self.along().domain();
        let columns = self.around().count();
        let control = self.control_points();
        let middle_of = |row: usize| middle(&control[row * columns..(row + 1) * columns]);
        // Measured from the apex of the lower lid, so that lid contributes nothing.
        let origin = middle_of(0);
        let apex = middle_of(self.along().count() - 1) - origin;
        let tube = self.integral(|point, du, dv| (point - origin).dot(&dv.cross(du)));
        let slice = |(v, weight): (f64, f64)| {
            let at = self.derivatives(last, v);
            weight * apex.dot(&(at.point - origin).cross(&at.dv)) / 2.0
        };
        let lid: f64 = composite(self.around().breakpoints()).into_iter().map(slice).sum();
        (tube + lid) / 3.0
    }

    /// Whether ∂P/∂u × ∂P/∂v points out of the tube. It points in if v runs counter-clockwise seen
    /// against the direction of u, and out for the mirror image. Independent of the frame, and of
    /// whether the ends are horizontal or plane.
    pub fn along_cross_around_is_outward(&self) -> bool {
        self.volume_mm3() < 0.0
    }

    /// The length of the closed curve at one `u`, mm; `u` is clamped to the domain. Gauss-Legendre
    /// quadrature of |dv|, five nodes per span.
    pub fn girth_mm(&self, u: f64) -> f64 {
        let nodes = composite(self.around().breakpoints());
        nodes.into_iter().map(|(v, weight)| weight * self.derivatives(u, v).dv.norm()).sum()
    }

    /// The integral over the domain of a function of the point, ∂P/∂u and ∂P/∂v.
    fn integral(&self, of: impl Fn(Point3<f64>, &Vector3<f64>, &Vector3<f64>) -> f64) -> f64 {
        let nodes = composite(self.around().breakpoints()).into_iter();
        let around: Vec<(Row, Row, f64)> = nodes
            .map(|(v, weight)| {
                let [row, slope, ..] = self.around().rows(v);
                (row, slope, weight)
            })
            .collect();
        let line = |(u, weight_u): (f64, f64)| {
            let [along, along_1, ..] = self.along().rows(u);
            let (ring, ring_1) = (self.ring(&along), self.ring(&along_1));
            let value = |(row, slope, weight_v): &(Row, Row, f64)| {
                let (point, dv) = (combined(&ring, row), combined(&ring, slope));
                weight_v * of(Point3::from(point), &combined(&ring_1, row), &dv)
            };
            weight_u * around.iter().map(value).sum::<f64>()
        };
        composite(self.along().breakpoints()).into_iter().map(line).sum()
    }
}

fn middle(points: &[Point3<f64>]) -> Point3<f64> {
    let sum = points.iter().fold(Vector3::zeros(), |sum, point| sum + point.coords);
    Point3::from(sum / points.len() as f64)
}
