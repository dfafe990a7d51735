//! The scalar fit: what it reproduces, what it minimises, and whether its figures are true.
#![allow(clippy::unwrap_used)]

use std::f64::consts::TAU;

use gaiter_spline::{Basis, FitFault, Smoothing, Spline, fit};

/// Normally distributed numbers of variance 1, the same in every run: an LCG (Knuth's MMIX) and
/// the Box-Muller transform.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }
}

/// Unevenly spaced directions around a section: four times denser in front than behind.
fn directions(count: usize) -> Vec<f64> {
    (0..count).map(|i| i as f64 / count as f64).map(|t| TAU * t + 0.6 * (TAU * t).sin()).collect()
}

fn section(theta: f64) -> f64 {
    50.0 + 5.0 * (2.0 * theta).cos() + 2.0 * (3.0 * theta + 1.0).sin()
}

fn around(intervals: usize) -> Basis {
    Basis::uniform_periodic(0.0, TAU, intervals).unwrap()
}

fn fitted(basis: &Basis, x: &[f64], y: &[f64], smoothing: Smoothing) -> Spline {
    fit(basis, x, y, &vec![1.0; x.len()], smoothing).unwrap()
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

#[test]
fn a_plain_clamped_fit_reproduces_cubics_with_their_derivatives() {
    let basis = Basis::clamped(&[-1.0, 0.0, 0.5, 2.0, 4.0, 4.3, 7.0]).unwrap();
    let cubic = |x: f64| 2.0 - x + 0.5 * x * x - 0.1 * x * x * x;
    let x: Vec<f64> = (0..60).map(|i| -1.0 + 8.0 * f64::from(i) / 59.0).collect();
    let y: Vec<f64> = x.iter().map(|x| cubic(*x)).collect();
    let spline = fitted(&basis, &x, &y, Smoothing::None);
    for i in 0..200 {
        let x = -1.0 + 8.0 * f64::from(i) / 199.0;
        let expected = [cubic(x), -1.0 + x - 0.3 * x * x, 1.0 - 0.6 * x, -0.6];
        for (found, expected) in spline.derivatives(x).into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-7, "{x}: {found} {expected}");
        }
        assert!((spline.value(x) - cubic(x)).abs() < 1e-9);
    }
    assert!((spline.edf - 9.0).abs() < 1e-6 && spline.rms < 1e-10 && spline.r2 > 1.0 - 1e-12);
}

#[test]
fn a_plain_periodic_fit_finds_the_coefficients_that_made_the_data() {
    let basis = Basis::periodic(&[0.0, 0.7, 1.0, 2.5, 3.0, 4.2, 5.0, TAU]).unwrap();
    let truth = [3.0, -1.0, 4.0, 1.0, -5.0, 9.0, 2.0];
    // The last turn's data lie outside the domain and must be wrapped.
    let x: Vec<f64> = (0..50).map(|i| 0.3 * f64::from(i)).collect();
    let y: Vec<f64> = x.iter().map(|x| basis.row(*x).dot(&truth)).collect();
    let spline = fitted(&basis, &x, &y, Smoothing::None);
    for (found, expected) in spline.coefficients.iter().zip(truth) {
        assert!((found - expected).abs() < 1e-8, "{found} {expected}");
    }
}

/// The integral of the product of two functions' second derivatives, interval by interval with
/// Simpson's rule, which is exact for it.
fn roughness(basis: &Basis, a: &[f64], b: &[f64]) -> f64 {
    let bend = |x: f64, c: &[f64]| basis.rows(x)[2].dot(c);
    let pieces = basis.breakpoints().windows(2).map(|ends| {
        let (h, middle) = (ends[1] - ends[0], 0.5 * (ends[0] + ends[1]));
        // The ends' own values come from within the interval: second derivatives are linear.
        let at = |c: &[f64]| {
            let (left, right) = (bend(ends[0], c), 2.0 * bend(middle, c) - bend(ends[0], c));
            [left, bend(middle, c), right]
        };
        let (a, b) = (at(a), at(b));
        h / 6.0 * (a[0] * b[0] + 4.0 * a[1] * b[1] + a[2] * b[2])
    });
    pieces.sum()
}

