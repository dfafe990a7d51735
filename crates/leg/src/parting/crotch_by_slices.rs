//! The crotch as slices show it: for clouds, which have no edges, and for skins that are torn at the
//! crotch.

use super::crotch::{APART_SD_MM, Crotch, CrotchFrom, HIDDEN_SD_MM, NOTCH_ABOVE_CROTCH_SHARE};
use super::leg_tracking::{GROWTH_UP_MM, Parting, Step, follow};
use crate::sections::slice::Mesh;

/// Distance between the fine slices that locate the crotch, mm.
const FINE_STEP_MM: f64 = 1.0;

/// The fine slices begin this far below the last height at which the thighs are separate, mm.
const FINE_BELOW_MM: f64 = 10.0;

/// The rate at which the thighs approach each other is measured over this height, mm, and
/// extrapolated to where they meet.
const CLOSING_MM: f64 = 5.0;

/// The crotch is at most this much above the last height at which the thighs were seen separate,
/// mm; further up they would still be seen separate.
const CLOSED_MAX_MM: f64 = 8.0;

/// Thighs approach each other by more than this where they meet, mm per mm of height. If they
/// approach more slowly, they run along each other, or the skin in the fold was not seen.
const CLOSING_MIN: f64 = 0.6;

/// The notch between the thighs in front ends where it is shallower than this share of the body's
/// depth.
const NOTCH_END_SHARE: f64 = 0.10;

/// Thighs touch if they join this far below the crotch found from the notch, mm: two standard errors.
const TOUCHING_MIN_MM: f64 = 2.0 * HIDDEN_SD_MM;

/// The crotch of legs that were followed upwards and are joined from the step `join` on. Slices
/// `mesh` again in finer steps.
pub fn crotch(mesh: &Mesh, steps: &[Step], join: usize, stature_mm: f64) -> Crotch {
    let (below, joined) = steps.split_at(join);
    let join_mm = joined.first().map_or(0.0, |step| step.height_mm);
    let notched = joined.iter().take_while(|step| notch_share(step) >= NOTCH_END_SHARE).last();
    let by_notch_mm = notched.map(|step| step.height_mm - NOTCH_ABOVE_CROTCH_SHARE * stature_mm);
    if let Some(height_mm) = by_notch_mm.filter(|mm| *mm > join_mm + TOUCHING_MIN_MM) {
        let crotch = Crotch::at(height_mm, HIDDEN_SD_MM, CrotchFrom::Notch);
        return Crotch { touching_from_mm: Some(join_mm), ..crotch };
    }
    let last = below.iter().rfind(|step| step.neck.is_none());
    let beneath = (join_mm, HIDDEN_SD_MM);
    let (height_mm, sd_mm) = last.map_or(beneath, |last| closed(mesh, last, join_mm));
    Crotch::at(height_mm, sd_mm, CrotchFrom::Thighs)
}

fn notch_share(step: &Step) -> f64 {
    step.neck.map_or(0.0, |neck| neck.notch_share)
}

/// The height at which thighs meet that are separate at `last` and joined at `join_mm`, with its
/// standard error. Their distance is visible until the points of one thigh are as close to the
/// other's as to each other; from there it is extrapolated to zero.
///
/// Below the top of an arch the width grows with the square root of the depth, so the square of the
/// distance is what decreases linearly.
fn closed(mesh: &Mesh, last: &Step, join_mm: f64) -> (f64, f64) {
    let from_mm = last.height_mm - FINE_BELOW_MM;
    let count = ((join_mm + FINE_BELOW_MM - from_mm) / FINE_STEP_MM) as usize + 1;
    let heights: Vec<f64> = (0..count).map(|index| from_mm + FINE_STEP_MM * index as f64).collect();
    let fine = follow(mesh, &last.prints, &heights, GROWTH_UP_MM, Parting::Neck);
    let gaps = fine.steps.iter().take_while(|step| step.neck.is_none());
    let gaps: Vec<(f64, f64)> =
        gaps.filter_map(|step| Some((step.height_mm, step.gap_mm?))).collect();
    let (Some(&(first_mm, first)), Some(&(last_mm, gap_mm))) = (gaps.first(), gaps.last()) else {
        return (join_mm, HIDDEN_SD_MM);
    };
    let earlier = gaps.iter().find(|(height_mm, _)| *height_mm >= last_mm - CLOSING_MM);
    let closing = earlier
        .map_or(0.0, |(height_mm, gap)| (gap * gap - gap_mm * gap_mm) / (last_mm - height_mm));
    let above_mm = if closing > 0.0 { gap_mm * gap_mm / closing } else { CLOSED_MAX_MM };
    let is_sudden = first - gap_mm >= CLOSING_MIN * (last_mm - first_mm);
    let sd_mm = if is_sudden { APART_SD_MM } else { HIDDEN_SD_MM };
    (last_mm + above_mm.min(CLOSED_MAX_MM), sd_mm)
}
