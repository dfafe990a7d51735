//! A leg unrolled: positions on the skin by their distance along the axis and their column.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Vector2, Vector3};

use super::fit_error::Place;
use super::ridge_parametrization::Columns;
use crate::leg::parting::segment::Leg;
use crate::leg::sections::axis::LegAxis;
use crate::leg::sections::section::{Outline, Section};

/// Angles at which a section is compared with the surface; none of them is a column of the grid.
const CHECK_ANGLES: usize = 90;

/// Angles over which the mean radius of an outline is taken.
const RADIUS_ANGLES: usize = 8;

/// A leg's outlines with the columns across them.
#[derive(Debug, Clone, Copy)]
pub struct Unrolled<'a> {
    /// The frame of the outlines.
    pub axis: &'a LegAxis,
    /// At least one; ascending.
    pub outlines: &'a [Outline],
    /// The positions of the columns.
    pub columns: &'a Columns,
}

impl<'a> Unrolled<'a> {
    /// The scan's points between two distances along the axis, mm. They are spread evenly over the
    /// skin, so each represents the same area.
    pub fn points(&self, leg: &Leg, from_mm: f64, to_mm: f64) -> Vec<Place> {
        let place = |point: &Point3<f64>| {
            let (along_mm, in_plane) = self.axis.place(point);
            (from_mm..=to_mm).contains(&along_mm).then(|| {
                let arm = in_plane - self.nearest(along_mm).centre;
                let angle = arm.y.atan2(arm.x);
                let at = (along_mm, self.columns.column(along_mm, angle));
                Place { point: *point, at, angle, radius_mm: arm.norm(), area: 1.0 }
            })
        };
        leg.mesh.points().iter().filter_map(place).collect()
    }

    /// Points all around the sections, each weighted by the area that it represents.
    pub fn sections(&self, sections: &'a [&'a Section]) -> impl Iterator<Item = Place> + 'a {
        let Unrolled { axis, columns, .. } = *self;
        sections.iter().flat_map(move |section| {
            let column = columns.at(section.along_mm);
            let plane = axis.plane(section.along_mm);
            (0..CHECK_ANGLES).map(move |index| {
                let angle = -PI + TAU * (index as f64 + 0.5) / CHECK_ANGLES as f64;
                let [radius_mm, slope, _] = section.curve.derivatives(angle);
                let arm = Vector2::new(angle.cos(), angle.sin()) * radius_mm;
                let point = plane.point(&(section.centre + arm));
                let at = (section.along_mm, column(angle));
                Place { point, at, angle, radius_mm, area: radius_mm.hypot(slope) }
            })
        })
    }

    /// The mean radius at a distance along the axis, mm.
    pub fn radius_mm(&self, along_mm: f64) -> f64 {
        let curve = &self.nearest(along_mm).curve;
        let angles = (0..RADIUS_ANGLES).map(|i| TAU * i as f64 / RADIUS_ANGLES as f64);
        angles.map(|angle| curve.radius(angle)).sum::<f64>() / RADIUS_ANGLES as f64
    }

    /// Distance of a point outside its outline, mm.
    pub fn outside_mm(&self, place: &Place) -> f64 {
        place.radius_mm - self.nearest(place.at.0).curve.radius(place.angle)
    }

    /// Vector from the middle of its outline to a point, perpendicular to the axis, body frame, mm.
    pub fn arm(&self, point: &Point3<f64>) -> Vector3<f64> {
        let along_mm = self.axis.along(point);
        point - self.axis.at(along_mm, &self.nearest(along_mm).centre)
    }

    /// The outline nearest to a distance along the axis.
    fn nearest(&self, along_mm: f64) -> &Outline {
        let above = self.outlines.partition_point(|outline| outline.along_mm < along_mm);
        let [low, high] = [above.saturating_sub(1), above.min(self.outlines.len() - 1)];
        let far = |index: usize| (self.outlines[index].along_mm - along_mm).abs();
        &self.outlines[if far(low) <= far(high) { low } else { high }]
    }
}
