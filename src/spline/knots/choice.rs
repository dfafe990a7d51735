//! Which breakpoints a fit of one direction gets, and why not those that were asked for.

use std::collections::BTreeSet;

use super::adaptive::adaptive;
use super::marks::{Marked, marked};
use super::polish::polished;
use super::profiles::{Domain, Profiles};
use super::request::{KnotRequest, Knots};
use super::schoenberg_whitney::{determines, undetermined};
use crate::spline::basis::Basis;
use crate::spline::fit::FitFault;

/// Where the knots of a fit do lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KnotsUsed {
    /// In the bases that the caller gave.
    Given,
    /// At equal distances, as asked.
    Uniform,
    /// Where the data bend.
    Adaptive,
    /// Where the data bend, but drawn towards the data until each function had some.
    Widened,
    /// Where the residual is least.
    Polished,
    /// At equal distances, though others were asked for: theirs left no smaller residual.
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
            KnotsUsed::Polished => "polished",
            KnotsUsed::UniformInstead => "uniform-instead",
        }
    }
}

/// The knots of one direction.
#[derive(Debug, Clone)]
pub struct Choice {
    /// The basis with them.
    pub basis: Basis,
    /// Where they come from.
    pub used: KnotsUsed,
    /// Marks that could not be knots.
    pub missed: Vec<f64>,
}

/// As many functions may stay without a datum in a gap that is bridged: with one more the surface
/// there would have a cubic piece of its own.
const BRIDGED: usize = 3;

/// Steps in which breakpoints are drawn towards the data until each function has some.
const WIDENINGS: usize = 8;

/// The basis of equal spans, without marks.
///
/// # Errors
/// [`FitFault::Gap`] where the places leave too many of its functions open, or an end of the domain
/// further than a span from the data.
pub fn equal_spans(places: &[f64], request: &KnotRequest) -> Result<Basis, FitFault> {
    let basis = request.domain.basis(&request.domain.equal(request.spans))?;
    let functions = undetermined(&basis, places).len();
    // Beyond the last datum nothing can be bridged.
    let span = (request.domain.to - request.domain.from) / request.spans as f64;
    let open_end = request.domain.open_ends(places).into_iter().find(|[from, to]| to - from > span);
    if functions > BRIDGED || open_end.is_some() {
        let [from, to] = open_end.unwrap_or_else(|| request.domain.widest_gap(places));
        return Err(FitFault::Gap { direction: request.direction, from, to, functions });
    }
    Ok(basis)
}

/// The knots for these data.
///
/// # Errors
/// A [`FitFault`] where they make no basis or the data do not determine the fine fit.
pub fn chosen(profiles: &Profiles, request: &KnotRequest) -> Result<Choice, FitFault> {
    let equal = marked(request.domain.equal(request.spans), &request.domain, request.marks);
    let uniform = request.domain.basis(&equal.breakpoints)?;
    let instead = Choice { basis: uniform, used: KnotsUsed::Uniform, missed: equal.missed };
    if request.knots == Knots::Uniform {
        return Ok(instead);
    }
    let instead = Choice { used: KnotsUsed::UniformInstead, ..instead };
    let found = adaptive(profiles, &request.domain, request.spans)?;
    let found = marked(found, &request.domain, request.marks);
    let polish = if request.knots == Knots::Polished {
        made_better(&found, request, profiles)
    } else {
        None
    };
    match polish.or_else(|| widened(found, &request.domain, &profiles.places)) {
        Some(choice) if profiles.rss(&choice.basis)? <= profiles.rss(&instead.basis)? => Ok(choice),
        _ => Ok(instead),
    }
}

/// The polished basis; None where it leaves a function without data.
fn made_better(found: &Marked, request: &KnotRequest, profiles: &Profiles) -> Option<Choice> {
    let basis = request.domain.basis(&polished(profiles, &request.domain, found)).ok()?;
    determines(&basis, &profiles.places).ok()?;
    Some(Choice { basis, used: KnotsUsed::Polished, missed: found.missed.clone() })
}

/// The basis of the breakpoints, drawn towards an even share of the data until each function has a
/// datum; None where even that does not help.
fn widened(found: Marked, domain: &Domain, places: &[f64]) -> Option<Choice> {
    let even = evenly_shared(&found, domain, places);
    (0..=WIDENINGS).find_map(|step| {
        let share = step as f64 / WIDENINGS as f64;
        let pairs = found.breakpoints.iter().zip(&even);
        let drawn: Vec<f64> = pairs.map(|(found, even)| found + share * (even - found)).collect();
        let basis = domain.basis(&drawn).ok()?;
        determines(&basis, places).ok()?;
        let used = if step == 0 { KnotsUsed::Adaptive } else { KnotsUsed::Widened };
        Some(Choice { basis, used, missed: found.missed.clone() })
    })
}

/// The breakpoints, the free ones between two fixed ones moved so that each span holds as many data.
fn evenly_shared(found: &Marked, domain: &Domain, places: &[f64]) -> Vec<f64> {
    let mut even = found.breakpoints.clone();
    let last = even.len() - 1;
    let places = domain.homed(places, even[0]);
    let ends = found.fixed.iter().copied().chain([0, last]).collect::<BTreeSet<_>>();
    for (low, high) in ends.iter().zip(ends.iter().skip(1)) {
        let (from, to) = (found.breakpoints[*low], found.breakpoints[*high]);
        let inside: Vec<f64> = places.iter().copied().filter(|x| (from..to).contains(x)).collect();
        for (i, free) in even[*low..*high].iter_mut().enumerate().skip(1) {
            let share = i as f64 / (high - low) as f64;
            *free = between(&inside, [from, to], share * inside.len() as f64);
        }
    }
    even
}

/// Where `count` of the ascending `places` within `ends` lie below: halfway through the counting of
/// a place on the place itself, linear in between.
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
