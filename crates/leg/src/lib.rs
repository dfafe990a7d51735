//! [`Scan`](gaiter_scan::Scan) → [`Extraction`].
//!
#![doc = include_str!("../README.md")]
//!
//! One folder per step of the method, one file per stage:
//!
//! | step | paper | where |
//! |---|---|---|
//! | unit, up, facing, floor | 1.1 | [`frame`] |
//! | legs cut at the crotch | 1.1, fig. 2a | [`parting`] |
//! | made upright; equidistant sections | 1.1, fig. 2b–2e | [`sections`] |
//! | height–girth curve; B, C, D, B1; A, Y, E, F, G | 1.2, fig. 3 | [`levels`] |
//! | curvature, feature points | 1.3, fig. 4, 5 | [`features`] |
//! | quasi-grid, NURBS surface, its error and holes | 2 | [`surface`] |
//! | volumes, the legs' differences, the scanner's own measures | – | [`comparison`] |
//! | the crop without a face, measured as the whole body | – | [`crop`] |
//!
//! [`mod@sectioned_leg`] calls them up to the girth curve, [`report`] all after it; between them both legs are compared for
//! what a [`disturbance`] is. The results are in [`measured`], [`finding`] and [`doubt`].

#![warn(missing_docs)]

#[macro_use]
mod words;
#[macro_use]
pub mod figure;

pub mod comparison;
pub mod crop;
pub mod disturbance;
pub mod doubt;
pub mod features;
pub mod finding;
pub mod frame;
pub mod level;
pub mod levels;
pub mod measured;
pub mod method;
pub mod parting;
pub mod phantom;
pub mod report;
pub mod sectioned_leg;
pub mod sections;
pub mod side;
mod statistics;
pub mod surface;

use rayon::prelude::*;

pub use comparison::difference::Differences;
use comparison::seams::{Traces, seams};
use comparison::smoothed::smoothing_sd_mm;
pub use crop::{Export, WholeBody, extract_crop};
use disturbance::{Common, Disturbance, MARGIN_SDS, coarse_spacing_mm};
use doubt::Doubt;
pub use finding::{Finding, What};
pub use frame::body::{Body, FacingFrom};
pub use frame::body_fault::BodyFault;
pub use gaiter_scan::Format;
use gaiter_scan::{self as scan, End, Reading, ScanFault};
pub use level::Level;
pub use levels::foot::Foot;
pub use levels::landmark::{Estimate, Landmark};
pub use measured::{LegReport, LevelSection};
pub use method::Method;
pub use parting::crotch::{Crotch, CrotchFrom};
pub use parting::segment::SegmentFault;
use parting::segment::{Leg, Legs, segment};
pub use sectioned_leg::LegFault;
use sectioned_leg::{SectionedLeg, compare_cloth, sectioned_leg};
pub use side::Side;
use side::Sides;

/// The result for one scan: the legs that could be measured, and the findings.
#[derive(Debug, Clone)]
pub struct Extraction {
    /// The body they belong to.
    pub body: Body,
    /// The scan's file; of a crop that of the whole body.
    pub export: Export,
    /// The crotch.
    pub crotch: Crotch,
    /// Measured legs, left before right; at least one.
    pub legs: Vec<LegReport>,
    /// The differences between the legs; `None` if there is only one.
    pub differences: Option<Differences>,
    /// Findings, in the order of the stages.
    pub findings: Vec<Finding>,
}

impl Extraction {
    /// How far apart the views of the scanner's cameras are, mm; `None` if they meet.
    pub fn views_apart_mm(&self) -> Option<f64> {
        self.findings.iter().find_map(|finding| match finding.what {
            What::Doubtful(Doubt::ViewsApart { step_mm, .. }) => Some(step_mm),
            _ => None,
        })
    }
}

