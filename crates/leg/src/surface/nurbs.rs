//! The NURBS surface of a leg and its distance from the sections and from the scan's points (paper 2).

use std::f64::consts::{PI, TAU};

use gaiter_spline::{
    DEGREE, FitFault, GridData, GridDomain, GridMethod, Knots, KnotsUsed, Surface, SurfaceFit,
    fit_grid_by,
};
use nalgebra::Point3;
use rayon::prelude::*;

use super::cylindrical::Unrolled;
use super::error_map::ErrorMap;
use super::fit_error::{FitError, Off, SurfacePoint};
use super::hole::{Coverage, Hole};
use super::ridge::ridges;
use super::ridge_parametrization::Columns;
use crate::figure::{AsFigure, Figure};
use crate::parting::segment::Leg;
use crate::sections::axis::LegAxis;
use crate::sections::equidistant::Sections;
use crate::sections::plane_frame::PlaneFrame;
use crate::sections::section::{Outline, Section};

/// Default distance between the rows of control points, mm.
const ROW_MM: f64 = 12.0;

/// Default number of columns of control points.
const COLUMNS: usize = 36;

/// Columns of the grid: one every 5°, about as many as the skin has pieces.
const GRID_COLUMNS: usize = 72;

/// A section that is not measured still contributes its seen part to the surface, unless its gap is
/// wider than this, degrees.
const BRIDGED_GAP_DEG: f64 = 180.0;

/// A band longer than this without a measured section is not bridged, mm, because the girth of a
/// calf may have an extremum within it.
const BAND_MAX_MM: f64 = 40.0;

/// Rows of the grid needed for each row of control points, so that none is determined only by the
/// ridge term.
const ROWS_PER_CONTROL_ROW: f64 = 1.25;

/// Minimum number of sections in the required range for a surface: 10 cm of a leg.
const ROWS_MIN: usize = 20;

/// Rows of the grid closer than this are redundant, mm: of a level and a section, the level is kept.
const APART_MM: f64 = 1.0;

/// Number of positions along and around at which the surface is checked for folds: at most 10 mm apart.
const FOLD_PLACES: [usize; 2] = [96, 48];

/// Points further than this from their section are not its skin, mm, and fill no hole.
const STRAY_MM: f64 = 6.0;

/// Points this far beyond the ends still show that the skin at the ends was seen, mm.
const BEYOND_MM: f64 = 20.0;

/// A leg's surface in the body frame.
#[derive(Debug, Clone)]
pub struct LegSurface {
    /// Parameters: u is the distance along the axis in mm, so that curves of constant u are
    /// sections; v is the column in radians from −π on, see [`Columns`].
    pub surface: Surface,
    /// The positions of the columns.
    pub columns: Columns,
    /// The seen part of the surface, and the holes that it bridges.
    pub coverage: Coverage,
    /// Distances of the scan's points outside the surface, position by position.
    pub error_map: ErrorMap,
    /// The placement of its knots along and around.
    pub knots: [KnotsUsed; 2],
    /// Height of the centres of the lower and the upper end above the floor, mm.
    pub height_mm: [f64; 2],
    /// Distance of the measured sections from the surface, where the skin was seen.
    pub to_sections: FitError,
    /// Distance of the sections from the surface in holes, where both are bridges; `None` without
    /// holes.
    pub in_holes: Option<FitError>,
    /// Distance of the scan's own points from the surface, noise included.
    pub to_points: FitError,
}

coded_enum! {
    /// Why the sections do not allow a surface.
    #[derive(Debug, Clone, PartialEq)]
    pub enum NoSurface {
        /// Too little of the leg was seen.
        TooFewRows {
            /// Sections in the longest part.
            rows: usize,
            /// Sections needed.
            needed: usize,
            /// Lower end of the required heights, mm.
            from_mm: f64,
            /// Upper end of the required heights, mm.
            to_mm: f64,
        } => "no-surface-too-few-sections",
        /// The surface would fold, which skin around a middle line never does: it oscillates where too
        /// little of the leg was seen.
        Folded {
            /// Height of the fold, mm.
            height_mm: f64,
        } => "no-surface-folded",
        /// The whole surface lies in holes.
        NothingSeen => "no-surface-nothing-seen",
        /// The sections cannot be fitted.
        Fit {
            /// The reason.
            why: FitFault,
        } => "no-surface-fit",
    }
}

impl From<FitFault> for NoSurface {
    fn from(why: FitFault) -> NoSurface {
        NoSurface::Fit { why }
    }
}

