//! Sections: points on a plane across the leg, fitted by a closed curve (paper 1.1, fig. 2b–2d).
//!
//! The points need not be a closed outline nor in any order, so holes and shells that overlap cost
//! only their points. The curve is radius over angle about the section's centroid.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

use nalgebra::Point2;
use rayon::prelude::*;

use super::axis::{LegAxis, outline_centroid};
use super::hull::Hull;
use super::method::SectionFit;
use super::polynomial::{self, Polynomial};
use super::segment::Leg;
use super::slice::Crossing;
use crate::spline::{Basis, Smoothing, Spline, fit, robust_fit};

/// Distance of neighbouring sections along the axis, mm.
pub const SPACING_MM: f64 = 5.0;

/// The lowest section, mm along the axis: through the foot's instep, below every malleolus.
const LOWEST_MM: f64 = 40.0;

/// Pieces of the periodic curve: 7.5° each, which is 4 mm on a slim ankle and 11 mm on a thigh;
/// how much of that is used is for the smoothing to say.
const INTERVALS: usize = 48;

/// Smallest scale of residuals, mm: perfect data must not throw out their own rounding.
const SCALE_MIN_MM: f64 = 0.02;

/// Of how many section planes one gives its share to the choice of smoothing; the median over some
/// twenty is as good as that over all.
const SMOOTHING_STRIDE: usize = 6;

/// A section with fewer points than this is not fitted.
const POINTS_MIN: usize = 24;

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
    /// How every one of them was fitted.
    pub fit: Fit,
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
    /// A periodic cubic smoothing spline.
    Periodic(Spline),
    /// The paper's polynomial.
    Polynomial(Polynomial),
}

impl Curve {
    /// Radius at an angle, mm.
    pub fn radius(&self, angle: f64) -> f64 {
        match self {
            Curve::Periodic(spline) => spline.value(angle),
            Curve::Polynomial(polynomial) => polynomial.derivatives(angle)[0],
        }
    }

