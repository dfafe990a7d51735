//! Information for the operator or a later step: findings about a scan or leg, doubts about a level.

use std::fmt;

use super::doubt::Doubt;
use super::level::Level;
use super::side::Side;
use crate::comparison::difference::LegsDiffer;
use crate::comparison::opinion::SecondOpinion;
use crate::frame::soles::FloorDoubt;
use crate::frame::stance::FeetUnclear;
use crate::levels::at_height::NoGirth;
use crate::levels::extremum::Absence;
use crate::sections::around::Around;
use crate::sections::axis_fit::{AxisFault, NoThigh};
use crate::surface::nurbs::NoSurface;

/// How much a finding matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing.
    Info,
    /// Check before you use the record.
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

/// Information about a scan, a leg or a level.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The leg, if the finding is about one leg.
    pub side: Option<Side>,
    /// The level, if the finding is about one level.
    pub level: Option<Level>,
    /// What was found.
    pub what: What,
}

/// What was found, with its values.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum What {
    /// The level is not on this leg.
    #[error("the level is absent: {0}")]
    LevelAbsent(Absence),
    /// A girth that no leg has.
    #[error("a girth of {girth_mm:.0} mm is not plausible for a leg: the level is left out")]
    LevelImplausible {
        /// The measured girth, mm.
        girth_mm: f64,
    },
    /// The feet were not seen, so the declared facing is unchecked.
    #[error("left and right are known from the declared facing only: {0}")]
    FacingUnchecked(FeetUnclear),
    /// The soles do not show the floor, from which heights are measured.
    #[error(transparent)]
    FloorUnclear(#[from] FloorDoubt),
    /// The triangles do not show whether the scan is mirrored.
    #[error(
        "nothing shows whether the scan is mirrored, with left and right exchanged: it has no mesh, or the \
         pieces of its mesh contradict each other"
    )]
    MirrorUnchecked,
    /// A file without any faces in a format of meshes: a part of it may be missing.
    #[error(
        "the file holds points but no faces, and was measured from its points: was the export cut \
         short, or the mesh left out?"
    )]
    NoFaces,
    /// An OBJ mesh without its last line end.
    #[error("the file ends after a face without a line end: was the export cut short there?")]
    NoLineEnd,
    /// The thighs touch below the crotch.
    #[error(
        "the legs are joined from {from_mm:.0} mm up: do the thighs touch, or is there cloth? They were \
         separated along the fold; the skin inside it was not seen"
    )]
    ThighsTouch {
        /// Height above which they touch, mm.
        from_mm: f64,
    },
    /// A crotch at an unusual height.
    #[error(
        "the crotch is at {percent:.0} % of the stature, for nearly all people it is at 44 to 53 %: \
         are head and feet whole in the scan?"
    )]
    Proportions {
        /// Height of the crotch, percent of the stature.
        percent: f64,
    },
    /// The skin at the crotch was not seen.
    #[error(
        "the skin at the crotch was not seen: its height, and with it G, is uncertain by {sd_mm:.0} mm"
    )]
    CrotchUncertain {
        /// Standard error of the crotch's height, mm.
        sd_mm: f64,
    },
    /// The scan shows nothing of the crotch.
    #[error("the scan does not show the crotch: F and G are estimated from the stature")]
    CrotchNotSeen,
    /// The leg ends below the crotch.
    #[error("the leg is seen up to {end_mm:.0} mm only: nothing was measured above")]
    LegCut {
        /// Height of its highest skin, mm.
        end_mm: f64,
    },
    /// The planes do not turn about the knee, because the thigh has no axis of its own.
    #[error("{0}: sections above the knee are square to the shank")]
    ThighAxisMissing(NoThigh),
    /// A doubt about a landmark.
    #[error("{0}")]
    Doubtful(Doubt),
    /// The leg could not be measured.
    #[error("the leg was not measured: {0}")]
    LegNotMeasured(LegFault),
    /// The sections allow no surface.
    #[error(transparent)]
    NoSurface(#[from] NoSurface),
    /// The surface does not cover the range that a stocking needs.
    #[error(
        "the surface covers {from_mm:.0} to {to_mm:.0} mm; {wanted_from_mm:.0} to {wanted_to_mm:.0} mm were requested"
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
    /// The surface bridges areas that the scanner did not see.
    #[error(
        "the surface bridges {count} {}; the largest is {length_mm:.0} mm long, {width_mm:.0} mm wide, \
         {}, {:.0} cm high",
        if *count == 1 { "hole" } else { "holes" },
        Around::at(*angle_deg),
        height_mm / 10.0
    )]
    SurfaceHoles {
        /// How many.
        count: usize,
        /// Extent of the largest along the leg, mm.
        length_mm: f64,
        /// Its extent around, mm.
        width_mm: f64,
        /// Height of its middle above the floor, mm.
        height_mm: f64,
        /// Angle of its middle, degrees: 0 front, 90 lateral.
        angle_deg: f64,
    },
    /// No girth at a requested height.
    #[error("no girth at {height_mm:.0} mm: {why}")]
    HeightNotMeasured {
        /// The height above the floor, mm.
        height_mm: f64,
        /// The reason.
        why: NoGirth,
    },
    /// The legs differ enough for a swelling.
    #[error(transparent)]
    LegsDiffer(#[from] LegsDiffer),
    /// The scanner's own measures disagree with ours.
    #[error(transparent)]
    SecondOpinion(#[from] SecondOpinion),
}

/// Why a leg could not be measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LegFault {
    /// The leg is not in the scan.
    #[error("it is not in the scan, or ends below the calf")]
    NotThere,
    /// The leg has no axis.
    #[error(transparent)]
    Axis(#[from] AxisFault),
    /// The leg has hardly any points.
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

impl From<SecondOpinion> for Finding {
    fn from(opinion: SecondOpinion) -> Finding {
        Finding { side: None, level: None, what: What::SecondOpinion(opinion) }
    }
}

impl fmt::Display for Finding {
    /// In English, with the leg and the level.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.side, self.level) {
            (Some(side), Some(level)) => write!(f, "{} leg, {}: ", side.word(), level.name())?,
            (Some(side), None) => write!(f, "{} leg: ", side.word())?,
            (None, Some(level)) => write!(f, "{}: ", level.name())?,
            (None, None) => {}
        }
        self.what.fmt(f)
    }
}

