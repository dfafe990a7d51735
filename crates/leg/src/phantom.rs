//! A phantom: a cylinder, a cone or another body of known girths, scanned as a daily check of scanner and
//! method.
//!
//! Its girths are measured from the same sections as a leg's. A scan of a patient cannot show that the
//! scanner's scale is off, or that its views do not meet; the phantom does. Nothing is corrected by it.

mod bias;
mod known;

use std::f64::consts::LN_2;

use gaiter_scan::{self as scan, Format, Scan, ScanFault};
use nalgebra::{Point2, Translation3};

pub use bias::{BiasLine, GirthCheck, PhantomCheck};
pub use known::{KnownGirth, Phantom, PhantomTextFault};

use super::frame::body::{moved, upright};
use super::frame::components::without_fragments;
use super::frame::unit_inference::extent;
use super::method::{Method, Unit, UnitChoice};
use super::parting::segment::Leg;
use super::sections::axis::LegAxis;
use super::sections::axis_fit::{AxisFault, straight_line};
use super::sections::equidistant::{Sections, sections};
use super::sections::hull::Hull;
use super::sections::section::Section;
use super::sections::slice::Mesh;
use super::side::Side;

/// Where a cylinder is measured, as shares of its height: away from its ends.
const CYLINDER_SHARES: [f64; 5] = [0.2, 0.35, 0.5, 0.65, 0.8];

/// Sections are made this far below the lowest and above the highest known girth, mm …
const BEYOND_MM: f64 = 40.0;

/// … but not nearer to an end of the scan than this, mm, where rims and the floor begin …
const END_MM: f64 = 5.0;

/// … and over this length at least, mm: the axis needs ten centroids 8 mm apart, the skin five pieces.
const LENGTH_MIN_MM: f64 = 100.0;

/// The girth of everything in the scan differs from the largest known girth by a factor of two at most.
/// Units differ by 2.54 and more.
const GIRTH_FACTOR_LN_MAX: f64 = LN_2;

/// The change of the girth with height is taken over this distance to each side, mm: long enough that the
/// scanner's noise is small in it, much shorter than a cylinder.
const SLOPE_REACH_MM: f64 = 15.0;

/// A section with a wider gap than this is not measured, degrees: the phantom is round, and the scanner
/// sees it from all sides.
const GAP_MAX_DEG: f64 = 45.0;

/// Why a phantom cannot be measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PhantomFault {
    /// The bytes are not a scan.
    #[error(transparent)]
    Scan(#[from] ScanFault),
    /// What is in the scan is much larger or smaller than the phantom.
    #[error(
        "what was scanned has a girth of {found_mm:.0} mm, the phantom one of {known_mm:.0} mm: is \
         something else in the scan, or is the unit wrong?"
    )]
    NotThePhantom {
        /// Girth of everything in the scan, mm.
        found_mm: f64,
        /// Largest known girth, mm.
        known_mm: f64,
    },
    /// The scan is lower than the known girths.
    #[error("the scan is {found_mm:.0} mm high; the known girths need {needed_mm:.0} mm")]
    TooLow {
        /// Height of the scan, mm.
        found_mm: f64,
        /// The height that is needed, mm.
        needed_mm: f64,
    },
    /// It has no axis.
    #[error("the phantom's axis cannot be found")]
    Axis(#[source] AxisFault),
    /// Too few points for sections.
    #[error("too few points for sections")]
    TooFewPoints,
    /// It was not seen from all sides.
    #[error("at {height_mm:.0} mm the phantom was not seen from all sides")]
    NotSeen {
        /// Height of the girth, mm.
        height_mm: f64,
    },
}

impl PhantomFault {
    /// The stable code.
    pub fn code(&self) -> &'static str {
        match self {
            PhantomFault::Scan(fault) => fault.code(),
            PhantomFault::NotThePhantom { .. } => "phantom-not-there",
            PhantomFault::TooLow { .. } => "phantom-too-low",
            PhantomFault::Axis(_) => "phantom-axis",
            PhantomFault::TooFewPoints => "phantom-points",
            PhantomFault::NotSeen { .. } => "phantom-not-seen",
        }
    }
}

/// Measures the girths of a phantom in the bytes of one export, by the method's unit, up axis and fit.
///
/// # Errors
/// A [`PhantomFault`] if one of the known girths cannot be measured.
pub fn check(
    bytes: &[u8],
    format: Format,
    phantom: &Phantom,
    method: &Method,
) -> Result<PhantomCheck, PhantomFault> {
    let (scan, _) = without_fragments(&scan::read(bytes, format)?);
    let mesh = standing(&scan, phantom, method)?;
    let top_mm = mesh.highest_mm();
    let known = phantom.girths(top_mm);
    let [first, last] =
        [known.first(), known.last()].map(|girth| girth.map(|girth| girth.height_mm));
    let (first_mm, last_mm) = first.zip(last).ok_or(PhantomFault::TooFewPoints)?;
    let span_mm = span_mm([first_mm, last_mm], top_mm)?;
    let leg = Leg { side: Side::Left, mesh, cut_mm: None };
    let line = straight_line(&leg, span_mm).map_err(PhantomFault::Axis)?;
    let axis = LegAxis::straight(line.through, &line.direction, leg.side);
    let tilt_deg = axis.tilt_deg();
    let sections = sections(&leg, axis, span_mm, method.fit).ok_or(PhantomFault::TooFewPoints)?;
    let girths = known.iter().map(|known| girth(&sections, &leg, known));
    Ok(PhantomCheck { girths: girths.collect::<Result<_, _>>()?, tilt_deg })
}

