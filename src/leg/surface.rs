//! The NURBS surface of a leg and how far it lies from the sections and from the scan's points
//! (paper 2).

use std::f64::consts::{PI, TAU};

use super::axis::LegAxis;
use super::columns::Columns;
use super::fit_error::{FitError, Place, feet};
use super::grid::Grid;
use super::hole::{Coverage, Hole};
use super::method::{SurfaceFrom, SurfaceMethod};
use super::ridge::ridges;
use super::section::{Outline, Section};
use super::sections::Sections;
use super::segment::Leg;
use super::span::span;
use crate::spline::{
    CloudData, CloudMethod, DEGREE, FitFault, GridData, GridDomain, GridMethod, GridSmoothing,
    KnotsUsed, Surface, SurfaceFit, fit_cloud, fit_grid_by,
};
use nalgebra::Point3;

/// Distance of the rows of control points where nobody chose their number, mm.
const ROW_MM: f64 = 12.0;

/// Columns of control points where nobody chose their number.
const COLUMNS: usize = 36;

/// Rows of the grid needed for each row of control points, so that none is left to the ridge.
const ROWS_PER_CONTROL_ROW: f64 = 1.25;

/// The fewest sections of what must be covered that make a surface: 10 cm of a leg.
const ROWS_MIN: usize = 20;

/// Angles at which a section is compared with the surface: none of them a column of the grid.
const CHECK_ANGLES: usize = 90;

/// Points that lie off the surface by more are no skin of it, mm: they fill no hole.
const STRAY_MM: f64 = 6.0;

/// Points so far beyond the ends still show that the skin at the ends was seen, mm.
const BEYOND_MM: f64 = 20.0;

/// Places around at which the girth of the surface is measured; the chord error is 3·10⁻⁶ of it.
const GIRTH_PLACES: usize = 720;

/// A leg's surface in the body frame.
#[derive(Debug, Clone)]
pub struct LegSurface {
    /// Parameters: u, distance along the axis in mm, so that curves of constant u are sections; v,
    /// column in radians from −π, see [`Columns`].
    pub surface: Surface,
    /// Where the columns run.
    pub columns: Columns,
    /// What of it was seen, with the holes that it bridges.
    pub coverage: Coverage,
    /// Where its knots lie along and around.
    pub knots: [KnotsUsed; 2],
    /// Height of the lower and the upper end's centre above the floor, mm.
    pub height_mm: [f64; 2],
    /// How far the measured sections lie from it, where the skin was seen.
    pub to_sections: FitError,
    /// How far the sections lie from it in holes, where both are bridges; none without holes.
    pub in_holes: Option<FitError>,
    /// How far the scan's own points lie from it, noise included.
    pub to_points: FitError,
}

/// Why sections allow no surface.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoSurface {
    /// Too little of the leg is seen.
    #[error(
        "no surface: between {from_mm:.0} and {to_mm:.0} mm only {rows} sections are seen without a \
         band between them, where it needs {needed}"
    )]
    TooFewRows {
        /// Sections in the longest part.
        rows: usize,
        /// Sections needed.
        needed: usize,
        /// From this height, mm.
        from_mm: f64,
        /// To this height, mm.
        to_mm: f64,
    },
    /// The sections cannot be fitted.
    #[error("no surface: {0}")]
    Fit(#[from] FitFault),
}

/// Where the surface shall lie.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// The heights that it must cover, mm; it goes on upwards as far as the skin was seen.
    pub height_mm: [f64; 2],
    /// Distances along the axis of levels that shall be rows of the grid, mm, ascending.
    pub levels_mm: &'a [f64],
}

