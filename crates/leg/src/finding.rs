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
use crate::sectioned_leg::LegFault;
use crate::sections::axis_fit::NoThigh;
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

coded_enum! {
    /// What was found, with its values.
    #[derive(Debug, Clone, PartialEq)]
    pub enum What {
        /// The level is not on this leg.
        LevelAbsent {
            /// The reason.
            why: Absence,
        } => "level-absent",
        /// A girth that no leg has.
        LevelImplausible {
            /// The measured girth, mm.
            girth_mm: f64,
        } => "level-implausible",
        /// The feet were not seen, so the declared facing is unchecked.
        FacingUnchecked {
            /// The reason.
            why: FeetUnclear,
        } => "facing-unchecked",
        /// The feet do not show the facing, but the calves do.
        FacingByCalves {
            /// The reason.
            why: FeetUnclear,
        } => "facing-by-calves",
        /// The triangles do not show whether the scan is mirrored.
        MirrorUnchecked => "mirror-unchecked",
        /// A file without any faces in a format of meshes: a part of it may be missing.
        NoFaces => "no-faces",
        /// An OBJ mesh without its last line end.
        NoLineEnd => "no-line-end",
        /// The points of the legs are far apart.
        Coarse {
            /// How far, mm.
            spacing_mm: f64,
            /// How far the girth of an ankle may be off by it: two standard errors, mm.
            girth_off_mm: f64,
        } => "coarse",
        /// One foot stands ahead of the other.
        FootForward {
            /// By how much, mm.
            by_mm: f64,
        } => "foot-forward",
        /// The thighs touch below the crotch.
        ThighsTouch {
            /// Height above which they touch, mm.
            from_mm: f64,
        } => "thighs-touch",
        /// A crotch at an unusual height.
        Proportions {
            /// Height of the crotch, percent of the stature.
            percent: f64,
        } => "proportions",
        /// The head is not in the scan.
        CrownNotSeen {
            /// The stature that heights are relative to, inferred from the feet, mm.
            stature_mm: f64,
        } => "crown-not-seen",
        /// The skin at the crotch was not seen.
        CrotchUncertain {
            /// Standard error of the crotch's height, mm.
            sd_mm: f64,
        } => "crotch-uncertain",
        /// The scan shows nothing of the crotch.
        CrotchNotSeen => "crotch-not-seen",
        /// The leg ends below the crotch.
        LegCut {
            /// Height of its highest skin, mm.
            end_mm: f64,
        } => "leg-cut",
        /// The planes do not turn about the knee, because the thigh has no axis of its own.
        ThighAxisMissing {
            /// The reason.
            why: NoThigh,
        } => "thigh-axis-missing",
        /// The leg could not be measured.
        LegNotMeasured {
            /// The reason.
            why: LegFault,
        } => "leg-not-measured",
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
        } => "surface-short",
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
        } => "holes-filled",
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
        } => "surface-holes",
        /// No girth at a requested height.
        HeightNotMeasured {
            /// The height above the floor, mm.
            height_mm: f64,
            /// The reason.
            why: NoGirth,
        } => "height-not-measured",
    }
    or {
        /// The soles do not show the floor, from which heights are measured.
        FloorUnclear(FloorDoubt),
        /// A doubt about a landmark.
        Doubtful(Doubt),
        /// The sections allow no surface.
        NoSurface(NoSurface),
        /// The legs differ enough for a swelling.
        LegsDiffer(LegsDiffer),
        /// The scanner's own measures disagree with ours.
        SecondOpinion(SecondOpinion),
    }
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
            What::NoSurface(_) => "no-surface",
            what => what.code(),
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
            What::LevelAbsent { .. }
            | What::SecondOpinion(_)
            | What::Doubtful(_)
            | What::HeightNotMeasured { .. }
            | What::FacingUnchecked { .. }
            | What::FacingByCalves { .. }
            | What::FloorUnclear(_)
            | What::NoFaces
            | What::ThighsTouch { .. }
            | What::Proportions { .. }
            | What::CrownNotSeen { .. }
            | What::CrotchUncertain { .. }
            | What::CrotchNotSeen
            | What::LegCut { .. }
            | What::ThighAxisMissing { .. }
            | What::HolesFilled { .. }
            | What::SurfaceShort { .. } => Severity::Warning,
            What::LevelImplausible { .. } | What::LegNotMeasured { .. } | What::NoSurface(_) => {
                Severity::Error
            }
        }
    }
}
