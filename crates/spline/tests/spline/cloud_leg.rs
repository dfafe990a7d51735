//! The fit of a cloud on the closed-form test leg: how near it comes, how much it smooths, what it
//! makes of outliers and holes.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::f64::consts::TAU;

use gaiter_spline::{
    Basis, CloudData, CloudFit, CloudMethod, CloudSmoothing, GridData, GridDomain, GridMethod,
    Knots, Surface, fit_cloud, fit_grid_by,
};
use nalgebra::Point3;
use support::cloud::{Faults, cloud};
use support::metric::{parameters, true_error};
use support::test_leg;

const NOISY: Faults = Faults { sigma_mm: 0.5, outliers: 0.0 };

/// The same surface with u from 0 to 1, as the metric wants it.
fn to_unit(surface: &Surface) -> Surface {
    let heights = surface.along().breakpoints();
    let along: Vec<f64> = heights.iter().map(|z| z / test_leg::HEIGHT_MM).collect();
    let control = surface.control_points().to_vec();
    Surface::new(Basis::clamped(&along).unwrap(), surface.around().clone(), control).unwrap()
}

/// Mean, RMS and largest distance in mm, and mean of distance over radius in percent.
fn error_of(fit: &CloudFit) -> [f64; 4] {
    true_error(&to_unit(&fit.surface))
}

/// The fit of points whose places around are their turns about the leg's centre line.
fn fitted_in(
    points: &[Point3<f64>],
    along: Basis,
    around: Basis,
    method: &CloudMethod,
) -> CloudFit {
    let turn = |point: &Point3<f64>| {
        let (cx, cy) = test_leg::center(point.z);
        (point.y - cy).atan2(point.x - cx) / TAU
    };
    let turns: Vec<f64> = points.iter().map(turn).collect();
    fit_cloud(&CloudData { points, around: &turns }, along, around, method).unwrap()
}

/// The fit with the knots of the surface through the leg's grid.
fn fitted(points: &[Point3<f64>], control_points: [usize; 2], knots: Knots) -> CloudFit {
    let grid = test_leg::grid();
    let (along, around) = parameters(&grid);
    let along: Vec<f64> = along.iter().map(|u| test_leg::HEIGHT_MM * u).collect();
    // The grid begins at 200°.
    let around: Vec<f64> = around.iter().map(|v| v + 200.0 / 360.0).collect();
    let data = GridData { along: &along, around: &around, points: &grid };
    let domain = GridDomain { along: [0.0, test_leg::HEIGHT_MM], around_from: 0.0, period: 1.0 };
    let method = GridMethod { control_points, knots, marks: [vec![], vec![]] };
    let like = fit_grid_by(&data, &domain, &method).unwrap().surface;
    fitted_in(points, like.along().clone(), like.around().clone(), &CloudMethod::default())
}

/// The fit with equal spans.
fn evenly_fitted(points: &[Point3<f64>], counts: [usize; 2], method: &CloudMethod) -> CloudFit {
    let along = Basis::uniform_clamped(0.0, test_leg::HEIGHT_MM, counts[0] - 3).unwrap();
    fitted_in(points, along, Basis::uniform_periodic(0.0, 1.0, counts[1]).unwrap(), method)
}

#[test]
fn a_noisy_cloud_gives_the_leg_to_eight_hundredths_of_a_percent() {
    for seed in [2, 3] {
        let fit = fitted(&cloud(100_000, NOISY, seed).points, [30, 24], Knots::Polished);
        let [mean, rms, max, percent] = error_of(&fit);
        println!("seed {seed}: mean {mean:.4} rms {rms:.4} max {max:.3} mm, {percent:.4} %");
        assert!(percent <= 0.066, "{percent}");
        assert!(max < 1.0, "{max}");
        assert!((fit.sigma_mm / 0.5 - 1.0).abs() < 0.03, "{}", fit.sigma_mm);
        assert!(fit.edf < 720.0, "{}", fit.edf);
    }
}

#[test]
fn outliers_cost_next_to_nothing_and_lose_all_their_weight() {
    for seed in [5, 6] {
        let cloud = cloud(100_000, Faults { outliers: 0.02, ..NOISY }, seed);
        let fit = fitted(&cloud.points, [30, 24], Knots::Polished);
        let [mean, rms, max, percent] = error_of(&fit);
        println!("seed {seed}: mean {mean:.4} rms {rms:.4} max {max:.3} mm, {percent:.4} %");
        assert!(percent <= 0.068, "{percent}");
        let weights = fit.weights.iter().zip(&cloud.outlier);
        let kept = weights.clone().filter(|(weight, outlier)| **outlier && **weight > 0.0).count();
        assert_eq!(kept, 0, "outliers believed");
        // Five standard deviations hold all but a few of 100 000 normal errors.
        let lost = weights.filter(|(weight, outlier)| !**outlier && **weight == 0.0).count();
        assert!(lost < 40, "{lost} good points lost");
    }
}

