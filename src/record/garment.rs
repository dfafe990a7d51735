//! Garments and the measures that an order for them needs.

use crate::leg::Level;

/// A compression garment by the levels at which it begins and ends (RAL-GZ 387).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Garment {
    /// Calf stocking, from the foot to below the knee.
    #[default]
    Ad,
    /// Stocking up to the middle of the thigh.
    Af,
    /// Thigh stocking, up to the root of the thigh.
    Ag,
    /// Tights. What lies above the thigh is left open on the sheet: a scan of the legs does not give it.
    At,
}

impl Garment {
    /// All garments, the shortest first.
    pub const ALL: [Garment; 4] = [Garment::Ad, Garment::Af, Garment::Ag, Garment::At];

    /// The name on order forms and in the configuration.
    pub const fn name(self) -> &'static str {
        match self {
            Garment::Ad => "AD",
            Garment::Af => "AF",
            Garment::Ag => "AG",
            Garment::At => "AT",
        }
    }

    /// The levels whose girths and heights it needs, highest first. A is not among them: a stocking with an
    /// open toe is ordered without it, and no scanner sees the sole.
    pub fn levels(self) -> &'static [Level] {
        const THIGH: [Level; 8] =
            [Level::G, Level::F, Level::E, Level::D, Level::C, Level::B1, Level::B, Level::Y];
        match self {
            Garment::Ad => &THIGH[3..],
            Garment::Af => &THIGH[1..],
            Garment::Ag | Garment::At => &THIGH,
        }
    }

    /// Whether it needs the length of the inside of the leg, lK.
    pub fn needs_inside_leg(self) -> bool {
        self == Garment::At
    }
}
