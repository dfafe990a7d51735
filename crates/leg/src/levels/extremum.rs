//! Turning points of the girth curve: which of them are prominent, which of them are the levels,
//! and why a level is absent.

use std::ops::RangeInclusive;

use super::girth::GirthCurve;
use crate::level::Level;

/// An extremum with less prominence than this is not clear, mm; a tape reads to 1 to 2 mm.
pub(super) const CLEAR_MM: f64 = 1.5;

/// An extremum of less than this many standard errors is noise and ignored, even as a doubtful one;
/// two girths closer than this are equal within the noise.
const NOISE_SDS: f64 = 2.0;

/// … the same in mm, because perfect data have no noise but rounding.
const NOISE_MIN_MM: f64 = 0.1;

/// Step of the search for extrema, mm; the curve's pieces are twelve times as long.
const STEP_MM: f64 = 1.0;

/// Two extrema of one level with equal girths are two separate ones from this distance on, mm;
/// closer ones are one flat stretch, which the height's standard error covers.
const APART_MM: f64 = 20.0;

/// Where people have B, C and D, as shares of the stature. On 130 to 144 legs of all kinds they were at
/// 0.054 to 0.095, 0.171 to 0.265 and 0.222 to 0.316; swollen legs need room.
const B_SHARE: [f64; 2] = [0.045, 0.12];
const C_SHARE: [f64; 2] = [0.15, 0.29];
const D_SHARE: [f64; 2] = [0.20, 0.34];

/// Of extrema where people have the level, one with less than this share of the largest prominence is
/// not the level: the edge of a sock.
const LARGE_SHARE: f64 = 0.25;

/// A turning point of the girth curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extremum {
    /// Distance along the axis, mm.
    pub along_mm: f64,
    /// Tape girth, mm.
    pub tape_mm: f64,
    /// Whether the girth has a maximum there; otherwise a minimum.
    pub is_maximum: bool,
    /// The prominence that an extremum here needs to be more than noise, mm.
    gate_mm: f64,
}

/// The extremum of a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Peak {
    pub at: Extremum,
    pub prominence_mm: f64,
    /// Distance along the axis of another extremum with the same girth, mm.
    pub rival_mm: Option<f64>,
    /// Distance along the axis of another clear extremum where people have the level, mm.
    pub other_mm: Option<f64>,
    /// Whether people have the level there.
    pub is_usual: bool,
}

impl Peak {
    /// The same, where people do not have the level.
    fn unusual(self) -> Peak {
        Peak { is_usual: false, other_mm: None, ..self }
    }
}

coded_enum! {
    /// Why a level is absent.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum Absence {
        /// The curve has no extremum of this kind.
        NoTurn => "no-turn",
        /// The curve is lowest where the search begins.
        BelowSearch {
            /// Lower end of the search, along the axis, mm.
            along_mm: f64,
        } => "below-search",
        /// The curve does not turn before the end of the search.
        AboveSearch {
            /// Upper end of the search, along the axis, mm.
            along_mm: f64,
        } => "above-search",
        /// The level depends on another one that is absent.
        Needs {
            /// The other one.
            level: Level,
        } => "needs-level",
        /// The level would lie above one that is higher on every leg.
        Beyond {
            /// The one that is higher.
            level: Level,
        } => "beyond-level",
    }
}

/// Distances along the axis at which a level usually lies, mm.
type Range = RangeInclusive<f64>;

/// The extrema of B, C and D on a leg of a body with this stature between two distances along the axis.
///
/// Extrema where people have the level go before others: folds and swellings have extrema too.
pub(super) fn extrema(
    curve: &GirthCurve,
    stature_mm: f64,
    [from_mm, to_mm]: [f64; 2],
) -> [Result<Peak, Absence>; 3] {
    let turns = turns(curve, from_mm, to_mm);
    let clear = standing_out(&turns, |_| CLEAR_MM);
    let faint = standing_out(&turns, |turn| turn.gate_mm);
    let usual = |[low, high]: [f64; 2]| low * stature_mm..=high * stature_mm;
    let [b_usual, c_usual, d_usual] = [B_SHARE, C_SHARE, D_SHARE].map(usual);
    // If the curve starts even lower, the lowest minimum is outside the range.
    let lowest = |b: &Peak| turns.iter().take(1).all(|turn| b.at.tape_mm < turn.tape_mm);
    let b_below = |c: Option<Peak>, usual: &Range| {
        let c_mm = c.map_or(to_mm, |c| c.at.along_mm);
        let range = *usual.start()..=usual.end().min(c_mm);
        let of = |turns: &[Extremum]| first(turns, false, &range).filter(lowest);
        of(&clear).or_else(|| of(&faint))
    };
    let c = first(&clear, true, &c_usual).or_else(|| largest(&faint, &c_usual));
    let anywhere = from_mm..=to_mm;
    let b = b_below(c, &b_usual).or_else(|| Some(b_below(c, &anywhere)?.unusual()));
    let above_b = b.map_or(from_mm, |b| b.at.along_mm);
    let beyond = |turns, is_maximum, above_mm| {
        Some(first(turns, is_maximum, &(above_mm..=to_mm))?.unusual())
    };
    let c = c.or_else(|| b.and_then(|b| beyond(&clear, true, b.at.along_mm)));
    let above_c = c.map_or(f64::INFINITY, |c| c.at.along_mm);
    let d = first(&clear, false, &(d_usual.start().max(above_c)..=*d_usual.end()));
    let d = d.or_else(|| beyond(&clear, false, above_c));
    // Each level's rivals lie between its neighbours.
    let c_mm = c.map_or(to_mm, |c| c.at.along_mm);
    let d_mm = d.map_or(to_mm, |d| d.at.along_mm);
    let rival = |peak: Peak, low_mm: f64, high_mm: f64| Peak {
        rival_mm: rival_mm(&turns, &peak.at, low_mm, high_mm),
        ..peak
    };
    let begins_low = turns.first().is_some_and(|turn| !turn.is_maximum);
    let no_b =
        if begins_low { Absence::BelowSearch { along_mm: from_mm } } else { Absence::NoTurn };
    let ends = Absence::AboveSearch { along_mm: to_mm };
    let no_d = if c.is_none() { Absence::Needs { level: Level::C } } else { ends };
    [
        b.map(|b| rival(b, from_mm, c_mm)).ok_or(no_b),
        c.map(|c| rival(c, above_b, d_mm)).ok_or(ends),
        d.map(|d| rival(d, above_c, to_mm)).ok_or(no_d),
    ]
}

