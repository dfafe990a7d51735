//! The surface of a tube: clamped along, periodic around, bicubic with unit weights.

use nalgebra::{Point3, Unit, Vector3};

use super::basis::{Basis, DEGREE, Row};

/// A C2 surface P(u, v), u along and v around, closed without a seam. As a NURBS, all its weights
/// are 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    along: Basis,
    around: Basis,
    /// `along.count()` rows of `around.count()`.
    control_points: Vec<Point3<f64>>,
    /// The same with a fourth coordinate of 0, so that sums are computed for all coordinates at once.
    lanes: Vec<Lanes>,
}

/// A vector whose coordinates are computed together.
type Lanes = [f64; 4];

/// A closed curve of constant u, with its derivatives along.
#[derive(Debug, Clone)]
pub struct Line<'a> {
    around: &'a Basis,
    /// Control points of the curve and of its first two derivatives with respect to u.
    curves: [Vec<Lanes>; 3],
}

impl Line<'_> {
    /// As [`Surface::derivatives`] at this u, in a third of the time.
    pub fn derivatives(&self, v: f64) -> Derivatives {
        let (span, values) = self.around.rows_to_second(v);
        let indices = self.around.indices(span);
        let [curve, slope, bend] = &self.curves;
        let sum = |of: &[Lanes], shares: [f64; 4]| vector(blended(indices.map(|j| &of[j]), shares));
        let [value, first, second] = values;
        Derivatives {
            point: sum(curve, value).into(),
            du: sum(slope, value),
            dv: sum(curve, first),
            duu: sum(bend, value),
            duv: sum(slope, first),
            dvv: sum(curve, second),
        }
    }
}

/// Why bases and control points do not form a surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SurfaceFault {
    /// The basis along must be clamped and the one around periodic.
    #[error("the basis {direction} the surface must be {needed}")]
    WrongBasis {
        /// "along" or "around".
        direction: &'static str,
        /// "clamped" or "periodic".
        needed: &'static str,
    },
    /// There must be one control point per pair of basis functions.
    #[error("{found} control points; the bases need {along} rows of {around}")]
    WrongCount {
        /// Number of control points given.
        found: usize,
        /// Number of rows needed.
        along: usize,
        /// Number of columns needed.
        around: usize,
    },
    /// A control point is not finite.
    #[error("control point {column} of row {row} is not finite")]
    NotFinite {
        /// 0-based row along.
        row: usize,
        /// 0-based column around.
        column: usize,
    },
}

/// A point of a surface with its derivatives, in mm per unit of u and v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Derivatives {
    /// The point.
    pub point: Point3<f64>,
    /// ∂P/∂u.
    pub du: Vector3<f64>,
    /// ∂P/∂v.
    pub dv: Vector3<f64>,
    /// ∂²P/∂u².
    pub duu: Vector3<f64>,
    /// ∂²P/∂u∂v.
    pub duv: Vector3<f64>,
    /// ∂²P/∂v².
    pub dvv: Vector3<f64>,
}

impl Derivatives {
    /// The unit normal dv × du: outward if u grows upwards and v counter-clockwise seen from above.
    /// `None` if the surface has no tangent plane.
    pub fn normal(&self) -> Option<Unit<Vector3<f64>>> {
        let Derivatives { du, dv, .. } = self;
        // Relative to the tangents' own lengths, so that the unit of u and v does not matter.
        Unit::try_new(dv.cross(du), 1e-12 * du.norm() * dv.norm())
    }
}

impl Surface {
    /// A surface from its control points, row-major, one row per function along.
    ///
    /// # Errors
    /// A [`SurfaceFault`] unless `along` is clamped, `around` is periodic, and there are
    /// `along.count() × around.count()` finite control points.
    pub fn new(
        along: Basis,
        around: Basis,
        control_points: Vec<Point3<f64>>,
    ) -> Result<Surface, SurfaceFault> {
        if along.is_periodic() {
            return Err(SurfaceFault::WrongBasis { direction: "along", needed: "clamped" });
        }
        if !around.is_periodic() {
            return Err(SurfaceFault::WrongBasis { direction: "around", needed: "periodic" });
        }
        let (found, rows, columns) = (control_points.len(), along.count(), around.count());
        if found != rows * columns {
            return Err(SurfaceFault::WrongCount { found, along: rows, around: columns });
        }
        let unusable = |point: &Point3<f64>| !point.iter().all(|value| value.is_finite());
        if let Some(i) = control_points.iter().position(unusable) {
            return Err(SurfaceFault::NotFinite { row: i / columns, column: i % columns });
        }
        let lanes = control_points.iter().map(|point| [point.x, point.y, point.z, 0.0]).collect();
        Ok(Surface { along, around, control_points, lanes })
    }

    /// The clamped basis of u.
    pub fn along(&self) -> &Basis {
        &self.along
    }

    /// The periodic basis of v.
    pub fn around(&self) -> &Basis {
        &self.around
    }

    /// The control points, row-major, `along().count()` rows of `around().count()`.
    pub fn control_points(&self) -> &[Point3<f64>] {
        &self.control_points
    }

    /// The point at `u`, clamped to the domain, and `v`, wrapped.
    pub fn point(&self, u: f64, v: f64) -> Point3<f64> {
        let (along, around) = (self.along.row(u), self.around.row(v));
        let mut point = [0.0; 4];
        for (i, share) in along.indices.into_iter().zip(along.values) {
            let [own] = self.across(i, &around.indices, &[around.values]);
            point = plus(point, share, &own);
        }
        vector(point).into()
    }

