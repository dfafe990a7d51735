//! What the operator or a later step must know: findings about a scan or leg, doubts about a level.

use super::at_height::NoGirth;
use super::axis::AxisFault;
use super::difference::LegsDiffer;
use super::extremum::Absence;
use super::level::Level;
use super::second_opinion::SecondOpinion;
use super::side::Side;
use super::stance::FeetUnclear;

/// How much a finding matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing.
    Info,
    /// Look before you use the record.
    Warning,
    /// Something was not measured.
    Error,
}

impl Severity {
    /// The word used in records.
    pub fn word(self) -> &'static str {
        match self {
            Severity::Info => "info",
            Severity::Warning => "warning",
            Severity::Error => "error",
        }
    }
}

/// Something that must be known about a scan, a leg or a level.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Which leg, where it is one leg's.
    pub side: Option<Side>,
    /// Which level, where it is one level's.
    pub level: Option<Level>,
    /// What.
    pub what: What,
}

/// What was found, with its figures.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum What {
    /// The level is not on this leg.
    #[error("the level is absent: {0}")]
    LevelAbsent(Absence),
    /// A girth that no leg has.
    #[error("a girth of {girth_mm:.0} mm is no leg's: the level is left out")]
    LevelImplausible {
        /// What was measured, mm.
        girth_mm: f64,
    },
    /// Nobody saw the feet, and the declared facing was believed.
    #[error("left and right rest on the declared facing alone: {0}")]
    FacingUnchecked(FeetUnclear),
    /// A file of a format for meshes that holds not one triangle.
    #[error(
        "the file holds points but no faces, and was measured by its points: was the export cut \
         short, or the mesh left out?"
    )]
    NoFaces,
    /// The thighs touch below the crotch.
    #[error(
        "the legs are one from {from_mm:.0} mm up: do the thighs touch, or is there cloth? they were \
         parted along the fold, and the skin in it was not seen"
    )]
    ThighsTouch {
        /// Height from which on they touch, mm.
        from_mm: f64,
    },
    /// A crotch where hardly anybody has it.
    #[error(
        "the crotch is at {percent:.0} % of the stature, where nearly everybody has it at 44 to 53 %: \
         are head and feet whole in the scan?"
    )]
    Proportions {
        /// Height of the crotch, percent of the stature.
        percent: f64,
    },
    /// A leg that ends below the crotch.
    #[error("the leg is seen up to {end_mm:.0} mm only: nothing was measured above")]
    LegCut {
        /// Height of its last skin, mm.
        end_mm: f64,
    },
    /// A doubt about a landmark.
    #[error("{0}")]
    Doubtful(Doubt),
    /// The leg could not be measured.
    #[error("the leg was not measured: {0}")]
    LegNotMeasured(LegFault),
    /// The sections allow no surface.
    #[error("no surface: only {rows} sections are seen between {from_mm:.0} and {to_mm:.0} mm")]
    NoSurface {
        /// Sections seen.
        rows: usize,
        /// From this height, mm.
        from_mm: f64,
        /// To this height, mm.
        to_mm: f64,
    },
    /// The surface does not cover the range that a stocking needs.
    #[error(
        "the surface covers {from_mm:.0} to {to_mm:.0} mm; {wanted_from_mm:.0} to {wanted_to_mm:.0} mm are wanted"
    )]
    SurfaceShort {
        /// Lower end, height in mm.
        from_mm: f64,
        /// Upper end, height in mm.
        to_mm: f64,
        /// Wanted lower end, height in mm.
        wanted_from_mm: f64,
        /// Wanted upper end, height in mm.
        wanted_to_mm: f64,
    },
    /// There is no girth at a height that was asked for.
    #[error("no girth at {height_mm:.0} mm: {why}")]
    HeightNotMeasured {
        /// The height above the floor, mm.
        height_mm: f64,
        /// Why not.
        why: NoGirth,
    },
    /// The legs differ as much as by a swelling.
    #[error(transparent)]
    LegsDiffer(#[from] LegsDiffer),
    /// What the scanner's own measures say to these.
    #[error(transparent)]
    SecondOpinion(#[from] SecondOpinion),
}

/// Why a leg could not be measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LegFault {
    /// It is not in the scan.
    #[error("it is not in the scan, or ends below the calf")]
    NotThere,
    /// It has no axis.
    #[error(transparent)]
    Axis(#[from] AxisFault),
    /// It has hardly any points.
    #[error("the leg has too few points")]
    TooFewPoints,
    /// Too few sections close.
    #[error("only {measured} of {planes} sections close")]
    TooFewSections {
        /// Sections that could be measured.
        measured: usize,
        /// Section planes.
        planes: usize,
    },
}

/// A reason not to trust a landmark blindly.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Doubt {
    /// The extremum hardly stands out.
    #[error("the extremum stands out by only {prominence_mm:.1} mm")]
    Shallow {
        /// How far it stands out, mm.
        prominence_mm: f64,
    },
    /// The height of the extremum is not determined.
    #[error("the girth is flat there: its height is uncertain by {height_sd_mm:.0} mm")]
    Flat {
        /// Standard error of the height, mm.
        height_sd_mm: f64,
    },
    /// Another extremum of the same kind cannot be told from this one.
    #[error("the girth at {other_height_mm:.0} mm is the same within the noise")]
    Double {
        /// Height of the other's centre above the floor, mm.
        other_height_mm: f64,
    },
    /// The extremum lies at an end of what was searched.
    #[error("the extremum lies {end_mm:.0} mm from the end of what was searched or seen")]
    Edge {
        /// Distance to the end along the axis, mm.
        end_mm: f64,
    },
    /// The skin there has a gap.
    #[error("{gap_deg:.0} degrees of the skin were not seen there")]
    Gap {
        /// Width of the gap as seen from the section's centre, degrees.
        gap_deg: f64,
    },
    /// The points there are not one skin.
    #[error("the points scatter by {rms_mm:.1} mm there: cloth, a second layer, or a movement?")]
    Scatter {
        /// Root mean square distance of the points from the section, mm.
        rms_mm: f64,
    },
    /// The skin there is longer than a tape around it.
    #[error("the skin is {percent:.1} % longer than a tape around it: is it folded there?")]
    Folds {
        /// Excess of the contour over the tape girth, percent.
        percent: f64,
    },
    /// The sections there could not be measured; the curve bridges them.
    #[error("the skin there was not seen; the girth is bridged")]
    NotSeen,
    /// A knee that would lie below D.
    #[error("by its proportion the knee would lie below D, which is at {d_height_mm:.0} mm")]
    BelowD {
        /// Height of D, mm.
        d_height_mm: f64,
    },
    /// The tape is closed along the floor, where no scanner looks.
    #[error("the sole is not seen; the tape is closed along the floor")]
    SoleNotSeen,
}

