//! A leg cut into sections: what is known before its levels are looked for. Both legs come this far first, because
//! comparing them shows what covers one, and what the scanner's cameras did to both.

use crate::comparison::seams::{SPAN_SHARE, Traces};
use crate::levels::girth::{GirthCurve, girth_curve};
use crate::parting::crotch::Crotch;
use crate::parting::filled::{Patch, filled};
use crate::parting::segment::Leg;
use crate::sections::axis_fit::{self, AxisFault, FoundAxis, NoThigh};
use crate::sections::cloth::Cloth;
use crate::sections::equidistant::{Sections, sections};
use crate::sections::placed::placed;
use crate::{Body, Method};

/// The lowest section, as a share of stature: above the instep, below every malleolus.
const LOWEST_STATURE_SHARE: f64 = 0.035;

/// Closed holes are looked for with their middle between these shares of stature: above the malleoli, below the thigh,
/// where skin is round.
const FILLED_STATURE_SHARE: [f64; 2] = [0.045, 0.33];

/// Below the crotch the thigh widens into the buttock within this length, mm.
const GROIN_MM: f64 = 50.0;

/// A leg cut into sections.
#[derive(Debug, Clone)]
pub struct SectionedLeg {
    /// Its skin, without what closes its holes.
    pub leg: Leg,
    /// The holes that were closed, lowest first.
    pub filled: Vec<Patch>,
    /// Why its axis has no thigh.
    pub no_thigh: Option<NoThigh>,
    /// The sections.
    pub sections: Sections,
    /// Girth over height.
    pub curve: GirthCurve,
    /// What covers the skin.
    pub cloth: Cloth,
    /// The mesh's evidence for seams; `None` where cloth hangs over the skin, whose folds look alike.
    pub traces: Option<Traces>,
}

impl SectionedLeg {
    /// Angle between the axes of shank and thigh, degrees, also where it is too wide for planes to turn by it; 0 if it
    /// was not seen.
    pub fn bend_deg(&self) -> f64 {
        match self.no_thigh {
            Some(NoThigh::TooBent { bend_deg }) => bend_deg,
            _ => self.sections.axis.bend_deg(),
        }
    }
}

coded_enum! {
    /// Why a leg could not be measured.
    #[derive(Debug, Clone, PartialEq, thiserror::Error)]
    pub enum LegFault {
        /// The leg is not in the scan.
        #[error("it is not in the scan, or ends below the calf")]
        NotThere => "leg-not-there",
        /// The leg has hardly any points.
        #[error("the leg has too few points")]
        TooFewPoints => "leg-too-few-points",
        /// Too few sections close.
        #[error("only {measured} of {planes} sections close")]
        TooFewSections {
            /// Sections that could be measured.
            measured: usize,
            /// Section planes.
            planes: usize,
        } => "leg-too-few-sections",
    }
    or {
        /// The leg has no axis.
        #[error(transparent)]
        Axis(#[from] AxisFault),
    }
}

/// Cuts a leg into sections.
///
/// # Errors
/// A [`LegFault`] if the leg has no axis or hardly any closed section.
pub fn sectioned_leg(
    leg: Leg,
    body: &Body,
    crotch: &Crotch,
    method: &Method,
) -> Result<SectionedLeg, LegFault> {
    let scale_mm = body.scale_mm;
    let (leg, filled) = without_filled(leg, scale_mm);
    let end_mm = leg.cut_mm.unwrap_or(crotch.height_mm);
    let FoundAxis { axis, no_thigh } = axis_fit::find(&leg, scale_mm, end_mm, method.tape)?;
    let span_mm = [LOWEST_STATURE_SHARE * scale_mm, end_mm];
    let [from_mm, to_mm] = span_mm.map(|height_mm| axis.along_at_height(height_mm));
    let sections =
        sections(&leg, axis, [from_mm, to_mm], method.fit).ok_or(LegFault::TooFewPoints)?;
    let curve = girth_curve(&sections, scale_mm).ok_or_else(|| {
        let measured = sections.rows.iter().filter(|row| row.section.is_some()).count();
        LegFault::TooFewSections { measured, planes: sections.rows.len() }
    })?;
    let cloth = sections.cloth([from_mm, to_mm - GROIN_MM]);
    let traces = cloth.covers.is_empty().then(|| traces(&leg, &sections, scale_mm));
    Ok(SectionedLeg { leg, filled, no_thigh, sections, curve, cloth, traces })
}

/// A leg with its closed holes open again, and the holes.
fn without_filled(leg: Leg, scale_mm: f64) -> (Leg, Vec<Patch>) {
    let found = filled(&leg.mesh, FILLED_STATURE_SHARE.map(|share| share * scale_mm));
    if found.patches.is_empty() {
        return (leg, Vec::new());
    }
    (Leg { mesh: leg.mesh.without(&found.is_filled), ..leg }, found.patches)
}

fn traces(leg: &Leg, sections: &Sections, scale_mm: f64) -> Traces {
    let measured = sections.rows.iter().filter_map(|row| row.section.as_ref());
    let girths: Vec<[f64; 2]> =
        measured.map(|section| [section.height_mm, section.girth.contour_mm]).collect();
    let span_mm = SPAN_SHARE.map(|share| share * scale_mm);
    Traces::new(&placed(leg, sections, span_mm), leg.mesh.edges(), &girths, scale_mm)
}

/// Makes sure of what is only suspected to cover one leg, if the other has nothing like it.
pub fn compare_cloth(legs: &mut [Result<SectionedLeg, LegFault>]) {
    let [Ok(left), Ok(right)] = legs else { return };
    let before = left.cloth.clone();
    left.cloth.compare(&right.cloth);
    right.cloth.compare(&before);
}
