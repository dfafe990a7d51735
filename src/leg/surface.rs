//! The NURBS surface of a leg and how far it lies from the sections and from the scan's points
//! (paper 2).

use std::f64::consts::{PI, TAU};

use nalgebra::{Point2, Point3};
use rayon::prelude::*;

use super::grid::{Grid, measured};
use super::section::Section;
use super::sections::Sections;
use super::segment::Leg;
use crate::spline::{Basis, GridData, Surface, fit_grid};

/// Control points along the leg and around it.
pub const CONTROL_POINTS: [usize; 2] = [30, 24];

/// Rows of the grid needed for each control row, so that none is left to the ridge.
const ROWS_PER_CONTROL_ROW: f64 = 1.0;

/// Angles at which a section is compared with the surface: none of them a column of the grid.
const CHECK_ANGLES: usize = 90;

/// A leg's surface in the body frame.
#[derive(Debug, Clone)]
pub struct LegSurface {
    /// Parameters: u, distance along the axis in mm; v, angle in radians from −π.
    pub surface: Surface,
    /// Height of the lower and the upper end's centre above the floor, mm.
    pub height_mm: [f64; 2],
    /// How far the measured sections lie from it.
    pub to_sections: FitError,
    /// How far the scan's own points lie from it, noise included.
    pub to_points: FitError,
}

/// Why sections allow no surface.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("no surface: only {rows} sections are seen between {from_mm:.0} and {to_mm:.0} mm")]
pub struct NoSurface {
    /// Sections seen.
    pub rows: usize,
    /// From this height, mm.
    pub from_mm: f64,
    /// To this height, mm.
    pub to_mm: f64,
}

/// Distances from the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitError {
    /// Mean of |distance| / local radius, weighted by area; 1 is 100 %.
    pub mean_relative: f64,
    /// Root mean square, weighted by area, mm.
    pub rms_mm: f64,
    /// Largest, mm.
    pub max_mm: f64,
}

/// Fits the surface between two heights: from the highest seen section that is not above the lower
/// to the lowest that is not below the upper, as far as there are such.
///
/// # Errors
/// [`NoSurface`] where too few sections are seen in the range to determine it.
pub fn surface(
    leg: &Leg,
    sections: &Sections,
    heights_mm: [f64; 2],
) -> Result<LegSurface, NoSurface> {
    let [from_mm, to_mm] = along_mm(sections, heights_mm);
    let grid = Grid::of(sections, from_mm, to_mm);
    let rows = grid.along_mm.len();
    let none = NoSurface { rows, from_mm: heights_mm[0], to_mm: heights_mm[1] };
    let [along_count, around_count] = CONTROL_POINTS;
    let (Some(&low), Some(&high)) = (grid.along_mm.first(), grid.along_mm.last()) else {
        return Err(none);
    };
    if (rows as f64) < ROWS_PER_CONTROL_ROW * along_count as f64 {
        return Err(none);
    }
    let along = Basis::uniform_clamped(low, high, along_count - crate::spline::DEGREE);
    let around = Basis::uniform_periodic(-PI, TAU, around_count);
    let (Ok(along), Ok(around)) = (along, around) else { return Err(none) };
    let data = GridData { along: &grid.along_mm, around: &grid.angles, points: &grid.points };
    let Ok(fit) = fit_grid(&data, along, around) else { return Err(none) };
    let inner: Vec<&Section> = measured(sections, low, high).collect();
    let [first, last] = [inner[0], inner[inner.len() - 1]];
    Ok(LegSurface {
        height_mm: [first.height_mm, last.height_mm],
        to_sections: to_sections(&fit.surface, sections, &inner),
        to_points: to_points(&fit.surface, leg, sections, &inner),
        surface: fit.surface,
    })
}

/// Distances along the axis of the sections that enclose two heights.
fn along_mm(sections: &Sections, [low_mm, high_mm]: [f64; 2]) -> [f64; 2] {
    let seen = sections.rows.iter().filter_map(|row| row.section.as_ref());
    let below = seen.clone().rfind(|section| section.height_mm <= low_mm);
    let above = seen.clone().find(|section| section.height_mm >= high_mm);
    [
        below.map_or(f64::NEG_INFINITY, |section| section.along_mm),
        above.map_or(f64::INFINITY, |section| section.along_mm),
    ]
}

/// A place of the skin to be compared: where, where on the surface it should be, its local radius
/// and the area it stands for.
struct Place {
    point: Point3<f64>,
    along_mm: f64,
    angle: f64,
    radius_mm: f64,
    area: f64,
}

fn to_sections(surface: &Surface, sections: &Sections, rows: &[&Section]) -> FitError {
    let places: Vec<Place> = rows
        .iter()
        .flat_map(|section| {
            (0..CHECK_ANGLES).map(move |index| {
                let angle = -PI + TAU * (index as f64 + 0.5) / CHECK_ANGLES as f64;
                let [radius_mm, slope, _] = section.curve.derivatives(angle);
                let area = radius_mm.hypot(slope);
                let point = section.point(&sections.axis, angle);
                Place { point, along_mm: section.along_mm, angle, radius_mm, area }
            })
        })
        .collect();
    fit_error(surface, &places)
}

/// The scan's points are spread evenly over the skin, so each stands for the same area.
fn to_points(surface: &Surface, leg: &Leg, sections: &Sections, rows: &[&Section]) -> FitError {
    let axis = &sections.axis;
    let (low, high) = surface.along().domain();
    let places: Vec<Place> = leg
        .mesh
        .points()
        .iter()
        .filter_map(|&point| {
            let along_mm = axis.along(&point);
            (low..=high).contains(&along_mm).then(|| {
                let arm = axis.in_plane(&point) - centre(rows, along_mm);
                let angle = arm.y.atan2(arm.x);
                Place { point, along_mm, angle, radius_mm: arm.norm(), area: 1.0 }
            })
        })
        .collect();
    fit_error(surface, &places)
}

/// The sections' centre at a distance along the axis, by the nearest row.
fn centre(rows: &[&Section], along_mm: f64) -> Point2<f64> {
    let above = rows.partition_point(|section| section.along_mm < along_mm);
    let candidates = &rows[above.saturating_sub(1)..(above + 1).min(rows.len())];
    let far = |section: &&&Section| (section.along_mm - along_mm).abs();
    let nearest = candidates.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
    nearest.map_or_else(Point2::origin, |section| section.centre)
}

/// Distances by foot points; order of summation is fixed, so results do not depend on threads.
fn fit_error(surface: &Surface, places: &[Place]) -> FitError {
    let distances: Vec<f64> = places
        .par_iter()
        .map(|place| surface.closest(&place.point, place.along_mm, place.angle).distance_mm)
        .collect();
    let (mut area, mut relative, mut squares, mut max_mm) = (0.0, 0.0, 0.0, 0.0_f64);
    for (place, distance) in places.iter().zip(&distances) {
        area += place.area;
        relative += place.area * distance / place.radius_mm;
        squares += place.area * distance * distance;
        max_mm = max_mm.max(*distance);
    }
    let area = area.max(f64::MIN_POSITIVE);
    FitError { mean_relative: relative / area, rms_mm: (squares / area).sqrt(), max_mm }
}
