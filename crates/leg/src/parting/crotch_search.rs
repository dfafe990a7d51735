//! The search for the crotch: the saddle of the skin, or what stands in for it.

use super::crotch::{APART_SD_MM, Crotch, CrotchFrom, HIDDEN_SD_MM, NOTCH_ABOVE_CROTCH_SHARE};
use super::crotch_by_slices;
use super::leg_tracking::Step;
use super::saddle::Saddle;
use crate::sections::slice::Mesh;

/// At least this share of the slices above a crotch shows one outline for both legs.
const ONE_SHARE: f64 = 0.8;

/// … and the same share of the first few of them.
const JOIN_STEPS: usize = 5;

/// A crotch below which the thighs touch joins the slices this far lower, mm, or further; where the
/// fold narrows, slices join a little early on every body.
const TOUCHING_MIN_MM: f64 = 30.0;

/// The body is examined this far above a saddle, mm.
const NECK_ABOVE_MM: f64 = 20.0;

/// The perineum is at least this share of the body's depth thick from front to back (0.45 to 0.93 in
/// bodies with a known crotch); skins of thighs that grew together are thinner (0.21 to 0.26).
const NECK_MIN_SHARE: f64 = 0.40;

/// Where skins grew together, the body is the first height at which it is this thick …
const BODY_MIN_SHARE: f64 = 0.60;

/// … and the crotch is this far below, mm.
const BODY_ABOVE_CROTCH_MM: f64 = 12.0;

/// The step from which on legs, followed upwards, stay joined; `None` if they never do.
///
/// Single slices of a trunk may fall apart where it has few points.
pub fn join(steps: &[Step]) -> Option<usize> {
    let is_one = |step: &Step| step.neck.is_some();
    let share =
        |part: &[Step]| part.iter().filter(|step| is_one(step)).count() as f64 / part.len() as f64;
    (0..steps.len()).find(|&first| {
        let above = &steps[first..];
        let next = &above[..above.len().min(JOIN_STEPS)];
        is_one(&steps[first]) && share(above) >= ONE_SHARE && share(next) >= ONE_SHARE
    })
}

/// The crotch of legs that were followed upwards and are joined from the step `join` on: the saddle
/// of their skin, unless it is missing, or lies in a web between thighs.
pub fn crotch(
    mesh: &Mesh,
    steps: &[Step],
    join: usize,
    saddle: Option<Saddle>,
    growth_mm: f64,
    stature_mm: f64,
) -> Crotch {
    let by_slices = || crotch_by_slices::crotch(mesh, steps, join, growth_mm, stature_mm);
    let Some(saddle) = saddle else { return by_slices() };
    let is_web = neck_share(steps, saddle.height_mm + NECK_ABOVE_MM) < NECK_MIN_SHARE;
    if mesh.triangles().is_empty() {
        let by_slices = by_slices();
        // In a cloud thighs that touch are connected like one skin.
        let is_sure =
            by_slices.sd_mm <= APART_SD_MM && !is_web && saddle.border_bottom_mm.is_none();
        return if is_sure { seen(saddle) } else { by_slices };
    }
    let found = match saddle.border_bottom_mm {
        Some(bottom_mm) => beside_border(saddle.height_mm, bottom_mm, stature_mm),
        None if is_web => above_web(steps, saddle.height_mm),
        None => seen(saddle),
    };
    let join_mm = steps.get(join).map(|step| step.height_mm);
    let touching_from_mm = join_mm.filter(|mm| *mm < found.height_mm - TOUCHING_MIN_MM);
    Crotch { touching_from_mm, ..found }
}

fn seen(saddle: Saddle) -> Crotch {
    let (height_mm, from) = (saddle.height_mm, CrotchFrom::Saddle);
    Crotch { height_mm, sd_mm: APART_SD_MM, from, touching_from_mm: None }
}

/// The crotch at a saddle that lies on a border of the skin. The way from leg to leg goes around what
/// was not seen, and no further up than to the end of the notch in front; so the crotch lies between
/// the lower end of that border, or of that notch, and the saddle.
fn beside_border(saddle_mm: f64, bottom_mm: f64, stature_mm: f64) -> Crotch {
    let notch_mm = NOTCH_ABOVE_CROTCH_SHARE * stature_mm;
    let below_mm = ((saddle_mm - bottom_mm) / 2.0).min(notch_mm);
    let sd_mm = APART_SD_MM.hypot(HIDDEN_SD_MM * below_mm / notch_mm);
    let (height_mm, from) = (saddle_mm - below_mm, CrotchFrom::Border);
    Crotch { height_mm, sd_mm, from, touching_from_mm: None }
}

/// The crotch above a web of skin between the thighs.
fn above_web(steps: &[Step], saddle_mm: f64) -> Crotch {
    let body_mm = body_from_mm(steps, saddle_mm).map(|mm| mm - BODY_ABOVE_CROTCH_MM);
    let (height_mm, from) = (body_mm.unwrap_or(saddle_mm), CrotchFrom::GrownTogether);
    Crotch { height_mm, sd_mm: HIDDEN_SD_MM, from, touching_from_mm: None }
}

/// Thickness of the body between the legs as a share of its depth, in the slice nearest to a height; 0
/// where the legs are separate.
fn neck_share(steps: &[Step], height_mm: f64) -> f64 {
    let far = |step: &&Step| (step.height_mm - height_mm).abs();
    let nearest = steps.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
    nearest.map_or(0.0, thickness_share)
}

fn thickness_share(step: &Step) -> f64 {
    step.neck.map_or(0.0, |neck| neck.thickness_share)
}

/// The lowest height above `from_mm` at which the legs are one body, mm.
fn body_from_mm(steps: &[Step], from_mm: f64) -> Option<f64> {
    let above = &steps[steps.partition_point(|step| step.height_mm < from_mm)..];
    let first = above.iter().position(|step| thickness_share(step) >= BODY_MIN_SHARE)?;
    let (low, high) = (&above[first.saturating_sub(1)], &above[first]);
    let rise = thickness_share(high) - thickness_share(low);
    let share = if rise > 0.0 { (BODY_MIN_SHARE - thickness_share(low)) / rise } else { 1.0 };
    Some(low.height_mm + share * (high.height_mm - low.height_mm))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parting::thigh_divider::Neck;
    use crate::side::Sides;

    /// Steps 10 mm apart; the pattern has a 1 where the legs are joined.
    fn steps(pattern: &str) -> Vec<Step> {
        let neck = Neck::of(&[], [-80.0, 80.0]);
        let step = |(index, mark)| Step {
            height_mm: 10.0 * index as f64,
            prints: Sides::default(),
            neck: (mark == '1').then_some(neck),
            gap_mm: None,
        };
        pattern.chars().enumerate().map(step).collect()
    }

    #[test]
    fn legs_are_one_from_where_nearly_all_slices_above_show_one() {
        assert_eq!(join(&steps("0000011111111111")), Some(5));
        // A slice of the trunk that falls apart, even the last one, is not a crotch.
        assert_eq!(join(&steps("0000011111111011")), Some(5));
        assert_eq!(join(&steps("0000011111111110")), Some(5));
        // Knees that touch are not a crotch either.
        assert_eq!(join(&steps("0011100000001111111111")), Some(12));
    }

    #[test]
    fn legs_that_stay_apart_or_part_again_are_never_one() {
        assert_eq!(join(&steps("0000000000")), None);
        assert_eq!(join(&steps("0000111110000000")), None);
        assert_eq!(join(&[]), None);
    }
}
