//! The quasi-grid: sections as rows, one common sequence of angles as columns (paper 2), so that
//! every row has the same number of points and a column means the same direction in all of them.

use std::f64::consts::{PI, TAU};

use nalgebra::Point3;

use super::section::Section;
use super::sections::Sections;

/// Columns: one every 5°, three times the surface's 24 control points.
pub const COLUMNS: usize = 72;

/// Points of the skin as rows × columns.
#[derive(Debug, Clone)]
pub struct Grid {
    /// Distance of each row along the axis, mm, ascending.
    pub along_mm: Vec<f64>,
    /// Angle of each column, radians from −π on, ascending.
    pub angles: Vec<f64>,
    /// `rows × columns` points, row-major, body frame, mm.
    pub points: Vec<Point3<f64>>,
}

impl Grid {
    /// The grid of the measured sections within a range along the axis; open ones have no row.
    pub fn of(sections: &Sections, from_mm: f64, to_mm: f64) -> Grid {
        let angles: Vec<f64> =
            (0..COLUMNS).map(|c| -PI + TAU * c as f64 / COLUMNS as f64).collect();
        let rows: Vec<&Section> = measured(sections, from_mm, to_mm).collect();
        let points = rows
            .iter()
            .flat_map(|section| angles.iter().map(|angle| section.point(&sections.axis, *angle)))
            .collect();
        Grid { along_mm: rows.iter().map(|section| section.along_mm).collect(), angles, points }
    }
}

/// The measured sections within a range along the axis, ascending.
pub fn measured(
    sections: &Sections,
    from_mm: f64,
    to_mm: f64,
) -> impl Iterator<Item = &Section> + Clone {
    let rows = sections.rows.iter().filter_map(|row| row.section.as_ref());
    rows.filter(move |section| (from_mm..=to_mm).contains(&section.along_mm))
}