#[test]
fn the_fit_minimises_squares_plus_roughness() {
    let clamped = Basis::clamped(&[0.0, 0.4, 1.0, 1.1, 2.0, 3.5, 4.0, 5.5, TAU]).unwrap();
    for basis in [around(9), clamped] {
        let (x, count) = (directions(40), basis.count());
        let y: Vec<f64> = x.iter().map(|x| section(*x)).collect();
        let weights: Vec<f64> = (0..40).map(|i| f64::from(i % 4)).collect();
        let spline = fit(&basis, &x, &y, &weights, Smoothing::Fixed(0.1)).unwrap();
        let unit = |i: usize| (0..count).map(|j| f64::from(u8::from(i == j))).collect::<Vec<_>>();
        let value = |x: f64, i: usize| basis.row(x).dot(&unit(i));
        let data = |i: usize| x.iter().zip(&weights).map(move |(x, w)| w * value(*x, i).powi(2));
        let data_trace: f64 = (0..count).flat_map(data).sum();
        let trace: f64 = (0..count).map(|i| roughness(&basis, &unit(i), &unit(i))).sum();
        for i in 0..count {
            let pull: f64 = (0..x.len())
                .map(|k| weights[k] * (spline.value(x[k]) - y[k]) * value(x[k], i))
                .sum();
            let stiffness = roughness(&basis, &spline.coefficients, &unit(i));
            let penalty = 0.1 * data_trace / trace * stiffness;
            assert!(penalty.abs() > 1e-3, "the penalty does nothing");
            assert!((pull + penalty).abs() < 1e-9, "{i}: {pull} {penalty}");
        }
    }
}

#[test]
fn edf_sigma_rms_and_r2_are_what_they_say() {
    let (basis, x, mut noise) = (around(20), directions(60), Noise(3));
    let y: Vec<f64> = x.iter().map(|x| section(*x) + noise.normal()).collect();
    let weights: Vec<f64> = (0..60).map(|i| 0.5 + f64::from(i % 3)).collect();
    let at = |y: &[f64]| fit(&basis, &x, y, &weights, Smoothing::Fixed(0.02)).unwrap();
    let spline = at(&y);
    let leverage = |i: usize| {
        let mut moved = y.clone();
        moved[i] += 1.0;
        at(&moved).value(x[i]) - spline.value(x[i])
    };
    let edf: f64 = (0..60).map(leverage).sum();
    assert!((spline.edf - edf).abs() < 1e-9 && (5.0..19.5).contains(&edf), "{edf}");
    let total: f64 = weights.iter().sum();
    let centre = y.iter().zip(&weights).map(|(y, w)| w * y).sum::<f64>() / total;
    let squares = |from: &dyn Fn(usize) -> f64| -> f64 {
        (0..60).map(|i| weights[i] * (y[i] - from(i)).powi(2)).sum()
    };
    let (rss, tss) = (squares(&|i| spline.value(x[i])), squares(&|_| centre));
    assert!((spline.sigma - (rss / (60.0 - edf)).sqrt()).abs() < 1e-9);
    assert!((spline.rms - (rss / total).sqrt()).abs() < 1e-12);
    assert!((spline.r2 - (1.0 - rss / tss)).abs() < 1e-12);
}

#[test]
fn lambda_depends_on_no_unit_and_no_number_of_data() {
    let x = directions(50);
    let y: Vec<f64> = x.iter().map(|x| section(*x)).collect();
    let one = fitted(&around(16), &x, &y, Smoothing::Fixed(0.3));
    let degrees: Vec<f64> = x.iter().map(|x| x.to_degrees()).collect();
    let turn = Basis::uniform_periodic(0.0, 360.0, 16).unwrap();
    let other = fitted(&turn, &degrees, &y, Smoothing::Fixed(0.3));
    let twice = fitted(
        &around(16),
        &[x.clone(), x].concat(),
        &[y.clone(), y].concat(),
        Smoothing::Fixed(0.3),
    );
    for (i, coefficient) in one.coefficients.iter().enumerate() {
        assert!((coefficient - other.coefficients[i]).abs() < 1e-9);
        assert!((coefficient - twice.coefficients[i]).abs() < 1e-9);
    }
}

