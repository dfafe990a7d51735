//! The crotch: where two legs become one body (paper 1, fig. 2a).

use serde::{Deserialize, Serialize};

/// Standard error of the crotch if its skin, or the thighs up to it, were seen, mm.
pub(super) const APART_SD_MM: f64 = 3.0;

/// Above the crotch the skin shows a notch in front and behind; the one in front ends this share of
/// stature above the crotch: 12 to 35 mm in bodies with a known crotch.
pub(super) const NOTCH_ABOVE_CROTCH_SHARE: f64 = 0.0145;

/// Standard error of a crotch found from such a notch, mm, or from thighs that run along each other for a
/// short way.
pub(super) const HIDDEN_SD_MM: f64 = 15.0;

/// Standard error of the crotch if only one leg is followed up to the trunk, mm: from the distance
/// between slices and the slope of a hip.
const ONE_LEG_SD_MM: f64 = 20.0;

/// The assumed crotch height if it is not visible, as a share of stature (ANSUR II).
pub(super) const MEAN_SHARE: f64 = 0.48;

/// Standard deviation of that share among people (ANSUR II), rounded up.
const SD_SHARE: f64 = 0.015;

/// Levels that hang on the crotch are measured if its standard error is at most this, mm. The girth there changes
/// by 0.5 to 0.8 mm a mm, so that two of them are 3 to 4 cm of girth: no figure to order by.
const LEVELS_MAX_SD_MM: f64 = 25.0;

/// Range of crotch heights, as shares of stature. ANSUR II: mean 0.48, first to last percentile
/// 0.45 to 0.52; children and patients need some room.
pub(super) const CROTCH_SHARE: [f64; 2] = [0.38, 0.56];

/// A body is cropped this far above its crotch, mm: 40 mm above what a leg keeps, because the corners of its facets lie
/// up to two thirds of their longest edge from their middle.
const CROP_ABOVE_CROTCH_MM: f64 = 100.0;

/// The height of the crotch and its source.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Crotch {
    /// Above the floor, mm.
    pub height_mm: f64,
    /// Standard error of its distance from the measured skin, mm; that of the floor comes on top.
    pub sd_mm: f64,
    /// The source of the height.
    pub from: CrotchFrom,
    /// Height above which the legs are joined in slices although the crotch is higher, mm: the thighs
    /// touch, or there is cloth.
    pub touching_from_mm: Option<f64>,
}

word_enum! {
    /// The source of the crotch's height.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum CrotchFrom as serde {
        /// The skin between the legs, seen.
        Saddle => "saddle",
        /// The border of what was seen there.
        Border => "border",
        /// The end of the fold between thighs whose skins are one in the scan.
        GrownTogether => "grown-together",
        /// The thighs, seen separate up to it; of a cloud or a torn skin.
        Thighs => "thighs",
        /// The end of the notch in front, because the thighs touch; of a cloud or a torn skin.
        Notch => "notch",
        /// The height at which one leg reaches the trunk, because the other is missing.
        OneLeg => "one-leg",
        /// No observation: the usual height for a body of this size.
        Proportion => "proportion",
    }
}

impl Crotch {
    /// A crotch up to which the legs are apart.
    pub(super) fn at(height_mm: f64, sd_mm: f64, from: CrotchFrom) -> Crotch {
        Crotch { height_mm, sd_mm, from, touching_from_mm: None }
    }

    /// The crotch at the height where one leg, followed alone, reaches the trunk.
    pub(super) fn of_one_leg(end_mm: f64) -> Crotch {
        Crotch::at(end_mm, ONE_LEG_SD_MM, CrotchFrom::OneLeg)
    }

    /// A crotch outside the scan.
    pub fn unseen(stature_mm: f64) -> Crotch {
        Crotch::at(MEAN_SHARE * stature_mm, SD_SHARE * stature_mm, CrotchFrom::Proportion)
    }

    /// A crotch hidden between legs that are joined from some height on.
    pub fn hidden(touching_from_mm: f64, stature_mm: f64) -> Crotch {
        Crotch { touching_from_mm: Some(touching_from_mm), ..Crotch::unseen(stature_mm) }
    }

    /// Height above which the legs are joined without a visible fold, mm, if the crotch is hidden.
    pub fn hidden_from_mm(&self) -> Option<f64> {
        if self.is_seen() { None } else { self.touching_from_mm }
    }

    /// The height below which a body is cropped, mm: nothing above it has a part in what is measured on the legs.
    pub fn crop_mm(&self) -> f64 {
        self.height_mm + CROP_ABOVE_CROTCH_MM
    }

    /// The stature of people with this crotch and its standard error, mm.
    pub fn stature_mm(&self) -> (f64, f64) {
        let stature_mm = self.height_mm / MEAN_SHARE;
        (stature_mm, (self.sd_mm / MEAN_SHARE).hypot(SD_SHARE / MEAN_SHARE * stature_mm))
    }

    /// Whether levels may be measured from it. One by proportion gives estimates, which are marked so.
    pub fn carries_levels(&self) -> bool {
        !self.is_seen() || self.sd_mm <= LEVELS_MAX_SD_MM
    }

    /// Whether the scan shows anything of the crotch.
    pub fn is_seen(&self) -> bool {
        self.from != CrotchFrom::Proportion
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crotch_that_may_be_five_centimetres_off_carries_no_levels() {
        let crotch = |sd_mm: f64| Crotch {
            height_mm: 800.0,
            sd_mm,
            from: CrotchFrom::GrownTogether,
            touching_from_mm: Some(600.0),
        };
        assert!(crotch(24.0).carries_levels() && !crotch(26.0).carries_levels());
        assert!(Crotch::unseen(1900.0).carries_levels());
    }
}