/// Fits the surface from the highest section that is not above the lower height up to the groin, as
/// far as the skin was seen.
///
/// # Errors
/// [`NoSurface`] where too few sections are seen to determine it.
pub fn surface(
    leg: &Leg,
    sections: &Sections,
    wanted: &Wanted,
    method: &SurfaceMethod,
) -> Result<LegSurface, NoSurface> {
    let axis = &sections.axis;
    let mut outlines = span(sections, wanted.height_mm);
    let [from_mm, to_mm] = wanted.height_mm;
    let is_wanted = |outline: &&Outline| {
        (from_mm..=to_mm).contains(&axis.at(outline.along_mm, &outline.centre).z)
    };
    let (rows, needed) = (outlines.iter().filter(is_wanted).count(), ROWS_MIN);
    let too_few = NoSurface::TooFewRows { rows, needed, from_mm, to_mm };
    let (Some(low), Some(high)) = (outlines.first(), outlines.last()) else { return Err(too_few) };
    let (low, high) = (low.along_mm, high.along_mm);
    if rows < needed {
        return Err(too_few);
    }
    let levels: Vec<f64> =
        wanted.levels_mm.iter().copied().filter(|mm| (low..=high).contains(mm)).collect();
    outlines.extend(sections.at(leg, &levels).iter().flatten().map(Outline::from));
    outlines.sort_by(|a, b| a.along_mm.total_cmp(&b.along_mm));

    let measured: Vec<&Section> = measured(sections, low, high).collect();
    let Some(columns) = Columns::following(&ridges(axis, &measured), low, high) else {
        return Err(too_few);
    };
    let grid = Grid::of(axis, &outlines, &columns);
    let fit = fitted(&grid, &levels, method)?;
    let knots = fit.knots;
    let surface = match method.from {
        SurfaceFrom::Sections => fit.surface,
        SurfaceFrom::Points => through_points(leg, axis, &outlines, &columns, &fit.surface)?,
    };
    let frame = Frame { axis, outlines: &outlines, columns: &columns, surface: &surface };
    let coverage = frame.coverage(leg);
    let places = section_places(axis, &measured, &columns);
    let feet_of_sections = feet(&surface, &places);
    let with_feet = || places.iter().zip(feet_of_sections.iter().map(|foot| foot.distance_mm));
    let is_in_hole = |place: &Place| coverage.is_in_hole(place.at.0, place.at.1);
    let seen = FitError::of(with_feet().filter(|(place, _)| !is_in_hole(place)));
    let in_holes = FitError::of(with_feet().filter(|(place, _)| is_in_hole(place)));
    let points = frame.places(leg, 0.0);
    let feet_of_points = feet(&surface, &points);
    let of_points = points.iter().zip(feet_of_points.iter().map(|foot| foot.distance_mm));
    let (Some(to_sections), Some(to_points)) = (seen, FitError::of(of_points)) else {
        return Err(too_few);
    };
    let height_mm = [&outlines[0], &outlines[outlines.len() - 1]]
        .map(|outline| axis.at(outline.along_mm, &outline.centre).z);
    Ok(LegSurface {
        height_mm,
        to_sections,
        in_holes,
        to_points,
        coverage,
        columns,
        knots,
        surface,
    })
}

/// The surface through a grid, with a row of knots at each level.
fn fitted(grid: &Grid, levels: &[f64], method: &SurfaceMethod) -> Result<SurfaceFit, FitFault> {
    let along = &grid.along_mm;
    let (low, high) = (along[0], along[along.len() - 1]);
    let rows = ((high - low) / ROW_MM).round() as usize + DEGREE;
    let most = (along.len() as f64 / ROWS_PER_CONTROL_ROW) as usize;
    let method = GridMethod {
        control_points: method.control_points.unwrap_or([rows.min(most), COLUMNS]),
        knots: method.knots,
        // The sections are smooth already, and their outliers gone.
        smoothing: GridSmoothing::None,
        robust: false,
        marks: [levels.to_vec(), Vec::new()],
    };
    let domain = GridDomain { along: [low, high], around_from: -PI, period: TAU };
    let data = GridData { along, around: &grid.columns, points: &grid.points };
    fit_grid_by(&data, &domain, &method)
}

/// The surface with the knots of another one, through the scan's own points.
fn through_points(
    leg: &Leg,
    axis: &LegAxis,
    outlines: &[Outline],
    columns: &Columns,
    like: &Surface,
) -> Result<Surface, FitFault> {
    let frame = Frame { axis, outlines, columns, surface: like };
    let places = frame.places(leg, 0.0);
    let points: Vec<Point3<f64>> = places
        .iter()
        .map(|place| {
            let across = axis.in_plane(&place.point);
            Point3::new(across.x, across.y, place.at.0)
        })
        .collect();
    let around: Vec<f64> = places.iter().map(|place| place.at.1).collect();
    let data = CloudData { points: &points, around: &around };
    let bases = (like.along().clone(), like.around().clone());
    let fit = fit_cloud(&data, bases.0.clone(), bases.1.clone(), &CloudMethod::default())?;
    let net = fit.surface.control_points().iter();
    let net = net.map(|point| axis.at(point.z, &point.xy())).collect();
    Ok(Surface::new(bases.0, bases.1, net)?)
}

