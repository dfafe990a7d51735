//! The caller's request for the knots along and around.

use super::profiles::Domain;
use crate::fit::FitFault;

/// The requested placement of a fit's knots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Knots {
    /// At equal distances.
    Uniform,
    /// Denser where the data bend more (`knots/adaptive`).
    Adaptive,
    /// Adaptive, then moved to minimise the residual (`knots/polish`).
    Polished,
}

impl Knots {
    /// The word used in configurations and records.
    pub fn word(self) -> &'static str {
        match self {
            Knots::Uniform => "uniform",
            Knots::Adaptive => "adaptive",
            Knots::Polished => "polished",
        }
    }
}

/// The domain of the surface's parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridDomain {
    /// First and last parameter along.
    pub along: [f64; 2],
    /// The start of a turn around, unless knots are polished or marked; then the knots determine it.
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
/// points.
///
/// # Errors
/// [`FitFault::MarkOutside`].
pub fn requests<'a>(
    domain: &GridDomain,
    control_points: [usize; 2],
    knots: Knots,
    marks: &'a [Vec<f64>; 2],
) -> Result<[KnotRequest<'a>; 2], FitFault> {
    let [from, to] = domain.along;
    let along = Domain { from, to, periodic: false };
    let (from, to) = (domain.around_from, domain.around_from + domain.period);
    let around = Domain { from, to, periodic: true };
    let request = |i: usize, direction, domain: Domain, spans: usize| {
        let marks = marks[i].as_slice();
        let Domain { from, to, periodic } = domain;
        let outside = |mark: &&f64| !mark.is_finite() || !periodic && !(from..=to).contains(*mark);
        match marks.iter().find(outside) {
            Some(&mark) => Err(FitFault::MarkOutside { direction, mark, from, to }),
            None => Ok(KnotRequest { direction, domain, spans, knots, marks }),
        }
    };
    let spans = control_points[0].saturating_sub(3);
    Ok([request(0, "along", along, spans)?, request(1, "around", around, control_points[1])?])
}
