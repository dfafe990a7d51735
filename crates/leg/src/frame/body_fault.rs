//! Reasons why a scan is not a measurable standing body.

use super::stance::{FeetUnclear, NoLegs};
use crate::method::{Unit, Up};

/// Plausible statures, mm: from a child of two years on. Figures of 80 to 90.5 are a child's in cm and a tall man's in
/// inches; all others are plausible in one unit at most.
pub const STATURE_MM: [f64; 2] = [800.0, 2300.0];

/// Why a scan is not a measurable standing body.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BodyFault {
    /// All shells are tiny.
    #[error("only fragments: no connected surface holds more than 0.5 % of the points")]
    OnlyFragments,
    /// No unit gives a plausible stature.
    #[error(
        "no unit makes this a standing person: {} units high along {} ({} × {} × {}); \
         check that the body is whole in the scan and that `up` is right",
        figure(*height), up.word(), figure(*x), figure(*y), figure(*z)
    )]
    NoPlausibleUnit {
        /// The axis assumed to be up.
        up: Up,
        /// Extent along it, export units.
        height: f64,
        /// Extent along x, export units.
        x: f64,
        /// Extent along y, export units.
        y: f64,
        /// Extent along z, export units.
        z: f64,
    },
    /// The declared unit gives no plausible stature.
    #[error(
        "the declared unit {} makes the stature {} mm, outside {} to {} mm: set `unit` to auto, or \
         to what the scanner exports",
        unit.word(), figure(*stature_mm), STATURE_MM[0], STATURE_MM[1]
    )]
    UnitImplausible {
        /// The declared unit.
        unit: Unit,
        /// The resulting stature, mm.
        stature_mm: f64,
    },
    /// Neither two legs on the floor nor a single one.
    #[error(transparent)]
    NotTwoLegs(#[from] NoLegs),
    /// The feet do not show the facing, and none was declared.
    #[error(
        "left and right cannot be determined: {0}; both feet must be fully visible, with nothing else on \
         the floor"
    )]
    FacingUnclear(FeetUnclear),
    /// The declared facing and the feet disagree.
    #[error(
        "the declared facing is {off_deg:.0} degrees from where the toes point: set `facing` to \
         auto, or to what the scanner exports"
    )]
    FacingContradicted {
        /// Angle between them, degrees.
        off_deg: f64,
    },
    /// The declared facing is the up axis.
    #[error("the declared facing is along the up axis")]
    FacingVertical,
    /// The triangles turn inwards, and that was not declared.
    #[error(
        "the mesh is inside out: it is mirrored, so that left and right are exchanged, or only wound the \
         other way round, and the scan does not show which; set `winding` after the check that its \
         documentation describes"
    )]
    WoundInward,
    /// The triangles turn outwards although they were declared to turn inwards.
    #[error(
        "the mesh is wound outwards, but `winding` says inward: was the scanner's export changed? check \
         which leg is which, then set `winding`"
    )]
    WoundOutward,
    /// Two skins beside each other.
    #[error(
        "there are two skins: {percent:.0} % of the legs' points lie close to another skin; is the body, or \
         its mirror image, twice in the export, or is there a layer over it?"
    )]
    Layers {
        /// Share of the legs' points with an unlinked neighbour, percent.
        percent: f64,
    },
    /// A single leg that stands under the middle of the trunk.
    #[error(
        "only one leg is seen, {off_mm:.0} mm beside the middle of the trunk: whether it is the left \
         or the right cannot be determined; scan it as a lone leg and declare its side"
    )]
    SideUnclear {
        /// Distance of the shank from the trunk's middle across the body, mm.
        off_mm: f64,
    },
    /// No unit makes the scan plausible as a lone leg.
    #[error(
        "no unit makes this a lone leg: {} units high, its foot {} units long; is `scope` right?",
        figure(*height), figure(*foot)
    )]
    NoPlausibleLeg {
        /// Extent along the up axis, export units.
        height: f64,
        /// Length of the part on the floor, export units.
        foot: f64,
    },
    /// A lone leg was declared but two are present.
    #[error(
        "a lone leg was declared, but two legs are visible: `scope` must be \"body\" for this scan"
    )]
    TwoLegs,
}

impl BodyFault {
    /// The stable code of this fault, for `reason.json` and programs.
    pub fn code(&self) -> &'static str {
        match self {
            BodyFault::OnlyFragments => "body-only-fragments",
            BodyFault::NoPlausibleUnit { .. } => "body-no-plausible-unit",
            BodyFault::UnitImplausible { .. } => "body-unit-implausible",
            BodyFault::NotTwoLegs(_) => "body-not-two-legs",
            BodyFault::FacingUnclear(_) => "body-facing-unclear",
            BodyFault::FacingContradicted { .. } => "body-facing-contradicted",
            BodyFault::FacingVertical => "body-facing-vertical",
            BodyFault::WoundInward => "body-wound-inward",
            BodyFault::WoundOutward => "body-wound-outward",
            BodyFault::Layers { .. } => "body-layers",
            BodyFault::SideUnclear { .. } => "body-side-unclear",
            BodyFault::NoPlausibleLeg { .. } => "body-no-plausible-leg",
            BodyFault::TwoLegs => "body-two-legs",
        }
    }
}

/// Formats a length of unknown unit for display: one decimal, or powers of ten if it is absurd.
fn figure(value: f64) -> String {
    let usual = (0.1..1e6).contains(&value);
    if usual { format!("{value:.1}") } else { format!("{value:.1e}") }
}
