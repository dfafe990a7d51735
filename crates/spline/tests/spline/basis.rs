//! The cubic basis: known values, and the laws that any breakpoints must obey.
#![allow(clippy::unwrap_used)]

use gaiter_spline::{Basis, BasisFault, Row};
use proptest::prelude::*;

/// Breakpoints from an origin and the lengths of the intervals.
fn breakpoints(origin: f64, lengths: &[f64]) -> Vec<f64> {
    let ends = lengths.iter().scan(origin, |at, length| {
        *at += length;
        Some(*at)
    });
    [origin].into_iter().chain(ends).collect()
}

/// A clamped or a periodic basis of 4 to 12 intervals that differ up to 50-fold.
fn any_basis() -> impl Strategy<Value = Basis> {
    let lengths = prop::collection::vec(0.1..5.0, 4..12);
    (any::<bool>(), -20.0..20.0, lengths).prop_map(|(periodic, origin, lengths)| {
        let breakpoints = breakpoints(origin, &lengths);
        if periodic { Basis::periodic(&breakpoints) } else { Basis::clamped(&breakpoints) }.unwrap()
    })
}

/// Coefficients without a pattern, of the order of 1.
fn coefficients(basis: &Basis) -> Vec<f64> {
    (0..basis.count()).map(|i| (1.7 * i as f64 * i as f64 + 0.3).sin()).collect()
}

fn close(a: f64, b: f64, tolerance: f64) -> Result<(), TestCaseError> {
    prop_assert!((a - b).abs() <= tolerance, "{a} {b}");
    Ok(())
}

/// The four derivatives at `x + h` that those at `x` foretell while both lie in one interval.
fn taylor([f, f1, f2, f3]: [f64; 4], h: f64) -> [f64; 4] {
    let value = f + h * (f1 + h * (f2 / 2.0 + h * f3 / 6.0));
    [value, f1 + h * (f2 + h * f3 / 2.0), f2 + h * f3, f3]
}

fn spline(basis: &Basis, x: f64) -> [f64; 4] {
    let coefficients = coefficients(basis);
    basis.rows(x).map(|row| row.dot(&coefficients))
}

proptest! {
    #[test]
    fn the_functions_are_not_negative_and_add_up_to_one(basis in any_basis(), at in 0.0..1.0) {
        let (from, to) = basis.domain();
        let rows = basis.rows(from + at * (to - from));
        prop_assert_eq!(rows[0], basis.row(from + at * (to - from)));
        prop_assert!(rows[0].values.iter().all(|value| *value >= 0.0));
        close(rows[0].values.iter().sum(), 1.0, 1e-14)?;
        for row in &rows[1..] {
            let size: f64 = row.values.iter().map(|value| value.abs()).sum();
            close(row.values.iter().sum(), 0.0, 1e-13 * size)?;
        }
    }

    #[test]
    fn derivatives_foretell_the_polynomial_of_their_interval(
        basis in any_basis(), which in 0_usize..4, a in 0.0..0.999, b in 0.0..0.999,
    ) {
        let (start, end) = (basis.breakpoints()[which], basis.breakpoints()[which + 1]);
        let (x, y) = (start + a * (end - start), start + b * (end - start));
        let (foretold, found) = (taylor(spline(&basis, x), y - x), spline(&basis, y));
        for (derivative, (foretold, found)) in foretold.into_iter().zip(found).enumerate() {
            close(foretold, found, 1e-11 * 0.1_f64.powi(-(derivative as i32)))?;
        }
    }

    #[test]
    fn two_derivatives_are_continuous_at_every_breakpoint_and_the_seam(basis in any_basis()) {
        let breakpoints = basis.breakpoints();
        let ends = if basis.is_periodic() { breakpoints.len() } else { breakpoints.len() - 1 };
        for i in 1..ends {
            let h = 0.5 * (breakpoints[i] - breakpoints[i - 1]);
            let from_left = taylor(spline(&basis, breakpoints[i] - h), h);
            let from_right = spline(&basis, breakpoints[i]);
            for derivative in 0..3 {
                let tolerance = 1e-11 * 0.1_f64.powi(-(derivative as i32));
                close(from_left[derivative], from_right[derivative], tolerance)?;
            }
            prop_assert!((from_left[3] - from_right[3]).abs() > 1e-9, "a knot that is none");
        }
    }

    #[test]
    fn a_periodic_basis_repeats_and_a_clamped_one_ends(basis in any_basis(), at in 0.0..1.0) {
        let (from, to) = basis.domain();
        let x = from + at * (to - from);
        if basis.is_periodic() {
            let here = spline(&basis, x);
            for turns in [-2.0, 1.0, 3.0] {
                let there = spline(&basis, x + turns * (to - from));
                close(here[0], there[0], 1e-11)?;
            }
        } else {
            close(spline(&basis, from - at)[0], coefficients(&basis)[0], 1e-14)?;
            prop_assert_eq!(basis.row(to + at), basis.row(to));
        }
    }

    #[test]
    fn greville_abscissae_make_a_clamped_spline_the_identity(basis in any_basis(), at in 0.0..1.0) {
        let (from, to) = basis.domain();
        let greville = basis.greville();
        prop_assert_eq!(greville.len(), basis.count());
        prop_assert!(greville.iter().all(|x| (from..=to).contains(x)));
        if !basis.is_periodic() {
            let x = from + at * (to - from);
            close(basis.row(x).dot(&greville), x, 1e-13 * (1.0 + from.abs() + to.abs()))?;
        }
    }
}

