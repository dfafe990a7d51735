//! A leg in cells, and the mean radius of planes that lean across it.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Directions in which the radius is averaged, 15° each.
pub const DIRECTIONS: usize = 24;

/// … and in which steps are compared: two of those each, so that a window holds some 25 points.
pub(super) const SECTORS: usize = 12;

/// Height of a row of cells, mm: half the distance between points.
pub(super) const ROW_MM: f64 = 2.5;

/// Points further from the fitted skin than this are another thing's, mm.
const STRAY_MM: f64 = 20.0;

/// Of a window, at least this many rows must lie below the edge: trousers end 60 mm above the floor.
pub(super) const BELOW_MIN: usize = 5;

/// Rows of a window on each side: 35 mm, which a cubic describes on any leg.
pub(super) const WINDOW_ROWS: usize = 14;

/// The plane of an edge leans from the leg's section by up to these angles, degrees: cloth is put on level or square to
/// the leg, and shanks lean by up to 5°. Beside each, the directions in which it may lean.
const LEANS: [(f64, usize); 3] = [(0.0, 1), (4.0, 6), (8.0, 10)];

/// The leg in cells: directions around, rows along.
pub(super) struct Rows {
    pub(super) from_mm: f64,
    pub(super) noise_mm: f64,
    /// Radius of the fitted skin in the middle of each cell, mm.
    fitted: Vec<[f64; DIRECTIONS]>,
    /// In each cell, the number of points and the sum of their distances outside that skin, mm.
    pub(super) cells: Vec<[(f64, f64); DIRECTIONS]>,
    /// Mean radius in each direction, mm.
    radii_mm: [f64; DIRECTIONS],
}

/// The middle of a direction, radians.
pub fn direction(index: usize) -> f64 {
    -PI + TAU * (index as f64 + 0.5) / DIRECTIONS as f64
}

/// A mean radius at a height.
#[derive(Clone, Copy)]
pub(super) struct Mean {
    /// Distance from the border that is looked at, mm.
    pub(super) from_border_mm: f64,
    pub(super) radius_mm: f64,
    /// The points it is of.
    pub(super) count: f64,
}

/// How a plane leans: the rise per mm to the front and to the side.
pub(super) type Lean = [f64; 2];

/// The level plane and all leaning ones.
fn leans() -> impl Iterator<Item = Lean> {
    LEANS.into_iter().flat_map(|(lean_deg, count)| {
        (0..count).map(move |index| {
            let (rise, to) = (lean_deg.to_radians().tan(), TAU * index as f64 / count as f64);
            [rise * to.cos(), rise * to.sin()]
        })
    })
}

impl Rows {
    pub(super) fn new(
        points: impl Iterator<Item = [f64; 3]>,
        fitted: impl Fn(f64) -> Option<[f64; DIRECTIONS]>,
        noise_mm: f64,
        [from_mm, to_mm]: [f64; 2],
    ) -> Option<Rows> {
        let count = ((to_mm - from_mm) / ROW_MM).max(0.0) as usize;
        let middle_mm = |row: usize| from_mm + ROW_MM * (row as f64 + 0.5);
        let fitted: Option<Vec<_>> = (0..count).map(|row| fitted(middle_mm(row))).collect();
        let fitted = fitted?;
        let mut cells = vec![[(0.0, 0.0); DIRECTIONS]; count];
        for [along_mm, angle, residual_mm] in points {
            let row = ((along_mm - from_mm) / ROW_MM).floor();
            if (0.0..count as f64).contains(&row) && residual_mm.abs() <= STRAY_MM {
                let turn = (angle + PI).rem_euclid(TAU) / TAU;
                let direction = (turn * DIRECTIONS as f64) as usize;
                let sum = &mut cells[row as usize][direction.min(DIRECTIONS - 1)];
                *sum = (sum.0 + 1.0, sum.1 + residual_mm);
            }
        }
        let mean = |direction: usize| {
            fitted.iter().map(|row| row[direction]).sum::<f64>() / count.max(1) as f64
        };
        let radii_mm = std::array::from_fn(mean);
        Some(Rows { from_mm, noise_mm, fitted, cells, radii_mm })
    }

    /// How many rows each direction is shifted by a leaning plane.
    pub(super) fn shifts(&self, [front, side]: Lean) -> [isize; DIRECTIONS] {
        std::array::from_fn(|direction| {
            let (sin, cos) = self::direction(direction).sin_cos();
            ((front * cos + side * sin) * self.radii_mm[direction] / ROW_MM).round() as isize
        })
    }

    /// The mean radius of some directions at a row of a leaning plane, and the number of points.
    fn mean(
        &self,
        row: usize,
        shifts: &[isize; DIRECTIONS],
        directions: impl Iterator<Item = usize>,
    ) -> (f64, f64) {
        let last = self.cells.len() - 1;
        let (mut fitted, mut parts, mut count, mut sum) = (0.0, 0.0, 0.0, 0.0);
        for direction in directions {
            let at = row.saturating_add_signed(shifts[direction]).min(last);
            let cell = self.cells[at][direction];
            fitted += self.fitted[at][direction];
            (parts, count, sum) = (parts + 1.0, count + cell.0, sum + cell.1);
        }
        (fitted / parts + sum / count.max(1.0), count)
    }

    /// For each lean, the mean radius and the number of points at each row.
    pub(super) fn means(&self) -> Vec<(Lean, Vec<(f64, f64)>)> {
        let along = |lean: Lean| {
            let shifts = self.shifts(lean);
            let rows = 0..self.cells.len();
            (lean, rows.map(|row| self.mean(row, &shifts, 0..DIRECTIONS)).collect())
        };
        leans().map(along).collect()
    }

    /// The means near a border.
    pub(super) fn window(
        &self,
        border: usize,
        shifts: &[isize; DIRECTIONS],
        directions: impl Iterator<Item = usize> + Clone,
    ) -> Vec<Mean> {
        let rows = border.saturating_sub(WINDOW_ROWS)..(border + WINDOW_ROWS).min(self.cells.len());
        let mean = |row: usize| {
            let (radius_mm, count) = self.mean(row, shifts, directions.clone());
            let from_border_mm = (row as f64 + 0.5 - border as f64) * ROW_MM;
            Mean { from_border_mm, radius_mm, count }
        };
        rows.map(mean).filter(|mean| mean.count > 0.0).collect()
    }
}

/// The directions of a sector.
pub(super) fn of_sector(sector: usize) -> Range<usize> {
    let each = DIRECTIONS / SECTORS;
    each * sector..each * (sector + 1)
}