#[test]
fn a_strong_penalty_leaves_the_line_or_the_mean() {
    let (x, mut noise) = (directions(50), Noise(8));
    let y: Vec<f64> = x.iter().map(|x| 3.0 + 2.0 * x + noise.normal()).collect();
    let (mx, my) = (mean(x.iter().copied()), mean(y.iter().copied()));
    let slope = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>()
        / x.iter().map(|x| (x - mx).powi(2)).sum::<f64>();
    let basis = Basis::uniform_clamped(0.0, TAU, 30).unwrap();
    let line = fitted(&basis, &x, &y, Smoothing::Fixed(1e9));
    assert!((line.edf - 2.0).abs() < 1e-3, "{}", line.edf);
    assert!((line.derivatives(2.0)[1] - slope).abs() < 1e-3);
    let flat = fitted(&around(30), &x, &y, Smoothing::Fixed(1e9));
    assert!((flat.edf - 1.0).abs() < 1e-3 && (flat.value(4.0) - my).abs() < 1e-2, "{}", flat.edf);
}

#[test]
fn gcv_recovers_noisy_sections() {
    // Number of data, intervals, noise, and the error left over that of the plain fit.
    for (count, intervals, sigma, gain) in
        [(200, 36, 0.3, 0.85), (400, 48, 1.0, 0.7), (120, 24, 0.05, 1.0), (48, 40, 0.2, 0.8)]
    {
        let (basis, x, mut noise) = (around(intervals), directions(count), Noise(1));
        let error = |spline: &Spline| {
            let places = (0..500).map(|i| TAU * f64::from(i) / 500.0);
            mean(places.map(|x| (spline.value(x) - section(x)).powi(2)))
        };
        let (mut smooth, mut plain, mut variance) = (0.0, 0.0, 0.0);
        for _ in 0..20 {
            let y: Vec<f64> = x.iter().map(|x| section(*x) + sigma * noise.normal()).collect();
            let spline = fitted(&basis, &x, &y, Smoothing::Gcv);
            // Two harmonics and the mean are 5 parameters.
            assert!((6.0..=intervals as f64).contains(&spline.edf), "{count}: {}", spline.edf);
            smooth += error(&spline) / 20.0;
            variance += spline.sigma.powi(2) / 20.0;
            plain += error(&fitted(&basis, &x, &y, Smoothing::None)) / 20.0;
        }
        let ratio = variance.sqrt() / sigma;
        assert!((ratio - 1.0).abs() < 0.1, "{count}: sigma {ratio}");
        assert!(smooth.sqrt() < 0.7 * sigma, "{count}: {smooth}");
        let found = (smooth / plain).sqrt();
        assert!(found < gain, "{count}: {found}");
    }
}

#[test]
fn gcv_finds_the_least_score() {
    let (basis, x, mut noise) = (around(36), directions(150), Noise(5));
    let y: Vec<f64> = x.iter().map(|x| section(*x) + 0.3 * noise.normal()).collect();
    let score = |spline: &Spline| (spline.rms / (150.0 - spline.edf)).powi(2);
    let found = score(&fitted(&basis, &x, &y, Smoothing::Gcv));
    let at = |i: i32| Smoothing::Fixed(10.0_f64.powf(-12.0 + 0.1 * f64::from(i)));
    let scores: Vec<f64> = (0..=200).map(|i| score(&fitted(&basis, &x, &y, at(i)))).collect();
    let least = scores.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(found < 1.0001 * least, "{found} {least}");
    assert!(scores[0] > 1.1 * least && scores[200] > 1.1 * least, "any lambda would do");
}

