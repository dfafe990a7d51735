//! The caller's request for the knots along and around.

use super::profiles::Domain;
use crate::basis::DEGREE;
use crate::fit::FitFault;

/// The requested placement of a fit's knots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Knots {
    /// At equal distances.
    Uniform,
    /// Denser where the data bend more (`knots/adaptive`).
    Adaptive,
}

/// The domain of the surface's parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridDomain {
    /// First and last parameter along.
    pub along: [f64; 2],
    /// The start of a turn around.
    pub around_from: f64,
    /// The period around.
    pub period: f64,
}

/// The request for the knots of one direction.
#[derive(Debug, Clone, Copy)]
pub struct KnotRequest<'a> {
    /// "along" or "around".
    pub direction: &'static str,
    /// The domain of the parameter.
    pub domain: Domain,
    /// Number of spans.
    pub spans: usize,
    /// The placement of the knots.
    pub knots: Knots,
    /// Positions that must be knots.
    pub marks: &'a [f64],
}

/// The requests along and around for a surface with these numbers of rows and columns of control
/// points, and with knots at `marks` along.
///
/// # Errors
/// [`FitFault::MarkOutside`].
pub fn requests<'a>(
    domain: &GridDomain,
    control_points: [usize; 2],
    knots: Knots,
    marks: &'a [f64],
) -> Result<[KnotRequest<'a>; 2], FitFault> {
    let [from, to] = domain.along;
    if let Some(&mark) = marks.iter().find(|mark| !(from..=to).contains(*mark)) {
        return Err(FitFault::MarkOutside { mark, from, to });
    }
    let along = Domain { from, to, periodic: false };
    let (from, to) = (domain.around_from, domain.around_from + domain.period);
    let around = Domain { from, to, periodic: true };
    let [rows, columns] = control_points;
    let spans = rows.saturating_sub(DEGREE);
    Ok([
        KnotRequest { direction: "along", domain: along, spans, knots, marks },
        KnotRequest { direction: "around", domain: around, spans: columns, knots, marks: &[] },
    ])
}