#[test]
fn without_noise_the_knots_say_how_near_the_surface_comes() {
    let exact = cloud(100_000, Faults { sigma_mm: 0.0, outliers: 0.0 }, 7).points;
    // The reference: .0270 mm with equal spans, .0089 mm with knots from an exact grid.
    for (knots, mean_mm) in [(Knots::Adaptive, 0.0125), (Knots::Polished, 0.0089)] {
        let [mean, rms, max, percent] = error_of(&fitted(&exact, [30, 24], knots));
        println!("{knots:?}: mean {mean:.4} rms {rms:.4} max {max:.3} mm, {percent:.4} %");
        assert!(mean < mean_mm, "{knots:?} {mean}");
    }
    let even = evenly_fitted(&exact, [30, 24], &CloudMethod::default());
    assert!((error_of(&even)[0] / 0.0270 - 1.0).abs() < 0.03);
}

#[test]
fn the_smoothing_chosen_is_as_good_as_any_picked_with_the_truth_in_sight() {
    for (count, sigma_mm) in [(50_000, 0.5), (10_000, 1.0)] {
        let points = cloud(count, Faults { sigma_mm, outliers: 0.0 }, 8).points;
        let with = |smoothing| {
            let method = CloudMethod { smoothing, robust: false, least_scale_mm: 0.3 };
            evenly_fitted(&points, [40, 32], &method)
        };
        let chosen = with(CloudSmoothing::Gcv);
        let by_choice = error_of(&chosen)[1];
        for along in [0.03, 1.0, 30.0] {
            for around in [0.03, 1.0, 30.0] {
                let lambdas = [along * chosen.lambdas[0], around * chosen.lambdas[1]];
                let rms = error_of(&with(CloudSmoothing::Fixed(lambdas)))[1];
                assert!(by_choice < 1.05 * rms, "{count}: {by_choice} {rms} {along} {around}");
            }
        }
        assert!(by_choice < 0.95 * error_of(&with(CloudSmoothing::None))[1]);
    }
}

/// Largest and root mean square horizontal error within 60° × 60 mm, of a fit of a noisy cloud that
/// has no points there, and of one that has.
fn in_patch(degrees: f64, z_mm: f64, holed: bool) -> [f64; 2] {
    let inside = |point: &Point3<f64>| {
        let (cx, cy) = test_leg::center(point.z);
        let turn = (point.y - cy).atan2(point.x - cx).to_degrees() - degrees;
        (turn + 180.0).rem_euclid(360.0) - 180.0
    };
    let inside = |point: &Point3<f64>| inside(point).abs() < 30.0 && (point.z - z_mm).abs() < 30.0;
    let mut points = cloud(100_000, NOISY, 9).points;
    points.retain(|point| !holed || !inside(point));
    let surface = fitted(&points, [30, 24], Knots::Polished).surface;
    let places = (0..60).flat_map(|i| (0..720).map(move |j| (f64::from(i), f64::from(j))));
    let places = places.map(|(i, j)| surface.point(z_mm - 29.5 + i, j / 720.0));
    let errors = places.filter(inside).map(|point| test_leg::outside_mm(&point).abs());
    let errors: Vec<f64> = errors.collect();
    assert!(errors.len() > 6000);
    let square = errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64;
    [errors.iter().copied().fold(0.0, f64::max), square.sqrt()]
}

#[test]
fn a_hole_of_sixty_degrees_and_sixty_millimetres_is_bridged() {
    // Over the malleolus nobody could know of its bump of 7 mm; at the shin of its edge.
    for (name, degrees, z_mm, max_mm) in [
        ("shin", 90.0, 200.0, 2.0),
        ("calf", 250.0, 250.0, 0.5),
        ("thigh", 20.0, 650.0, 0.5),
        ("ankle", 185.0, 70.0, 7.5),
    ] {
        let [[holed_max, holed_rms], [max, rms]] =
            [true, false].map(|holed| in_patch(degrees, z_mm, holed));
        println!("{name}: max {holed_max:.2} rms {holed_rms:.2}; with points {max:.2} {rms:.2} mm");
        assert!(holed_max < max_mm, "{name} {holed_max}");
    }
}
