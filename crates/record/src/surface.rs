//! The surface of a leg in `record.json`: its extent, its error, and the holes it bridges.

use std::collections::BTreeMap;

use gaiter_leg::LegReport;
use gaiter_leg::surface::fit_error::FitError;
use gaiter_leg::surface::hole::Hole;
use gaiter_leg::surface::nurbs::LegSurface;
use gaiter_spline::DEGREE;
use serde::{Deserialize, Serialize};

use super::rounding::{cm2, degrees, mm, share};

/// The surface's extent and error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SurfaceFigures {
    /// Number along and around the leg.
    pub control_points: [usize; 2],
    /// Degree along and around the leg.
    pub degree: [usize; 2],
    /// Where the knots lie along and around: `adaptive`, `widened`, `uniform-instead`, …
    pub knots: Vec<String>,
    /// Height of the lower end's centre.
    pub from_height_mm: f64,
    /// Height of the upper end's centre.
    pub to_height_mm: f64,
    /// Distances of the measured sections, without holes.
    pub to_sections: ErrorFigures,
    /// Distances of the sections in holes, where both only bridge the hole; null without holes.
    pub in_holes: Option<ErrorFigures>,
    /// Distances of the scan's own points.
    pub to_points: ErrorFigures,
    /// The surface's girth at the levels it covers, by name.
    pub girths: BTreeMap<String, SurfaceGirth>,
    /// The holes it bridges, largest first.
    pub holes: Vec<HoleFigures>,
}

/// Distances from the surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct ErrorFigures {
    /// Area-weighted mean of |distance| / local radius.
    pub mean_relative: f64,
    /// Root mean square.
    pub rms_mm: f64,
    /// 95 % of the area lies within this distance.
    pub p95_mm: f64,
    /// The largest distance.
    pub max_mm: f64,
}

/// The girth of the surface at a level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct SurfaceGirth {
    /// Along the surface's own section.
    pub contour_mm: f64,
    /// The same minus the girth of the section on which the level was measured.
    pub minus_section_mm: f64,
}

/// A hole of the scan that the surface bridges.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct HoleFigures {
    /// Height of its middle above the floor.
    pub height_mm: f64,
    /// Angle of its middle around the leg: 0 front, 90 lateral.
    pub angle_deg: f64,
    /// Extent along the leg.
    pub length_mm: f64,
    /// Extent around the leg.
    pub width_mm: f64,
    /// Area.
    pub area_cm2: f64,
}

/// The figures of a leg's surface; `None` if it has none.
pub(crate) fn surface(report: &LegReport) -> Option<SurfaceFigures> {
    let leg = report.surface.as_ref()?;
    let [from_mm, to_mm] = leg.height_mm;
    Some(SurfaceFigures {
        control_points: [leg.surface.along().count(), leg.surface.around().count()],
        degree: [DEGREE; 2],
        knots: leg.knots.iter().map(|used| used.word().to_owned()).collect(),
        from_height_mm: mm(from_mm),
        to_height_mm: mm(to_mm),
        to_sections: error(&leg.to_sections),
        in_holes: leg.in_holes.as_ref().map(error),
        to_points: error(&leg.to_points),
        girths: girths(report, leg),
        holes: leg.holes().iter().map(|at| hole(leg, at)).collect(),
    })
}

fn girths(report: &LegReport, leg: &LegSurface) -> BTreeMap<String, SurfaceGirth> {
    let (low, high) = leg.surface.along().domain();
    let covered = report.level_sections.iter().filter(|at| {
        let along_mm = at.section.along_mm;
        (low..=high).contains(&along_mm)
    });
    let girth = |at: &gaiter_leg::LevelSection| {
        let own_mm = leg.surface.girth_mm(at.section.along_mm);
        let minus_section_mm = mm(own_mm - at.section.girth.contour_mm);
        (at.level.name().to_owned(), SurfaceGirth { contour_mm: mm(own_mm), minus_section_mm })
    };
    covered.map(girth).collect()
}

fn hole(leg: &LegSurface, hole: &Hole) -> HoleFigures {
    let (height_mm, angle_deg) = leg.middle_of(hole);
    HoleFigures {
        height_mm: mm(height_mm),
        angle_deg: degrees(angle_deg),
        length_mm: mm(hole.length_mm),
        width_mm: mm(hole.width_mm),
        area_cm2: cm2(hole.area_mm2),
    }
}

fn error(error: &FitError) -> ErrorFigures {
    ErrorFigures {
        mean_relative: share(error.mean_relative),
        rms_mm: mm(error.rms_mm),
        p95_mm: mm(error.p95_mm),
        max_mm: mm(error.max_mm),
    }
}
