//! Feature points: peaks and valleys of the curvature around a section (paper 1.3, fig. 4b, 4c).
//!
//! The curvature is that of the section's outline without its finest harmonics. A feature point is
//! a turning point of the curvature that exceeds the leg's roundness and the scan's noise. Its
//! position is where the curvature has its extreme; where it has the same extreme over a stretch, the
//! middle of that stretch.

use std::f64::consts::{PI, SQRT_2, TAU};

use nalgebra::{Point2, Point3};

use super::circular_extrema::{ExtremePosition, TurningPoint, standing_out};
use super::harmonic::Harmonics;
use super::{curvature, harmonic};
use crate::sections::plane_frame::PlaneFrame;
use crate::sections::section::{Section, Spokes};

/// Angles at which the curvature is taken.
const ANGLES: usize = 360;

/// A peak or valley has a prominence of at least this share of the mean curvature 2π / girth; less
/// is a round side of the leg with uniform curvature.
const PROMINENCE_MIN_SHARE: f64 = 0.25;

/// … and of at least this many standard errors of a difference of two curvatures; less is noise.
const PROMINENCE_MIN_SD: f64 = 2.0;

/// Curvatures that differ by less than this share of the mean curvature are the same extreme: it is
/// half of the standard error of the curvature in the best of scans, and less than a line's width in the
/// figure of the curvature. Where a side is an arc of a circle, less would let rounding choose a place.
///
/// The standard error itself, 2 to 31 % of the mean curvature, is too much: the middle of all that is
/// within it is no more stable than the extreme when noise is added to bodies, and may lie on a bump of
/// a valley.
const SAME_SHARE: f64 = 0.01;

word_enum! {
    /// The kind of a feature point.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Kind {
        /// Locally most curved: a corner, such as the tibial crest or the Achilles tendon.
        Peak => "peak",
        /// Locally flattest or most hollow.
        Valley => "valley",
    }
}

/// A feature point of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feature {
    /// Peak or valley.
    pub kind: Kind,
    /// Angle around the section's centre, degrees in (−180, 180]: 0 front, 90 lateral.
    pub angle_deg: f64,
    /// The point on the fitted curve, body frame, mm.
    pub position: Point3<f64>,
    /// Standard error of the position along the skin from the scan's noise, mm. That noise may move the
    /// point to another bottom of the same valley, almost as deep, is not part of it.
    pub position_sd_mm: f64,
    /// The largest (peak) or smallest (valley) curvature of the turn, 1/mm, positive where convex. Waves
    /// of number n around are attenuated to 1 / (1 + (n / 7.5)⁶) of their size.
    pub curvature_per_mm: f64,
    /// Prominence relative to its neighbours, 1/mm.
    pub prominence_per_mm: f64,
}

/// The feature points of a section in its plane, in order around it from the front: P1, P2, …
pub fn features(plane: &PlaneFrame, section: &Section) -> Vec<Feature> {
    let (curvatures, turns) = turns(section, &Angles::from_section(section));
    let error = CurvatureError::from_section(section);
    let feature = |turn: TurningPoint| {
        let place = turn.place(&curvatures, SAME_SHARE * mean(section));
        let angle = wrapped(angle(turn.index as f64 + place.offset));
        let [radius_mm, slope, _] = section.curve.derivatives(angle);
        let step_mm = radius_mm.hypot(slope) * TAU / ANGLES as f64;
        Feature {
            kind: if turn.is_peak { Kind::Peak } else { Kind::Valley },
            angle_deg: angle.to_degrees(),
            position: section.point(plane, angle),
            position_sd_mm: step_mm * error.place_sd(&place),
            curvature_per_mm: curvatures[turn.index],
            prominence_per_mm: turn.prominence,
        }
    };
    let mut found: Vec<Feature> = turns.into_iter().map(feature).collect();
    found.sort_by(|a, b| a.angle_deg.rem_euclid(360.0).total_cmp(&b.angle_deg.rem_euclid(360.0)));
    found
}

/// The curvature in which the feature points of a section are found, at `count` equal angles from
/// −180° on, 1/mm. `count` must be a divisor of 360.
pub fn curvatures(section: &Section, count: usize) -> Vec<f64> {
    let all = curvature::around(&outline(section, &Angles::from_section(section)));
    all.into_iter().step_by(ANGLES / count).collect()
}

/// The angles at which the curvature of sections is taken.
pub struct Angles {
    harmonics: Harmonics,
    /// For curves in one basis; `None` for the paper's polynomial.
    spokes: Option<Spokes>,
}

