//! The search for levels on the girth curve: B, C and D at its valleys and peak, B1 at its largest
//! slope (paper 1.2, fig. 3b and 3c; definitions in docs/record.md) or at a fixed height above B.
//!
//! The shape of the curve decides. Where it has several turning points, those count where people have
//! the level; one elsewhere is taken with a doubt. A missing level is reported as absent.

use super::extremum::{Absence, CLEAR_MM, Peak, extrema};
use super::girth::GirthCurve;
use super::landmark::Landmark;
use super::level_reading::Ruler;
use crate::doubt::Doubt;
use crate::level::{By, Level};
use crate::method::B1;
use crate::sections::equidistant::Sections;

/// An extremum with a prominence below this many standard errors is not clear.
const CLEAR_SDS: f64 = 3.0;

/// The search for levels starts here, as a share of stature: above the malleoli (ANSUR II, lateral
/// malleolus: mean 0.042, 99th percentile 0.048).
const FROM_STATURE_SHARE: f64 = 0.045;

/// … and ends here, as a share of the crotch's height: above every knee (mid-patella at 0.575).
const TO_CROTCH_SHARE: f64 = 0.80;

/// The slope at B1 is averaged over this length, mm, so that noise of single sections has little
/// effect.
const SLOPE_SPAN_MM: f64 = 30.0;

/// Step of the search for the largest slope, mm.
const STEP_MM: f64 = 1.0;

/// Closer than this to an end of the search, the curve is not seen on both sides of an extremum,
/// mm: the length of one of its pieces.
const EDGE_MM: f64 = 12.0;

/// Minimum standard error of the place of an extremum, mm: on noise-free bodies of known shape B, C and D are
/// off against each other by 0.6 to 2 mm (root mean square), because the curve is smooth.
const TURN_SD_MIN_MM: f64 = 0.7;

/// A height with a larger standard error than this is poorly determined, mm: a finger's breadth.
const FLAT_SD_MM: f64 = 15.0;

/// The result of the search for B, B1, C and D.
#[derive(Debug, Clone, PartialEq)]
pub struct Levels {
    /// Levels found, lowest first.
    pub found: Vec<Landmark>,
    /// Levels that are absent, with the reason, lowest first.
    pub absent: Vec<(Level, Absence)>,
}

/// Finds the levels.
pub fn levels(
    curve: &GirthCurve,
    stature_mm: f64,
    crotch_height_mm: f64,
    b1: B1,
    sections: &Sections,
) -> Levels {
    let (from, to) = curve.domain();
    let from_mm = from.max(FROM_STATURE_SHARE * stature_mm);
    let to_mm = to.min(TO_CROTCH_SHARE * crotch_height_mm);
    let ends_mm = [from_mm, to_mm];
    let [b, c, d] = extrema(curve, stature_mm, ends_mm);
    let search = Search { ruler: Ruler { curve, sections }, ends_mm, stature_mm };
    let turn = |level: Level, peak: Result<Peak, Absence>| {
        peak.and_then(|peak| search.extremum(level, &peak).ok_or(Absence::NoTurn))
    };
    let all = [
        (Level::B, turn(Level::B, b)),
        (Level::B1, search.b1(b1, b.ok(), c.ok())),
        (Level::C, turn(Level::C, c)),
        (Level::D, turn(Level::D, d)),
    ];
    let mut levels = Levels { found: Vec::new(), absent: Vec::new() };
    for (level, landmark) in all {
        match landmark {
            Ok(landmark) => levels.found.push(landmark),
            Err(absence) => levels.absent.push((level, absence)),
        }
    }
    levels
}

/// Turns positions on the girth curve into landmarks.
struct Search<'c> {
    ruler: Ruler<'c>,
    /// Start and end of the search, mm along the axis.
    ends_mm: [f64; 2],
    stature_mm: f64,
}