impl AsFigure for FitFault {
    fn figure(&self) -> Option<Figure> {
        Some(Figure::Name(self.to_string()))
    }
}

/// The required extent and net of the surface.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'a> {
    /// The heights that it must cover, mm; it continues upwards as far as the skin was seen.
    pub height_mm: [f64; 2],
    /// Distances along the axis of levels that must be rows of the grid, mm, ascending.
    pub levels_mm: &'a [f64],
    /// Rows and columns of control points, along and around; `None` chooses them by the leg's length.
    pub control_points: Option<[usize; 2]>,
}

/// Fits the surface from the highest section that is not above the lower height up to the groin, as
/// far as the skin was seen.
///
/// # Errors
/// [`NoSurface`] if too few sections were seen to determine it.
pub fn surface(leg: &Leg, sections: &Sections, wanted: &Wanted) -> Result<LegSurface, NoSurface> {
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
    let levels = apart(wanted.levels_mm, [low, high]);
    let is_end = |mm: f64| mm <= low || mm >= high;
    let is_apart = |mm: f64| levels.iter().all(|level| (level - mm).abs() >= APART_MM);
    outlines.retain(|outline| is_end(outline.along_mm) || is_apart(outline.along_mm));
    outlines.extend(sections.at(leg, &levels).iter().flatten().map(Outline::from));
    outlines.sort_by(|a, b| a.along_mm.total_cmp(&b.along_mm));

    let rows = sections.rows.iter().filter_map(|row| row.section.as_ref());
    let measured: Vec<&Section> =
        rows.filter(|section| (low..=high).contains(&section.along_mm)).collect();
    let columns = Columns::following(&ridges(&measured), low, high)?;
    let unrolled = Unrolled::new(axis, &outlines, &columns);
    let points = unrolled.points(leg, low - BEYOND_MM, high + BEYOND_MM);
    let SurfaceFit { surface, knots, .. } =
        fitted(axis, &outlines, &columns, levels, wanted.control_points)?;
    let surface = with_plane_ends(axis, &surface)?;
    if let Some(height_mm) = fold(&unrolled, &surface) {
        return Err(NoSurface::Folded { height_mm });
    }
    let skin: Vec<bool> =
        points.iter().map(|place| unrolled.outside_mm(place).abs() <= STRAY_MM).collect();
    let shown = points.iter().zip(&skin).filter(|(_, is_skin)| **is_skin);
    let shown: Vec<(f64, f64)> = shown.map(|(place, _)| place.at).collect();
    let coverage = Coverage::find([low, high], &shown, |along_mm| unrolled.radius_mm(along_mm));
    let (to_sections, in_holes) = to_sections(&unrolled, &measured, &surface, &coverage);
    let on_it = points.iter().zip(skin).filter(|(place, _)| (low..=high).contains(&place.at.0));
    let (on_it, skin): (Vec<SurfacePoint>, Vec<bool>) = on_it.unzip();
    let off: Vec<Off> = on_it
        .par_iter()
        .map(|place| Off::measure(&surface, place, &unrolled.arm(&place.point, place.at.0)))
        .collect();
    let distances_mm: Vec<f64> = off.iter().map(|off| off.distance_mm).collect();
    let to_points = FitError::from_distances(&on_it, &distances_mm);
    let (Some(to_sections), Some(to_points)) = (to_sections, to_points) else {
        return Err(NoSurface::NothingSeen);
    };
    let outside = on_it.iter().zip(&off).zip(skin).filter(|(_, is_skin)| *is_skin);
    let outside = outside.filter_map(|((place, off), _)| Some((place, off.outside_mm?)));
    let error_map = ErrorMap::new([low, high], &columns, &coverage, outside);
    let height_mm = [&outlines[0], &outlines[outlines.len() - 1]]
        .map(|outline| axis.at(outline.along_mm, &outline.centre).z);
    Ok(LegSurface {
        height_mm,
        to_sections,
        in_holes,
        to_points,
        coverage,
        columns,
        error_map,
        knots,
        surface,
    })
}

