//! Where the fold between thighs that touch ends: there two legs become one body.
//!
//! Where thighs touch, the skin in front has a groove along the middle, however an exporter rounds it. Above
//! the crotch the middle lies no further inward than the skin beside it. (Behind, the groove continues
//! between the buttocks and shows nothing.) Each slice is evidence for one or the other, and people's
//! proportions make some heights more likely than others. The crotch is the mean of all heights that could
//! part the slices, weighted by the evidence for each; so its standard error shows how clear the end is.

use super::crotch::{CROTCH_SHARE, MEAN_SHARE};
use super::leg_tracking::{STEP_MM, Step};

/// A groove this steep is as likely as not a fold between thighs. Thighs that touch have 0.4 to 2, the body
/// from 10 mm above a known crotch −0.5 to 0.2; noise of 1.5 mm changes it by 0.05.
const STEEP: f64 = 0.3;

/// The most evidence of one slice, as the logarithm of a ratio of probabilities. Slices 10 mm apart see nearly the
/// same skin, so the evidence of each is limited.
const SLICE_MAX: f64 = 1.0;

/// Standard deviation of the crotch's usual height as a share of stature: 0.015 among soldiers; children, heavy people, and skin that no rod is
/// pressed to differ by more.
const USUAL_SD_SHARE: f64 = 0.02;

/// The fold ends this share of stature above the crotch: 3 to 18 mm in bodies with a known crotch.
const ABOVE_CROTCH_SHARE: f64 = 0.005;

/// Standard error of the crotch if the end of the fold is known exactly, mm.
const OWN_SD_MM: f64 = 10.0;

/// … and how much is added for each mm over which the thighs touch: the longer they do, the more has
/// settled about the crotch that no outline shows.
const SD_PER_MM: f64 = 0.1;

/// The fold is clear if the evidence of the slices below its end is at least this …
const CLEAR_MIN: f64 = 1.5;

/// … and this per slice, so that the pleats of cloth do not add up to a fold.
const CLEAR_MIN_PER_SLICE: f64 = 0.35;

/// The end of a fold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoldEnd {
    /// The height of the crotch, mm.
    pub crotch_mm: f64,
    /// Its standard error, mm.
    pub sd_mm: f64,
    /// The height of the crotch by the slices alone, mm; `None` if they show no clear fold.
    pub by_slices_mm: Option<f64>,
}

/// A height that could part the slices.
struct CrotchCandidate {
    crotch_mm: f64,
    /// The evidence of the slices below for a fold.
    below: f64,
    /// The logarithm of its weight.
    log_weight: f64,
}

/// The end of the fold in slices of legs that are joined from the first on, up to where a crotch can be.
pub fn fold_end(joined: &[Step], stature_mm: f64) -> Option<FoldEnd> {
    let join_mm = joined.first()?.height_mm;
    let above_mm = ABOVE_CROTCH_SHARE * stature_mm;
    let place = |end_mm: f64, below: f64| {
        let crotch_mm = end_mm - above_mm;
        let off = (crotch_mm / stature_mm - MEAN_SHARE) / USUAL_SD_SHARE;
        CrotchCandidate { crotch_mm, below, log_weight: below - off * off / 2.0 }
    };
    let steps: Vec<&Step> =
        joined.iter().take_while(|step| step.height_mm <= CROTCH_SHARE[1] * stature_mm).collect();
    let mut places = vec![place(join_mm - STEP_MM / 2.0, 0.0)];
    let mut below = 0.0;
    for step in &steps {
        below += evidence(step);
        places.push(place(step.height_mm + STEP_MM / 2.0, below));
    }
    let count_below =
        (0..places.len()).max_by(|a, b| places[*a].log_weight.total_cmp(&places[*b].log_weight))?;
    let best = &places[count_below];
    let weight = |place: &CrotchCandidate| (place.log_weight - best.log_weight).exp();
    let sum: f64 = places.iter().map(weight).sum();
    let mean = |value: &dyn Fn(&CrotchCandidate) -> f64| {
        places.iter().map(|place| weight(place) * value(place)).sum::<f64>() / sum
    };
    let crotch_mm = mean(&|place| place.crotch_mm);
    let end_sd_mm = mean(&|place| (place.crotch_mm - crotch_mm).powi(2)).sqrt();
    let length_mm = (crotch_mm - join_mm).max(0.0);
    let is_clear =
        best.below >= CLEAR_MIN && best.below >= CLEAR_MIN_PER_SLICE * count_below as f64;
    Some(FoldEnd {
        crotch_mm,
        sd_mm: end_sd_mm.hypot(OWN_SD_MM).hypot(SD_PER_MM * length_mm),
        by_slices_mm: is_clear.then(|| end_mm(&steps, count_below) - above_mm),
    })
}

