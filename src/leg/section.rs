//! Sections: closed curves where planes across the leg's axis meet the skin (paper 1.1, fig. 2d),
//! as radius over angle about the section's centre.

use std::f64::consts::{PI, TAU};

use nalgebra::Point2;
use rayon::prelude::*;

use super::axis::LegAxis;
use super::hull::Hull;
use super::method::SectionFit;
use super::plane::{self, PlaneFit};
use super::polynomial::Polynomial;
use super::segment::Leg;
use super::skin::Skin;
use super::slice::Crossing;
use crate::spline::Basis;

/// Distance of neighbouring sections along the axis, mm.
pub const SPACING_MM: f64 = 5.0;

/// Angles at which a curve's girth is measured; the chord error is 3·10⁻⁶ of the girth.
const GIRTH_ANGLES: usize = 720;

/// A section with a gap wider than this in its points is not measured, degrees: a bridge over
/// more is a guess.
pub const GAP_MAX_DEG: f64 = 60.0;

/// The sections of a leg from the foot to the groin.
#[derive(Debug, Clone)]
pub struct Sections {
    /// The frame the sections lie in.
    pub axis: LegAxis,
    /// What every one of them was taken from.
    pub source: Source,
    /// One entry a plane, [`SPACING_MM`] apart, ascending; none where the skin does not close.
    pub rows: Vec<Row>,
}

/// One section plane.
#[derive(Debug, Clone)]
pub struct Row {
    /// Distance of the plane along the axis, mm.
    pub along_mm: f64,
    /// The section, where it could be measured.
    pub section: Option<Section>,
}

/// A measured section.
#[derive(Debug, Clone)]
pub struct Section {
    /// Distance of the plane along the axis, mm.
    pub along_mm: f64,
    /// Height of the section's centre above the floor, mm.
    pub height_mm: f64,
    /// The centroid of the area inside, (front, lateral) in mm from the axis.
    pub centre: Point2<f64>,
    /// Radius over angle about `centre`.
    pub curve: Curve,
    /// Circumference.
    pub girth: Girth,
    /// Standard error of the girth and of its first two derivatives along the axis, where the fit
    /// knows them.
    pub girth_sd: Option<[f64; 3]>,
    /// Number of points on the plane.
    pub points: usize,
    /// Coefficient of determination of the radius over all points.
    pub r2: f64,
    /// Root mean square of the radial residuals, outliers at their weight, mm.
    pub rms_mm: f64,
    /// Widest gap between neighbouring points as seen from the centre, degrees.
    pub largest_gap_deg: f64,
}

/// Circumference of a section, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Girth {
    /// Of the convex hull: what a tape reads, which bridges hollows.
    pub tape_mm: f64,
    /// Along the skin.
    pub contour_mm: f64,
}

/// Radius over angle, mm over radians; angle 0 is the front, positive towards the lateral side.
#[derive(Debug, Clone)]
pub enum Curve {
    /// A periodic cubic spline.
    Periodic {
        /// Its basis, over angles in radians.
        basis: Basis,
        /// Its coefficients, mm.
        coefficients: Vec<f64>,
    },
    /// The paper's polynomial.
    Polynomial(Polynomial),
}

impl Curve {
    /// Radius at an angle, mm.
    pub fn radius(&self, angle: f64) -> f64 {
        match self {
            Curve::Periodic { basis, coefficients } => basis.row(angle).dot(coefficients),
            Curve::Polynomial(polynomial) => polynomial.derivatives(angle)[0],
        }
    }

    /// Radius and its first two derivatives by the angle.
    pub fn derivatives(&self, angle: f64) -> [f64; 3] {
        match self {
            Curve::Periodic { basis, coefficients } => {
                let [r, dr, ddr, _] = basis.rows(angle).map(|row| row.dot(coefficients));
                [r, dr, ddr]
            }
            Curve::Polynomial(polynomial) => polynomial.derivatives(angle),
        }
    }

    /// The point at an angle, relative to the centre, (front, lateral) in mm.
    pub fn point(&self, angle: f64) -> Point2<f64> {
        let radius = self.radius(angle);
        Point2::new(radius * angle.cos(), radius * angle.sin())
    }