/// The inner turning points of one kind in a range.
fn peaks(turns: &[Extremum], is_maximum: bool, range: &Range) -> Vec<Peak> {
    let inner = 1..turns.len().saturating_sub(1);
    let fits =
        |i: &usize| turns[*i].is_maximum == is_maximum && range.contains(&turns[*i].along_mm);
    inner.filter(fits).map(|i| peak(turns, i)).collect()
}

/// The lowest turning point of one kind in a range, of those that are not small beside the others. Another
/// that is as clear, or a small one below it, could also be meant.
fn first(turns: &[Extremum], is_maximum: bool, range: &Range) -> Option<Peak> {
    let peaks = peaks(turns, is_maximum, range);
    let most_mm = peaks.iter().map(|peak| peak.prominence_mm).fold(0.0, f64::max);
    let is_large = |peak: &Peak| peak.prominence_mm >= LARGE_SHARE * most_mm;
    let chosen = peaks.iter().position(is_large)?;
    let above = peaks[chosen + 1..].iter().find(|peak| is_large(peak));
    let other = above.or_else(|| peaks[..chosen].last());
    Some(Peak { other_mm: other.map(|peak| peak.at.along_mm), ..peaks[chosen] })
}

/// The largest maximum in a range.
fn largest(turns: &[Extremum], range: &Range) -> Option<Peak> {
    let peaks = peaks(turns, true, range).into_iter();
    peaks.max_by(|p, q| p.at.tape_mm.total_cmp(&q.at.tape_mm))
}

/// Turning points of the curve in a range, ascending. The first and last are the two ends of the
/// range; each counts as a maximum or minimum according to the slope there.
fn turns(curve: &GirthCurve, from_mm: f64, to_mm: f64) -> Vec<Extremum> {
    let count = ((to_mm - from_mm) / STEP_MM).max(1.0) as usize;
    let at = |index: usize| from_mm + (to_mm - from_mm) * index as f64 / count as f64;
    let slope = |along: f64| curve.tape(along)[1];
    let extremum = |along_mm: f64, is_maximum| Extremum {
        along_mm,
        tape_mm: curve.tape(along_mm)[0],
        is_maximum,
        gate_mm: (NOISE_SDS * curve.tape_sd(along_mm, 0)).max(NOISE_MIN_MM),
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

/// The zero of `function` between two abscissas with values of opposite sign, by bisection to 1 µm.
pub(crate) fn root(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
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

/// An inner turning point and its prominence relative to the closer of its two neighbours.
fn peak(turns: &[Extremum], index: usize) -> Peak {
    let at = turns[index];
    let neighbours = [turns[index - 1].tape_mm, turns[index + 1].tape_mm];
    let apart = neighbours.map(|tape_mm| (tape_mm - at.tape_mm).abs());
    let prominence_mm = apart[0].min(apart[1]);
    Peak { at, prominence_mm, rival_mm: None, other_mm: None, is_usual: true }
}

/// The nearest turning point of the same kind in a range whose girth is equal to this one's within
/// the noise.
fn rival_mm(turns: &[Extremum], of: &Extremum, low_mm: f64, high_mm: f64) -> Option<f64> {
    let far = |turn: &Extremum| (turn.along_mm - of.along_mm).abs();
    let inner = turns.iter().take(turns.len().saturating_sub(1)).skip(1);
    let rivals = inner.filter(|turn| {
        turn.is_maximum == of.is_maximum
            && low_mm < turn.along_mm
            && turn.along_mm < high_mm
            && far(turn) > APART_MM
            && (turn.tape_mm - of.tape_mm).abs() < turn.gate_mm.max(of.gate_mm)
    });
    rivals.min_by(|a, b| far(a).total_cmp(&far(b))).map(|turn| turn.along_mm)
}

/// Removes pairs of neighbouring turning points that differ by less than their gates, the closest
/// pair first; the remaining ones are prominent (topological persistence in one dimension).
fn standing_out(turns: &[Extremum], gate_mm: impl Fn(&Extremum) -> f64) -> Vec<Extremum> {
    let mut kept = turns.to_vec();
    loop {
        let difference = |pair: &[Extremum]| (pair[0].tape_mm - pair[1].tape_mm).abs();
        let closest = kept
            .windows(2)
            .enumerate()
            .filter(|(_, pair)| difference(pair) < gate_mm(&pair[0]).max(gate_mm(&pair[1])))
            .min_by(|a, b| difference(a.1).total_cmp(&difference(b.1)));
        let Some((index, _)) = closest else { break };
        let last = kept.len() - 1;
        match index {
            // An end of the range stays an end; only its inner neighbour is removed.
            0 if kept.len() > 2 => drop(kept.remove(1)),
            _ if index + 1 == last && kept.len() > 2 => drop(kept.remove(index)),
            _ if kept.len() > 2 => drop(kept.drain(index..index + 2)),
            _ => break,
        }
    }
    kept
}
