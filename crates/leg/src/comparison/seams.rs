//! Where the views of a scanner's cameras do not meet: a camera that is not aligned moves its part of the skin
//! outwards, inwards or aside, and every girth is off by millimetres, on both legs.
//!
//! A camera sees the skin that faces it, so the seam of its view runs along both legs where the skin has a certain
//! direction. Edges of the mesh that cross a seam are uneven, longer or shorter than others, and lead outwards or
//! inwards. What belongs to the legs themselves, such as a vein, a tendon or the edge of the shin, is on one leg only,
//! or on the other side of the other leg. So both legs must show the same in a direction, and it counts as much as on
//! the leg that shows less.
//!
//! A girth is off by the sum of what edges are too long at all seams (Cauchy: a part that is moved by d adds to the
//! girth what d and the vector between its ends make). Shells that overlap are compared by themselves.

use std::f64::consts::{PI, TAU};

use super::shells;
pub use super::shells::SPAN_SHARE;
use crate::sections::placed::Placed;
use crate::statistics::median;

/// Directions of the skin: 5° each, 4 mm of a calf, about an edge.
const DIRECTIONS: usize = 72;

/// Bands of height, so that a scar, a fold or the border of a hole, which is in one or two, counts little …
const BANDS: usize = 6;

/// … and as many of the lowest are looked at for themselves, where a turned camera is off most.
const LOW_BANDS: usize = 3;

/// The edges of a seam lie in up to this many directions to each side …
const SEAM_REACH: usize = 1;

/// … and are compared with those so far aside.
const BESIDE: [usize; 3] = [3, 4, 5];

/// Two seams of a camera are at least this many directions apart.
const SEAMS_APART: usize = 6;

/// Edges of more than this many times the mean length bridge holes.
const LONG: f64 = 4.0;

/// A point that is further off its neighbour counts as this far, mm: a speck should not look like a seam.
const STEP_MAX_MM: f64 = 6.0;

/// About a direction of a band with fewer edges, nothing is known of noise.
const EDGES_MIN: f64 = 8.0;

/// The median of squares is this share of their mean where they are normal.
const MEDIAN_SQUARE: f64 = 0.455;

/// What a trace of a seam must exceed to be remarkable for itself, in all bands: about the most that scans without seams
/// had of each kind, with noise of 0 to 1.9 mm.
const ALL: Least = Least { uneven: 1.0, longer_mm: 1.2, shorter_mm: 0.8, step: 1.0 };

/// In the lowest bands alone there are half as many edges, and the median counts.
const LOW: Least = Least { uneven: 1.6, longer_mm: 1.8, shorter_mm: 1.2, step: 1.9 };

/// Unevenness of a seam, mm²: this many times the variance of the noise, and what skin may have without any.
const UNEVEN: [f64; 2] = [2.5, 0.15];

/// Mean step over a seam, mm: this many times the standard deviation of the noise, and what skin may have.
const STEP: [f64; 2] = [0.35, 0.15];

/// Lengths across vary with the length of edges: these limits are for edges of up to this mean length, mm …
const EDGE_MM: f64 = 7.0;

/// … and grow with this power of it, because coarse meshes are less even, too.
const EDGE_POWER: f64 = 1.25;

/// Traces that together exceed their limits this many times (root of the sum of squares) are a seam, if there is a
/// second one, for a view has two borders, that exceeds them this many times. Scans without seams, also decimated ones
/// and such whose views have more or less noise, had up to 1.21 in the first, or less in the second.
const TOGETHER_MIN: f64 = 1.35;
const SECOND_MIN: f64 = 0.85;

/// A seam is this many times as remarkable as the usual direction: those of mannequins whose points lie in columns along
/// the legs are all alike, at 1.7. Scans have usual ones of 0.1 to 0.4.
const STANDS_OUT: f64 = 3.0;

/// Shells are apart if they are by this, mm: scanners promise 1 mm.
const SHELLS_APART_MM: f64 = 1.2;