/// The height at which the fold ends, between the last of the `count_below` slices that show it and the next.
fn end_mm(steps: &[&Step], count_below: usize) -> f64 {
    let (low, high) = (count_below.checked_sub(1), steps.get(count_below));
    let (Some(low), Some(high)) = (low.and_then(|index| steps.get(index)), high) else {
        return steps.last().map_or(0.0, |step| step.height_mm);
    };
    let [for_fold, against] = [evidence(low).max(0.0), -evidence(high).min(0.0)];
    let share = for_fold / (for_fold + against).max(f64::MIN_POSITIVE);
    low.height_mm + share * (high.height_mm - low.height_mm)
}

/// The evidence of a slice for a fold between thighs; negative against it. A slice in pieces, as of a trunk with
/// few points, has none.
fn evidence(step: &Step) -> f64 {
    let steepness = step.neck.and_then(|neck| neck.front_steepness).unwrap_or(STEEP);
    let steep = steepness.min(2.0 * STEEP);
    (SLICE_MAX * (steep - STEEP) / STEEP).max(-SLICE_MAX)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::parting::thigh_divider::Neck;
    use crate::side::Sides;

    const STATURE_MM: f64 = 1700.0;

    /// A neck behind a groove of this steepness.
    fn neck(steepness: f64) -> Option<Neck> {
        let mut neck = Neck::find(&[], [-80.0, 80.0]);
        neck.front_steepness = Some(steepness);
        Some(neck)
    }

    /// Joined slices from a height on, with a groove of a given steepness up to another height and one
    /// of another above.
    fn slices([from_mm, to_mm]: [f64; 2], [below, above]: [f64; 2]) -> Vec<Step> {
        let step = |index: u32| {
            let height_mm = from_mm + STEP_MM * f64::from(index);
            let neck = neck(if height_mm < to_mm { below } else { above });
            Step { height_mm, prints: Sides::default(), neck, gap_mm: None }
        };
        (0..60).map(step).collect()
    }

    fn end(span_mm: [f64; 2], steepness: [f64; 2]) -> FoldEnd {
        fold_end(&slices(span_mm, steepness), STATURE_MM).unwrap()
    }

    #[test]
    fn the_crotch_is_just_below_the_end_of_the_fold() {
        for crotch_mm in [760.0, 790.0, 816.0, 850.0] {
            for length_mm in [40.0, 100.0, 250.0] {
                let found = end([crotch_mm - length_mm, crotch_mm + 8.5], [1.0, -0.2]);
                let off_mm = (found.crotch_mm - crotch_mm).abs();
                assert!(
                    off_mm < 12.0 && found.by_slices_mm.is_some(),
                    "{crotch_mm} {length_mm} {found:?}"
                );
                assert!(off_mm < 2.0 * found.sd_mm, "{crotch_mm} {length_mm} {found:?}");
            }
        }
    }

    #[test]
    fn the_standard_error_grows_with_the_length_over_which_the_thighs_touch() {
        let sd_mm = [40.0, 100.0, 150.0, 250.0]
            .map(|length_mm| end([816.0 - length_mm, 824.0], [1.0, -0.2]).sd_mm);
        assert!(sd_mm.is_sorted(), "{sd_mm:?}");
        assert!(sd_mm[0] < 18.0 && sd_mm[3] > 25.0, "{sd_mm:?}");
    }

    #[test]
    fn slices_that_show_no_groove_leave_it_to_the_proportions() {
        let found = end([600.0, 824.0], [STEEP, STEEP]);
        assert!((found.crotch_mm - MEAN_SHARE * STATURE_MM).abs() < 5.0, "{found:?}");
        assert!(found.sd_mm > 30.0 && found.by_slices_mm.is_none(), "{found:?}");
    }

    #[test]
    fn a_fold_that_ends_at_an_unusual_height_is_less_sure() {
        let [usual, high, low] = [816.0, 900.0, 720.0]
            .map(|to_mm| end([to_mm - 60.0, to_mm], [0.5, 0.1]))
            .map(|found| found.sd_mm);
        assert!(high > usual && low > usual, "{usual} {high} {low}");
    }

    #[test]
    fn one_slice_without_a_groove_is_not_the_end() {
        let mut steps = slices([700.0, 824.0], [1.0, -0.2]);
        let whole = fold_end(&steps, STATURE_MM).unwrap();
        steps[5].neck = neck(-0.2);
        let found = fold_end(&steps, STATURE_MM).unwrap();
        assert!((found.crotch_mm - whole.crotch_mm).abs() < 2.0, "{found:?} {whole:?}");
    }

    #[test]
    fn a_body_without_a_fold_has_no_clear_end() {
        assert_eq!(end([816.0, 824.0], [1.0, -0.2]).by_slices_mm, None);
        assert_eq!(fold_end(&[], STATURE_MM), None);
    }
}
