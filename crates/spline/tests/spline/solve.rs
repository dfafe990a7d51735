//! The skyline factor against dense linear algebra.
#![allow(clippy::unwrap_used)]

use gaiter_spline::Basis;
use gaiter_spline::solve::Skyline;
use nalgebra::DMatrix;

/// The bases tried: clamped from a single piece on, periodic from the smallest, whose corners
/// overlap the band.
fn bases() -> Vec<Basis> {
    let clamped = [1, 2, 5, 20].map(|n| Basis::uniform_clamped(-1.0, 2.0, n).unwrap());
    let periodic = [4, 5, 6, 7, 8, 20].map(|n| Basis::uniform_periodic(0.5, 3.0, n).unwrap());
    clamped.into_iter().chain(periodic).collect()
}

/// A Gram matrix of unevenly spread abscissae, in both forms.
fn gram(basis: &Basis) -> (Skyline, DMatrix<f64>) {
    let count = basis.count();
    let (from, to) = basis.domain();
    let mut skyline = Skyline::zero(basis);
    let mut dense = DMatrix::zeros(count, count);
    let data = 7 * count;
    for i in 0..data {
        let (share, weight) = (i as f64 / data as f64, 1.0 + (i % 5) as f64);
        let row = basis.row(from + (to - from) * share.powf(1.2));
        skyline.add_square(&row, weight);
        for (a, p) in row.indices.into_iter().zip(row.values) {
            for (b, q) in row.indices.into_iter().zip(row.values) {
                dense[(a, b)] += weight * p * q;
            }
        }
    }
    (skyline, dense)
}

#[test]
fn three_right_hand_sides_are_solved_at_once() {
    for basis in bases() {
        let (skyline, dense) = gram(&basis);
        let count = basis.count();
        let known = DMatrix::from_fn(count, 3, |i, j| ((3 * i + j) as f64).sin());
        let right = &dense * &known;
        // nalgebra keeps columns together; the solver wants rows.
        let mut rows = right.transpose().as_slice().to_vec();
        let factor = skyline.clone().factor().unwrap();
        factor.solve(&mut rows, 3);
        let solved = DMatrix::from_row_slice(count, 3, &rows);
        assert!((solved - known).amax() < 1e-11, "{basis:?}");
    }
}

#[test]
fn the_inverse_agrees_with_the_dense_one_where_functions_overlap() {
    for basis in bases() {
        let (skyline, dense) = gram(&basis);
        let inverse = skyline.clone().factor().unwrap().into_inverse();
        let expected = dense.clone().try_inverse().unwrap();
        let size = expected.amax();
        for breakpoint in basis.breakpoints() {
            let indices = basis.row(*breakpoint).indices;
            for (i, j) in indices.into_iter().flat_map(|i| indices.map(|j| (i, j))) {
                let (found, expected) = (inverse.entry(i, j), expected[(i, j)]);
                assert!((found - expected).abs() < 1e-11 * size, "{i} {j}: {found} {expected}");
            }
        }
        assert!((skyline.trace() - dense.trace()).abs() < 1e-12 * dense.trace());
        let product = inverse.trace_of_product(&skyline);
        assert!((product - basis.count() as f64).abs() < 1e-9, "{product}");
    }
}

#[test]
fn a_coefficient_without_data_is_reported_as_singular() {
    let basis = Basis::uniform_clamped(0.0, 10.0, 10).unwrap();
    let mut gram = Skyline::zero(&basis);
    for i in 0..60 {
        gram.add_square(&basis.row(0.1 * f64::from(i)), 1.0);
    }
    // The data end within interval 5, whose last function is number 8.
    let fault = gram.clone().factor().unwrap_err();
    assert_eq!((fault.row, fault.relative_pivot), (9, 0.0));
}

#[test]
fn data_that_leave_a_sawtooth_free_are_singular_up_to_rounding() {
    // An even number of data at the middles of uniform periodic intervals.
    let basis = Basis::uniform_periodic(0.0, 12.0, 12).unwrap();
    let mut gram = Skyline::zero(&basis);
    (0..12).for_each(|i| gram.add_square(&basis.row(f64::from(i) + 0.5), 1.0));
    let fault = gram.clone().factor().unwrap_err();
    assert_eq!(fault.row, 11);
    assert!(fault.relative_pivot.abs() < 1e-14);
}