/// Standard error of a girth per millimetre by which shells are apart: of girths of draws, 95 in 100 were off by less than
/// two …
const GIRTH_PER_APART: f64 = 1.2;

/// … and per millimetre by which edges are too long or too short at two seams, together …
const GIRTH_PER_LONGER: f64 = 1.5;

/// … for which unevenness and mean step stand with this many millimetres, if that is more.
const LONGER_PER_UNEVEN: f64 = 2.0;
const LONGER_PER_STEP: f64 = 3.0;

/// A view is off by this many times what edges across a seam are too long, with what unevenness stands for at right
/// angles to it: some is lost in the fit of the skin and in the directions beside.
const STEP_SHARE: f64 = 1.3;
const STEP_PER_UNEVEN: f64 = 1.7;

/// The views of a scanner that do not meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seams {
    /// How far they are apart, mm; within a half.
    pub step_mm: f64,
    /// Standard error that girths have by it, mm.
    pub girth_sd_mm: f64,
}

/// Limits of one kind each.
struct Least {
    uneven: f64,
    longer_mm: f64,
    shorter_mm: f64,
    step: f64,
}

/// The evidence of a band's edges in a direction, summed over them.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    edges: f64,
    /// Lengths across the leg, mm.
    across_mm: f64,
    /// How far the end that is further to the patient's left around lies outside, mm.
    step_mm: f64,
}

/// How uneven the mesh is about a direction of a band.
#[derive(Debug, Clone, Copy, Default)]
struct Uneven {
    /// Median squared step along an edge, mm²: that of the noise there or beside, whichever is more.
    usual_mm2: f64,
    /// What squared steps have beyond what goes with that median, per edge that crosses a seam, mm².
    more_mm2: f64,
}

/// The evidence for seams in the mesh of one leg.
#[derive(Debug, Clone)]
pub struct Traces {
    directions: Vec<[Sums; BANDS]>,
    uneven: Vec<[Uneven; BANDS]>,
    /// Edges that cross a line along the leg in each band; 0 if the band was not seen.
    crossing: [f64; BANDS],
    /// Mean length of an edge, mm.
    edge_mm: f64,
    /// How far overlapping shells are apart, mm; `None` if none overlap all along.
    shells_apart_mm: Option<f64>,
}

impl Traces {
    /// Reads the mesh of a leg: its points on the skin, its edges, and girths of the leg by height, mm.
    pub fn new(
        placed: &[Option<Placed>],
        edges: &[[u32; 2]],
        girths: &[[f64; 2]],
        stature_mm: f64,
    ) -> Traces {
        let point = |index: u32| placed.get(index as usize).copied().flatten();
        let ends = edges.iter().filter_map(|&[a, b]| Some([point(a)?, point(b)?]));
        let length_mm = |[a, b]: &[Placed; 2]| {
            ((b.place - a.place).norm_squared() + (b.height_mm - a.height_mm).powi(2)).sqrt()
        };
        let lengths = ends.clone().map(|ends| length_mm(&ends));
        let (count, sum_mm) = lengths.fold((0.0, 0.0), |(count, sum), mm| (count + 1.0, sum + mm));
        let mut directions = vec![[Sums::default(); BANDS]; DIRECTIONS];
        let mut squares = vec![[const { Vec::new() }; BANDS]; DIRECTIONS];
        for [a, b] in ends.filter(|ends| count * length_mm(ends) < LONG * sum_mm) {
            let Some(band) = band(0.5 * (a.height_mm + b.height_mm), stature_mm) else { continue };
            let middle = middle(a.direction, b.direction);
            let (sin, cos) = middle.sin_cos();
            let arm = b.place - a.place;
            let across_mm = arm.y * cos - arm.x * sin;
            let step_mm = (b.outside_mm - a.outside_mm).clamp(-STEP_MAX_MM, STEP_MAX_MM);
            let sums = &mut directions[direction(middle)][band];
            sums.edges += 1.0;
            squares[direction(middle)][band].push(step_mm * step_mm);
            sums.across_mm += across_mm.abs();
            sums.step_mm += step_mm * across_mm.signum();
        }
        let crossing = std::array::from_fn(|index| {
            let inside =
                girths.iter().filter(|[height, _]| band(*height, stature_mm) == Some(index));
            let (count, sum_mm) =
                inside.fold((0.0, 0.0), |(n, sum), [_, girth]| (n + 1.0, sum + girth));
            let across_mm: f64 = directions.iter().map(|bands| bands[index].across_mm).sum();
            if sum_mm > 0.0 { across_mm * count / sum_mm } else { 0.0 }
        });
        let uneven = uneven(&squares, &crossing);
        let shells_apart_mm = shells::apart_mm(placed, edges, stature_mm);
        Traces {
            directions,
            uneven,
            crossing,
            edge_mm: sum_mm / f64::max(count, 1.0),
            shells_apart_mm,
        }
    }

