//! The guard against bases that the data do not determine, against the rank of the matrix itself.
#![allow(clippy::unwrap_used)]

use gaiter_spline::{Basis, undetermined};
use nalgebra::DMatrix;
use proptest::prelude::*;

/// The singular values of the matrix of basis values, relative to the largest.
fn singular_values(basis: &Basis, places: &[f64]) -> Vec<f64> {
    let mut matrix: DMatrix<f64> = DMatrix::zeros(places.len(), basis.count());
    for (i, place) in places.iter().enumerate() {
        let row = basis.row(*place);
        row.indices.into_iter().zip(row.values).for_each(|(j, value)| matrix[(i, j)] += value);
    }
    let found = matrix.singular_values();
    found.iter().map(|value| value / found.max()).collect()
}

/// The smallest of as many singular values as there are functions.
fn smallest(basis: &Basis, places: &[f64]) -> f64 {
    let values = singular_values(basis, places);
    let short = places.len() < basis.count();
    if short { 0.0 } else { values.into_iter().fold(f64::INFINITY, f64::min) }
}

fn breakpoints(steps: &[f64]) -> Vec<f64> {
    let heaped = steps.iter().scan(0.0, |sum, step| {
        *sum += step;
        Some(*sum)
    });
    [0.0].into_iter().chain(heaped).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 300, ..Default::default() })]

    /// Clamped: refused exactly where the rank falls short. Values on a coarse raster make both
    /// happen, and keep singular values apart from rounding.
    #[test]
    fn a_clamped_basis_is_determined_where_its_matrix_has_full_rank(
        steps in prop::collection::vec(1..4_u32, 2..8),
        places in prop::collection::vec(0.0..1.0_f64, 5..16),
    ) {
        let steps: Vec<f64> = steps.iter().map(|step| f64::from(*step)).collect();
        let basis = Basis::clamped(&breakpoints(&steps)).unwrap();
        let end = basis.domain().1;
        let places: Vec<f64> = places.iter().map(|x| (x * 8.0 * end).round() / 8.0).collect();
        let full = smallest(&basis, &places) > 1e-13;
        prop_assert_eq!(undetermined(&basis, &places).is_empty(), full, "{:?}", places);
    }

    /// Periodic: what is refused has no full rank; the other way round there are exceptions.
    #[test]
    fn a_periodic_basis_that_is_refused_lacks_rank(
        steps in prop::collection::vec(1..4_u32, 4..9),
        places in prop::collection::vec(-1.0..2.0_f64, 3..16),
    ) {
        let steps: Vec<f64> = steps.iter().map(|step| f64::from(*step)).collect();
        let basis = Basis::periodic(&breakpoints(&steps)).unwrap();
        let end = basis.domain().1;
        let places: Vec<f64> = places.iter().map(|x| x * end).collect();
        if !undetermined(&basis, &places).is_empty() {
            prop_assert!(smallest(&basis, &places) < 1e-12, "{:?}", places);
        }
    }

    /// Turning the data by whole turns, or naming them in another order, changes nothing.
    #[test]
    fn turns_and_order_do_not_matter(
        places in prop::collection::vec(0.0..1.0_f64, 3..16),
        turns in -3..3_i32,
    ) {
        let basis = Basis::uniform_periodic(0.0, 1.0, 7).unwrap();
        let turned: Vec<f64> = places.iter().rev().map(|x| x + f64::from(turns)).collect();
        prop_assert_eq!(undetermined(&basis, &places).is_empty(), undetermined(&basis, &turned).is_empty());
    }
}

#[test]
fn the_function_without_data_is_named() {
    let basis = Basis::uniform_clamped(0.0, 10.0, 10).unwrap();
    // Nothing between 2 and 8: of the 13 functions those of knots 2..6 to 4..8 see no datum.
    let places: Vec<f64> = (0..=40).map(|i| f64::from(i) / 4.0).collect();
    let places: Vec<f64> = places.into_iter().filter(|x| *x <= 2.0 || *x >= 8.0).collect();
    let function = undetermined(&basis, &places)[0];
    let support = [basis.knots()[function], basis.knots()[function + 4]];
    assert_eq!((function, support), (5, [2.0, 6.0]));
    assert!(
        undetermined(&basis, &(0..=12).map(|i| f64::from(i) / 1.2).collect::<Vec<_>>()).is_empty()
    );
}

#[test]
fn a_seam_is_no_edge() {
    let basis = Basis::uniform_periodic(0.0, 8.0, 8).unwrap();
    // Eight data for eight functions, all in the first half turn: the other half is empty.
    let crowded: Vec<f64> = (0..8).map(|i| 0.5 * f64::from(i)).collect();
    assert!(!undetermined(&basis, &crowded).is_empty());
    // One in each span determines all, wherever the turn is cut open.
    for start in 0..8 {
        let places: Vec<f64> = (0..8).map(|i| f64::from(start + i) + 0.3).collect();
        assert!(undetermined(&basis, &places).is_empty());
    }
}
