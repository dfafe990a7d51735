//! Levels found on a leg: B, C and D by valley and peak of the girth curve, B1 by its largest
//! slope (paper 1.2, fig. 3b and 3c; definitions in the README).
//!
//! Decided by the shape of the curve alone. A level that is not there is absent; where a level
//! usually lies decides nothing.

use super::finding::Doubt;
use super::girth::GirthCurve;
use super::level::Level;
use super::section::Section;

/// An extremum that stands out by less than this is no clear one, mm; a tape reads to 1 to 2 mm.
pub const CLEAR_MM: f64 = 1.5;

/// … nor one that stands out by less than this many of its standard errors.
const CLEAR_SDS: f64 = 3.0;

/// An extremum below this many standard errors is noise and not looked at, even in doubt.
const NOISE_SDS: f64 = 2.0;

/// … nor below this, mm: perfect data have no noise, but rounding.
const NOISE_MIN_MM: f64 = 0.1;

/// Levels are looked for from here, as a share of stature: above the malleoli (ANSUR II, lateral
/// malleolus: mean 0.042, 99th percentile 0.048).
const FROM_STATURE_SHARE: f64 = 0.045;

/// … to here, as a share of the crotch's height: above every knee (mid-patella at 0.575).
const TO_CROTCH_SHARE: f64 = 0.80;

/// Step in which extrema are looked for, mm; the curve's pieces are twelve times as long.
const STEP_MM: f64 = 1.0;

/// The slope at B1 is taken over this length, mm: noise of single sections is no slope.
const SLOPE_SPAN_MM: f64 = 30.0;

/// A gap in the skin wider than this is named as a doubt, degrees.
const GAP_DOUBT_DEG: f64 = 30.0;

/// Points that scatter more than this about the section are not one skin, mm: cloth, a second
/// layer, a patient who moved. Scanners scatter by 1 mm, poor ones by 1.5.
const SCATTER_DOUBT_MM: f64 = 2.0;

/// Skin that is longer than the tape by more than this share is folded, or no skin.
const FOLDS_DOUBT_SHARE: f64 = 0.01;

/// Girths of legs, mm, from a small child's ankle to a thigh with elephantiasis; what lies outside
/// was not measured on a leg.
const GIRTH_MM: [f64; 2] = [90.0, 1200.0];

/// A level found on a leg.
#[derive(Debug, Clone, PartialEq)]
pub struct Landmark {
    /// Which level.
    pub level: Level,
    /// Distance along the axis from the floor, mm.
    pub along_mm: f64,
    /// Vertical height of the section's centre above the floor, mm.
    pub height_mm: f64,
    /// Girth over the convex hull, mm.
    pub girth_tape_mm: f64,
    /// Girth along the skin, mm.
    pub girth_contour_mm: f64,
    /// Standard error of the height, mm.
    pub height_sd_mm: f64,
    /// Standard error of the tape girth, mm.
    pub girth_sd_mm: f64,
    /// What a person must know before using it.
    pub doubts: Vec<Doubt>,
}

/// A turning point of the girth curve.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Extremum {
    along_mm: f64,
    tape_mm: f64,
    is_maximum: bool,
}

/// Finds the levels, lowest first. `near` gives the section nearest to a distance along the axis,
/// where it could be measured.
pub fn landmarks<'a>(
    curve: &GirthCurve,
    stature_mm: f64,
    crotch_height_mm: f64,
    near: impl Fn(f64) -> Option<&'a Section>,
) -> Vec<Landmark> {
    let (from, to) = curve.domain();
    let from_mm = from.max(FROM_STATURE_SHARE * stature_mm);
    let to_mm = to.min(TO_CROTCH_SHARE * crotch_height_mm);
    let turns = extrema(curve, from_mm, to_mm);
    let found = Found::among(&turns, &noise_gates(curve, &turns));
    let at = Levels { curve, near };
    let b1 = || at.slope(found.b?.0.along_mm, found.c?.0.along_mm);
    let [b, c, d] = [(Level::B, found.b), (Level::C, found.c), (Level::D, found.d)]
        .map(|(level, extremum)| at.extremum(level, extremum?));
    [b, b1(), c, d].into_iter().flatten().collect()
}

/// Makes landmarks of places on the girth curve.
struct Levels<'c, F> {
    curve: &'c GirthCurve,
    near: F,
}