    /// Variance of the noise of points about a direction, mm²: the median of the lowest bands.
    fn noise_mm2(&self, at: usize, bands: usize) -> f64 {
        let usual = self.uneven[at][..bands].iter().map(|uneven| uneven.usual_mm2).collect();
        median(usual).unwrap_or_default() / (2.0 * MEDIAN_SQUARE)
    }

    /// How uneven the seam of a direction is.
    fn uneven_mm2(&self, at: usize, bands: usize) -> f64 {
        middle_mean((0..bands).map(|band| self.uneven[at][band].more_mm2).collect())
    }

    /// By how much edges are longer across it than those beside.
    fn longer_mm(&self, at: usize, bands: usize) -> f64 {
        let beside = || BESIDE.into_iter().flat_map(|by| [by, DIRECTIONS - by]);
        let longer = |band: usize| {
            let [edges, across_mm] = self.sums(at, band, about(), |sums| sums.across_mm);
            let [usual, usual_mm] = self.sums(at, band, beside(), |sums| sums.across_mm);
            self.per_crossing(across_mm - usual_mm * edges / usual.max(1.0), band)
        };
        middle_mean((0..bands).map(longer).collect())
    }

    /// By how much they lead outwards towards the patient's left around.
    fn step_mm(&self, at: usize, bands: usize) -> f64 {
        let step = |band: usize| {
            let [_, step_mm] = self.sums(at, band, about(), |sums| sums.step_mm);
            self.per_crossing(step_mm, band)
        };
        middle_mean((0..bands).map(step).collect())
    }

    /// The edges, and the sum of something of them, in directions that are so far on from one.
    fn sums(
        &self,
        at: usize,
        band: usize,
        on: impl Iterator<Item = usize>,
        of: fn(&Sums) -> f64,
    ) -> [f64; 2] {
        on.fold([0.0, 0.0], |[edges, sum], on| {
            let sums = &self.directions[(at + on) % DIRECTIONS][band];
            [edges + sums.edges, sum + of(sums)]
        })
    }

    fn per_crossing(&self, sum: f64, band: usize) -> f64 {
        if self.crossing[band] > 0.0 { sum / self.crossing[band] } else { 0.0 }
    }
}

/// The directions of a seam's edges, as steps on from its own.
fn about() -> impl Iterator<Item = usize> {
    (0..=2 * SEAM_REACH).map(|index| (DIRECTIONS + index - SEAM_REACH) % DIRECTIONS)
}

