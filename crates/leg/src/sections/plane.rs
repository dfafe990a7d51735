//! Sections plane by plane, each from its own points on the plane (paper 1.1, fig. 2c, 2d), as an
//! alternative to [`super::skin`]: a periodic spline through the intersections with the mesh, or
//! the paper's polynomial through the paper's pairs ([`super::point_pairs`]).
//!
//! The points need not form a closed outline or be in any order, so holes and overlapping shells
//! only affect their own points.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

use gaiter_spline::{Basis, Smoothing, Spline, fit, r2, robust_fit};
use nalgebra::Point2;
use rayon::prelude::*;

use super::axis::LegAxis;
use super::centroid::outline_centroid;
use super::plane_frame::PlaneFrame;
use super::polynomial;
use super::section::{Curve, Section, girth};
use super::slice::Crossing;
use crate::statistics::{GAP_MAX_DEG, largest_gap_deg, median};

/// Pieces of the periodic curve: 7.5° each, which is 4 mm on a slim ankle and 11 mm on a thigh; the
/// smoothing determines how much of this resolution is used.
const INTERVALS: usize = 48;

/// Minimum scale of residuals, mm, so that perfect data do not lose points to rounding errors.
const SCALE_MIN_MM: f64 = 0.02;

/// One in this many section planes contributes to the choice of smoothing; the median over some
/// twenty is as good as that over all.
const SMOOTHING_STRIDE: usize = 6;

/// A section with fewer points than this is not fitted.
const POINTS_MIN: usize = 24;

/// A polynomial of order 15 oscillates in a gap wider than this, degrees: its girth is then off by
/// centimetres while its R² stays at 0.9998.
const POLYNOMIAL_GAP_MAX_DEG: f64 = 20.0;

/// The curve that is fitted to the points of a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlaneFit {
    /// A periodic smoothing spline with this relative penalty, see [`Smoothing::Fixed`].
    Periodic {
        /// The penalty's factor.
        lambda: f64,
    },
    /// The paper's polynomial.
    Polynomial,
}

/// The penalty for all sections of a leg: the median of the cross-validation results for each.
///
/// Cross-validation assumes independent errors, but crossings of edges with a common mesh point
/// share its error. So it only uses crossings without common points; the resulting factor is
/// relative to the data and valid for all of them.
pub(crate) fn lambda(axis: &LegAxis, along_mm: &[f64], slices: &[Vec<Crossing>]) -> f64 {
    let one = |(along_mm, slice): (&f64, &Vec<Crossing>)| {
        let points = independent(&axis.plane(*along_mm), slice);
        let centre = outline_centroid(&points)?;
        let (angles, radii) = polar(&points, centre);
        let weights = vec![1.0; radii.len()];
        fit(&basis()?, &angles, &radii, &weights, Smoothing::Gcv).ok().map(|fit| fit.lambda)
    };
    let found = along_mm.par_iter().zip(slices).step_by(SMOOTHING_STRIDE).filter_map(one);
    median(found.collect()).unwrap_or(0.0)
}

/// The basis of every periodic section curve.
fn basis() -> Option<Basis> {
    Basis::uniform_periodic(-PI, TAU, INTERVALS).ok()
}

/// The crossings without common mesh points, as points of their plane, chosen greedily by position, so that the order in the file
/// makes no difference.
fn independent(plane: &PlaneFrame, slice: &[Crossing]) -> Vec<Point2<f64>> {
    let place = |crossing: &Crossing| (plane.coordinates(&crossing.position), crossing.edge);
    let mut ordered: Vec<_> = slice.iter().map(place).collect();
    ordered.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut used = BTreeSet::new();
    ordered.retain(|(_, [from, to])| {
        !used.contains(from) && !used.contains(to) && used.insert(*from) && used.insert(*to)
    });
    ordered.into_iter().map(|(point, _)| point).collect()
}

/// Angles and radii of points about a centre.
fn polar(points: &[Point2<f64>], centre: Point2<f64>) -> (Vec<f64>, Vec<f64>) {
    let arms = points.iter().map(|p| p - centre);
    arms.map(|arm| (arm.y.atan2(arm.x), arm.norm())).unzip()
}

/// Fits the section through points on a plane, (front, lateral) in mm, about the centroid of their
/// outline; `None` if there are too few points or too wide a gap.
pub(crate) fn section(
    axis: &LegAxis,
    along_mm: f64,
    points: &[Point2<f64>],
    fit: PlaneFit,
) -> Option<Section> {
    if points.len() < POINTS_MIN {
        return None;
    }
    let centre = outline_centroid(points)?;
    let (angles, radii) = polar(points, centre);
    let (curve, weights, gap_max_deg) = match fit {
        PlaneFit::Periodic { lambda } => {
            let fit = robust_fit(&basis()?, &angles, &radii, lambda, SCALE_MIN_MM).ok()?;
            let Spline { basis, coefficients, .. } = fit.spline;
            (Curve::Periodic { basis, coefficients }, fit.weights, GAP_MAX_DEG)
        }
        PlaneFit::Polynomial => {
            let curve = Curve::Polynomial(polynomial::fit(&angles, &radii)?);
            (curve, vec![1.0; radii.len()], POLYNOMIAL_GAP_MAX_DEG)
        }
    };
    let counts = angles.iter().zip(&weights).filter(|(_, weight)| **weight > 0.0);
    let largest_gap_deg = largest_gap_deg(&counts.map(|(angle, _)| *angle).collect::<Vec<_>>());
    if largest_gap_deg > gap_max_deg {
        return None;
    }
    let total: f64 = weights.iter().sum();
    let mean = radii.iter().sum::<f64>() / radii.len() as f64;
    let (mut rss, mut spread, mut weighted) = (0.0, 0.0, 0.0);
    for ((angle, radius), weight) in angles.iter().zip(&radii).zip(&weights) {
        let residual = radius - curve.radius(*angle);
        rss += residual * residual;
        weighted += weight * residual * residual;
        spread += (radius - mean).powi(2);
    }
    Some(Section {
        along_mm,
        height_mm: axis.at(along_mm, &centre).z,
        centre,
        girth: girth(&curve)?,
        girth_sd: None,
        wave_sd_mm: None,
        points: points.len(),
        r2: r2(rss, spread, mean * mean * radii.len() as f64),
        rms_mm: (weighted / total).sqrt(),
        largest_gap_deg,
        curve,
    })
}
