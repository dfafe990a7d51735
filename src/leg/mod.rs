//! [`Scan`](crate::scan::Scan) → [`Extraction`]: the method of Wang, Wu and Li (2022), a stage per
//! file.
//!
//! | stage | paper | file |
//! |---|---|---|
//! | unit, up, facing, floor | 1.1 | [`body`], [`stance`] |
//! | legs cut at the crotch | 1.1, fig. 2a | [`segment`] |
//! | made upright | 1.1 | [`axis`] |
//! | equidistant sections | 1.1, fig. 2b–2e | [`mod@slice`], [`section`], [`mod@sections`], [`skin`], [`plane`], [`pairs`], [`polynomial`] |
//! | height–girth curve | 1.2, fig. 3a | [`girth`] |
//! | B, C, D, B1 | 1.2, fig. 3b, 3c | [`landmark`] |
//! | curvature, feature points | 1.3, fig. 4, 5 | [`curvature`], [`feature`] |
//! | quasi-grid, NURBS surface | 2 | [`grid`], [`surface`] |

#![deny(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod axis;
pub mod body;
mod cluster;
pub mod curvature;
pub mod feature;
pub mod finding;
mod footprint;
pub mod girth;
pub mod grid;
mod hull;
pub mod landmark;
pub mod level;
pub mod method;
pub mod pairs;
pub mod plane;
pub mod polynomial;
pub mod report;
pub mod section;
pub mod sections;
pub mod segment;
mod shell;
pub mod skin;
pub mod slice;
pub mod stance;
pub mod surface;

use rayon::prelude::*;

use crate::scan::{self, Format, ScanFault};
pub use body::{Body, BodyFault, FacingFrom};
pub use finding::{Finding, What};
pub use landmark::Landmark;
pub use level::Level;
pub use method::Method;
pub use report::{LegReport, LevelSection};
pub use segment::{SegmentFault, Side};

/// What one scan gave: the legs that could be measured and what must be known about them.
#[derive(Debug, Clone)]
pub struct Extraction {
    /// The body they belong to.
    pub body: Body,
    /// Points in the scan's file.
    pub points: usize,
    /// Triangles in the scan's file.
    pub triangles: usize,
    /// The format of the scan's file.
    pub format: Format,
    /// Height of the crotch above the floor, mm.
    pub crotch_height_mm: f64,
    /// Measured legs, left before right; at least one.
    pub legs: Vec<LegReport>,
    /// What must be known, in the order of the stages.
    pub findings: Vec<Finding>,
}

/// Why a whole scan cannot be measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The bytes are no scan.
    #[error(transparent)]
    Scan(#[from] ScanFault),
    /// The scan is no standing body.
    #[error(transparent)]
    Body(#[from] BodyFault),
    /// The legs cannot be parted.
    #[error(transparent)]
    Segment(#[from] SegmentFault),
    /// Neither leg can be measured.
    #[error("neither leg can be measured: left: {left}; right: {right}")]
    NoLeg {
        /// Why not the left.
        left: finding::LegFault,
        /// Why not the right.
        right: finding::LegFault,
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
/// A [`Refusal`] where nothing at all can be measured; a leg or level that cannot be measured is a
/// finding in the extraction, not an error.
pub fn extract(bytes: &[u8], format: Format, method: &Method) -> Result<Extraction, Refusal> {
    let scan = scan::read(bytes, format)?;
    let body = body::body(&scan, method)?;
    let cut = segment::segment(&body)?;
    let crotch_height_mm = cut.crotch_height_mm;
    let reports: Vec<_> = [&cut.legs.left, &cut.legs.right]
        .into_par_iter()
        .map(|leg| report::leg_report(leg, &body, crotch_height_mm, method))
        .collect();
    if let [Err(left), Err(right)] = reports.as_slice() {
        return Err(Refusal::NoLeg { left: left.clone(), right: right.clone() });
    }
    let (mut legs, mut findings) = (Vec::new(), Vec::new());
    if let FacingFrom::Declared(unclear) = body.facing_from {
        findings.push(Finding { side: None, level: None, what: What::FacingUnchecked(unclear) });
    }
    for (side, report) in Side::BOTH.into_iter().zip(reports) {
        match report {
            Ok((leg, found)) => {
                legs.push(leg);
                findings.extend(found);
            }
            Err(fault) => {
                let what = What::LegNotMeasured(fault);
                findings.push(Finding { side: Some(side), level: None, what });
            }
        }
    }
    let (points, triangles) = (scan.points.len(), scan.triangles.len());
    Ok(Extraction { body, points, triangles, format, crotch_height_mm, legs, findings })
}