impl Search<'_> {
    /// A level at an extremum.
    fn extremum(&self, level: Level, peak: &Peak) -> Option<Landmark> {
        let (curve, along_mm) = (self.ruler.curve, peak.at.along_mm);
        let [_, _, bend, _] = curve.tape(along_mm);
        let by_noise_mm = curve.tape_sd(along_mm, 1) / bend.abs().max(f64::MIN_POSITIVE);
        let height_sd_mm = by_noise_mm.hypot(TURN_SD_MIN_MM);
        let girth_sd_mm = curve.tape_sd(along_mm, 0);
        let sds = [height_sd_mm, girth_sd_mm];
        let mut landmark = self.ruler.landmark(level, By::Turn, along_mm, sds)?;
        landmark.doubts.extend(self.extremum_doubts(peak, sds));
        Some(landmark)
    }

    /// The doubts about an extremum from the shape of the curve.
    fn extremum_doubts(&self, peak: &Peak, [height_sd_mm, girth_sd_mm]: [f64; 2]) -> Vec<Doubt> {
        let Peak { at, prominence_mm, rival_mm, .. } = *peak;
        let shallow = prominence_mm < CLEAR_MM.max(CLEAR_SDS * girth_sd_mm);
        let end_mm = self.ends_mm.map(|end| (end - at.along_mm).abs()).into_iter();
        let end_mm = end_mm.fold(f64::INFINITY, f64::min);
        let rival = rival_mm.and_then(|along_mm| self.ruler.curve.height_mm(along_mm));
        let shape = [
            shallow.then_some(Doubt::Shallow { prominence_mm }),
            (height_sd_mm > FLAT_SD_MM).then_some(Doubt::Flat { height_sd_mm }),
            rival.map(|other_height_mm| Doubt::Double { other_height_mm }),
        ];
        let edge = (end_mm < EDGE_MM).then_some(Doubt::Edge { end_mm });
        shape.into_iter().chain(self.which(peak)).chain([edge]).flatten().collect()
    }

    /// The doubts whether an extremum is the level, and not a fold or a swelling.
    fn which(&self, peak: &Peak) -> [Option<Doubt>; 2] {
        let other = peak.other_mm.and_then(|along_mm| self.ruler.curve.height_mm(along_mm));
        let percent = 100.0 * peak.at.along_mm / self.stature_mm;
        let several = other.map(|other_height_mm| Doubt::Several { other_height_mm });
        let unusual = (!peak.is_usual).then_some(Doubt::UnusualHeight { percent });
        [several, unusual]
    }

    /// B1 by the chosen definition.
    fn b1(&self, b1: B1, b: Option<Peak>, c: Option<Peak>) -> Result<Landmark, Absence> {
        let b_mm = b.ok_or(Absence::Needs { level: Level::B })?.at.along_mm;
        let c_mm = c.map(|c| c.at.along_mm);
        match b1 {
            B1::Steepest => {
                let c_mm = c_mm.ok_or(Absence::Needs { level: Level::C })?;
                let mut b1 = self.steepest(b_mm, c_mm).ok_or(Absence::NoTurn)?;
                // Between other levels it would be elsewhere.
                let doubts = [b, c].into_iter().flatten().flat_map(|of| self.which(&of));
                b1.doubts.extend(doubts.flatten());
                Ok(b1)
            }
            B1::AboveB { distance_mm } => self.above_b(b_mm, c_mm, distance_mm),
        }
    }

    /// B1 where the girth grows fastest between B and C.
    fn steepest(&self, b_mm: f64, c_mm: f64) -> Option<Landmark> {
        let curve = self.ruler.curve;
        let along_mm = steepest(curve, b_mm, c_mm)?;
        let slope = curve.tape(along_mm)[1];
        let height_sd_mm = steepest_sd_mm(curve, along_mm).min(SLOPE_SPAN_MM);
        let of_level_mm = curve.tape_sd(along_mm, 0).hypot(slope * height_sd_mm);
        // That the place is uncertain is no doubt: the girth belongs to its height.
        self.ruler.landmark(Level::B1, By::Steepest, along_mm, [height_sd_mm, of_level_mm])
    }

    /// B1 at a fixed height above B; its height has the standard error of B's, and it is never above C.
    fn above_b(&self, b_mm: f64, c_mm: Option<f64>, distance_mm: f64) -> Result<Landmark, Absence> {
        let curve = self.ruler.curve;
        let height_mm =
            curve.height_mm(b_mm).ok_or(Absence::Needs { level: Level::B })? + distance_mm;
        let [_, _, bend, _] = curve.tape(b_mm);
        let height_sd_mm = curve.tape_sd(b_mm, 1) / bend.abs().max(f64::MIN_POSITIVE);
        let by = By::AboveB { distance_mm };
        let ends = Absence::AboveSearch { along_mm: self.ends_mm[1] };
        let b1 = self.ruler.at_height(Level::B1, by, height_mm, height_sd_mm).ok_or(ends)?;
        match c_mm {
            Some(c_mm) if b1.along_mm > c_mm => Err(Absence::Beyond { level: Level::C }),
            _ => Ok(b1),
        }
    }
}

/// Where the curve rises fastest in a range, averaged over a span; `None` if the range is too short.
fn steepest(curve: &GirthCurve, from_mm: f64, to_mm: f64) -> Option<f64> {
    let count = ((to_mm - from_mm) / STEP_MM) as usize;
    let at = |index: usize| from_mm + STEP_MM * index as f64;
    let most = (1..count).max_by(|a, b| rise(curve, at(*a)).total_cmp(&rise(curve, at(*b))))?;
    // The parabola through the steepest step and its neighbours gives the position between the steps.
    let [before, own, after] = [most - 1, most, most + 1].map(|index| rise(curve, at(index)));
    let bend = before - 2.0 * own + after;
    let off = if bend < 0.0 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 };
    Some(at(most) + STEP_MM * off)
}

/// Slope of the curve over a span, limited to the curve's range.
fn rise(curve: &GirthCurve, along_mm: f64) -> f64 {
    let [below, above] = span(curve, along_mm);
    (curve.tape(above)[0] - curve.tape(below)[0]) / (above - below)
}

fn span(curve: &GirthCurve, along_mm: f64) -> [f64; 2] {
    let (low, high) = curve.domain();
    let half = SLOPE_SPAN_MM / 2.0;
    [(along_mm - half).max(low), (along_mm + half).min(high)]
}

/// Standard error of the position of the largest rise, mm: that of the rise's slope (with
/// independent errors at the two ends) divided by the curvature of the rise, taken over the span.
fn steepest_sd_mm(curve: &GirthCurve, along_mm: f64) -> f64 {
    let [below, above] = span(curve, along_mm);
    let slope_sd = curve.tape_sd(below, 1).hypot(curve.tape_sd(above, 1)) / (above - below);
    let half = SLOPE_SPAN_MM / 2.0;
    let around = [along_mm - half, along_mm, along_mm + half].map(|place| rise(curve, place));
    let bend = (around[0] - 2.0 * around[1] + around[2]) / (half * half);
    slope_sd / bend.abs().max(f64::MIN_POSITIVE)
}
