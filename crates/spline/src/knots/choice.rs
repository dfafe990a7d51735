//! Chooses the breakpoints of a fit in one direction, and reports why they may differ from the request.

use super::adaptive::adaptive;
use super::marks::{Marked, marked};
use super::profiles::{Domain, Profiles};
use super::request::{KnotRequest, Knots};
use super::schoenberg_whitney::undetermined;
use crate::basis::Basis;
use crate::fit::FitFault;

/// The actual placement of the knots of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KnotsUsed {
    /// In the bases given by the caller.
    Given,
    /// At equal distances, as requested.
    Uniform,
    /// Where the data bend.
    Adaptive,
    /// Where the data bend, but shifted towards the data until each function had some.
    Widened,
    /// At equal distances although others were requested, because theirs left no smaller residual.
    UniformInstead,
}

impl KnotsUsed {
    /// The word used in records.
    pub fn word(self) -> &'static str {
        match self {
            KnotsUsed::Given => "given",
            KnotsUsed::Uniform => "uniform",
            KnotsUsed::Adaptive => "adaptive",
            KnotsUsed::Widened => "widened",
            KnotsUsed::UniformInstead => "uniform-instead",
        }
    }
}

/// The knots of one direction.
#[derive(Debug, Clone)]
pub struct Choice {
    /// The basis with them.
    pub basis: Basis,
    /// The origin of the knots.
    pub used: KnotsUsed,
}

/// Maximum number of functions without a datum in a bridged gap; with one more, the surface there
/// would have a cubic piece independent of the data.
const BRIDGED: usize = 3;

/// Number of steps in which breakpoints are shifted towards the data until each function has some.
const WIDENINGS: usize = 8;

/// Refuses gaps that cannot be bridged.
///
/// # Errors
/// [`FitFault::Gap`] if the positions leave too many functions on equal spans undetermined, or if an end
/// of the domain is further than a span from the data.
pub fn check_gaps(places: &[f64], request: &KnotRequest) -> Result<(), FitFault> {
    let basis = request.domain.basis(&request.domain.equal(request.spans))?;
    let functions = undetermined(&basis, places).len();
    // Beyond the last datum nothing can be bridged.
    let span = (request.domain.to - request.domain.from) / request.spans as f64;
    let open_end = request.domain.open_ends(places).into_iter().find(|[from, to]| to - from > span);
    if functions > BRIDGED || open_end.is_some() {
        let [from, to] = open_end.unwrap_or_else(|| request.domain.widest_gap(places));
        return Err(FitFault::Gap { direction: request.direction, from, to, functions });
    }
    Ok(())
}

/// The knots for these data.
///
/// # Errors
/// A [`FitFault`] if they do not form a basis, or if the data do not determine the fine fit.
pub fn chosen(profiles: &Profiles, request: &KnotRequest) -> Result<Choice, FitFault> {
    let equal = marked(request.domain.equal(request.spans), &request.domain, request.marks);
    let uniform = request.domain.basis(&equal.breakpoints)?;
    if request.knots == Knots::Uniform {
        return Ok(Choice { basis: uniform, used: KnotsUsed::Uniform });
    }
    let instead = Choice { basis: uniform, used: KnotsUsed::UniformInstead };
    let found = adaptive(profiles, &request.domain, request.spans)?;
    let found = marked(found, &request.domain, request.marks);
    match widened(&found, &request.domain, &profiles.places) {
        Some(choice) if profiles.rss(&choice.basis)? <= profiles.rss(&instead.basis)? => Ok(choice),
        _ => Ok(instead),
    }
}

/// The basis of the breakpoints, shifted towards an even distribution of the data until each
/// function has a datum; `None` if even that is not enough.
fn widened(found: &Marked, domain: &Domain, places: &[f64]) -> Option<Choice> {
    let even = evenly_shared(found, domain, places);
    (0..=WIDENINGS).find_map(|step| {
        let share = step as f64 / WIDENINGS as f64;
        let pairs = found.breakpoints.iter().zip(&even);
        let drawn: Vec<f64> = pairs.map(|(found, even)| found + share * (even - found)).collect();
        let basis = domain.basis(&drawn).ok()?;
        let used = if step == 0 { KnotsUsed::Adaptive } else { KnotsUsed::Widened };
        undetermined(&basis, places).is_empty().then_some(Choice { basis, used })
    })
}

/// The breakpoints, with the free ones between two fixed ones moved so that each span holds equally
/// many data.
fn evenly_shared(found: &Marked, domain: &Domain, places: &[f64]) -> Vec<f64> {
    let mut even = found.breakpoints.clone();
    let places = domain.wrapped(places, even[0]);
    for (low, high) in found.fixed.iter().zip(&found.fixed[1..]) {
        let (from, to) = (found.breakpoints[*low], found.breakpoints[*high]);
        let inside: Vec<f64> = places.iter().copied().filter(|x| (from..to).contains(x)).collect();
        for (i, free) in even[*low..*high].iter_mut().enumerate().skip(1) {
            let share = i as f64 / (high - low) as f64;
            *free = between(&inside, [from, to], share * inside.len() as f64);
        }
    }
    even
}

/// The abscissa within `ends` below which `count` of the ascending `places` lie: a position counts
/// half at itself, with linear interpolation between positions.
fn between(places: &[f64], [from, to]: [f64; 2], count: f64) -> f64 {
    let below = (count + 0.5).floor();
    let at = |i: f64| match i {
        i if i < 0.0 => (0.0, from),
        i if i as usize >= places.len() => (places.len() as f64, to),
        i => (i + 0.5, places[i as usize]),
    };
    let ((low, start), (high, end)) = (at(below - 1.0), at(below));
    start + (end - start) * (count - low) / (high - low)
}
