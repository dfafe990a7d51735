//! Holes of the skin that a surface bridges: their positions and sizes.
//!
//! A point lies in a hole if it is covered by a disc that contains no scan point (a morphological
//! opening of the unseen area), so the normal spacing of points does not cause holes.

use std::f64::consts::{PI, TAU};

use crate::frame::union_find::DisjointSets;

/// Radius of that disc in point spacings: among evenly spread random points, one position in a
/// hundred thousand would falsely count as a hole.
const RADIUS_SPACINGS: f64 = 2.0;

/// … and at least this, mm: smaller holes are bridged as reliably as the skin between any two points.
const RADIUS_MIN_MM: f64 = 8.0;

/// Height of a cell, mm, and number of cells around: at most 2.5 mm each on a lower leg.
const CELL_MM: f64 = 2.5;
const CELLS_AROUND: usize = 144;

/// A hole of a leg's skin, bridged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    /// Distance of its middle along the axis, mm.
    pub along_mm: f64,
    /// Column of its middle, radians in [−π, π).
    pub column: f64,
    /// Its extent along the leg, mm.
    pub length_mm: f64,
    /// Its extent around the leg, mm.
    pub width_mm: f64,
    /// Its area, mm².
    pub area_mm2: f64,
}

/// The seen and unseen parts of a surface.
#[derive(Debug, Clone)]
pub struct Coverage {
    raster: Raster,
    /// For each cell, by rows from below, whether it lies in a hole.
    in_hole: Vec<bool>,
    /// The holes, largest first.
    pub holes: Vec<Hole>,
}

impl Coverage {
    /// Finds the unseen parts of a surface between two distances along the axis, mm, with a radius
    /// of `radius_mm`. `places` are the positions of its points, including those just beyond its
    /// ends: distance along the axis, mm, and column.
    pub fn find(
        [from_mm, to_mm]: [f64; 2],
        places: &[(f64, f64)],
        radius_mm: impl Fn(f64) -> f64,
    ) -> Coverage {
        let raster = Raster::new([from_mm, to_mm], radius_mm);
        let inside = places.iter().filter(|(u, _)| (from_mm..=to_mm).contains(u)).count();
        let spacing_mm = (raster.area_mm2() / inside.max(1) as f64).sqrt();
        let reach_mm = (RADIUS_SPACINGS * spacing_mm).max(RADIUS_MIN_MM);
        let mut near_a_point = vec![false; raster.radii_mm.len() * CELLS_AROUND];
        places.iter().for_each(|place| raster.set_within(&mut near_a_point, *place, reach_mm));
        let mut in_hole = vec![false; near_a_point.len()];
        for cell in (0..near_a_point.len()).filter(|cell| !near_a_point[*cell]) {
            raster.set_within(&mut in_hole, raster.middle(cell), reach_mm);
        }
        let holes = raster.holes(&in_hole);
        Coverage { raster, in_hole, holes }
    }

    /// Whether a point of the surface lies in a hole.
    pub fn is_in_hole(&self, along_mm: f64, column: f64) -> bool {
        self.in_hole[self.raster.row(along_mm) * CELLS_AROUND + column_cell(column)]
    }
}

/// The cells of a surface.
#[derive(Debug, Clone)]
struct Raster {
    from_mm: f64,
    cell_mm: f64,
    /// Radius of each row, mm.
    radii_mm: Vec<f64>,
}

impl Raster {
    fn new([from_mm, to_mm]: [f64; 2], radius_mm: impl Fn(f64) -> f64) -> Raster {
        let rows = ((to_mm - from_mm) / CELL_MM).ceil().max(1.0) as usize;
        let cell_mm = (to_mm - from_mm) / rows as f64;
        let middle_mm = |row: usize| from_mm + cell_mm * (row as f64 + 0.5);
        let radii_mm = (0..rows).map(|row| radius_mm(middle_mm(row))).collect();
        Raster { from_mm, cell_mm, radii_mm }
    }