impl Angles {
    /// The angles, quickest for sections in the basis of this one.
    pub fn from_section(section: &Section) -> Angles {
        Angles { harmonics: Harmonics::at(ANGLES), spokes: section.curve.spokes(ANGLES) }
    }
}

/// The middles of a section's curvature peaks, radians in (−π, π]: what a column of the surface's grid
/// follows from section to section. They are not the feature points, so the surface does not depend on
/// which of two bumps of a ridge is the greater; it comes as near to the skin with either.
pub(crate) fn peaks(section: &Section, angles: &Angles) -> Vec<f64> {
    let (curvatures, turns) = turns(section, angles);
    let peaks = turns.into_iter().filter(|turn| turn.is_peak);
    let middle = |turn: TurningPoint| turn.index as f64 + turn.middle(&curvatures, alike(section));
    peaks.map(|turn| wrapped(angle(middle(turn)))).collect()
}

/// The curvature around a section and its turning points beyond roundness and noise.
fn turns(section: &Section, angles: &Angles) -> (Vec<f64>, Vec<TurningPoint>) {
    let curvatures = curvature::around(&outline(section, angles));
    let noise = PROMINENCE_MIN_SD * SQRT_2 * CurvatureError::from_section(section).sd();
    let turns = standing_out(&curvatures, alike(section).max(noise));
    (curvatures, turns)
}

/// Curvatures that differ by less than this count as equal, 1/mm.
fn alike(section: &Section) -> f64 {
    PROMINENCE_MIN_SHARE * mean(section)
}

/// The mean curvature, 1/mm.
fn mean(section: &Section) -> f64 {
    TAU / section.girth.contour_mm
}

/// The angle at a (fractional) index into the angles.
fn angle(index: f64) -> f64 {
    -PI + TAU * index / ANGLES as f64
}

/// The section without its finest harmonics, relative to its centre, from −180° on.
fn outline(section: &Section, angles: &Angles) -> Vec<Point2<f64>> {
    let radii_mm = section.curve.radii(ANGLES, angles.spokes.as_ref());
    let smooth = angles.harmonics.smoothed(&radii_mm);
    // The first angle is −180°, so each direction is inverted.
    let directions = angles.harmonics.directions().map(|(cos, sin)| (-cos, -sin));
    smooth
        .into_iter()
        .zip(directions)
        .map(|(r, (cos, sin))| Point2::new(r * cos, r * sin))
        .collect()
}

/// The curvature error from the scan's noise: standard errors of its harmonics, 1/mm, the same for
/// the sine and the cosine.
struct CurvatureError([f64; harmonic::FINEST + 1]);

impl CurvatureError {
    /// A harmonic of the radius has twice the variance of its mean, and the harmonic n contributes
    /// (n² − 1) / r² of curvature.
    fn from_section(section: &Section) -> CurvatureError {
        let independent_mm = SQRT_2 * section.rms_mm / (section.points as f64).sqrt();
        let wave_sd_mm = section.wave_sd_mm.unwrap_or(independent_mm);
        let mean_radius_mm = section.girth.contour_mm / TAU;
        CurvatureError(std::array::from_fn(|n| {
            let bend = (n * n).saturating_sub(1) as f64 / mean_radius_mm.powi(2);
            wave_sd_mm * harmonic::kept(n) * bend
        }))
    }

    /// Standard error of the curvature at any angle.
    fn sd(&self) -> f64 {
        self.0.iter().map(|sd| sd * sd).sum::<f64>().sqrt()
    }

    /// Standard error of a place, in steps, propagated through each harmonic.
    fn place_sd(&self, place: &ExtremePosition) -> f64 {
        let variance = |(n, sd): (usize, &f64)| {
            let (mut sine, mut cosine) = (0.0, 0.0);
            for (index, pull) in &place.pulls {
                let (sin, cos) = (n as f64 * angle(*index as f64)).sin_cos();
                sine += pull * sin;
                cosine += pull * cos;
            }
            sd * sd * (sine * sine + cosine * cosine)
        };
        self.0.iter().enumerate().map(variance).sum::<f64>().sqrt()
    }
}

/// The equivalent angle in (−π, π].
fn wrapped(angle: f64) -> f64 {
    PI - (PI - angle).rem_euclid(TAU)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_angle_of_the_seam_is_180_degrees() {
        assert_eq!(wrapped(-PI), PI);
        assert_eq!(wrapped(PI), PI);
        assert!((wrapped(3.0 * PI / 2.0) + PI / 2.0).abs() < 1e-15);
    }
}