    /// Radius and its first two derivatives by the angle.
    pub fn derivatives(&self, angle: f64) -> [f64; 3] {
        match self {
            Curve::Periodic(spline) => {
                let [r, dr, ddr, _] = spline.derivatives(angle);
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

/// Cuts a leg into sections, from the foot up to the crotch.
pub fn sections(leg: &Leg, axis: LegAxis, crotch_height_mm: f64, fit: SectionFit) -> Sections {
    let top_mm = crotch_height_mm / axis.direction.z;
    let count = ((top_mm - LOWEST_MM) / SPACING_MM).max(0.0) as usize;
    let along: Vec<f64> = (0..count).map(|i| LOWEST_MM + SPACING_MM * i as f64).collect();
    let slices = axis.slices(leg, &along);
    let fit = match fit {
        SectionFit::Periodic => Fit::Periodic { lambda: lambda(&axis, &slices) },
        SectionFit::Polynomial => Fit::Polynomial,
    };
    let row = |(&along_mm, slice): (&f64, &Vec<Crossing>)| Row {
        along_mm,
        section: section(&axis, along_mm, &axis.points(slice), fit),
    };
    let rows = along.par_iter().zip(&slices).map(row).collect();
    Sections { axis, fit, rows }
}

impl Sections {
    /// Sections of the same leg at other distances along the axis, which must ascend, fitted
    /// alike; none where the skin does not close.
    pub fn at(&self, leg: &Leg, along_mm: &[f64]) -> Vec<Option<Section>> {
        let slices = self.axis.slices(leg, along_mm);
        let one = |(&along_mm, slice): (&f64, &Vec<Crossing>)| {
            section(&self.axis, along_mm, &self.axis.points(slice), self.fit)
        };
        along_mm.iter().zip(&slices).map(one).collect()
    }
}

/// How the sections of one leg are fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fit {
    /// A periodic smoothing spline with this relative penalty, see [`Smoothing::Fixed`].
    Periodic {
        /// The penalty's factor.
        lambda: f64,
    },
    /// The paper's polynomial.
    Polynomial,
}

/// The penalty for all sections of a leg: the median of what cross-validation finds for each.
///
/// Cross-validation takes errors for independent, but crossings of edges that share a mesh point
/// share its error. So it sees only crossings that share none; the factor it finds is relative to
/// the data and serves for all of them.
fn lambda(axis: &LegAxis, slices: &[Vec<Crossing>]) -> f64 {
    let one = |slice: &Vec<Crossing>| {
        let points = axis.points(&independent(slice));
        let centre = outline_centroid(&points)?;
        let (angles, radii) = polar(&points, centre);
        let weights = vec![1.0; radii.len()];
        fit(&basis()?, &angles, &radii, &weights, Smoothing::Gcv).ok().map(|fit| fit.lambda)
    };
    let mut found: Vec<f64> = slices.par_iter().step_by(SMOOTHING_STRIDE).filter_map(one).collect();
    found.sort_by(f64::total_cmp);
    found.get(found.len() / 2).copied().unwrap_or(0.0)
}

/// The pieces of every periodic section curve.
fn basis() -> Option<Basis> {
    Basis::uniform_periodic(-PI, TAU, INTERVALS).ok()
}

/// Crossings of which no two share a point of the mesh, as many as come first.
fn independent(slice: &[Crossing]) -> Vec<Crossing> {
    let mut used = BTreeSet::new();
    let fresh = |crossing: &&Crossing| {
        let [from, to] = crossing.edge;
        !used.contains(&from) && !used.contains(&to) && used.insert(from) && used.insert(to)
    };
    slice.iter().filter(fresh).copied().collect()
}

/// Angles and radii of points about a centre.
fn polar(points: &[Point2<f64>], centre: Point2<f64>) -> (Vec<f64>, Vec<f64>) {
    let arms = points.iter().map(|p| p - centre);
    arms.map(|arm| (arm.y.atan2(arm.x), arm.norm())).unzip()
}

/// Fits one section about the centroid of its outline; none where too few points or too wide a gap leave it open.
pub fn section(axis: &LegAxis, along_mm: f64, points: &[Point2<f64>], fit: Fit) -> Option<Section> {
    if points.len() < POINTS_MIN {
        return None;
    }
    let centre = outline_centroid(points)?;
    let found = fitted(points, centre, fit)?;
    let largest_gap_deg = largest_gap_deg(&found.angles, &found.weights);
    if largest_gap_deg > GAP_MAX_DEG {
        return None;
    }
    Some(Section {
        along_mm,
        height_mm: axis.at(along_mm, &centre).z,
        centre,
        girth: girth(&found.curve)?,
        points: points.len(),
        r2: found.r2,
        rms_mm: found.rms_mm,
        largest_gap_deg,
        curve: found.curve,
    })
}

/// A curve and the data it was fitted to.
struct Fitted {
    curve: Curve,
    angles: Vec<f64>,
    weights: Vec<f64>,
    r2: f64,
    rms_mm: f64,
}

fn fitted(points: &[Point2<f64>], centre: Point2<f64>, fit: Fit) -> Option<Fitted> {
    let (angles, radii) = polar(points, centre);
    let (curve, weights) = match fit {
        Fit::Periodic { lambda } => {
            let fit = robust_fit(&basis()?, &angles, &radii, lambda, SCALE_MIN_MM).ok()?;
            (Curve::Periodic(fit.spline), fit.weights)
        }
        Fit::Polynomial => {
            (Curve::Polynomial(polynomial::fit(&angles, &radii)?), vec![1.0; radii.len()])
        }
    };
    let total: f64 = weights.iter().sum();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    let (mut rss, mut spread, mut weighted) = (0.0, 0.0, 0.0);
    for ((angle, radius), weight) in angles.iter().zip(&radii).zip(&weights) {
        let residual = radius - curve.radius(*angle);
        rss += residual * residual;
        weighted += weight * residual * residual;
        spread += (radius - mean).powi(2);
    }
    let r2 = if spread > 0.0 { 1.0 - rss / spread } else { 1.0 };
    Some(Fitted { curve, angles, weights, r2, rms_mm: (weighted / total).sqrt() })
}

/// Widest angle without a point that counts, degrees.
fn largest_gap_deg(angles: &[f64], weights: &[f64]) -> f64 {
    let counts = angles.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
    let mut seen: Vec<f64> = counts.map(|(angle, _)| *angle).collect();
    seen.sort_by(f64::total_cmp);
    let (Some(first), Some(last)) = (seen.first(), seen.last()) else {
        return 360.0;
    };
    let across_the_seam = first + TAU - last;
    let gaps = seen.windows(2).map(|pair| pair[1] - pair[0]);
    gaps.fold(across_the_seam, f64::max).to_degrees()
}

/// Circumference of a closed curve; none where it encloses nothing.
fn girth(curve: &Curve) -> Option<Girth> {
    let points = curve.points(GIRTH_ANGLES);
    let next = points.iter().cycle().skip(1);
    let contour_mm = points.iter().zip(next).map(|(p, q)| (q - p).norm()).sum();
    Some(Girth { tape_mm: Hull::of(&points)?.perimeter(), contour_mm })
}
