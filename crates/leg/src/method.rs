//! The choices of the method: the properties declared for the export, and the steps of the paper to
//! use.

use serde::{Deserialize, Serialize};

use super::side::Side;
pub use crate::comparison::tape_volume::VolumeBy;

/// How to read and measure a scan. `Default` is the method without any choices by the user.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Method {
    /// What is in the scan.
    pub scope: Scope,
    /// The unit of the export's coordinates.
    pub unit: UnitChoice,
    /// The export's axis that points up.
    pub up: Up,
    /// The declared direction of the toes, if any.
    pub facing: FacingChoice,
    /// Which way round the export's triangles are wound.
    pub winding: Winding,
    /// How the patient holds the legs. It changes nothing of the measurement; girths and volumes depend on it.
    pub posture: Posture,
    /// The source of the sections.
    pub fit: SectionFit,
    /// How the tape lies around the leg.
    pub tape: Tape,
    /// Rows and columns of control points of the surface, along and around; `None` chooses them by the
    /// leg's length.
    pub surface_control_points: Option<[usize; 2]>,
    /// Additional heights above the floor at which girths are wanted, mm, in the order of the report.
    pub at_heights_mm: Vec<f64>,
    /// The chosen definitions of levels that have more than one.
    pub levels: LevelChoices,
    /// How volumes are made of girths at fixed places, for comparing visits.
    pub volume: VolumeBy,
}

word_enum! {
    /// How the patient holds the legs while they are scanned.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    pub enum Posture {
        /// Standing, with the weight on both legs, as in a booth.
        #[default]
        BothLegs => "both-legs",
        /// Standing, with the weight on the leg that is measured, as rules for the tape ask for.
        OneLeg => "one-leg",
        /// Sitting.
        Sitting => "sitting",
        /// Lying.
        Lying => "lying",
    }
}

word_enum! {
    /// Which way round triangles are wound: their corners run counter-clockwise as seen from …
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    pub enum Winding {
        /// … outside the body.
        #[default]
        Outward => "outward",
        /// … inside it.
        Inward => "inward",
    }
}

/// The contents of the scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Scope {
    /// A whole standing body.
    #[default]
    Body,
    /// One leg or lower leg with its foot, alone; the scan does not show which side it is.
    Leg(Side),
}

impl Scope {
    /// The words used in records.
    pub fn word(self) -> &'static str {
        match self {
            Scope::Body => "body",
            Scope::Leg(Side::Left) => "left leg",
            Scope::Leg(Side::Right) => "right leg",
        }
    }
}

/// The definitions of the levels that manufacturers define in more than one way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LevelChoices {
    /// The definition of B1.
    pub b1: B1,
    /// How far below the crotch G is, mm.
    pub g_below_crotch_mm: f64,
}

/// The definition of B1.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub enum B1 {
    /// Where the girth grows fastest between B and C (the paper's definition).
    #[default]
    Steepest,
    /// At a fixed height above B.
    AboveB {
        /// The vertical distance, mm.
        distance_mm: f64,
    },
}

impl Default for LevelChoices {
    fn default() -> LevelChoices {
        // Manufacturers put G 2 to 5 cm below the crotch. 5 cm is used, because a section
        // perpendicular to a leg that leans by 10° reaches 15 mm higher on the medial side, and
        // thighs that touch do so at the top.
        LevelChoices { b1: B1::Steepest, g_below_crotch_mm: 50.0 }
    }
}

impl B1 {
    /// The word used in the configuration and in records.
    pub fn word(self) -> &'static str {
        match self {
            B1::Steepest => "steepest",
            B1::AboveB { .. } => "above-b",
        }
    }
}

/// The unit of the export's coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum UnitChoice {
    /// The only unit that gives a plausible stature.
    #[default]
    Auto,
    /// Declared; still checked against a plausible stature.
    Declared(Unit),
}

word_enum! {
    /// A unit of length that scanners export in, smallest first.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Unit {
        /// Millimetre.
        Mm => "mm",
        /// Centimetre.
        Cm => "cm",
        /// Inch, 25.4 mm.
        In => "in",
        /// Metre.
        M => "m",
    }
}

impl Unit {
    /// Millimetres in one of this unit.
    pub fn in_mm(self) -> f64 {
        match self {
            Unit::Mm => 1.0,
            Unit::Cm => 10.0,
            Unit::In => 25.4,
            Unit::M => 1000.0,
        }
    }
}

word_enum! {
    /// The export's axis that points up.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    pub enum Up {
        /// +y, as \[TC\]2 exports it.
        #[default]
        Y => "y",
        /// +z.
        Z => "z",
        /// +x.
        X => "x",
    }
}

/// The direction of the toes in the export's own axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum FacingChoice {
    /// Found from the feet.
    #[default]
    Auto,
    /// Declared; feet that contradict it cause a refusal.
    Declared(Axis),
}

impl FacingChoice {
    /// The word used in records and in the configuration.
    pub fn word(self) -> &'static str {
        match self {
            FacingChoice::Auto => "auto",
            FacingChoice::Declared(axis) => axis.word(),
        }
    }
}

word_enum! {
    /// A signed axis of the export.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Axis {
        /// +x.
        PlusX => "+x",
        /// −x.
        MinusX => "-x",
        /// +y.
        PlusY => "+y",
        /// −y.
        MinusY => "-y",
        /// +z.
        PlusZ => "+z",
        /// −z.
        MinusZ => "-z",
    }
}

word_enum! {
    /// The source of a leg's sections and the curve that each of them is.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    pub enum SectionFit {
        /// The section through the leg's skin as one smooth function of angle and height, fitted to all
        /// points at once.
        #[default]
        Skin => "skin",
        /// Radius over angle as a periodic smoothing spline, C2 across the seam, through the crossings
        /// of the mesh with the plane.
        Periodic => "periodic",
        /// The paper's method: radius over angle in (−π, π] as a polynomial of order 15, through the
        /// points where the lines between nearest points on both sides of the plane intersect it.
        Paper => "paper",
    }
}

/// The planes in which girths are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Tape {
    /// Square to the part of the leg that the tape goes around: to the shank up to the knee, to the thigh
    /// above it, as a person holds a tape.
    #[default]
    Shank,
    /// All square to one axis of the whole leg, as in the paper.
    Leg(AxisFit),
    /// All horizontal, as most scanners' software measures.
    Horizontal,
}

impl Tape {
    /// The word used in records.
    pub fn word(self) -> &'static str {
        match self {
            Tape::Shank => "shank",
            Tape::Leg(_) => "leg",
            Tape::Horizontal => "horizontal",
        }
    }
}

word_enum! {
    /// The line used as the axis of a whole leg.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
    pub enum AxisFit {
        /// Through the centroids of its sections between ankle and groin, all with equal weight.
        #[default]
        Centroids => "centroids",
        /// The paper's method: the first principal component of its points from the floor to the crotch.
        Principal => "principal",
    }
}