    /// The points at every pair of `u` and `v`, row-major, `u.len()` rows of `v.len()`; ten times
    /// faster than the same number of calls of [`Surface::point`].
    pub fn grid(&self, u: &[f64], v: &[f64]) -> Vec<Point3<f64>> {
        let around: Vec<Row> = v.iter().map(|v| self.around.row(*v)).collect();
        let mut points = Vec::with_capacity(u.len() * v.len());
        for u in u {
            let ring = self.ring(&self.along.row(*u));
            points.extend(around.iter().map(|row| Point3::from(combined(&ring, row))));
        }
        points
    }

    /// The point and its derivatives of first and second order at `u`, clamped to the domain, and
    /// `v`, wrapped. Source: The NURBS Book, A3.6.
    pub fn derivatives(&self, u: f64, v: f64) -> Derivatives {
        let (from, [along, along_1, along_2]) = self.along.rows_to_second(u);
        let (beside, around) = self.around.rows_to_second(v);
        let around_indices = self.around.indices(beside);
        let mut sums = [[0.0; 4]; 6];
        for (k, i) in self.along.indices(from).into_iter().enumerate() {
            let [own, own_1, own_2] = self.across(i, &around_indices, &around);
            sums[0] = plus(sums[0], along[k], &own);
            sums[1] = plus(sums[1], along_1[k], &own);
            sums[2] = plus(sums[2], along[k], &own_1);
            sums[3] = plus(sums[3], along_2[k], &own);
            sums[4] = plus(sums[4], along_1[k], &own_1);
            sums[5] = plus(sums[5], along[k], &own_2);
        }
        let [point, du, dv, duu, duv, dvv] = sums.map(vector);
        Derivatives { point: point.into(), du, dv, duu, duv, dvv }
    }

    /// The closed curve at one `u`, clamped to the domain, for derivatives at many places around.
    pub fn line(&self, u: f64) -> Line<'_> {
        let (span, along) = self.along.rows_to_second(u);
        let columns = self.around.count();
        let [a, b, c, d] =
            self.along.indices(span).map(|i| &self.lanes[i * columns..(i + 1) * columns]);
        let curve = |shares: [f64; 4]| {
            (0..columns).map(|j| blended([&a[j], &b[j], &c[j], &d[j]], shares)).collect()
        };
        Line { around: &self.around, curves: along.map(curve) }
    }

    /// The same surface with clamped knots around, for CAD: the knot vector around and the control
    /// points, row-major, `along().count()` rows of `around().count() + 3`. The last column equals
    /// the first. Exact: each column is the polar form at its three inner knots, which is
    /// equivalent to knot insertion (Ramshaw 1989).
    pub fn clamped_around(&self) -> (Vec<f64>, Vec<Point3<f64>>) {
        let columns = self.around.count();
        let (from, to) = self.around.domain();
        let mut knots = vec![from; DEGREE];
        knots.extend_from_slice(self.around.breakpoints());
        knots.extend([to; DEGREE]);
        let column = |j: usize| {
            // The last column is exactly the first, not a rounded copy of it.
            let j = j % (columns + DEGREE - 1);
            self.around.blossom(j.min(columns - 1), [knots[j + 1], knots[j + 2], knots[j + 3]])
        };
        let clamped: Vec<Row> = (0..columns + DEGREE).map(column).collect();
        let rows = self.control_points.chunks_exact(columns);
        let points = rows.flat_map(|row| clamped.iter().map(|column| combined(row, column)));
        let points = points.map(Point3::from).collect();
        (knots, points)
    }

    /// The control points around of the closed curve at one u.
    pub(super) fn ring(&self, along: &Row) -> Vec<Point3<f64>> {
        let columns = self.around.count();
        let at = |i: usize, j: usize| self.control_points[i * columns + j].coords;
        let terms = || along.indices.into_iter().zip(along.values);
        let sum = |j: usize| terms().map(|(i, value)| value * at(i, j)).sum::<Vector3<f64>>();
        (0..columns).map(|j| Point3::from(sum(j))).collect()
    }

    /// The sums of four control points of one row, weighted by each of the given values of the functions
    /// around.
    #[inline]
    fn across<const N: usize>(
        &self,
        row: usize,
        around: &[usize; 4],
        values: &[[f64; 4]; N],
    ) -> [Lanes; N] {
        let columns = self.around.count();
        let row = &self.lanes[row * columns..(row + 1) * columns];
        values.map(|values| blended(around.map(|j| &row[j]), values))
    }
}

/// `sum + share · lanes`, written out, so that coordinates are computed two at a time.
#[inline]
fn plus(sum: Lanes, share: f64, lanes: &Lanes) -> Lanes {
    [
        sum[0] + share * lanes[0],
        sum[1] + share * lanes[1],
        sum[2] + share * lanes[2],
        sum[3] + share * lanes[3],
    ]
}

/// The sum of four control points, weighted by the shares.
#[inline]
fn blended([a, b, c, d]: [&Lanes; 4], [of_a, of_b, of_c, of_d]: [f64; 4]) -> Lanes {
    plus(plus(plus(plus([0.0; 4], of_a, a), of_b, b), of_c, c), of_d, d)
}

#[inline]
fn vector([x, y, z, _]: Lanes) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

/// The sum of points of a closed curve, weighted by a row of basis values.
pub(super) fn combined(points: &[Point3<f64>], row: &Row) -> Vector3<f64> {
    row.indices.into_iter().zip(row.values).map(|(i, value)| value * points[i].coords).sum()
}
