//! The quasi-grid: sections as rows with one common sequence of columns (paper 2), so that every
//! row has the same number of points and a column keeps its meaning along the leg.

use std::f64::consts::{PI, TAU};

use nalgebra::Point3;

use super::ridge_parametrization::Columns;
use crate::sections::axis::LegAxis;
use crate::sections::section::Outline;

/// Columns: one every 5°, about as many as the skin has pieces.
pub const COLUMNS: usize = 72;

/// Points of the skin as rows × columns.
#[derive(Debug, Clone)]
pub struct Grid {
    /// Distance of each row along the axis, mm, ascending.
    pub along_mm: Vec<f64>,
    /// Parameter v of each column, radians from −π on, ascending; see [`Columns`].
    pub columns: Vec<f64>,
    /// `rows × columns` points, row-major, body frame, mm.
    pub points: Vec<Point3<f64>>,
}

impl Grid {
    /// The grid of outlines, which must ascend.
    pub fn of(axis: &LegAxis, outlines: &[Outline], columns: &Columns) -> Grid {
        let v: Vec<f64> = (0..COLUMNS).map(|c| -PI + TAU * c as f64 / COLUMNS as f64).collect();
        let row = |outline: &Outline| {
            let angle = columns.angles_at(outline.along_mm);
            let plane = axis.plane(outline.along_mm);
            v.iter().map(|v| outline.point(&plane, angle(*v))).collect::<Vec<_>>()
        };
        let points = outlines.iter().flat_map(row).collect();
        let along_mm = outlines.iter().map(|outline| outline.along_mm).collect();
        Grid { along_mm, columns: v, points }
    }
}