impl Doubt {
    /// The stable code used in records.
    pub fn code(&self) -> &'static str {
        match self {
            Doubt::Shallow { .. } => "shallow",
            Doubt::Flat { .. } => "flat",
            Doubt::Double { .. } => "double",
            Doubt::Edge { .. } => "edge",
            Doubt::Gap { .. } => "gap",
            Doubt::Scatter { .. } => "scatter",
            Doubt::Folds { .. } => "folds",
            Doubt::NotSeen => "not-seen",
            Doubt::BelowD { .. } => "below-d",
            Doubt::SoleNotSeen => "sole-not-seen",
        }
    }
}

impl Finding {
    /// The stable code used in records and the README's table.
    pub fn code(&self) -> &'static str {
        match &self.what {
            What::LevelAbsent(_) => "level-absent",
            What::LevelImplausible { .. } => "level-implausible",
            What::FacingUnchecked(_) => "facing-unchecked",
            What::NoFaces => "no-faces",
            What::ThighsTouch { .. } => "thighs-touch",
            What::Proportions { .. } => "proportions",
            What::LegCut { .. } => "leg-cut",
            What::Doubtful(doubt) => doubt.code(),
            What::LegNotMeasured(_) => "leg-not-measured",
            What::NoSurface { .. } => "no-surface",
            What::SurfaceShort { .. } => "surface-short",
            What::HeightNotMeasured { .. } => "height-not-measured",
            What::LegsDiffer(_) => "legs-differ",
            What::SecondOpinion(opinion) => opinion.code(),
        }
    }

    /// How much it matters.
    pub fn severity(&self) -> Severity {
        match &self.what {
            What::LegsDiffer(_) => Severity::Info,
            What::SecondOpinion(opinion) => opinion.severity(),
            What::LevelAbsent(_)
            | What::Doubtful(_)
            | What::HeightNotMeasured { .. }
            | What::FacingUnchecked(_)
            | What::NoFaces
            | What::ThighsTouch { .. }
            | What::Proportions { .. }
            | What::LegCut { .. }
            | What::SurfaceShort { .. } => Severity::Warning,
            What::LevelImplausible { .. } | What::LegNotMeasured(_) | What::NoSurface { .. } => {
                Severity::Error
            }
        }
    }
}