/// Why a whole scan cannot be measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The bytes are not a scan.
    #[error(transparent)]
    Scan(#[from] ScanFault),
    /// The scan is not a standing body.
    #[error(transparent)]
    Body(#[from] BodyFault),
    /// The legs cannot be separated.
    #[error(transparent)]
    Segment(#[from] SegmentFault),
    /// Neither leg can be measured.
    #[error("neither leg can be measured: left: {left}; right: {right}")]
    NoLeg {
        /// The fault of the left leg.
        left: LegFault,
        /// The fault of the right leg.
        right: LegFault,
    },
}

impl Refusal {
    /// The stable code of this refusal, for `reason.json` and programs.
    pub fn code(&self) -> &'static str {
        match self {
            Refusal::Scan(fault) => fault.code(),
            Refusal::Body(fault) => fault.code(),
            Refusal::Segment(fault) => fault.code(),
            Refusal::NoLeg { .. } => "no-leg",
        }
    }
}

/// Measures both legs in the bytes of one export.
///
/// # Errors
/// A [`Refusal`] if nothing at all can be measured; a leg or level that cannot be measured is a
/// finding in the extraction, not an error.
pub fn extract(bytes: &[u8], format: Format, method: &Method) -> Result<Extraction, Refusal> {
    let Reading { scan, end } = scan::reading(bytes, format);
    let scan = scan?;
    let mut body = frame::body::body(&scan, method)?;
    let cut = segment(&body)?;
    if body.stature_mm.is_none() && cut.crotch.is_seen() {
        let (stature_mm, sd_mm) = cut.crotch.stature_mm();
        body.scale_also_by(stature_mm, sd_mm);
    }
    let (points, triangles) = (scan.points.len(), scan.triangles.len());
    let has_line_end = end != End::NoLineEnd;
    measure(body, cut, Export { format, points, triangles, has_line_end }, method)
}

/// Measures legs that are cut from their body. Nothing above its crop has a part in this.
fn measure(body: Body, cut: Legs, export: Export, method: &Method) -> Result<Extraction, Refusal> {
    let coarse_mm = coarse_spacing_mm(&cut.legs);
    let (reports, common) = reports(cut.legs, &cut.crotch, &body, coarse_mm, method);
    if let [Err(left), Err(right)] = reports.as_slice() {
        return Err(Refusal::NoLeg { left: left.clone(), right: right.clone() });
    }
    let mut findings = about_body(&body, &cut.crotch, coarse_mm);
    let doubts = common.doubts().into_iter().map(What::Doubtful);
    findings.extend(doubts.map(|what| Finding { side: None, level: None, what }));
    // A list of points has no faces by design.
    if export.triangles == 0 && export.format != Format::Xyz {
        findings.insert(0, Finding { side: None, level: None, what: What::NoFaces });
    }
    if !export.has_line_end {
        findings.insert(0, Finding { side: None, level: None, what: What::NoLineEnd });
    }
    let mut legs = Vec::new();
    for (side, report) in Side::BOTH.into_iter().zip(reports) {
        match report {
            Ok((leg, found)) => {
                legs.push(leg);
                findings.extend(found);
            }
            // A scan of a lone leg is not missing the other one.
            Err(LegFault::NotThere) if !body.is_whole => {}
            Err(why) => {
                let what = What::LegNotMeasured { why };
                findings.push(Finding { side: Some(side), level: None, what });
            }
        }
    }
    let differences = comparison::difference::differences(&legs);
    // Cloth on one leg is no swelling.
    let is_cloth = |finding: &Finding| matches!(finding.what, What::Doubtful(Doubt::Cloth { .. }));
    if !findings.iter().any(is_cloth) {
        findings.extend(differences.iter().flat_map(swellings));
    }
    Ok(Extraction { body, export, crotch: cut.crotch, legs, differences, findings })
}

/// What one leg is, or why it is not measured.
type Report = Result<(LegReport, Vec<Finding>), LegFault>;

/// Both legs, left before right, and what disturbs both alike; `coarse_mm` is how far apart the points of coarse legs
/// are.
fn reports(
    legs: Sides<Option<Leg>>,
    crotch: &Crotch,
    body: &Body,
    coarse_mm: Option<f64>,
    method: &Method,
) -> (Vec<Report>, Common) {
    let sectioned = [legs.left, legs.right]
        .into_par_iter()
        .map(|leg| sectioned_leg(leg.ok_or(LegFault::NotThere)?, body, crotch, method));
    let mut sectioned: Vec<_> = sectioned.collect();
    compare_cloth(&mut sectioned);
    let legs: Vec<&SectionedLeg> = sectioned.iter().flatten().collect();
    let traces: Vec<&Traces> = legs.iter().filter_map(|leg| leg.traces.as_ref()).collect();
    let meshes: Vec<_> = legs.iter().map(|leg| &leg.leg.mesh).collect();
    let smoothing_sd_mm = smoothing_sd_mm(&meshes, body.scale_mm);
    let common = Common { seams: seams(&traces), smoothing_sd_mm, coarse_mm };
    let reports = sectioned.into_par_iter().map(|leg| {
        let leg = leg?;
        Ok(report::leg_report(leg, body, crotch, &common, method))
    });
    (reports.collect(), common)
}

/// Usual crotch heights of standing people as shares of stature: ANSUR II, mean 0.48, first to last
/// percentile 0.45 to 0.52, with some room. A missing head or missing feet shift the share out of
/// this range.
const CROTCH_USUAL_SHARE: [f64; 2] = [0.435, 0.535];

/// A crotch with a larger standard error is a finding, mm: G, 50 mm below it, moves by as much.
const CROTCH_SURE_SD_MM: f64 = 6.0;

/// The girth for which the error by coarse points is reported, mm: an ankle's, where it is largest.
const ANKLE_GIRTH_MM: f64 = 200.0;

/// One foot stands ahead of the other if its shank does by more than this, mm: of bodies that stand straight by up to
/// 10 mm, by 90 mm where one foot alone is turned out by 30°.
const FORWARD_MIN_MM: f64 = 100.0;

/// The findings about the body as a whole; `coarse_mm` is how far apart the points of coarse legs are.
fn about_body(body: &Body, crotch: &Crotch, coarse_mm: Option<f64>) -> Vec<Finding> {
    let mut found = Vec::new();
    found.extend(coarse_mm.map(|spacing_mm| {
        let ankle_sd_mm = Disturbance::of_coarse(spacing_mm).sd_of_mm(ANKLE_GIRTH_MM);
        What::Coarse { spacing_mm, girth_off_mm: MARGIN_SDS * ankle_sd_mm }
    }));
    match body.facing_from {
        FacingFrom::Feet => {}
        FacingFrom::Calves(why) => found.push(What::FacingByCalves { why }),
        FacingFrom::Declared(why) => found.push(What::FacingUnchecked { why }),
    }
    if !body.is_mirror_checked {
        found.push(What::MirrorUnchecked);
    }
    found.extend(body.floor_doubt.map(What::FloorUnclear));
    let forward_mm = body.forward_mm.filter(|by_mm| *by_mm > FORWARD_MIN_MM);
    found.extend(forward_mm.map(|by_mm| What::FootForward { by_mm }));
    if let Some(from_mm) = crotch.touching_from_mm {
        found.push(What::ThighsTouch { from_mm });
    }
    if body.is_whole && body.stature_mm.is_none() {
        found.push(What::CrownNotSeen { stature_mm: body.scale_mm });
    }
    if body.is_whole && !crotch.is_seen() {
        found.push(What::CrotchNotSeen);
    } else if body.is_whole && crotch.sd_mm > CROTCH_SURE_SD_MM {
        found.push(What::CrotchUncertain { sd_mm: crotch.sd_mm });
    }
    if let Some(stature_mm) = body.stature_mm.filter(|_| crotch.is_seen()) {
        let share = crotch.height_mm / stature_mm;
        if !(CROTCH_USUAL_SHARE[0]..=CROTCH_USUAL_SHARE[1]).contains(&share) {
            found.push(What::Proportions { percent: 100.0 * share });
        }
    }
    found.into_iter().map(|what| Finding { side: None, level: None, what }).collect()
}

/// The findings about differences between the legs.
fn swellings(differences: &Differences) -> impl Iterator<Item = Finding> {
    let finding = |(level, differ)| Finding { side: None, level, what: What::LegsDiffer(differ) };
    differences.swellings().into_iter().map(finding)
}
