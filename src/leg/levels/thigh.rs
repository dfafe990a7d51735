//! The levels that depend on the crotch: G by its distance, E and F by proportion.
//!
//! The girth has no feature at the middle of the patella. The patella shows as a bulge in the
//! outline of the front, but on noise-free bodies of known shape the outline's outermost point and
//! its sharpest bend lie between 0.58 and 0.69 of the crotch's height, depending on the fat and
//! muscle above the knee. So E is an estimate, and so is F, which depends on it.

use super::landmark::{Estimate, Landmark};
use super::level_reading::Ruler;
use crate::leg::doubt::Doubt;
use crate::leg::level::{By, Level};
use crate::leg::parting::crotch::Crotch;
use crate::leg::sections::section::Section;

/// Height of the mid-patella as a share of the crotch's (ANSUR II: men 0.577, women 0.574).
pub const KNEE_CROTCH_SHARE: f64 = 0.575;

/// Standard deviation of that share among people (ANSUR II: men 0.014, women 0.013).
const KNEE_CROTCH_SHARE_SD: f64 = 0.014;

/// G, a vertical distance below the crotch; `None` if the leg was not measured that high.
pub(in crate::leg) fn g<'a>(
    ruler: &Ruler<impl Fn(f64) -> Option<&'a Section>>,
    crotch: &Crotch,
    distance_mm: f64,
) -> Option<Landmark> {
    let by = By::BelowCrotch { distance_mm };
    ruler.at_height(Level::G, by, crotch.height_mm - distance_mm, crotch.sd_mm)
}

/// E by its share of the crotch's height and F halfway from there to G, if the leg was measured
/// that high; lowest first. D, if found, is below every knee.
pub(in crate::leg) fn knee_and_thigh<'a>(
    ruler: &Ruler<impl Fn(f64) -> Option<&'a Section>>,
    crotch: &Crotch,
    distance_mm: f64,
    d: Option<&Landmark>,
) -> Vec<Estimate> {
    let knee_mm = KNEE_CROTCH_SHARE * crotch.height_mm;
    let knee_sd_mm =
        (KNEE_CROTCH_SHARE_SD * crotch.height_mm).hypot(KNEE_CROTCH_SHARE * crotch.sd_mm);
    let middle_mm = (knee_mm + crotch.height_mm - distance_mm) / 2.0;
    let middle_sd_mm = knee_sd_mm.hypot(crotch.sd_mm) / 2.0;
    let by_share = By::CrotchShare { share: KNEE_CROTCH_SHARE };
    let e = ruler.at_height(Level::E, by_share, knee_mm, knee_sd_mm);
    let between = By::Between(Level::E, Level::G);
    let f = ruler.at_height(Level::F, between, middle_mm, middle_sd_mm);
    let mut estimates: Vec<Estimate> = [e, f].into_iter().flatten().map(Estimate::from).collect();
    if let Some(d) = d.filter(|d| d.height_mm > knee_mm) {
        let doubt = Doubt::BelowD { d_height_mm: d.height_mm };
        estimates.iter_mut().for_each(|estimate| estimate.doubts.push(doubt));
    }
    estimates
}
