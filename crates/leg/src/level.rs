//! The levels of a leg: their names and how each is found.

use serde::{Deserialize, Serialize};

use crate::figure::{AsFigure, Figure};

word_enum! {
    /// A level of the leg (RAL-GZ 387), lowest first.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
    pub enum Level {
        /// Around the heads of the metatarsals.
        A => "A",
        /// Over heel and instep, the tape at 45°; not a section across the leg.
        Y => "Y",
        /// Smallest girth above the malleoli.
        B => "B",
        /// Where the Achilles tendon meets the muscle: the largest slope of the girth between B and C,
        /// or a fixed height above B.
        B1 => "B1",
        /// Largest girth of the calf.
        C => "C",
        /// First minimum above the calf.
        D => "D",
        /// Knee, at the middle of the patella.
        E => "E",
        /// Middle of the thigh, halfway between E and G.
        F => "F",
        /// Root of the thigh, a fixed height below the crotch.
        G => "G",
    }
}

impl Level {
    /// The levels that are searched for on every leg, lowest first (paper 1.2): each is found, or
    /// its absence is a finding.
    pub const SOUGHT: [Level; 4] = [Level::B, Level::B1, Level::C, Level::D];

    /// The name used on paper and in records.
    pub fn name(self) -> &'static str {
        self.word()
    }
}

impl AsFigure for Level {
    fn figure(&self) -> Option<Figure> {
        Some(Figure::Name(self.name().to_owned()))
    }
}

coded_enum! {
    /// How a level is found or, if it is not visible on the skin, estimated.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub enum By {
        /// A turning point of the girth curve.
        Turn => "turning-point",
        /// The largest slope of the girth curve.
        Steepest => "largest-slope",
        /// A vertical distance above B.
        AboveB {
            /// The distance, mm.
            distance_mm: f64,
        } => "above-b",
        /// A vertical distance below the crotch.
        BelowCrotch {
            /// The distance, mm.
            distance_mm: f64,
        } => "below-crotch",
        /// A tape at 45° from the point where heel and floor meet, over the instep.
        HeelTape => "heel-tape",
        /// A share of the stature.
        StatureShare {
            /// The share.
            share: f64,
        } => "stature-share",
        /// The mean of a share of the stature and a distance above D.
        Knee {
            /// The share.
            stature_share: f64,
            /// The distance, mm.
            above_d_mm: f64,
        } => "knee",
        /// Halfway between two levels.
        Between {
            /// The lower one.
            low: Level,
            /// The higher one.
            high: Level,
        } => "halfway",
        /// Shares of the foot's length, from the heel, on its two sides.
        FootShares {
            /// On the medial side.
            medial: f64,
            /// On the lateral side.
            lateral: f64,
        } => "foot-shares",
    }
}