    /// `count` points at equal angles from −180° on.
    pub fn points(&self, count: usize) -> Vec<Point2<f64>> {
        (0..count).map(|index| self.point(-PI + TAU * index as f64 / count as f64)).collect()
    }
}

impl Section {
    /// The skin's point at an angle, in the body frame.
    pub fn point(&self, axis: &LegAxis, angle: f64) -> nalgebra::Point3<f64> {
        axis.at(self.along_mm, &(self.centre + self.curve.point(angle).coords))
    }
}

/// What the sections of one leg are taken from.
#[derive(Debug, Clone)]
pub enum Source {
    /// The skin as one function, fitted to all points.
    Skin(Box<Skin>),
    /// Each plane's own crossings.
    Planes(PlaneFit),
}

/// Cuts a leg into sections between two distances along its axis, from above the foot to the
/// crotch; none where it has hardly any points.
pub fn sections(
    leg: &Leg,
    axis: LegAxis,
    [from_mm, to_mm]: [f64; 2],
    fit: SectionFit,
) -> Option<Sections> {
    let count = ((to_mm - from_mm) / SPACING_MM).max(0.0) as usize;
    let along_mm: Vec<f64> = (0..count).map(|i| from_mm + SPACING_MM * i as f64).collect();
    let source = match fit {
        SectionFit::Skin => Source::Skin(Box::new(Skin::of(leg, &axis, from_mm, to_mm)?)),
        SectionFit::Periodic => {
            Source::Planes(PlaneFit::periodic(&axis, &axis.slices(leg, &along_mm)))
        }
        SectionFit::Polynomial => Source::Planes(PlaneFit::Polynomial),
    };
    let mut sections = Sections { axis, source, rows: Vec::new() };
    let found = sections.at(leg, &along_mm);
    let rows = along_mm.into_iter().zip(found);
    sections.rows = rows.map(|(along_mm, section)| Row { along_mm, section }).collect();
    Some(sections)
}

impl Sections {
    /// The section of the plane nearest to a distance along the axis; none where it is open.
    pub fn nearest(&self, along_mm: f64) -> Option<&Section> {
        let far = |row: &&Row| (row.along_mm - along_mm).abs();
        let row = self.rows.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        row.and_then(|row| row.section.as_ref())
    }

    /// The sections of the same leg at other distances along the axis, which must ascend, from the
    /// same source; none where the skin does not close.
    pub fn at(&self, leg: &Leg, along_mm: &[f64]) -> Vec<Option<Section>> {
        match &self.source {
            Source::Skin(skin) => {
                along_mm.par_iter().map(|along_mm| skin.section(&self.axis, *along_mm)).collect()
            }
            Source::Planes(fit) => {
                let slices = self.axis.slices(leg, along_mm);
                let one = |(&along_mm, slice): (&f64, &Vec<Crossing>)| {
                    plane::section(&self.axis, along_mm, slice, *fit)
                };
                along_mm.par_iter().zip(&slices).map(one).collect()
            }
        }
    }
}

/// Coefficient of determination from the sums of squared residuals, of squared deviations from the
/// mean, and of squared values; 1 where the values differ by rounding only.
pub fn r2(residuals: f64, deviations: f64, values: f64) -> f64 {
    const ROUNDING: f64 = 1e-18;
    if deviations > ROUNDING * values { 1.0 - residuals / deviations } else { 1.0 }
}

/// Widest angle between neighbours among angles in radians, degrees; 360 where there are none.
pub fn largest_gap_deg(angles: &[f64]) -> f64 {
    let mut seen = angles.to_vec();
    seen.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (seen.first(), seen.last()) else {
        return 360.0;
    };
    let across_the_seam = first + TAU - last;
    let gaps = seen.windows(2).map(|pair| pair[1] - pair[0]);
    gaps.fold(across_the_seam, f64::max).to_degrees()
}

/// Circumference of a closed curve; none where it encloses nothing.
pub fn girth(curve: &Curve) -> Option<Girth> {
    let points = curve.points(GIRTH_ANGLES);
    let next = points.iter().cycle().skip(1);
    let contour_mm = points.iter().zip(next).map(|(p, q)| (q - p).norm()).sum();
    Some(Girth { tape_mm: Hull::of(&points)?.perimeter(), contour_mm })
}
