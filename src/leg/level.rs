//! The levels of a leg by name.

/// A level of the leg (RAL-GZ 387).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Smallest girth above the malleoli.
    B,
    /// Largest slope of the girth between B and C: where the Achilles tendon meets the muscle.
    B1,
    /// Largest girth of the calf.
    C,
    /// First minimum above the calf.
    D,
}

impl Level {
    /// All levels, lowest first.
    pub const ALL: [Level; 4] = [Level::B, Level::B1, Level::C, Level::D];

    /// The name used on paper and in records.
    pub fn name(self) -> &'static str {
        match self {
            Level::B => "B",
            Level::B1 => "B1",
            Level::C => "C",
            Level::D => "D",
        }
    }
}