/// The outlines, ascending, of the part of the leg that covers most of the heights and has no
/// longer band without a measured section. The part begins with the highest section that is not
/// above the lower height.
fn span(sections: &Sections, [low_mm, high_mm]: [f64; 2]) -> Vec<Outline> {
    let measured = sections.rows.iter().filter_map(|row| row.section.as_ref());
    let measured: Vec<&Section> = measured.collect();
    let parts = measured.chunk_by(|low, high| high.along_mm - low.along_mm <= BAND_MAX_MM);
    let covered_mm = |part: &&[&Section]| {
        let (Some(first), Some(last)) = (part.first(), part.last()) else { return 0.0 };
        last.height_mm.min(high_mm) - first.height_mm.max(low_mm)
    };
    let Some(part) = parts.max_by(|a, b| covered_mm(a).total_cmp(&covered_mm(b))) else {
        return Vec::new();
    };
    let first = part.iter().rposition(|section| section.height_mm <= low_mm).unwrap_or(0);
    let (from_mm, to_mm) = (part[first].along_mm, part[part.len() - 1].along_mm);
    let rows = sections.rows.iter().filter(|row| (from_mm..=to_mm).contains(&row.along_mm));
    rows.filter_map(|row| sections.outline(row, BRIDGED_GAP_DEG)).collect()
}

/// The levels (which ascend) without those too close to the previous one or to an end.
fn apart(levels_mm: &[f64], [low, high]: [f64; 2]) -> Vec<f64> {
    let is_inner = |mm: &f64| (low + APART_MM..=high - APART_MM).contains(mm);
    let mut inner: Vec<f64> = levels_mm.iter().copied().filter(is_inner).collect();
    inner.dedup_by(|next, last| *next - *last < APART_MM);
    inner
}

/// The surface through the quasi-grid of outlines, which must ascend, with a row of knots at each level. The rows of the
/// grid have one common sequence of columns (paper 2), so that every row has the same number of points and a column keeps
/// its meaning along the leg.
fn fitted(
    axis: &LegAxis,
    outlines: &[Outline],
    columns: &Columns,
    levels: Vec<f64>,
    control_points: Option<[usize; 2]>,
) -> Result<SurfaceFit, FitFault> {
    let along: Vec<f64> = outlines.iter().map(|outline| outline.along_mm).collect();
    let around: Vec<f64> =
        (0..GRID_COLUMNS).map(|c| -PI + TAU * c as f64 / GRID_COLUMNS as f64).collect();
    let row = |outline: &Outline| {
        let angle = columns.angles_at(outline.along_mm);
        let plane = axis.plane(outline.along_mm);
        around.iter().map(|v| outline.point(&plane, angle(*v))).collect::<Vec<_>>()
    };
    let points: Vec<Point3<f64>> = outlines.iter().flat_map(row).collect();
    let (low, high) = (along[0], along[along.len() - 1]);
    let rows = ((high - low) / ROW_MM).round() as usize + DEGREE;
    let most = (along.len() as f64 / ROWS_PER_CONTROL_ROW) as usize;
    let method = GridMethod {
        control_points: control_points.unwrap_or([rows.min(most), COLUMNS]),
        knots: Knots::Adaptive,
        marks: levels,
    };
    let domain = GridDomain { along: [low, high], around_from: -PI, period: TAU };
    let data = GridData { along: &along, around: &around, points: &points };
    fit_grid_by(&data, &domain, &method)
}

/// The surface with the control points of its ends moved into their planes, so that its ends are plane
/// where the planes turn, too.
fn with_plane_ends(axis: &LegAxis, surface: &Surface) -> Result<Surface, FitFault> {
    let (low, high) = surface.along().domain();
    let columns = surface.around().count();
    let mut net = surface.control_points().to_vec();
    let last = net.len() - columns;
    for (row, along_mm) in [(0..columns, low), (last..net.len(), high)] {
        let plane = axis.plane(along_mm);
        for point in &mut net[row] {
            *point -= plane.normal.into_inner() * plane.above(point);
        }
    }
    Ok(Surface::new(surface.along().clone(), surface.around().clone(), net)?)
}

/// The height of the lowest fold of a surface, mm, where its outside faces the middle of the leg.
/// Sections are curves with one radius per angle, so a surface through them has no folds.
fn fold(unrolled: &Unrolled, surface: &Surface) -> Option<f64> {
    let (low, high) = surface.along().domain();
    // The front and lateral directions turn counter-clockwise about the axis, so u × v points inward.
    let PlaneFrame { normal, front, lateral, .. } = unrolled.axis.foot;
    let outward = -front.cross(&lateral).dot(&normal).signum();
    let [rows, columns] = FOLD_PLACES;
    (0..rows).find_map(|i| {
        let along_mm = low + (high - low) * (i as f64 + 0.5) / rows as f64;
        let line = surface.line(along_mm);
        (0..columns).find_map(|j| {
            let here = line.derivatives(TAU * j as f64 / columns as f64);
            let arm = unrolled.arm(&here.point, along_mm);
            let faces_out = outward * here.du.cross(&here.dv).dot(&arm);
            (faces_out <= 0.0).then_some(here.point.z)
        })
    })
}

