//! Reasons not to trust a landmark blindly.

/// A reason not to trust a landmark blindly.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Doubt {
    /// The extremum is hardly prominent.
    #[error("the extremum stands out by only {prominence_mm:.1} mm")]
    Shallow {
        /// Its prominence, mm.
        prominence_mm: f64,
    },
    /// The height of the extremum is poorly determined.
    #[error("the girth is flat there: its height is uncertain by {height_sd_mm:.0} mm")]
    Flat {
        /// Standard error of the height, mm.
        height_sd_mm: f64,
    },
    /// The girth is poorly determined: at its height, or because that is uncertain where the girth changes fast.
    #[error("its girth is uncertain by {girth_sd_mm:.0} mm")]
    GirthUncertain {
        /// Standard error of the girth, mm.
        girth_sd_mm: f64,
    },
    /// Another extremum of the same kind is equal to this one within the noise.
    #[error("the girth at {other_height_mm:.0} mm is the same within the noise")]
    Double {
        /// Height of the other extremum's centre above the floor, mm.
        other_height_mm: f64,
    },
    /// Another clear extremum of the same kind lies where people have the level too.
    #[error("the girth turns in the same way at {other_height_mm:.0} mm: a fold or a swelling?")]
    Several {
        /// Height of the other extremum's centre above the floor, mm.
        other_height_mm: f64,
    },
    /// People do not have the level there.
    #[error("it lies at {percent:.0} % of the stature, where people do not have it")]
    UnusualHeight {
        /// Its distance from the floor, percent of the stature.
        percent: f64,
    },
    /// The extremum lies at an end of the searched range.
    #[error("the extremum lies {end_mm:.0} mm from the end of what was searched or seen")]
    Edge {
        /// Distance to the end along the axis, mm.
        end_mm: f64,
    },
    /// The skin at the level has a gap.
    #[error("{gap_deg:.0} degrees of the skin were not seen there")]
    Gap {
        /// Width of the gap as seen from the section's centre, degrees.
        gap_deg: f64,
    },
    /// The points at the level do not form a single skin.
    #[error("the points scatter by {rms_mm:.1} mm there: cloth, a second layer, or a movement?")]
    Scatter {
        /// Root mean square distance of the points from the section, mm.
        rms_mm: f64,
    },
    /// The level lies above a hem.
    #[error(
        "the skin steps out by {step_mm:.0} mm all around at {height_mm:.0} mm: is there cloth above, or does \
         a fold hang over?"
    )]
    Cloth {
        /// How far, mm.
        step_mm: f64,
        /// Height above the floor, mm.
        height_mm: f64,
    },
    /// The skin at the level is longer than a tape around it.
    #[error("the skin is {percent:.1} % longer than a tape around it: is it folded there?")]
    Folds {
        /// Excess of the contour over the tape girth, percent.
        percent: f64,
    },
    /// The sections at the level could not be measured; the curve bridges them.
    #[error("the skin there was not seen; the girth is bridged")]
    NotSeen,
    /// The planes above the calf turn by more than a standing leg's.
    #[error("the knee is bent by {bend_deg:.0} degrees: a tape lies differently there")]
    KneeBent {
        /// Angle between the axes of shank and thigh, degrees.
        bend_deg: f64,
    },
    /// The knee would lie below D.
    #[error("by its proportion the knee would lie below D, which is at {d_height_mm:.0} mm")]
    BelowD {
        /// Height of D, mm.
        d_height_mm: f64,
    },
    /// The tape is closed along the floor, which no scanner sees.
    #[error("the sole is not seen; the tape is closed along the floor")]
    SoleNotSeen,
}

impl Doubt {
    /// The stable code used in records.
    pub fn code(&self) -> &'static str {
        match self {
            Doubt::Shallow { .. } => "shallow",
            Doubt::Flat { .. } => "flat",
            Doubt::GirthUncertain { .. } => "girth-uncertain",
            Doubt::Double { .. } => "double",
            Doubt::Several { .. } => "several",
            Doubt::UnusualHeight { .. } => "unusual-height",
            Doubt::Edge { .. } => "edge",
            Doubt::Gap { .. } => "gap",
            Doubt::Scatter { .. } => "scatter",
            Doubt::Cloth { .. } => "cloth",
            Doubt::Folds { .. } => "folds",
            Doubt::NotSeen => "not-seen",
            Doubt::KneeBent { .. } => "knee-bent",
            Doubt::BelowD { .. } => "below-d",
            Doubt::SoleNotSeen => "sole-not-seen",
        }
    }
}
