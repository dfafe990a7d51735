//! The point of a surface nearest to any given point: branch and bound over cells.

use nalgebra::{Point3, Vector3};

use super::basis::{Basis, DEGREE};
use super::foot::Foot;
use super::surface::Surface;

/// How often the cells that could contain the nearest point are split into four: from whole spans
/// to eighths, a few millimetres on a leg. In such a small cell the distance has a single minimum,
/// which Newton steps find.
const CUTS: usize = 3;

impl Surface {
    /// The point of the surface nearest to `point`, mm, anywhere on the surface. Spans and their
    /// parts are skipped only if the surface's speed proves that they contain no nearer point;
    /// [`Surface::closest`] starts from the middle of every remaining part.
    pub fn closest_from_anywhere(&self, point: &Point3<f64>) -> Foot {
        let mut cells = Cell::spans(self, point);
        let mut best = self.lowest(point, &cells);
        for _ in 0..CUTS {
            cells.retain(|cell| cell.bound_mm() < best.distance_mm);
            cells = cells.iter().flat_map(|cell| cell.quarters(self, point)).collect();
        }
        cells.sort_by(|a, b| a.distance_mm.total_cmp(&b.distance_mm));
        for cell in cells {
            if cell.bound_mm() < best.distance_mm {
                let foot = self.closest(point, cell.u, cell.v);
                best = if foot.distance_mm < best.distance_mm { foot } else { best };
            }
        }
        best
    }

    /// The foot downhill from the cell with the nearest middle.
    fn lowest(&self, point: &Point3<f64>, cells: &[Cell]) -> Foot {
        let nearest = cells.iter().min_by(|a, b| a.distance_mm.total_cmp(&b.distance_mm));
        let (u, v) = nearest.map_or((self.along().domain().0, 0.0), |cell| (cell.u, cell.v));
        self.closest(point, u, v)
    }
}

/// A part of a surface, a rectangle in u and v within one span each way.
struct Cell {
    /// The middle.
    u: f64,
    v: f64,
    /// Half the widths in u and v.
    half: (f64, f64),
    /// Upper bounds of the lengths of ∂P/∂u and ∂P/∂v in the cell, mm per unit.
    speed: (f64, f64),
    /// Distance from the point to the middle.
    distance_mm: f64,
}

impl Cell {
    /// Every span of the surface.
    fn spans(surface: &Surface, point: &Point3<f64>) -> Vec<Cell> {
        let (along, around) = (surface.along(), surface.around());
        let mut cells = Vec::new();
        for (row, u) in along.breakpoints().windows(2).enumerate() {
            for (column, v) in around.breakpoints().windows(2).enumerate() {
                let middle = (0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1]));
                let half = (0.5 * (u[1] - u[0]), 0.5 * (v[1] - v[0]));
                cells.push(Cell::at(surface, point, middle, half, speed(surface, row, column)));
            }
        }
        cells
    }

    fn at(
        surface: &Surface,
        point: &Point3<f64>,
        (u, v): (f64, f64),
        half: (f64, f64),
        speed: (f64, f64),
    ) -> Cell {
        Cell { u, v, half, speed, distance_mm: (surface.point(u, v) - point).norm() }
    }

    fn quarters(&self, surface: &Surface, point: &Point3<f64>) -> [Cell; 4] {
        let half = (0.5 * self.half.0, 0.5 * self.half.1);
        [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].map(|(along, around)| {
            let middle = (self.u + along * half.0, self.v + around * half.1);
            Cell::at(surface, point, middle, half, self.speed)
        })
    }

    /// A lower bound of the distance of the cell's points from the point.
    fn bound_mm(&self) -> f64 {
        self.distance_mm - self.half.0 * self.speed.0 - self.half.1 * self.speed.1
    }
}

/// The maximum lengths of the derivatives' control points that influence a span: the derivatives
/// lie in their convex hull. Source: The NURBS Book, 3.3 and P3.5.
fn speed(surface: &Surface, row: usize, column: usize) -> (f64, f64) {
    let (along, around) = (surface.along(), surface.around());
    let (rows, columns) = (along.indices(row), around.indices(column));
    let at = |i: usize, j: usize| surface.control_points()[i * around.count() + j].coords;
    let mut speed: (f64, f64) = (0.0, 0.0);
    for k in 0..DEGREE {
        for across in 0..=DEGREE {
            let du = at(rows[k + 1], columns[across]) - at(rows[k], columns[across]);
            let dv = at(rows[across], columns[k + 1]) - at(rows[across], columns[k]);
            speed.0 = speed.0.max(pace(along, row + k, du));
            speed.1 = speed.1.max(pace(around, column + k, dv));
        }
    }
    speed
}

/// The length of the derivative's control point between two coefficients that differ by `step`.
fn pace(basis: &Basis, function: usize, step: Vector3<f64>) -> f64 {
    let knots = basis.knots();
    DEGREE as f64 * step.norm() / (knots[function + DEGREE + 1] - knots[function + 1])
}