/// Distance of sections from a surface, where it was seen and in its holes.
fn to_sections(
    unrolled: &Unrolled,
    sections: &[&Section],
    surface: &Surface,
    coverage: &Coverage,
) -> (Option<FitError>, Option<FitError>) {
    let places = unrolled.sections(sections);
    let distances_mm = |(section, places): (&&Section, &Vec<SurfacePoint>)| -> Vec<f64> {
        let line = surface.line(section.along_mm);
        let distance_mm = |place: &SurfacePoint| {
            let (u, v) = place.at;
            surface.distance_mm(&place.point, [u, v], line.derivatives(v))
        };
        places.iter().map(distance_mm).collect()
    };
    let distances_mm: Vec<f64> =
        sections.par_iter().zip(&places).flat_map_iter(distances_mm).collect();
    let is_in_hole = |(place, _): &(SurfacePoint, f64)| coverage.is_in_hole(place.at.0, place.at.1);
    let places = places.into_iter().flatten().zip(distances_mm);
    let (in_holes, seen): (Vec<_>, Vec<_>) = places.partition(is_in_hole);
    let error = |places: Vec<(SurfacePoint, f64)>| {
        let (places, distances_mm): (Vec<SurfacePoint>, Vec<f64>) = places.into_iter().unzip();
        FitError::from_distances(&places, &distances_mm)
    };
    (error(seen), error(in_holes))
}

impl LegSurface {
    /// The holes it bridges, largest first.
    pub fn holes(&self) -> &[Hole] {
        &self.coverage.holes
    }

    /// The middle of a hole: its height above the floor, mm, and its angle around the leg, degrees
    /// in (−180, 180]: 0 front, 90 lateral.
    pub fn middle_of(&self, hole: &Hole) -> (f64, f64) {
        let Hole { along_mm, column, .. } = *hole;
        let angle_deg = self.columns.angle(along_mm, column).to_degrees();
        let height_mm = self.surface.point(along_mm, column).z;
        (height_mm, 180.0 - (180.0 - angle_deg).rem_euclid(360.0))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point2, Vector3};

    use super::*;
    use crate::sections::section::Curve;
    use crate::side::Side;
    use gaiter_spline::{Basis, fit_grid};

    /// A tube of 50 mm radius whose columns run backwards if `swing` is more than 0.5.
    fn tube(axis: &LegAxis, swing: f64) -> Surface {
        let along: Vec<f64> = (0..20).map(|i| 10.0 * f64::from(i)).collect();
        let around: Vec<f64> = (0..72).map(|j| TAU * f64::from(j) / 72.0 - PI).collect();
        let place = |(u, v): (f64, f64)| {
            // Only in the middle of its length.
            let angle = v + swing * (2.0 * v).sin() * (-((u - 120.0) / 30.0).powi(2)).exp();
            axis.at(u, &Point2::new(50.0 * angle.cos(), 50.0 * angle.sin()))
        };
        let places = along.iter().flat_map(|u| around.iter().map(move |v| (*u, *v)));
        let points: Vec<Point3<f64>> = places.map(place).collect();
        let data = GridData { along: &along, around: &around, points: &points };
        let bases = [Basis::uniform_clamped(0.0, 190.0, 14), Basis::uniform_periodic(-PI, TAU, 36)];
        let [rows, columns] = bases.map(Result::unwrap);
        fit_grid(&data, rows, columns).unwrap().surface
    }

    #[test]
    fn a_fold_is_found_with_its_height_and_none_where_columns_only_lie_closer() {
        let axis = LegAxis::straight(Point3::origin(), &Vector3::z(), Side::Left);
        let basis = Basis::uniform_periodic(-PI, TAU, 8).unwrap();
        let round = |along_mm: f64| Outline {
            along_mm,
            centre: Point2::origin(),
            curve: Curve::Periodic { coefficients: vec![50.0; 8], basis: basis.clone() },
        };
        let outlines: Vec<Outline> = (0..20).map(|i| round(10.0 * f64::from(i))).collect();
        let columns = Columns::following(&[], 0.0, 190.0).unwrap();
        let unrolled = Unrolled::new(&axis, &outlines, &columns);
        assert_eq!(fold(&unrolled, &tube(&axis, 0.4)), None);
        let height_mm = fold(&unrolled, &tube(&axis, 0.8)).unwrap();
        // 1 − 2 · 0.8 exp(−x²) is 0 where x = 0.69 · 30 mm below the middle.
        assert!((height_mm - (120.0 - 20.6)).abs() < 4.0, "{height_mm}");
    }
}
