//! Where the skin steps out all around and stays out: the hem of trousers or shorts. A fold of skin steps
//! out, too, but ends above, and a furrow begins below.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Directions in which the radius is compared.
const DIRECTIONS: usize = 8;

/// The radius must be seen in this many of them.
const DIRECTIONS_MIN: usize = 6;

/// Radii are averaged over bins of this length along the leg, mm …
const BIN_MM: f64 = 2.0;

/// … of so many bins below a height and above it, with one left out at the height itself on each side.
const BINS: usize = 2;

/// A step in half of the directions that is smaller than this is no hem, mm: within the 6 mm between the
/// averages, a bulge that rises at 45° gains 6 mm, an ankle swollen by 18 mm above a fold 7 mm.
const STEP_MIN_MM: f64 = 8.0;

/// Folds, and furrows between them, end within this distance below a step and above it, mm: those of
/// swollen knees are 40 to 60 mm long.
const FOLD_MM: [f64; 2] = [40.0, 60.0];

/// The lowest part of the span holds the instep, which is thicker than the ankle above, mm.
const INSTEP_MM: f64 = 40.0;

/// Cloth holds at least this share of its step beyond folds; the leg beneath may grow thinner there.
const HELD_SHARE: f64 = 0.5;

/// A step outwards that is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hem {
    /// Distance along the axis, mm.
    pub along_mm: f64,
    /// How far the radius grows, mm.
    pub step_mm: f64,
}

/// The largest such step between two distances along the axis, of points given by their distance along,
/// their angle and their radius.
pub fn hem(points: impl Iterator<Item = [f64; 3]>, [from_mm, to_mm]: [f64; 2]) -> Option<Hem> {
    let count = ((to_mm - from_mm) / BIN_MM).max(0.0) as usize;
    let mut bins = vec![[(0.0, 0.0); DIRECTIONS]; count];
    for [along_mm, angle, radius_mm] in points {
        let direction = ((angle + PI).rem_euclid(TAU) / TAU * DIRECTIONS as f64) as usize;
        let bin = ((along_mm - from_mm) / BIN_MM).floor();
        if (0.0..count as f64).contains(&bin) {
            let sum = &mut bins[bin as usize][direction.min(DIRECTIONS - 1)];
            *sum = (sum.0 + 1.0, sum.1 + radius_mm);
        }
    }
    let mean = |part: &[[(f64, f64); DIRECTIONS]], direction: usize| {
        let sums = part.iter().map(|bin| bin[direction]);
        let (count, sum) = sums.fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
        (count > 0.0).then(|| sum / count)
    };
    // The median over the directions of how far the radius grows from one range of bins to another.
    let growth = |below: Range<usize>, above: Range<usize>| {
        let (below, above) = (bins.get(below)?, bins.get(above)?);
        let steps = (0..DIRECTIONS).filter_map(|d| Some(mean(above, d)? - mean(below, d)?));
        let mut steps: Vec<f64> = steps.collect();
        steps.sort_by(f64::total_cmp);
        (steps.len() >= DIRECTIONS_MIN).then(|| steps[steps.len() / 2])
    };
    let [fold_below, fold_above] = FOLD_MM.map(|mm| (mm / BIN_MM) as usize);
    let lowest = (INSTEP_MM / BIN_MM) as usize;
    let places = (BINS + 1..count.saturating_sub(BINS)).filter_map(|at| {
        let below = at - BINS - 1..at - 1;
        let step_mm = growth(below.clone(), at + 1..at + BINS + 1)?;
        let further_below = match at.checked_sub(fold_below) {
            Some(start) if start >= lowest => start..start + BINS,
            _ => below.clone(),
        };
        let further_above = at + fold_above..at + fold_above + BINS;
        // Where the leg ends first, nothing speaks against cloth.
        let is_held = |below| {
            growth(below, further_above.clone()).is_none_or(|mm| mm >= HELD_SHARE * step_mm)
        };
        let along_mm = from_mm + at as f64 * BIN_MM;
        (is_held(below) && is_held(further_below)).then_some(Hem { along_mm, step_mm })
    });
    let largest = places.max_by(|a, b| a.step_mm.total_cmp(&b.step_mm))?;
    (largest.step_mm >= STEP_MIN_MM).then_some(largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points 4 mm apart on a leg whose radius depends on the distance along.
    fn leg(radius: impl Fn(f64, f64) -> f64) -> Option<Hem> {
        let grid = (0..2000).flat_map(|row| (0..60).map(move |column| (row, column)));
        let points = grid.filter(|(row, column)| (row * 7 + column) % 16 == 0);
        let points = points.map(|(row, column)| {
            let (along, angle) = (f64::from(row) * 0.4, TAU * f64::from(column) / 60.0 - PI);
            [along, angle, radius(along, angle)]
        });
        hem(points, [50.0, 700.0])
    }

    #[test]
    fn trousers_have_a_hem_where_they_begin_and_stand_off_by_what_they_do() {
        let found = leg(|along, _| if along > 90.0 { 42.0 } else { 30.0 }).unwrap();
        assert!((found.along_mm - 90.0).abs() <= BIN_MM, "{found:?}");
        assert!((found.step_mm - 12.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn a_steep_bulge_has_none() {
        // It gains 12 mm of radius at 40° from the axis.
        let slope = 40.0_f64.to_radians().tan();
        assert_eq!(leg(|along, _| 30.0 + ((along - 90.0) * slope).clamp(0.0, 12.0)), None);
    }

    #[test]
    fn a_fold_that_hangs_out_all_around_has_none() {
        let fold = |from: f64| {
            move |along: f64, _| if (from..from + 25.0).contains(&along) { 44.0 } else { 30.0 }
        };
        assert_eq!(leg(fold(400.0)), None);
        let furrow = |along: f64, _| if (400.0..420.0).contains(&along) { 44.0 } else { 58.0 };
        assert_eq!(leg(furrow), None);
        // Trousers over it begin where they begin.
        let trousers = |along: f64| if along > 90.0 { 12.0 } else { 0.0 };
        let found = leg(|along, angle| fold(400.0)(along, angle) + trousers(along)).unwrap();
        assert!((found.along_mm - 90.0).abs() <= BIN_MM, "{found:?}");
    }

    #[test]
    fn a_step_on_one_side_has_none() {
        let ulcer = |along: f64, angle: f64| if along > 90.0 && angle > 1.0 { 42.0 } else { 30.0 };
        assert_eq!(leg(ulcer), None);
    }

    #[test]
    fn the_edge_of_a_sock_has_none() {
        assert_eq!(leg(|along, _| if along > 150.0 { 30.0 } else { 33.0 }), None);
    }
}