impl Finding {
    /// The stable code used in records and docs/codes.md.
    pub fn code(&self) -> &'static str {
        match &self.what {
            What::LevelAbsent(_) => "level-absent",
            What::LevelImplausible { .. } => "level-implausible",
            What::FacingUnchecked(_) => "facing-unchecked",
            What::FloorUnclear(doubt) => doubt.code(),
            What::MirrorUnchecked => "mirror-unchecked",
            What::NoFaces => "no-faces",
            What::NoLineEnd => "no-line-end",
            What::ThighsTouch { .. } => "thighs-touch",
            What::Proportions { .. } => "proportions",
            What::CrotchUncertain { .. } => "crotch-uncertain",
            What::CrotchNotSeen => "crotch-not-seen",
            What::LegCut { .. } => "leg-cut",
            What::ThighAxisMissing(_) => "thigh-axis-missing",
            What::Doubtful(doubt) => doubt.code(),
            What::LegNotMeasured(_) => "leg-not-measured",
            What::NoSurface(_) => "no-surface",
            What::SurfaceShort { .. } => "surface-short",
            What::SurfaceHoles { .. } => "surface-holes",
            What::HeightNotMeasured { .. } => "height-not-measured",
            What::LegsDiffer(_) => "legs-differ",
            What::SecondOpinion(opinion) => opinion.code(),
        }
    }

    /// How much it matters.
    pub fn severity(&self) -> Severity {
        match &self.what {
            What::LegsDiffer(_)
            | What::SurfaceHoles { .. }
            | What::NoLineEnd
            | What::MirrorUnchecked => Severity::Info,
            What::SecondOpinion(SecondOpinion::Sides { .. }) => Severity::Error,
            What::LevelAbsent(_)
            | What::SecondOpinion(_)
            | What::Doubtful(_)
            | What::HeightNotMeasured { .. }
            | What::FacingUnchecked(_)
            | What::FloorUnclear(_)
            | What::NoFaces
            | What::ThighsTouch { .. }
            | What::Proportions { .. }
            | What::CrotchUncertain { .. }
            | What::CrotchNotSeen
            | What::LegCut { .. }
            | What::ThighAxisMissing(_)
            | What::SurfaceShort { .. } => Severity::Warning,
            What::LevelImplausible { .. } | What::LegNotMeasured(_) | What::NoSurface(_) => {
                Severity::Error
            }
        }
    }
}