#[test]
fn standard_errors_match_repeated_measurements() {
    let (basis, x, sigma) = (around(14), directions(80), 0.4);
    let mut noise = Noise(11);
    let places = [0.1, 1.7, 3.1, 4.0, 6.2];
    let mut squares = [[0.0; 5]; 3];
    let repeats = 1500;
    let truth: Vec<f64> = x.iter().map(|x| section(*x)).collect();
    let clean = fitted(&basis, &x, &truth, Smoothing::None);
    let mut last = clean.clone();
    for _ in 0..repeats {
        let y: Vec<f64> = truth.iter().map(|y| y + sigma * noise.normal()).collect();
        last = fitted(&basis, &x, &y, Smoothing::None);
        for (i, x) in places.into_iter().enumerate() {
            let (found, expected) = (last.derivatives(x), clean.derivatives(x));
            for derivative in 0..3 {
                squares[derivative][i] += (found[derivative] - expected[derivative]).powi(2);
            }
        }
    }
    for (derivative, squares) in squares.iter().enumerate() {
        for (x, square) in places.into_iter().zip(squares) {
            let scatter = (square / f64::from(repeats)).sqrt();
            let foretold = last.sd(x, derivative) * sigma / last.sigma;
            let ratio = foretold / scatter;
            assert!((ratio - 1.0).abs() < 0.08, "{derivative} at {x}: {foretold} {scatter}");
        }
    }
}

#[test]
fn standard_errors_of_a_smoothed_fit_cover_its_error_on_average() {
    let (basis, x, mut noise) = (around(36), directions(120), Noise(21));
    let places: Vec<f64> = (0..60).map(|i| TAU * f64::from(i) / 60.0).collect();
    let (mut errors, mut foretold) = (0.0, 0.0);
    for _ in 0..40 {
        let y: Vec<f64> = x.iter().map(|x| section(*x) + 0.4 * noise.normal()).collect();
        let spline = fitted(&basis, &x, &y, Smoothing::Gcv);
        errors += mean(places.iter().map(|x| (spline.value(*x) - section(*x)).powi(2)));
        foretold += mean(places.iter().map(|x| spline.sd(*x, 0).powi(2)));
    }
    let ratio = (foretold / errors).sqrt();
    assert!((ratio - 1.0).abs() < 0.15, "{ratio}");
}

#[test]
fn a_gap_is_bridged_and_known_less_well() {
    let (basis, mut noise) = (around(36), Noise(31));
    // 50° of the section hidden: 5 intervals without a datum.
    let hidden = 2.0..2.0 + 5.0 * TAU / 36.0;
    let x: Vec<f64> = directions(200).into_iter().filter(|x| !hidden.contains(x)).collect();
    let y: Vec<f64> = x.iter().map(|x| section(*x) + 0.1 * noise.normal()).collect();
    let spline = fitted(&basis, &x, &y, Smoothing::Gcv);
    let middle = 0.5 * (hidden.start + hidden.end);
    // The bridge is a thin beam: it misses the true curve by more than the noise alone explains.
    let missed = (spline.value(middle) - section(middle)).abs();
    assert!(missed < 1.0 && missed < 5.0 * spline.sd(middle, 0), "{missed}");
    assert!(spline.sd(middle, 0) > 4.0 * spline.sd(0.0, 0), "{}", spline.sd(middle, 0));
    let plain = fitted(&basis, &x, &y, Smoothing::None);
    assert!((plain.value(0.3) - section(0.3)).abs() < 0.3 && plain.value(middle).is_finite());
    assert!(plain.sd(middle, 0) > spline.sd(middle, 0));
    // Half a turn without data, and fewer data than coefficients.
    let few: Vec<f64> = (0..10).map(|i| 0.3 * f64::from(i)).collect();
    let y: Vec<f64> = few.iter().map(|x| section(*x)).collect();
    for smoothing in [Smoothing::None, Smoothing::Gcv, Smoothing::Fixed(1e-3)] {
        let spline = fitted(&basis, &few, &y, smoothing);
        assert!(spline.coefficients.iter().all(|c| c.is_finite()), "{smoothing:?}");
        assert!(spline.rms < 0.3, "{smoothing:?}: {}", spline.rms);
    }
}

#[test]
fn an_interpolation_does_not_know_its_error() {
    for count in [12, 17, 20] {
        let (x, mut noise) = (directions(count), Noise(count as u64));
        let y: Vec<f64> = x.iter().map(|x| section(*x) + noise.normal()).collect();
        let spline = fitted(&around(24), &x, &y, Smoothing::None);
        assert!(spline.rms < 1e-3 && spline.sigma == f64::INFINITY, "{count}: {}", spline.sigma);
        assert_eq!(spline.sd(1.0, 0), f64::INFINITY);
    }
}