    fn area_mm2(&self) -> f64 {
        self.radii_mm.iter().map(|radius| TAU * radius * self.cell_mm).sum()
    }

    /// The row at a distance along the axis, or the one next to it.
    fn row(&self, along_mm: f64) -> usize {
        (((along_mm - self.from_mm) / self.cell_mm) as usize).min(self.radii_mm.len() - 1)
    }

    fn middle(&self, cell: usize) -> (f64, f64) {
        let (row, column) = (cell / CELLS_AROUND, cell % CELLS_AROUND);
        let along_mm = self.from_mm + self.cell_mm * (row as f64 + 0.5);
        (along_mm, -PI + TAU * (column as f64 + 0.5) / CELLS_AROUND as f64)
    }

    /// Sets every cell whose middle is within reach of a position.
    fn set_within(&self, cells: &mut [bool], (along_mm, column): (f64, f64), reach_mm: f64) {
        // In units of cells, relative to the middle of the first one.
        let home = (column + PI) / TAU * CELLS_AROUND as f64 - 0.5;
        for row in self.row(along_mm - reach_mm)..=self.row(along_mm + reach_mm) {
            let up_mm = self.from_mm + self.cell_mm * (row as f64 + 0.5) - along_mm;
            let aside_mm2 = reach_mm * reach_mm - up_mm * up_mm;
            if aside_mm2 < 0.0 {
                continue;
            }
            let aside = aside_mm2.sqrt() / self.radii_mm[row] / TAU * CELLS_AROUND as f64;
            let cells = &mut cells[row * CELLS_AROUND..(row + 1) * CELLS_AROUND];
            if 2.0 * aside >= CELLS_AROUND as f64 {
                cells.fill(true);
                continue;
            }
            // A turn further on, where no number is negative, whole parts are numbers rounded down.
            let turn = CELLS_AROUND as f64;
            let (from, to) = (home - aside + turn, home + aside + turn);
            let first = from as usize + usize::from((from as usize as f64) < from);
            let count = (to as usize + 1).saturating_sub(first);
            let first = first % CELLS_AROUND;
            // A run that passes the row's end continues at its start.
            let wrapped = (first + count).saturating_sub(CELLS_AROUND);
            cells[first..first + count - wrapped].fill(true);
            cells[..wrapped].fill(true);
        }
    }

    /// The connected groups of cells in holes, largest first.
    fn holes(&self, in_hole: &[bool]) -> Vec<Hole> {
        let mut sets = DisjointSets::new(in_hole.len());
        for cell in (0..in_hole.len()).filter(|cell| in_hole[*cell]) {
            let (row, column) = (cell / CELLS_AROUND, cell % CELLS_AROUND);
            let aside = row * CELLS_AROUND + (column + 1) % CELLS_AROUND;
            for other in [aside, cell + CELLS_AROUND] {
                if in_hole.get(other) == Some(&true) {
                    sets.join(cell as u32, other as u32);
                }
            }
        }
        let mut members = std::collections::BTreeMap::<u32, Vec<usize>>::new();
        for cell in (0..in_hole.len()).filter(|cell| in_hole[*cell]) {
            members.entry(sets.root(cell as u32)).or_default().push(cell);
        }
        let mut holes: Vec<Hole> = members.values().map(|cells| self.hole(cells)).collect();
        holes.sort_by(|a, b| b.area_mm2.total_cmp(&a.area_mm2));
        holes
    }