impl<'a, F: Fn(f64) -> Option<&'a Section>> Levels<'_, F> {
    /// A level at an extremum that stands out by so much.
    fn extremum(
        &self,
        level: Level,
        (extremum, prominence_mm): (Extremum, f64),
    ) -> Option<Landmark> {
        let along_mm = extremum.along_mm;
        let [_, _, bend, _] = self.curve.tape(along_mm);
        let height_sd_mm = self.curve.tape_sd(along_mm, 1) / bend.abs().max(f64::MIN_POSITIVE);
        let girth_sd_mm = self.curve.tape_sd(along_mm, 0);
        let mut landmark = self.landmark(level, along_mm, [height_sd_mm, girth_sd_mm])?;
        if prominence_mm < CLEAR_MM.max(CLEAR_SDS * girth_sd_mm) {
            landmark.doubts.push(Doubt::Shallow { prominence_mm });
        }
        Some(landmark)
    }

    /// B1 between B and C.
    fn slope(&self, b_mm: f64, c_mm: f64) -> Option<Landmark> {
        let along_mm = steepest(self.curve, b_mm, c_mm)?;
        let slope = self.curve.tape(along_mm)[1];
        let height_sd_mm = steepest_sd_mm(self.curve, along_mm).min(SLOPE_SPAN_MM);
        let girth_sd_mm = self.curve.tape_sd(along_mm, 0).hypot(slope * height_sd_mm);
        self.landmark(Level::B1, along_mm, [height_sd_mm, girth_sd_mm])
    }

    fn landmark(
        &self,
        level: Level,
        along_mm: f64,
        [height_sd_mm, girth_sd_mm]: [f64; 2],
    ) -> Option<Landmark> {
        Some(Landmark {
            level,
            along_mm,
            height_mm: self.curve.height_mm(along_mm)?,
            girth_tape_mm: self.curve.tape(along_mm)[0],
            girth_contour_mm: self.curve.contour_mm(along_mm),
            height_sd_mm,
            girth_sd_mm,
            doubts: doubts(self.curve, along_mm, (self.near)(along_mm)),
        })
    }
}

/// What the skin at a distance along the axis gives to doubt; `section` is the nearest one.
pub(super) fn doubts(curve: &GirthCurve, along_mm: f64, section: Option<&Section>) -> Vec<Doubt> {
    let Some(section) = section.filter(|_| curve.is_seen(along_mm)) else {
        return vec![Doubt::NotSeen];
    };
    let (gap_deg, rms_mm) = (section.largest_gap_deg, section.rms_mm);
    let excess = section.girth.contour_mm / section.girth.tape_mm - 1.0;
    let all = [
        (gap_deg > GAP_DOUBT_DEG, Doubt::Gap { gap_deg }),
        (rms_mm > SCATTER_DOUBT_MM, Doubt::Scatter { rms_mm }),
        (excess > FOLDS_DOUBT_SHARE, Doubt::Folds { percent: 100.0 * excess }),
    ];
    all.into_iter().filter(|(holds, _)| *holds).map(|(_, doubt)| doubt).collect()
}

impl Landmark {
    /// Whether a leg can have this girth at all.
    pub fn is_plausible(&self) -> bool {
        (GIRTH_MM[0]..=GIRTH_MM[1]).contains(&self.girth_tape_mm)
    }
}

/// Turning points of the curve in a range, ascending, with the range's two ends as the first and
/// last: an end counts as the turning point that the curve makes of it.
fn extrema(curve: &GirthCurve, from_mm: f64, to_mm: f64) -> Vec<Extremum> {
    let count = ((to_mm - from_mm) / STEP_MM).max(1.0) as usize;
    let at = |index: usize| from_mm + (to_mm - from_mm) * index as f64 / count as f64;
    let slope = |along: f64| curve.tape(along)[1];
    let extremum = |along_mm: f64, is_maximum| Extremum {
        along_mm,
        tape_mm: curve.tape(along_mm)[0],
        is_maximum,
    };
    let mut turns = vec![extremum(from_mm, slope(from_mm) < 0.0)];
    for index in 0..count {
        let (low, high) = (at(index), at(index + 1));
        if slope(low) * slope(high) < 0.0 {
            turns.push(extremum(root(slope, low, high), slope(low) > 0.0));
        }
    }
    turns.push(extremum(to_mm, slope(to_mm) > 0.0));
    turns
}

