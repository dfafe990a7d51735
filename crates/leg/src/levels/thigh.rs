//! The levels above D: G by its distance from the crotch, E by the body's size and D, F between them.
//!
//! The girth has no feature at the middle of the patella, and single features of the outline (the hollow
//! behind the knee, the bulge in front, the breadth) scatter by 22 to 84 mm about it. So E is an
//! estimate, and so is F, which depends on it.

use super::landmark::{Estimate, Landmark};
use super::level_reading::Ruler;
use crate::doubt::Doubt;
use crate::level::{By, Level};
use crate::parting::crotch::Crotch;

/// Height of the mid-patella as a share of stature, among people.
pub const KNEE_STATURE_SHARE: f64 = 0.277;

/// … and above D, mm.
const KNEE_ABOVE_D_MM: f64 = 45.0;

/// Standard error of the mean of both, mm: on bodies and people with a known patella it is 14 mm off
/// on average, 5 mm low.
const KNEE_SD_MM: f64 = 18.0;

/// … and of the share alone, on a leg without D, mm.
const KNEE_BY_STATURE_SD_MM: f64 = 25.0;

/// G, a vertical distance below the crotch; `None` if the leg was not measured that high, or if the crotch is too
/// uncertain: then it is measured by hand.
pub(crate) fn g(ruler: &Ruler, crotch: &Crotch, distance_mm: f64) -> Option<Landmark> {
    if !crotch.carries_levels() {
        return None;
    }
    let by = By::BelowCrotch { distance_mm };
    ruler.at_height(Level::G, by, crotch.height_mm - distance_mm, crotch.sd_mm)
}

/// The height of the knee and its standard error, mm, with the rule that gave it. No knee is below D.
fn knee(d: Option<&Landmark>, stature_mm: f64, stature_sd_mm: f64) -> (f64, f64, By) {
    let by_stature_mm = KNEE_STATURE_SHARE * stature_mm;
    let share_sd_mm = KNEE_STATURE_SHARE * stature_sd_mm;
    let Some(d) = d else {
        let by = By::StatureShare { share: KNEE_STATURE_SHARE };
        return (by_stature_mm, KNEE_BY_STATURE_SD_MM.hypot(share_sd_mm), by);
    };
    let mean_mm = (by_stature_mm + d.height_mm + KNEE_ABOVE_D_MM) / 2.0;
    let sd_mm = KNEE_SD_MM.hypot(share_sd_mm.hypot(d.height_sd_mm) / 2.0);
    let by = By::Knee { stature_share: KNEE_STATURE_SHARE, above_d_mm: KNEE_ABOVE_D_MM };
    (mean_mm.max(d.height_mm), sd_mm, by)
}

/// E, and F halfway from there to G, if the leg was measured that high and the crotch is certain enough; lowest
/// first.
pub(crate) fn knee_and_thigh(
    ruler: &Ruler,
    crotch: &Crotch,
    distance_mm: f64,
    d: Option<&Landmark>,
    [stature_mm, stature_sd_mm]: [f64; 2],
) -> Vec<Estimate> {
    let (knee_mm, knee_sd_mm, by) = knee(d, stature_mm, stature_sd_mm);
    let middle_mm = (knee_mm + crotch.height_mm - distance_mm) / 2.0;
    let middle_sd_mm = knee_sd_mm.hypot(crotch.sd_mm) / 2.0;
    let e = ruler.at_height(Level::E, by, knee_mm, knee_sd_mm);
    let between = By::Between { low: Level::E, high: Level::G };
    let f = ruler.at_height(Level::F, between, middle_mm, middle_sd_mm);
    let f = f.filter(|_| crotch.carries_levels());
    let mut estimates: Vec<Estimate> = [e, f].into_iter().flatten().map(Estimate::from).collect();
    if let Some(d) = d.filter(|d| d.height_mm > KNEE_STATURE_SHARE * stature_mm) {
        let doubt = Doubt::BelowD { d_height_mm: d.height_mm };
        estimates.iter_mut().for_each(|estimate| estimate.doubts.push(doubt));
    }
    estimates
}
