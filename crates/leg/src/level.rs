//! The levels of a leg: their names and how each is found.

use serde::{Deserialize, Serialize};

/// A level of the leg (RAL-GZ 387).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Level {
    /// Around the heads of the metatarsals.
    A,
    /// Over heel and instep, the tape at 45°; not a section across the leg.
    Y,
    /// Smallest girth above the malleoli.
    B,
    /// Where the Achilles tendon meets the muscle: the largest slope of the girth between B and C,
    /// or a fixed height above B.
    B1,
    /// Largest girth of the calf.
    C,
    /// First minimum above the calf.
    D,
    /// Knee, at the middle of the patella.
    E,
    /// Middle of the thigh, halfway between E and G.
    F,
    /// Root of the thigh, a fixed height below the crotch.
    G,
}

impl Level {
    /// All levels, lowest first.
    pub const ALL: [Level; 9] =
        [Level::A, Level::Y, Level::B, Level::B1, Level::C, Level::D, Level::E, Level::F, Level::G];

    /// The levels that are searched for on every leg, lowest first (paper 1.2): each is found, or
    /// its absence is a finding.
    pub const SOUGHT: [Level; 4] = [Level::B, Level::B1, Level::C, Level::D];

    /// The name used on paper and in records.
    pub fn name(self) -> &'static str {
        match self {
            Level::A => "A",
            Level::Y => "Y",
            Level::B => "B",
            Level::B1 => "B1",
            Level::C => "C",
            Level::D => "D",
            Level::E => "E",
            Level::F => "F",
            Level::G => "G",
        }
    }
}

/// How a level is found or, if it is not visible on the skin, estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum By {
    /// A turning point of the girth curve.
    Turn,
    /// The largest slope of the girth curve.
    Steepest,
    /// A vertical distance above B.
    AboveB {
        /// The distance, mm.
        distance_mm: f64,
    },
    /// A vertical distance below the crotch.
    BelowCrotch {
        /// The distance, mm.
        distance_mm: f64,
    },
    /// A tape at 45° from the point where heel and floor meet, over the instep.
    HeelTape,
    /// The mean of a share of the stature and a distance above D; the share alone without D.
    Knee {
        /// The share.
        stature_share: f64,
        /// The distance, mm; `None` without D.
        above_d_mm: Option<f64>,
    },
    /// Halfway between two levels.
    Between(Level, Level),
    /// Shares of the foot's length, from the heel, on its two sides.
    FootShares {
        /// On the medial side.
        medial: f64,
        /// On the lateral side.
        lateral: f64,
    },
}
