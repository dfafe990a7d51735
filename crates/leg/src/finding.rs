//! Information for the operator or a later step: findings about a scan or leg, doubts about a level.

use super::doubt::Doubt;
use super::level::Level;
use super::side::Side;
use crate::comparison::difference::LegsDiffer;
use crate::comparison::opinion::SecondOpinion;
use crate::frame::soles::FloorDoubt;
use crate::frame::stance::FeetUnclear;
use crate::levels::at_height::NoGirth;
use crate::levels::extremum::Absence;
use crate::sections::axis_fit::{AxisFault, NoThigh};
use crate::surface::nurbs::NoSurface;

word_enum! {
    /// How much a finding matters.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Severity {
        /// Worth knowing.
        Info => "info",
        /// Check before you use the record.
        Warning => "warning",
        /// Something was not measured.
        Error => "error",
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
#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// The level is not on this leg.
    LevelAbsent(Absence),
    /// A girth that no leg has.
    LevelImplausible {
        /// The measured girth, mm.
        girth_mm: f64,
    },
    /// The feet were not seen, so the declared facing is unchecked.
    FacingUnchecked(FeetUnclear),
    /// The feet do not show the facing, but the calves do.
    FacingByCalves(FeetUnclear),
    /// The soles do not show the floor, from which heights are measured.
    FloorUnclear(FloorDoubt),
    /// The triangles do not show whether the scan is mirrored.
    MirrorUnchecked,
    /// A file without any faces in a format of meshes: a part of it may be missing.
    NoFaces,
    /// An OBJ mesh without its last line end.
    NoLineEnd,
    /// The points of the legs are far apart.
    Coarse {
        /// How far, mm.
        spacing_mm: f64,
        /// Standard error that the girth of an ankle has by it, mm.
        ankle_sd_mm: f64,
    },
    /// One foot stands ahead of the other.
    FootForward {
        /// By how much, mm.
        by_mm: f64,
    },
    /// The thighs touch below the crotch.
    ThighsTouch {
        /// Height above which they touch, mm.
        from_mm: f64,
    },
    /// A crotch at an unusual height.
    Proportions {
        /// Height of the crotch, percent of the stature.
        percent: f64,
    },
    /// The head is not in the scan.
    CrownNotSeen {
        /// The stature that heights are relative to, inferred from the feet, mm.
        stature_mm: f64,
    },
    /// The skin at the crotch was not seen.
    CrotchUncertain {
        /// Standard error of the crotch's height, mm.
        sd_mm: f64,
    },
    /// The scan shows nothing of the crotch.
    CrotchNotSeen,
    /// The leg ends below the crotch.
    LegCut {
        /// Height of its highest skin, mm.
        end_mm: f64,
    },
    /// The planes do not turn about the knee, because the thigh has no axis of its own.
    ThighAxisMissing(NoThigh),
    /// A doubt about a landmark.
    Doubtful(Doubt),
    /// The leg could not be measured.
    LegNotMeasured(LegFault),
    /// The sections allow no surface.
    NoSurface(NoSurface),
    /// The surface does not cover the range that a stocking needs.
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
    /// The scanner's software closed holes in the skin. They are open again, and bridged.
    HolesFilled {
        /// How many.
        count: usize,
        /// Extent of the largest along the leg, mm.
        length_mm: f64,
        /// Its extent around, mm.
        width_mm: f64,
        /// Height of its middle above the floor, mm.
        height_mm: f64,
    },
    /// The surface bridges areas that the scanner did not see.
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
    HeightNotMeasured {
        /// The height above the floor, mm.
        height_mm: f64,
        /// The reason.
        why: NoGirth,
    },
    /// The legs differ enough for a swelling.
    LegsDiffer(LegsDiffer),
    /// The scanner's own measures disagree with ours.
    SecondOpinion(SecondOpinion),
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

impl Finding {
    /// The stable code used in records and docs/codes.md.
    pub fn code(&self) -> &'static str {
        match &self.what {
            What::LevelAbsent(_) => "level-absent",
            What::LevelImplausible { .. } => "level-implausible",
            What::FacingUnchecked(_) => "facing-unchecked",
            What::FacingByCalves(_) => "facing-by-calves",
            What::FloorUnclear(doubt) => doubt.code(),
            What::MirrorUnchecked => "mirror-unchecked",
            What::NoFaces => "no-faces",
            What::NoLineEnd => "no-line-end",
            What::Coarse { .. } => "coarse",
            What::FootForward { .. } => "foot-forward",
            What::ThighsTouch { .. } => "thighs-touch",
            What::Proportions { .. } => "proportions",
            What::CrownNotSeen { .. } => "crown-not-seen",
            What::CrotchUncertain { .. } => "crotch-uncertain",
            What::CrotchNotSeen => "crotch-not-seen",
            What::LegCut { .. } => "leg-cut",
            What::ThighAxisMissing(_) => "thigh-axis-missing",
            What::Doubtful(doubt) => doubt.code(),
            What::LegNotMeasured(_) => "leg-not-measured",
            What::NoSurface(_) => "no-surface",
            What::SurfaceShort { .. } => "surface-short",
            What::HolesFilled { .. } => "holes-filled",
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
            | What::Coarse { .. }
            | What::FootForward { .. }
            | What::NoLineEnd
            | What::MirrorUnchecked => Severity::Info,
            What::SecondOpinion(SecondOpinion::Sides { .. }) => Severity::Error,
            What::LevelAbsent(_)
            | What::SecondOpinion(_)
            | What::Doubtful(_)
            | What::HeightNotMeasured { .. }
            | What::FacingUnchecked(_)
            | What::FacingByCalves(_)
            | What::FloorUnclear(_)
            | What::NoFaces
            | What::ThighsTouch { .. }
            | What::Proportions { .. }
            | What::CrownNotSeen { .. }
            | What::CrotchUncertain { .. }
            | What::CrotchNotSeen
            | What::LegCut { .. }
            | What::ThighAxisMissing(_)
            | What::HolesFilled { .. }
            | What::SurfaceShort { .. } => Severity::Warning,
            What::LevelImplausible { .. } | What::LegNotMeasured(_) | What::NoSurface(_) => {
                Severity::Error
            }
        }
    }
}
