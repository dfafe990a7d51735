//! The shape of a leg for pictures: coarser than the measured data, and not used for measurements.

use gaiter_spline::Surface;
use nalgebra::Point3;

use super::error_map::{self, ErrorMap};
use super::foot_skin::FootSkin;
use super::nurbs::LegSurface;
use super::ridge_parametrization::Columns;
use crate::parting::segment::Leg;
use crate::sections::axis::LegAxis;
use crate::sections::equidistant::Sections;
use crate::sections::section::Section;
use crate::sections::slice::Crossing;

/// Number of points around a row, at equal angles from −180° on.
pub const COLUMNS: usize = error_map::ANGLES;

/// Every n-th section becomes a row of the skin: 10 mm apart.
const ROWS_APART: usize = 2;

/// Number of the scan's points shown on a leg: about 10 mm apart.
const SCAN_POINTS: usize = 4000;

/// Number of the scan's points shown on the section of a level.
const SECTION_POINTS: usize = 180;

/// The fractional parts of its multiples are spread as evenly as possible (Weyl; the golden ratio).
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A leg's shape.
#[derive(Debug, Clone)]
pub struct Shape {
    /// Rows of the measured skin, upwards; `None` where a row is not closed.
    pub skin: Vec<Option<Vec<Point3<f64>>>>,
    /// The skin below the lowest row; `None` without triangles or rows.
    pub foot: Option<FootSkin>,
    /// The surface, row by row at the positions of `error_map`; `None` without a surface.
    pub surface: Option<Vec<Vec<Point3<f64>>>>,
    /// A sample of the scan's own points.
    pub scan: Vec<Point3<f64>>,
}

/// One of the scan's own points on the plane of a section, relative to its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnPlane {
    /// 0 front, 90 lateral, degrees.
    pub angle_deg: f64,
    /// Distance from the section's centre, mm.
    pub radius_mm: f64,
}

impl Shape {
    /// The shape of a leg.
    pub fn new(leg: &Leg, sections: &Sections, surface: Option<&LegSurface>) -> Shape {
        let rows = sections.rows.iter().step_by(ROWS_APART);
        let ring = |section: &Section| {
            let plane = sections.axis.plane(section.along_mm);
            (0..COLUMNS).map(|j| section.point(&plane, error_map::angle(j))).collect()
        };
        let lowest = rows.clone().find_map(|row| row.section.as_ref());
        let skin = rows.map(|row| row.section.as_ref().map(ring)).collect();
        let points = leg.mesh.points();
        Shape {
            skin,
            foot: lowest
                .and_then(|section| FootSkin::new(leg, &sections.axis.plane(section.along_mm))),
            surface: surface.map(|leg| rows_of(&leg.surface, &leg.columns, &leg.error_map)),
            scan: share(points, SCAN_POINTS),
        }
    }
}

fn rows_of(surface: &Surface, columns: &Columns, map: &ErrorMap) -> Vec<Vec<Point3<f64>>> {
    let row = |along_mm: &f64| {
        let column = columns.at(*along_mm);
        let place = |j: usize| surface.point(*along_mm, column(error_map::angle(j)));
        (0..COLUMNS).map(place).collect()
    };
    map.along_mm.iter().map(row).collect()
}

/// The scan's points on the planes of sections, which must ascend.
pub(crate) fn on_planes(axis: &LegAxis, leg: &Leg, sections: &[&Section]) -> Vec<Vec<OnPlane>> {
    let along_mm: Vec<f64> = sections.iter().map(|section| section.along_mm).collect();
    let slices = axis.slices(leg, &along_mm);
    let of = |(section, slice): (&&Section, &Vec<Crossing>)| {
        let on_plane = share(&axis.points(section.along_mm, slice), SECTION_POINTS);
        let mut points: Vec<OnPlane> = on_plane
            .iter()
            .map(|point| {
                let arm = point - section.centre;
                OnPlane { angle_deg: arm.y.atan2(arm.x).to_degrees(), radius_mm: arm.norm() }
            })
            .collect();
        points.sort_by(|a, b| a.angle_deg.total_cmp(&b.angle_deg));
        points
    };
    sections.iter().zip(&slices).map(of).collect()
}

/// At most about `most` of the items, spread evenly over their order.
fn share<T: Copy>(things: &[T], most: usize) -> Vec<T> {
    let share = most as f64 / things.len().max(1) as f64;
    let is_taken = |index: &usize| (*index as f64 * GOLDEN).fract() < share;
    (0..things.len()).filter(is_taken).map(|index| things[index]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_spread_evenly_and_few_things_are_all_taken() {
        let things: Vec<usize> = (0..50_000).collect();
        let taken = share(&things, 4000);
        assert!((3990..=4010).contains(&taken.len()), "{}", taken.len());
        let widest = taken.windows(2).map(|pair| pair[1] - pair[0]).max();
        assert!(widest <= Some(21), "{widest:?}");
        assert_eq!(share(&things[..3], 4000), [0, 1, 2]);
        assert_eq!(share::<usize>(&[], 4000), [0_usize; 0]);
    }
}