/// How uneven the mesh is everywhere, from the squared steps of all edges. Where a view has more noise, or edges see
/// the skin at a flat angle, all squares are larger; at a seam a few are. A membrane over a hole has no noise, so the
/// noisier side of its border shows what is usual.
fn uneven(squares: &[[Vec<f64>; BANDS]], crossing: &[f64; BANDS]) -> Vec<[Uneven; BANDS]> {
    let mut found = vec![[Uneven::default(); BANDS]; DIRECTIONS];
    for (band, crossing) in crossing.iter().enumerate() {
        let near = |at: usize| {
            let cells = about().map(|on| &squares[(at + on) % DIRECTIONS][band]);
            let near: Vec<f64> = cells.flatten().copied().collect();
            let (count, sum) = (near.len() as f64, near.iter().sum::<f64>());
            let usual_mm2 = median(near).unwrap_or_default();
            (count, sum, usual_mm2)
        };
        let all: Vec<_> = (0..DIRECTIONS).map(near).collect();
        let seen = all.iter().filter(|(count, _, usual)| *count >= EDGES_MIN && *usual > 0.0);
        // How the mean of squares goes with their median: 2.2 times if noise is normal.
        let share = median(seen.map(|(count, sum, usual)| sum / (count * usual)).collect());
        let (Some(share), true) = (share, *crossing > 0.0) else { continue };
        for (at, found) in found.iter_mut().enumerate() {
            let (count, sum, here) = all[at];
            let [before, after] =
                [DIRECTIONS - BESIDE[0], BESIDE[0]].map(|on| all[(at + on) % DIRECTIONS].2);
            let usual_mm2 = here.max(before).max(after);
            if count >= EDGES_MIN {
                let more_mm2 = (sum - share * count * usual_mm2) / crossing;
                found[band] = Uneven { usual_mm2, more_mm2 };
            }
        }
    }
    found
}

/// The mean without the largest and the smallest.
fn middle_mean(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let kept = values.get(1..values.len() - 1).unwrap_or_default();
    kept.iter().sum::<f64>() / kept.len().max(1) as f64
}

/// The traces of a seam in one direction, the same on both legs.
#[derive(Debug, Clone, Copy, Default)]
struct Trace {
    uneven_mm2: f64,
    longer_mm: f64,
    step_mm: f64,
}

impl Trace {
    /// The largest of each kind.
    fn largest(self, other: Trace) -> Trace {
        Trace {
            uneven_mm2: self.uneven_mm2.max(other.uneven_mm2),
            longer_mm: self.longer_mm.max(other.longer_mm),
            step_mm: self.step_mm.max(other.step_mm),
        }
    }
}

/// The evidence of a direction, and how remarkable each kind of trace is.
#[derive(Debug, Clone, Copy)]
struct Found {
    /// Sizes.
    trace: Trace,
    /// Shares of what is remarkable.
    shares: Trace,
}

impl Found {
    fn together(&self) -> f64 {
        let Trace { uneven_mm2, longer_mm, step_mm } = self.shares;
        uneven_mm2.hypot(longer_mm).hypot(step_mm)
    }
}

/// The seams that the legs show; `None` if the views meet, or if that cannot be determined: from one leg alone,
/// unless its shells overlap, or from a cloud.
pub fn seams(legs: &[&Traces]) -> Option<Seams> {
    let apart_mm = legs.iter().filter_map(|leg| leg.shells_apart_mm).reduce(f64::max);
    if let Some(apart_mm) = apart_mm {
        // The borders of shells that overlap would look like seams.
        let girth_sd_mm = GIRTH_PER_APART * apart_mm;
        return (apart_mm >= SHELLS_APART_MM).then_some(Seams { step_mm: apart_mm, girth_sd_mm });
    }
    let &[left, right] = legs else { return None };
    let looks = [(BANDS, &ALL), (LOW_BANDS, &LOW)];
    let strongest = looks.map(|(bands, least)| strongest([left, right], bands, least));
    let [all, low] = strongest;
    let Strongest { first, second, usual } =
        if low.first.together() > all.first.together() { low } else { all };
    let together = first.together();
    if together < TOGETHER_MIN.max(STANDS_OUT * usual) || second.together() < SECOND_MIN {
        return None;
    }
    let Trace { uneven_mm2, longer_mm, step_mm } = first.trace;
    let uneven_mm = uneven_mm2.sqrt();
    let girth_mm = (longer_mm + second.trace.longer_mm)
        .max(LONGER_PER_UNEVEN * uneven_mm)
        .max(LONGER_PER_STEP * step_mm);
    Some(Seams {
        step_mm: STEP_SHARE * longer_mm.hypot(STEP_PER_UNEVEN * uneven_mm).max(step_mm),
        girth_sd_mm: GIRTH_PER_LONGER * girth_mm,
    })
}