    fn hole(&self, cells: &[usize]) -> Hole {
        let (mut area_mm2, mut moment_mm) = (0.0, 0.0);
        let mut arrow = nalgebra::Vector2::zeros();
        let mut columns = [false; CELLS_AROUND];
        let mut rows = [usize::MAX, 0];
        for &cell in cells {
            let (along_mm, column) = self.middle(cell);
            let row = cell / CELLS_AROUND;
            let own_mm2 = self.cell_mm * TAU * self.radii_mm[row] / CELLS_AROUND as f64;
            area_mm2 += own_mm2;
            moment_mm += own_mm2 * along_mm;
            arrow += own_mm2 * nalgebra::Vector2::new(column.cos(), column.sin());
            columns[cell % CELLS_AROUND] = true;
            rows = [rows[0].min(row), rows[1].max(row)];
        }
        let along_mm = moment_mm / area_mm2;
        let share = columns.iter().filter(|column| **column).count() as f64 / CELLS_AROUND as f64;
        Hole {
            along_mm,
            column: arrow.y.atan2(arrow.x),
            length_mm: self.cell_mm * (rows[1] - rows[0] + 1) as f64,
            width_mm: share * TAU * self.radii_mm[self.row(along_mm)],
            area_mm2,
        }
    }
}

fn column_cell(column: f64) -> usize {
    let share = (column + PI).rem_euclid(TAU) / TAU;
    ((share * CELLS_AROUND as f64) as usize).min(CELLS_AROUND - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points 5 mm apart on a cylinder of 50 mm radius, in rows rotated relative to each other.
    fn strewn(is_seen: impl Fn(f64, f64) -> bool) -> Vec<(f64, f64)> {
        let rows = (0..70).map(|i| (5.0 * f64::from(i) - 10.0, 0.37 * f64::from(i)));
        let places = rows.flat_map(|(u, turn)| {
            (0..63).map(move |j| (u, (f64::from(j) + turn) * TAU / 63.0 % TAU - PI))
        });
        places.filter(|(u, v)| is_seen(*u, *v)).collect()
    }

    fn coverage(places: &[(f64, f64)]) -> Coverage {
        Coverage::find([0.0, 320.0], places, |_| 50.0)
    }

    #[test]
    fn skin_that_was_seen_all_over_has_no_hole() {
        assert_eq!(coverage(&strewn(|_, _| true)).holes, []);
    }

    #[test]
    fn points_strewn_at_random_leave_no_hole() {
        // Knuth's generator (The Art of Computer Programming 2, MMIX).
        let mut state = 1_u64;
        let mut even = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        // One per 25 mm².
        let places: Vec<(f64, f64)> =
            (0..4300).map(|_| (342.0 * even() - 11.0, TAU * even() - PI)).collect();
        assert_eq!(coverage(&places).holes, []);
    }

    #[test]
    fn a_round_hole_has_its_place_and_size_across_the_seam_too() {
        for column in [0.3, PI, -2.9] {
            let aside = |v: f64| {
                let turn = v - column;
                50.0 * (turn - TAU * (turn / TAU).round())
            };
            let places = strewn(|u, v| (u - 150.0_f64).hypot(aside(v)) > 20.0);
            let found = coverage(&places);
            let [hole] = found.holes[..] else { panic!("{:?}", found.holes) };
            assert!((hole.along_mm - 150.0).abs() < 1.5, "{hole:?}");
            assert!(aside(hole.column).abs() < 1.5, "{hole:?}");
            // Points are 5 mm apart, so the hole extends up to that far outside the disc; at its
            // upper and lower end, parts narrower than the test disc do not count.
            assert!((34.0..=46.0).contains(&hole.length_mm), "{hole:?}");
            assert!((34.0..=46.0).contains(&hole.width_mm), "{hole:?}");
            assert!((1200.0..1600.0).contains(&hole.area_mm2), "{hole:?}");
            assert!(found.is_in_hole(150.0, column) && !found.is_in_hole(150.0, column + 0.6));
        }
    }

    #[test]
    fn a_band_that_was_not_seen_goes_all_around() {
        let found = coverage(&strewn(|u, _| !(100.0..=130.0).contains(&u)));
        let [hole] = found.holes[..] else { panic!("{:?}", found.holes) };
        assert!((hole.width_mm - TAU * 50.0).abs() < 1e-9, "{hole:?}");
        assert!((33.0..=43.0).contains(&hole.length_mm), "{hole:?}");
    }
}