/// The zero of `function` between two places of different sign, by bisection to 1 µm.
fn root(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let falls = function(low) > 0.0;
    while high - low > 1e-3 {
        let middle = (low + high) / 2.0;
        if (function(middle) > 0.0) == falls {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low + high) / 2.0
}

/// What an extremum must stand out by to be more than noise, mm, for each turning point.
fn noise_gates(curve: &GirthCurve, turns: &[Extremum]) -> Vec<f64> {
    let gate = |turn: &Extremum| (NOISE_SDS * curve.tape_sd(turn.along_mm, 0)).max(NOISE_MIN_MM);
    turns.iter().map(gate).collect()
}

/// The extrema of the levels with how far each stands out, mm.
struct Found {
    b: Option<(Extremum, f64)>,
    c: Option<(Extremum, f64)>,
    d: Option<(Extremum, f64)>,
}

impl Found {
    fn among(turns: &[Extremum], gates: &[f64]) -> Found {
        let clear = standing_out(turns, &vec![CLEAR_MM; turns.len()]);
        let faint = standing_out(turns, gates);
        let first = |turns: &[Extremum], above_mm: f64, is_maximum: bool| {
            let inner = 1..turns.len().saturating_sub(1);
            let fits =
                |i: &usize| turns[*i].is_maximum == is_maximum && turns[*i].along_mm > above_mm;
            inner.clone().find(fits).map(|i| (turns[i], prominence_mm(turns, i)))
        };
        // Where the curve begins lower still, the lowest minimum is not in sight.
        let lowest = |b: &(Extremum, f64)| turns.iter().take(1).all(|t| b.0.tape_mm < t.tape_mm);
        let b = first(&clear, 0.0, false).or_else(|| first(&faint, 0.0, false)).filter(lowest);
        let above_b = b.map_or(f64::INFINITY, |(b, _)| b.along_mm);
        let c = first(&clear, above_b, true).or_else(|| {
            let inner = 1..faint.len().saturating_sub(1);
            let maxima = inner.filter(|&i| faint[i].is_maximum && faint[i].along_mm > above_b);
            let largest = maxima.max_by(|&i, &j| faint[i].tape_mm.total_cmp(&faint[j].tape_mm))?;
            Some((faint[largest], prominence_mm(&faint, largest)))
        });
        let above_c = c.map_or(f64::INFINITY, |(c, _)| c.along_mm);
        Found { b, c, d: first(&clear, above_c, false) }
    }
}

/// How far an inner turning point stands out from the lesser of its two neighbours, mm.
fn prominence_mm(turns: &[Extremum], index: usize) -> f64 {
    let own = turns[index].tape_mm;
    let neighbours = [turns[index - 1].tape_mm, turns[index + 1].tape_mm];
    neighbours.map(|tape| (tape - own).abs()).into_iter().fold(f64::INFINITY, f64::min)
}

/// Leaves out pairs of neighbouring turning points that differ by less than their gates, the
/// closest pair first; what stays stands out (topological persistence in one dimension).
fn standing_out(turns: &[Extremum], gates: &[f64]) -> Vec<Extremum> {
    let mut kept: Vec<(Extremum, f64)> = turns.iter().copied().zip(gates.iter().copied()).collect();
    loop {
        let difference = |pair: &[(Extremum, f64)]| (pair[0].0.tape_mm - pair[1].0.tape_mm).abs();
        let closest = kept
            .windows(2)
            .enumerate()
            .filter(|(_, pair)| difference(pair) < pair[0].1.max(pair[1].1))
            .min_by(|a, b| difference(a.1).total_cmp(&difference(b.1)));
        let Some((index, _)) = closest else { break };
        let last = kept.len() - 1;
        match index {
            // An end of the range stays an end; only its inner neighbour goes.
            0 if kept.len() > 2 => drop(kept.remove(1)),
            _ if index + 1 == last && kept.len() > 2 => drop(kept.remove(index)),
            _ if kept.len() > 2 => drop(kept.drain(index..index + 2)),
            _ => break,
        }
    }
    kept.into_iter().map(|(turn, _)| turn).collect()
}

/// Where the curve rises most between two places, over a span; none where they are closer.
fn steepest(curve: &GirthCurve, from_mm: f64, to_mm: f64) -> Option<f64> {
    let count = ((to_mm - from_mm) / STEP_MM) as usize;
    let places = (1..count).map(|index| from_mm + STEP_MM * index as f64);
    places.max_by(|a, b| rise(curve, *a).total_cmp(&rise(curve, *b)))
}

/// Slope of the curve over a span, as far as the curve reaches.
fn rise(curve: &GirthCurve, along_mm: f64) -> f64 {
    let [below, above] = span(curve, along_mm);
    (curve.tape(above)[0] - curve.tape(below)[0]) / (above - below)
}

fn span(curve: &GirthCurve, along_mm: f64) -> [f64; 2] {
    let (low, high) = curve.domain();
    let half = SLOPE_SPAN_MM / 2.0;
    [(along_mm - half).max(low), (along_mm + half).min(high)]
}

/// Standard error of the place of the largest rise, mm: that of the rise's slope, whose two ends
/// err apart from each other, over how sharply the rise turns, taken over the span.
fn steepest_sd_mm(curve: &GirthCurve, along_mm: f64) -> f64 {
    let [below, above] = span(curve, along_mm);
    let slope_sd = curve.tape_sd(below, 1).hypot(curve.tape_sd(above, 1)) / (above - below);
    let half = SLOPE_SPAN_MM / 2.0;
    let around = [along_mm - half, along_mm, along_mm + half].map(|place| rise(curve, place));
    let bend = (around[0] - 2.0 * around[1] + around[2]) / (half * half);
    slope_sd / bend.abs().max(f64::MIN_POSITIVE)
}