/// The most remarkable direction, the most remarkable one away from it, and how remarkable the usual one is.
struct Strongest {
    first: Found,
    second: Found,
    usual: f64,
}

fn strongest(legs: [&Traces; 2], bands: usize, least: &Least) -> Strongest {
    let agreed = |of: &dyn Fn(&Traces) -> f64| {
        let [left, right] = legs.map(of);
        if left * right > 0.0 { left.signum() * left.abs().min(right.abs()) } else { 0.0 }
    };
    let noise = |at: usize| 0.5 * legs.iter().map(|leg| leg.noise_mm2(at, bands)).sum::<f64>();
    let noises: Vec<f64> = (0..DIRECTIONS).map(noise).collect();
    let usual_mm2 = median(noises.clone()).unwrap_or_default();
    let edge_mm = 0.5 * legs.iter().map(|leg| leg.edge_mm).sum::<f64>();
    let coarse = (edge_mm / EDGE_MM).max(1.0).powf(EDGE_POWER);
    let found = |at: usize| {
        let noise_mm2 = usual_mm2.max(noises[at]);
        let uneven_mm2 = agreed(&|leg| leg.uneven_mm2(at, bands)).max(0.0);
        let longer_mm = agreed(&|leg| leg.longer_mm(at, bands));
        let step_mm = agreed(&|leg| leg.step_mm(at, bands)).abs();
        let longer_least = if longer_mm > 0.0 { least.longer_mm } else { least.shorter_mm };
        let longer_mm = longer_mm.abs();
        let shares = Trace {
            uneven_mm2: uneven_mm2 / (least.uneven * (UNEVEN[0] * noise_mm2 + UNEVEN[1])),
            longer_mm: longer_mm / (coarse * longer_least),
            step_mm: step_mm / (least.step * (STEP[0] * noise_mm2.sqrt() + STEP[1])),
        };
        Found { trace: Trace { uneven_mm2, longer_mm, step_mm }, shares }
    };
    let each: Vec<Found> = (0..DIRECTIONS).map(found).collect();
    // The kinds need not peak in the very same direction.
    let near = |at: usize| {
        let around = [DIRECTIONS - 1, 0, 1].map(|offset| each[(at + offset) % DIRECTIONS]);
        let [before, here, after] = around;
        Found {
            trace: before.trace.largest(here.trace).largest(after.trace),
            shares: before.shares.largest(here.shares).largest(after.shares),
        }
    };
    let each: Vec<Found> = (0..DIRECTIONS).map(near).collect();
    let largest = |is_in: &dyn Fn(usize) -> bool| {
        (0..DIRECTIONS).filter(|at| is_in(*at)).fold(0, |best, at| {
            let is_more = !is_in(best) || each[at].together() > each[best].together();
            if is_more { at } else { best }
        })
    };
    let first = largest(&|_| true);
    let second = largest(&|at| {
        let turned = at.abs_diff(first);
        turned.min(DIRECTIONS - turned) >= SEAMS_APART
    });
    let usual = median(each.iter().map(Found::together).collect()).unwrap_or_default();
    Strongest { first: each[first], second: each[second], usual }
}

/// The band of a height; `None` outside.
fn band(height_mm: f64, stature_mm: f64) -> Option<usize> {
    let [low, high] = SPAN_SHARE;
    let share = (height_mm / stature_mm - low) / (high - low);
    (0.0..1.0).contains(&share).then_some((share * BANDS as f64) as usize)
}

/// The index of a direction.
fn direction(radians: f64) -> usize {
    ((radians + PI).rem_euclid(TAU) / TAU * DIRECTIONS as f64) as usize % DIRECTIONS
}

/// The direction between two.
fn middle(a: f64, b: f64) -> f64 {
    let turn = (b - a + PI).rem_euclid(TAU) - PI;
    a + 0.5 * turn
}

#[cfg(test)]
mod tests;