#[test]
fn gcv_does_not_interpolate_where_it_could() {
    // With more coefficients than data the score of an interpolation is 0 over 0.
    for seed in 0..40 {
        let (basis, x, mut noise) = (around(40), directions(32), Noise(seed));
        let y: Vec<f64> = x.iter().map(|x| section(*x) + 0.5 * noise.normal()).collect();
        let spline = fitted(&basis, &x, &y, Smoothing::Gcv);
        assert!(spline.edf <= 0.9 * 32.0 && spline.lambda > 1e-6, "{seed}: {}", spline.lambda);
        assert!(spline.sigma > 0.1, "{seed}: {}", spline.sigma);
    }
}

#[test]
fn the_order_of_the_data_does_not_matter() {
    let x = directions(40);
    let y: Vec<f64> = x.iter().map(|x| section(*x)).collect();
    let backwards = |values: &[f64]| values.iter().rev().copied().collect::<Vec<_>>();
    let one = fitted(&around(12), &x, &y, Smoothing::Gcv);
    let other = fitted(&around(12), &backwards(&x), &backwards(&y), Smoothing::Gcv);
    assert!((one.value(2.0) - other.value(2.0)).abs() < 1e-9);
}

#[test]
fn a_datum_of_weight_zero_says_nothing() {
    let (basis, x) = (around(12), directions(40));
    let y: Vec<f64> = x.iter().map(|x| section(*x)).collect();
    let (mut weights, mut wild) = (vec![1.0; 40], y.clone());
    (weights[7], wild[7]) = (0.0, 1e6);
    let without: Vec<usize> = (0..40).filter(|i| *i != 7).collect();
    let pick = |values: &[f64]| without.iter().map(|i| values[*i]).collect::<Vec<_>>();
    let one = fit(&basis, &x, &wild, &weights, Smoothing::Gcv).unwrap();
    let other = fitted(&basis, &pick(&x), &pick(&y), Smoothing::Gcv);
    assert!((one.value(1.0) - other.value(1.0)).abs() < 1e-9);
    assert!((one.sigma - other.sigma).abs() < 1e-9 && (one.r2 - other.r2).abs() < 1e-9);
}

#[test]
fn data_that_cannot_be_fitted_are_refused_with_their_figures() {
    let basis = Basis::uniform_clamped(0.0, 1.0, 4).unwrap();
    let (x, y, w) = ([0.0, 0.3, 0.6, 0.8, 1.0], [1.0; 5], [1.0; 5]);
    let refused =
        |x: &[f64], y: &[f64], w: &[f64], smoothing| fit(&basis, x, y, w, smoothing).unwrap_err();
    let plain = Smoothing::None;
    assert_eq!(refused(&x, &y[..4], &w, plain), FitFault::LengthsDiffer { x: 5, y: 4, weights: 5 });
    assert_eq!(
        refused(&x, &[1.0, f64::NAN, 1.0, 1.0, 1.0], &w, plain),
        FitFault::NotFinite { index: 1 }
    );
    assert_eq!(
        refused(&x, &y, &[1.0, 1.0, -2.0, 1.0, 1.0], plain),
        FitFault::NegativeWeight { index: 2, weight: -2.0 }
    );
    assert_eq!(
        refused(&[0.0, 0.3, 0.6, 0.8, 1.1], &y, &w, plain),
        FitFault::OutsideDomain { index: 4, x: 1.1, from: 0.0, to: 1.0 }
    );
    assert_eq!(
        refused(&x, &y, &[1.0, 1.0, 0.0, 0.0, 1.0], plain),
        FitFault::TooFewPlaces { found: 3, needed: 4 }
    );
    assert_eq!(refused(&[0.5; 5], &y, &w, plain), FitFault::TooFewPlaces { found: 1, needed: 4 });
    assert_eq!(refused(&x, &y, &w, Smoothing::Fixed(-1.0)), FitFault::BadLambda { lambda: -1.0 });
}