#[test]
fn uniform_functions_have_their_textbook_values() {
    let basis = Basis::uniform_periodic(0.0, 8.0, 8).unwrap();
    assert_eq!(basis.count(), 8);
    assert_eq!(basis.knots().len(), 15);
    let Row { indices, values } = basis.row(7.5);
    assert_eq!(indices, [7, 0, 1, 2]);
    for (value, expected) in values.iter().zip([1.0, 23.0, 23.0, 1.0]) {
        assert!((value - expected / 48.0).abs() < 1e-15, "{values:?}");
    }
    let [value, slope, bend, third] = basis.rows(2.0).map(|row| row.values);
    for (found, expected) in [
        (value, [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0]),
        (slope, [-0.5, 0.0, 0.5, 0.0]),
        (bend, [1.0, -2.0, 1.0, 0.0]),
        (third, [-1.0, 3.0, -3.0, 1.0]),
    ] {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
    }
}

#[test]
fn one_clamped_interval_is_a_bezier_piece() {
    let basis = Basis::clamped(&[2.0, 4.0]).unwrap();
    assert_eq!(basis.knots(), [2.0, 2.0, 2.0, 2.0, 4.0, 4.0, 4.0, 4.0]);
    let row = basis.row(2.5);
    assert_eq!(row.indices, [0, 1, 2, 3]);
    for (value, expected) in row.values.iter().zip([27.0, 27.0, 9.0, 1.0]) {
        assert!((value - expected / 64.0).abs() < 1e-15);
    }
}

#[test]
fn breakpoints_that_make_no_basis_are_refused_with_their_place() {
    let faults = [
        (Basis::clamped(&[1.0]), BasisFault::TooFewBreakpoints { found: 1, needed: 2 }),
        (
            Basis::periodic(&[0.0, 1.0, 2.0, 3.0]),
            BasisFault::TooFewBreakpoints { found: 4, needed: 5 },
        ),
        (Basis::clamped(&[0.0, f64::NAN, 1.0]), BasisFault::NotFinite { index: 1 }),
        (
            Basis::clamped(&[0.0, 1.0, 1.0]),
            BasisFault::NotIncreasing { index: 2, before: 1.0, value: 1.0 },
        ),
        (
            Basis::uniform_clamped(1.0, 0.0, 1),
            BasisFault::NotIncreasing { index: 1, before: 1.0, value: 0.0 },
        ),
        (
            Basis::uniform_clamped(0.0, 1.0, 0),
            BasisFault::TooFewBreakpoints { found: 1, needed: 2 },
        ),
    ];
    for (found, expected) in faults {
        assert_eq!(found.unwrap_err(), expected);
    }
}

proptest! {
    #[test]
    fn a_period_ends_where_it_starts_to_the_last_bit(from in -9.0..9.0_f64, period in 0.1..7.0_f64) {
        let basis = Basis::uniform_periodic(from, period, 7).unwrap();
        let (from, to) = basis.domain();
        prop_assert_eq!(basis.row(from), basis.row(to));
    }
}

#[test]
fn equal_intervals_have_the_functions_that_their_knots_give() {
    for intervals in 4..12 {
        let step = |i: usize| 1.5 + 0.3 * i as f64;
        let breakpoints: Vec<f64> = (0..=intervals).map(step).collect();
        let (from, length) = (step(0), step(intervals) - step(0));
        let pairs = [
            (
                Basis::uniform_clamped(from, step(intervals), intervals),
                Basis::clamped(&breakpoints),
            ),
            (Basis::uniform_periodic(from, length, intervals), Basis::periodic(&breakpoints)),
        ];
        for (even, general) in pairs.map(|(even, general)| (even.unwrap(), general.unwrap())) {
            for x in (0..=100).map(|i| from + length * (0.007 + 0.0098 * f64::from(i))) {
                let (found, expected) = (even.row(x), general.row(x));
                assert_eq!(found.indices, expected.indices, "{x}");
                let pairs = found.values.into_iter().zip(expected.values);
                pairs.for_each(|(a, b)| assert!((a - b).abs() < 1e-14, "{x}: {a} {b}"));
            }
        }
    }
}