/// One girth as it is measured.
fn girth(sections: &Sections, leg: &Leg, known: &KnownGirth) -> Result<GirthCheck, PhantomFault> {
    let KnownGirth { height_mm, girth_mm: known_mm } = *known;
    let around = [-SLOPE_REACH_MM, 0.0, SLOPE_REACH_MM].map(|off_mm| height_mm + off_mm);
    let found = sections.at(leg, &around).into_iter().flatten();
    let seen: Vec<Section> =
        found.filter(|section| section.largest_gap_deg <= GAP_MAX_DEG).collect();
    let [below, section, above] = seen.as_slice() else {
        return Err(PhantomFault::NotSeen { height_mm });
    };
    let sd_mm = section.girth_sd.map_or(section.rms_mm, |[girth_sd_mm, ..]| girth_sd_mm);
    let slope = (above.girth.tape_mm - below.girth.tape_mm) / (2.0 * SLOPE_REACH_MM);
    Ok(GirthCheck { height_mm, known_mm, measured_mm: section.girth.tape_mm, sd_mm, slope })
}

impl Phantom {
    /// The girths to be measured if the phantom is this high, lowest first.
    fn girths(&self, top_mm: f64) -> Vec<KnownGirth> {
        match self {
            Phantom::Cylinder { girth_mm } => {
                let at = |share| KnownGirth { height_mm: share * top_mm, girth_mm: *girth_mm };
                CYLINDER_SHARES.map(at).to_vec()
            }
            Phantom::AtHeights(girths) => girths.clone(),
        }
    }

    /// Its largest known girth, mm.
    fn largest_mm(&self) -> f64 {
        match self {
            Phantom::Cylinder { girth_mm } => *girth_mm,
            Phantom::AtHeights(girths) => {
                girths.iter().map(|girth| girth.girth_mm).fold(0.0, f64::max)
            }
        }
    }
}

/// The stretch of the axis in which sections are made.
fn span_mm([first_mm, last_mm]: [f64; 2], top_mm: f64) -> Result<[f64; 2], PhantomFault> {
    let too_low = |needed_mm| PhantomFault::TooLow { found_mm: top_mm, needed_mm };
    if last_mm > top_mm - END_MM {
        return Err(too_low(last_mm + END_MM));
    }
    let from_mm = (first_mm - BEYOND_MM).max(END_MM);
    let to_mm = (last_mm + BEYOND_MM).max(from_mm + LENGTH_MIN_MM).min(top_mm - END_MM);
    let from_mm = from_mm.min(to_mm - LENGTH_MIN_MM);
    if from_mm < END_MM {
        return Err(too_low(LENGTH_MIN_MM + 2.0 * END_MM));
    }
    Ok([from_mm, to_mm])
}

/// The scan upright, in mm, from its lowest point up. The unit is that in which it is as wide as the
/// phantom.
fn standing(scan: &Scan, phantom: &Phantom, method: &Method) -> Result<Mesh, PhantomFault> {
    let upright = upright(method.up);
    let points = || scan.points.iter().map(|point| upright * point);
    let (low, _) = extent(points());
    let from_above: Vec<Point2<f64>> = points().map(|point| point.xy()).collect();
    let around = Hull::from_points(&from_above).ok_or(PhantomFault::TooFewPoints)?.perimeter();
    let known_mm = phantom.largest_mm();
    let factor_ln = |unit: &Unit| (around * unit.in_mm() / known_mm).ln().abs();
    let nearest = Unit::ALL.into_iter().min_by(|a, b| factor_ln(a).total_cmp(&factor_ln(b)));
    let unit = match method.unit {
        UnitChoice::Declared(unit) => Some(unit),
        UnitChoice::Auto => nearest,
    };
    let unit = unit.ok_or(PhantomFault::TooFewPoints)?;
    if factor_ln(&unit) > GIRTH_FACTOR_LN_MAX {
        let found_mm = around * unit.in_mm();
        return Err(PhantomFault::NotThePhantom { found_mm, known_mm });
    }
    let to_mm = nalgebra::Matrix4::new_scaling(unit.in_mm())
        * Translation3::new(0.0, 0.0, -low.z).to_homogeneous()
        * upright.to_homogeneous();
    Ok(moved(scan, &to_mm, unit))
}
