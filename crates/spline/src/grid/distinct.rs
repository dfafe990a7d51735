//! Refuses grids whose rows or columns are too few or coincide.

use crate::basis::DEGREE;
use crate::fit::{FitFault, check_places};
use crate::knots::profiles::Profiles;
use crate::knots::request::KnotRequest;

/// Rows closer than this are the same: as a share of the domain for their parameters, or of the
/// data's extent for all of their points.
const ONE_LINE: f64 = 1e-9;

/// Refuses data to which no surface with these knots can be fitted.
///
/// # Errors
/// [`FitFault::FewerThanControlPoints`], [`FitFault::Basis`], [`FitFault::OutsideDomain`],
/// [`FitFault::Coincident`].
pub fn check_lines(profiles: &Profiles, request: &KnotRequest) -> Result<(), FitFault> {
    let KnotRequest { direction, domain, spans, .. } = *request;
    let (found, needed) = (profiles.places.len(), spans + if domain.periodic { 0 } else { DEGREE });
    if found < needed {
        return Err(FitFault::FewerThanControlPoints { direction, found, needed });
    }
    let basis = domain.basis(&domain.equal(spans))?;
    check_places(&basis, &profiles.places, &profiles.places)?;
    let lines = if request.domain.periodic { "columns" } else { "rows" };
    match twins(profiles, request) {
        Some([first, second]) => Err(FitFault::Coincident { lines, first, second }),
        None => Ok(()),
    }
}

/// Two neighbours with the same parameter or the same points.
fn twins(profiles: &Profiles, request: &KnotRequest) -> Option<[usize; 2]> {
    let Profiles { places, values } = profiles;
    let domain = request.domain;
    let width = values.len() / places.len();
    let line = |i: usize| &values[i * width..(i + 1) * width];
    let extent = |axis: usize| {
        let values = || values.iter().skip(axis).step_by(3).copied();
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    let near_mm = ONE_LINE * (0..3).map(extent).fold(0.0, f64::max);
    let near = ONE_LINE * (domain.to - domain.from);
    let home = |i: usize| domain.wrap(places[i], domain.from);
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by(|a, b| home(*a).total_cmp(&home(*b)));
    let same = |&[i, j]: &[usize; 2]| {
        let apart = (home(j) - home(i)).abs();
        let apart =
            if domain.periodic { apart.min(domain.to - domain.from - apart) } else { apart };
        apart <= near || line(i).iter().zip(line(j)).all(|(a, b)| (a - b).abs() <= near_mm)
    };
    let next = order.iter().cycle().skip(1);
    let pairs = order.iter().zip(next).map(|(i, j)| [*i, *j]);
    let pairs = pairs.take(if domain.periodic { order.len() } else { order.len() - 1 });
    pairs.into_iter().find(same)
}
