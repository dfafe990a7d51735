//! A leg unrolled: positions on the skin by their distance along the axis and their column.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Unit, Vector2, Vector3};

use super::fit_error::SurfacePoint;
use super::ridge_parametrization::Columns;
use crate::parting::segment::Leg;
use crate::sections::axis::LegAxis;
use crate::sections::section::{Outline, Section};

/// Angles at which a section is compared with the surface; none of them is a column of the grid.
const CHECK_ANGLES: usize = 90;

/// Angles over which the mean radius of an outline is taken.
const RADIUS_ANGLES: usize = 8;

/// A leg's outlines with the columns across them.
#[derive(Debug, Clone)]
pub struct Unrolled<'a> {
    /// The frame of the outlines.
    pub axis: &'a LegAxis,
    /// At least one; ascending.
    pub outlines: &'a [Outline],
    /// The positions of the columns.
    pub columns: &'a Columns,
    /// Plane and middle of each outline, body frame.
    middles: Vec<(Unit<Vector3<f64>>, Point3<f64>)>,
}

impl<'a> Unrolled<'a> {
    /// A leg with these outlines, at least one, ascending.
    pub fn new(axis: &'a LegAxis, outlines: &'a [Outline], columns: &'a Columns) -> Unrolled<'a> {
        let middle = |outline: &Outline| {
            let plane = axis.plane(outline.along_mm);
            (plane.normal, plane.point(&outline.centre))
        };
        Unrolled { axis, outlines, columns, middles: outlines.iter().map(middle).collect() }
    }

    /// The scan's points between two distances along the axis, mm. They are spread evenly over the
    /// skin, so each represents the same area.
    pub fn points(&self, leg: &Leg, from_mm: f64, to_mm: f64) -> Vec<SurfacePoint> {
        let place = |point: &Point3<f64>| {
            let (along_mm, in_plane) = self.axis.place(point);
            (from_mm..=to_mm).contains(&along_mm).then(|| {
                let arm = in_plane - self.nearest(along_mm).centre;
                let angle = arm.y.atan2(arm.x);
                let at = (along_mm, self.columns.column(along_mm, angle));
                SurfacePoint { point: *point, at, angle, radius_mm: arm.norm(), area: 1.0 }
            })
        };
        leg.mesh.points().iter().filter_map(place).collect()
    }

    /// Points all around the sections, one section after the other, each weighted by the area that it
    /// represents.
    pub fn sections(&self, sections: &[&Section]) -> Vec<Vec<SurfacePoint>> {
        let angles = (0..CHECK_ANGLES)
            .map(|index| -PI + TAU * (index as f64 + 0.5) / CHECK_ANGLES as f64)
            .map(|angle| (angle, Vector2::new(angle.cos(), angle.sin())));
        let angles: Vec<(f64, Vector2<f64>)> = angles.collect();
        let places = |section: &&Section| {
            let column = self.columns.at(section.along_mm);
            let plane = self.axis.plane(section.along_mm);
            let place = |&(angle, direction): &(f64, Vector2<f64>)| {
                let [radius_mm, slope, _] = section.curve.derivatives(angle);
                let point = plane.point(&(section.centre + direction * radius_mm));
                let at = (section.along_mm, column(angle));
                SurfacePoint { point, at, angle, radius_mm, area: radius_mm.hypot(slope) }
            };
            angles.iter().map(place).collect()
        };
        sections.iter().map(places).collect()
    }

    /// The mean radius at a distance along the axis, mm.
    pub fn radius_mm(&self, along_mm: f64) -> f64 {
        let curve = &self.nearest(along_mm).curve;
        let angles = (0..RADIUS_ANGLES).map(|i| TAU * i as f64 / RADIUS_ANGLES as f64);
        angles.map(|angle| curve.radius(angle)).sum::<f64>() / RADIUS_ANGLES as f64
    }

    /// Distance of a point outside its outline, mm.
    pub fn outside_mm(&self, place: &SurfacePoint) -> f64 {
        place.radius_mm - self.nearest(place.at.0).curve.radius(place.angle)
    }

    /// Vector from the middle of the nearest outline to a point at this distance along the axis,
    /// perpendicular to the axis, body frame, mm.
    pub fn arm(&self, point: &Point3<f64>, along_mm: f64) -> Vector3<f64> {
        let (normal, middle) = self.middles[self.nearest_index(along_mm)];
        let arm = point - middle;
        arm - normal.into_inner() * normal.dot(&arm)
    }

    /// The outline nearest to a distance along the axis.
    fn nearest(&self, along_mm: f64) -> &Outline {
        &self.outlines[self.nearest_index(along_mm)]
    }

    fn nearest_index(&self, along_mm: f64) -> usize {
        let above = self.outlines.partition_point(|outline| outline.along_mm < along_mm);
        let [low, high] = [above.saturating_sub(1), above.min(self.outlines.len() - 1)];
        let far = |index: usize| (self.outlines[index].along_mm - along_mm).abs();
        if far(low) <= far(high) { low } else { high }
    }
}
