//! The skin of a point cloud: which neighbouring points the skin connects, and where it ends.
//!
//! Thighs that nearly touch are as near to each other as the points of one skin, so nearness is not enough: a
//! step over the skin stays in the plane of the points around both its ends. That distinguishes two skins
//! that are further apart than half the reach of a step.

use nalgebra::{Matrix3, Point3, SymmetricEigen, Unit, Vector3};

use super::skin_border::{OFF_SKIN_MAX_SHARE, SAME_SKIN_MIN_COSINE};
use crate::frame::point_cloud::spacing;
use crate::statistics::largest_gap_deg;

/// The plane of the skin is that of at least this many points.
const PLANE_POINTS_MIN: usize = 5;

/// The skin ends at a point whose neighbours leave out this much of the directions around it, degrees:
/// 180 on a straight border.
const OPEN_MIN_DEG: f64 = 160.0;

/// A part of a cloud.
pub struct CloudSkin<'a> {
    points: &'a [Point3<f64>],
    /// Index of each point of the part by cell, in order of the cells.
    by_cell: Vec<([i64; 3], u32)>,
    reach_mm: f64,
    /// Direction of the skin by point; `None` outside the part or where points are few.
    normals: Vec<Option<Unit<Vector3<f64>>>>,
}

impl<'a> CloudSkin<'a> {
    /// The part of a cloud between two heights. Neighbours are at most `reach` spacings apart.
    pub fn between(
        points: &'a [Point3<f64>],
        [from_mm, to_mm]: [f64; 2],
        reach: f64,
    ) -> CloudSkin<'a> {
        let within = points.iter().zip(0..).filter(|(p, _)| (from_mm..to_mm).contains(&p.z));
        let own: Vec<Point3<f64>> = within.clone().map(|(point, _)| *point).collect();
        let reach_mm = (reach * spacing(&own)).max(f64::MIN_POSITIVE);
        let mut by_cell: Vec<([i64; 3], u32)> =
            within.map(|(point, index)| (cell(point, reach_mm), index)).collect();
        by_cell.sort_unstable();
        let mut skin = CloudSkin { points, by_cell, reach_mm, normals: vec![None; points.len()] };
        for &(_, index) in &skin.by_cell {
            let steps = skin.indices_near(index).map(|other| skin.step(index, other));
            skin.normals[index as usize] = normal(&steps.collect::<Vec<_>>());
        }
        skin
    }

    /// Pairs of points that the skin connects.
    pub fn links(&self) -> Vec<[u32; 2]> {
        let of = |&(_, own): &([i64; 3], u32)| {
            let later = self.indices_near(own).filter(move |other| *other > own);
            later.filter(move |other| self.is_linked(own, *other)).map(move |other| [own, other])
        };
        self.by_cell.iter().flat_map(of).collect()
    }

    /// Whether the skin ends at a point.
    pub fn is_open(&self, point: u32) -> bool {
        let Some(normal) = self.normals[point as usize] else { return true };
        let first = normal.cross(&Vector3::x_axis()).try_normalize(f64::MIN_POSITIVE);
        let first = first.unwrap_or_else(|| *Vector3::y_axis());
        let second = normal.cross(&first);
        let linked = self.indices_near(point).filter(|other| self.is_linked(point, *other));
        let steps = linked.map(|other| self.step(point, other));
        let angles: Vec<f64> =
            steps.map(|step| step.dot(&second).atan2(step.dot(&first))).collect();
        largest_gap_deg(&angles) > OPEN_MIN_DEG
    }

    fn step(&self, from: u32, to: u32) -> Vector3<f64> {
        self.points[to as usize] - self.points[from as usize]
    }

    fn is_linked(&self, a: u32, b: u32) -> bool {
        let (Some(na), Some(nb)) = (self.normals[a as usize], self.normals[b as usize]) else {
            return false;
        };
        let step = self.step(a, b);
        let off_max_mm = OFF_SKIN_MAX_SHARE * step.norm();
        na.dot(&nb).abs() >= SAME_SKIN_MIN_COSINE
            && step.dot(&na).abs() <= off_max_mm
            && step.dot(&nb).abs() <= off_max_mm
    }

    /// The other points within reach.
    fn indices_near(&self, own: u32) -> impl Iterator<Item = u32> {
        let point = &self.points[own as usize];
        let [x, y, z] = cell(point, self.reach_mm);
        let around = (-1..=1).flat_map(move |dx| (-1..=1).map(move |dy| [x + dx, y + dy]));
        let columns = around.flat_map(move |[x, y]| {
            let first = self.by_cell.partition_point(|entry| entry.0 < [x, y, z - 1]);
            self.by_cell[first..].iter().take_while(move |entry| entry.0 <= [x, y, z + 1])
        });
        columns.map(|(_, other)| *other).filter(move |other| {
            *other != own && self.step(own, *other).norm_squared() <= self.reach_mm.powi(2)
        })
    }
}

fn cell(point: &Point3<f64>, side_mm: f64) -> [i64; 3] {
    [point.x, point.y, point.z].map(|value| (value / side_mm).floor() as i64)
}

/// The direction in which points around a point extend least.
fn normal(steps: &[Vector3<f64>]) -> Option<Unit<Vector3<f64>>> {
    if steps.len() + 1 < PLANE_POINTS_MIN {
        return None;
    }
    let count = (steps.len() + 1) as f64;
    let mean = steps.iter().sum::<Vector3<f64>>() / count;
    let squares: Matrix3<f64> = steps.iter().map(|step| step * step.transpose()).sum();
    let eigen = SymmetricEigen::new(squares / count - mean * mean.transpose());
    let least = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
    Unit::try_new(least, f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sheet of 11 × 11 points, 5 mm apart.
    fn sheet(x: f64) -> impl Iterator<Item = Point3<f64>> {
        let at = |i: i32| 5.0 * f64::from(i);
        (0..11).flat_map(move |i| (0..11).map(move |j| Point3::new(x, at(i), 500.0 + at(j))))
    }

    #[test]
    fn a_sheet_is_connected_and_open_at_its_border_only() {
        let points: Vec<_> = sheet(0.0).collect();
        let skin = CloudSkin::between(&points, [0.0, 1000.0], 2.5);
        assert!(skin.links().contains(&[0, 1]) && skin.links().contains(&[0, 11]));
        let open = (0..points.len() as u32).filter(|point| skin.is_open(*point));
        assert_eq!(open.count(), 40);
    }

    #[test]
    fn two_sheets_further_apart_than_half_a_step_are_not_connected() {
        for gap_mm in [8.0, 10.0, 12.0] {
            let points: Vec<_> = sheet(0.0).chain(sheet(gap_mm)).collect();
            let links = CloudSkin::between(&points, [0.0, 1000.0], 2.5).links();
            // At a sheet's border its plane is less sure.
            let is_inner = |point: &u32| {
                (3..8).contains(&(point % 11)) && (3..8).contains(&(point % 121 / 11))
            };
            let crossing = links.iter().filter(|[a, b]| (*a < 121) != (*b < 121));
            let crossing = crossing.filter(|ends| ends.iter().all(is_inner));
            assert_eq!((crossing.count(), links.len() > 400), (0, true), "{gap_mm} mm");
        }
    }

    #[test]
    fn points_outside_the_part_are_left_out() {
        let points: Vec<_> = sheet(0.0).collect();
        assert!(CloudSkin::between(&points, [0.0, 400.0], 2.5).links().is_empty());
    }
}