impl LegSurface {
    /// Length of the surface's section at a distance along the axis, mm.
    pub fn girth_mm(&self, along_mm: f64) -> f64 {
        let v: Vec<f64> = (0..GIRTH_PLACES).map(|i| TAU * i as f64 / GIRTH_PLACES as f64).collect();
        let ring = self.surface.grid(&[along_mm], &v);
        let next = ring.iter().cycle().skip(1);
        ring.iter().zip(next).map(|(p, q)| (q - p).norm()).sum()
    }

    /// The holes it bridges, largest first.
    pub fn holes(&self) -> &[Hole] {
        &self.coverage.holes
    }
}

/// The measured sections within a range along the axis, ascending.
fn measured(sections: &Sections, from_mm: f64, to_mm: f64) -> impl Iterator<Item = &Section> {
    let rows = sections.rows.iter().filter_map(|row| row.section.as_ref());
    rows.filter(move |section| (from_mm..=to_mm).contains(&section.along_mm))
}

fn section_places(axis: &LegAxis, rows: &[&Section], columns: &Columns) -> Vec<Place> {
    let place = |section: &Section, index: usize| {
        let angle = -PI + TAU * (index as f64 + 0.5) / CHECK_ANGLES as f64;
        let [radius_mm, slope, _] = section.curve.derivatives(angle);
        let at = (section.along_mm, columns.column(section.along_mm, angle));
        Place { point: section.point(axis, angle), at, radius_mm, area: radius_mm.hypot(slope) }
    };
    let of = |section: &&Section| {
        let section: &Section = section;
        (0..CHECK_ANGLES).map(|index| place(section, index)).collect::<Vec<_>>()
    };
    rows.iter().flat_map(of).collect()
}

/// A surface where it belongs.
struct Frame<'a> {
    axis: &'a LegAxis,
    outlines: &'a [Outline],
    columns: &'a Columns,
    surface: &'a Surface,
}

impl Frame<'_> {
    /// The scan's points along the surface and up to `beyond_mm` further. They are spread evenly
    /// over the skin, so each stands for the same area.
    fn places(&self, leg: &Leg, beyond_mm: f64) -> Vec<Place> {
        let (low, high) = self.surface.along().domain();
        let place = |point: &Point3<f64>| {
            let along_mm = self.axis.along(point);
            (low - beyond_mm..=high + beyond_mm).contains(&along_mm).then(|| {
                let arm = self.axis.in_plane(point) - self.nearest(along_mm).centre;
                let angle = arm.y.atan2(arm.x);
                let at = (along_mm, self.columns.column(along_mm, angle));
                Place { point: *point, at, radius_mm: arm.norm(), area: 1.0 }
            })
        };
        leg.mesh.points().iter().filter_map(place).collect()
    }

    fn coverage(&self, leg: &Leg) -> Coverage {
        let (low, high) = self.surface.along().domain();
        let is_skin = |place: &Place| {
            let (along_mm, column) = place.at;
            let on = self.surface.point(along_mm, column);
            let arm = self.axis.in_plane(&on) - self.nearest(along_mm).centre;
            (arm.norm() - place.radius_mm).abs() <= STRAY_MM
        };
        let places = self.places(leg, BEYOND_MM);
        let places: Vec<(f64, f64)> =
            places.iter().filter(|place| is_skin(place)).map(|place| place.at).collect();
        let radius_mm = |along_mm: f64| {
            let outline = self.nearest(along_mm);
            (0..8).map(|i| outline.curve.radius(TAU * f64::from(i) / 8.0)).sum::<f64>() / 8.0
        };
        Coverage::of([low, high], &places, radius_mm)
    }

    /// The outline nearest to a distance along the axis.
    fn nearest(&self, along_mm: f64) -> &Outline {
        let above = self.outlines.partition_point(|outline| outline.along_mm < along_mm);
        let [low, high] = [above.saturating_sub(1), above.min(self.outlines.len() - 1)];
        let far = |index: usize| (self.outlines[index].along_mm - along_mm).abs();
        &self.outlines[if far(low) <= far(high) { low } else { high }]
    }
}
