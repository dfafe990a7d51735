//! Feature points: where they must be, the laws they obey, and that noise neither moves nor makes
//! them.

#![allow(clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};

use gaiter_leg::features::feature::{Feature, Kind, features};
use gaiter_leg::method::SectionFit;
use gaiter_leg::sections::plane_frame::PlaneFrame;
use gaiter_leg::sections::section::{Curve, Section, girth};
use gaiter_leg::{Level, Method, Side, extract};
use gaiter_scan::Format;
use gaiter_spline::{Basis, Smoothing, fit};
use nalgebra::{Point2, Point3, Vector3};
use proptest::prelude::*;
use support::noise::{Fate, quantile, roughened};
use support::recorded;
use support::solids::{Tube, all, ellipse, near, off_deg};

/// The floor, across a leg that stands upright.
fn plane() -> PlaneFrame {
    PlaneFrame::new(Point3::origin(), &Vector3::z(), Side::Left)
}

/// A section of this radius, mm over radians, known without error.
pub fn section(radius: impl Fn(f64) -> f64) -> Section {
    let basis = Basis::uniform_periodic(-PI, TAU, 72).unwrap();
    let angles: Vec<f64> = (0..720).map(|i| -PI + TAU * f64::from(i) / 720.0).collect();
    let radii: Vec<f64> = angles.iter().map(|angle| radius(*angle)).collect();
    let spline = fit(&basis, &angles, &radii, &[1.0; 720], Smoothing::None).unwrap();
    let curve = Curve::Periodic { basis, coefficients: spline.coefficients };
    Section {
        along_mm: 100.0,
        height_mm: 100.0,
        centre: Point2::origin(),
        girth: girth(&curve).unwrap(),
        curve,
        girth_sd: None,
        wave_sd_mm: None,
        points: angles.len(),
        r2: 1.0,
        rms_mm: 0.0,
        largest_gap_deg: 0.5,
    }
}

pub fn found(radius: impl Fn(f64) -> f64) -> Vec<Feature> {
    features(&plane(), &section(radius))
}

/// The radius of |x / a|ⁿ + |y / b|ⁿ = 1, x to the front.
pub fn superellipse(n: f64, a: f64, b: f64) -> impl Fn(f64) -> f64 {
    move |angle: f64| {
        ((angle.cos() / a).abs().powf(n) + (angle.sin() / b).abs().powf(n)).powf(-1.0 / n)
    }
}

/// Kinds and angles must be these, in order around from the front.
#[track_caller]
pub fn check(found: &[Feature], expected: &[(Kind, f64)], tolerance_deg: f64) {
    assert_eq!(found.len(), expected.len(), "{found:#?}");
    for (feature, (kind, angle_deg)) in found.iter().zip(expected) {
        assert_eq!(feature.kind, *kind, "{feature:?}");
        let off = off_deg(feature.angle_deg, *angle_deg);
        assert!(off <= tolerance_deg, "{feature:?} is not at {angle_deg}°");
    }
}

#[test]
fn an_ellipse_has_four_points_at_its_axes_with_the_curvatures_of_an_ellipse() {
    let (long, short) = (55.0, 43.0);
    let around = ellipse(long, short);
    // Turned by 10° so that no point lies at the front, where the order begins.
    let features = found(|angle| around(angle - 10_f64.to_radians(), 0.0));
    use Kind::{Peak, Valley};
    check(&features, &[(Peak, 10.0), (Valley, 100.0), (Peak, 190.0), (Valley, 280.0)], 0.01);
    let (tip, side) = (long / short.powi(2), short / long.powi(2));
    for feature in &features {
        let expected = if feature.kind == Peak { tip } else { side };
        near(feature.curvature_per_mm, expected, 0.02 * expected, "curvature");
        near(feature.prominence_per_mm, tip - side, 0.03 * (tip - side), "prominence");
    }
}

#[test]
fn a_rounded_square_has_its_corners_and_one_flat_on_each_side() {
    let turned = |angle: f64| angle - 20_f64.to_radians();
    let eight: Vec<(Kind, f64)> = (0..4)
        .map(|corner| 20.0 + 90.0 * f64::from(corner))
        .flat_map(|side| [(Kind::Valley, side), (Kind::Peak, side + 45.0)])
        .collect();
    for n in [3.0, 4.0, 8.0] {
        let radius = superellipse(n, 45.0, 45.0);
        check(&found(|angle| radius(turned(angle))), &eight, 0.1);
    }
}

#[test]
fn a_circle_about_another_centre_has_no_point() {
    for (radius_mm, off_mm) in [(30.0_f64, 0.0), (50.0, 0.0), (50.0, 4.0), (90.0, 8.0)] {
        let radius = |angle: f64| {
            off_mm * angle.cos() + (radius_mm.powi(2) - (off_mm * angle.sin()).powi(2)).sqrt()
        };
        assert_eq!(found(radius), [], "radius {radius_mm}, {off_mm} off");
    }
}

#[test]
fn a_ridge_too_fine_for_a_leg_is_no_point_and_a_broad_one_is() {
    // Twelve waves around a calf are 25 mm apart: clothing, folds, noise.
    assert_eq!(found(|angle| 50.0 + 0.3 * (12.0 * angle).cos()), []);
    assert_eq!(found(|angle| 50.0 + 0.8 * (4.0 * angle).cos()).len(), 8);
}

/// Radius over angle and distance along.
type Radius<'a> = &'a dyn Fn(f64, f64) -> f64;

#[test]
fn noise_alone_makes_no_point() {
    let (ellipse, square) = (ellipse(40.0, 31.0), superellipse(4.0, 45.0, 45.0));
    let circle = |_: f64, _: f64| 45.0;
    let square = |angle: f64, _: f64| square(angle);
    let shapes: [(Radius, usize); 3] = [(&circle, 0), (&ellipse, 4), (&square, 8)];
    for ((radius, count), noise_mm) in
        shapes.into_iter().flat_map(|shape| [0.3, 1.0, 1.5].map(|noise_mm| (shape, noise_mm)))
    {
        let tube = Tube { noise_mm, is_scattered: true, columns: 48, ..Tube::upright(radius) };
        let sections = tube.sections(SectionFit::Skin);
        for section in all(&sections) {
            let found = features(&sections.axis.plane(section.along_mm), section);
            assert_eq!(found.len(), count, "{noise_mm} mm, at {} mm", section.along_mm);
        }
    }
    // A plane's own crossings are few: what noise makes of them must be told from their residuals.
    let tube = Tube { noise_mm: 1.0, is_scattered: true, columns: 48, ..Tube::upright(&ellipse) };
    let sections = tube.sections(SectionFit::Periodic);
    let more =
        |section: &&Section| features(&sections.axis.plane(section.along_mm), section).len() > 4;
    let invented = all(&sections).into_iter().filter(more).count();
    assert!(invented * 50 <= sections.rows.len(), "{invented} sections have invented points");
}

#[test]
fn the_standard_error_tells_how_far_noise_moves_a_point() {
    // A bump along a part of the leg, so that the fit cannot smooth everything along.
    let shape = |angle: f64, along: f64| {
        let bump = ((angle - 1.5) / 0.5).powi(2) + ((along - 300.0) / 60.0).powi(2);
        45.0 + 3.0 * (2.0 * (angle - 0.3)).cos() + 4.0 * (-bump).exp()
    };
    let sections = |noise_mm: f64, seed: u64| {
        let tube = Tube { noise_mm, seed, is_scattered: true, ..Tube::upright(&shape) };
        tube.sections(SectionFit::Skin)
    };
    let exact = sections(0.0, 1);
    let mut fate = Fate::default();
    for seed in 2..=4 {
        let noisy = sections(1.0, seed);
        for (before, after) in all(&exact).into_iter().zip(all(&noisy)) {
            let [from, to] = [(&exact, before), (&noisy, after)]
                .map(|(s, at)| features(&s.axis.plane(at.along_mm), at));
            fate.add(before, &from, &to);
        }
    }
    assert!(fate.moved_mm.len() > 1000, "{}", fate.moved_mm.len());
    // 0.68 of normal errors lie within one standard error. The smallest known girth error is taken
    // for noise too, so figures may be too careful, but not by much.
    let within = quantile(&fate.moved_sd, 0.68);
    assert!((0.3..1.2).contains(&within), "68 % move by up to {within} standard errors");
}

proptest! {
    #[test]
    fn points_turn_mirror_and_grow_with_their_section(
        waves in proptest::collection::vec((-2.0..2.0_f64, -PI..PI), 4),
        steps in 0..24_i32,
        k in 0.5..2.0_f64,
    ) {
        let radius = |angle: f64| {
            let wave = |(n, (size, at)): (usize, &(f64, f64))| size * ((n + 2) as f64 * (angle - at)).cos();
            50.0 + waves.iter().enumerate().map(wave).sum::<f64>()
        };
        let plain = found(radius);
        let turn = 15.0 * f64::from(steps);
        let turned = found(|angle| radius(angle - turn.to_radians()));
        let mirrored = found(|angle| radius(-angle));
        let grown = found(|angle| k * radius(angle));
        same(&plain, &turned, |angle_deg| angle_deg + turn, 1.0)?;
        same(&plain, &mirrored, |angle_deg| -angle_deg, 1.0)?;
        same(&plain, &grown, |angle_deg| angle_deg, k)?;
        for (before, after) in plain.iter().zip(&grown) {
            let (p, q) = (before.position.xy() * k, after.position.xy());
            prop_assert!((p - q).norm() < 1e-6, "{p} {q}");
        }
    }

    #[test]
    fn points_go_around_from_the_front_peaks_and_valleys_by_turns_and_lie_on_the_skin(
        waves in proptest::collection::vec((-2.0..2.0_f64, -PI..PI), 6),
    ) {
        let section = section(|angle: f64| {
            let wave = |(n, (size, at)): (usize, &(f64, f64))| size * ((n + 2) as f64 * (angle - at)).cos();
            50.0 + waves.iter().enumerate().map(wave).sum::<f64>()
        });
        let features = features(&plane(), &section);
        let order: Vec<f64> = features.iter().map(|f| f.angle_deg.rem_euclid(360.0)).collect();
        prop_assert!(order.is_sorted(), "{order:?}");
        let mean = TAU / section.girth.contour_mm;
        for (index, feature) in features.iter().enumerate() {
            let next = &features[(index + 1) % features.len()];
            prop_assert_ne!(feature.kind, next.kind);
            let above = feature.curvature_per_mm - next.curvature_per_mm;
            prop_assert_eq!(above > 0.0, feature.kind == Kind::Peak);
            prop_assert!(above.abs() >= feature.prominence_per_mm);
            prop_assert!(feature.prominence_per_mm >= 0.25 * mean);
            let skin = section.point(&plane(), feature.angle_deg.to_radians());
            prop_assert!((feature.position - skin).norm() < 1e-9);
        }
    }
}

/// Both must be the same points, the second's angles turned and its lengths grown.
fn same(
    plain: &[Feature],
    other: &[Feature],
    turned: impl Fn(f64) -> f64,
    grown: f64,
) -> Result<(), TestCaseError> {
    prop_assert_eq!(plain.len(), other.len());
    for feature in plain {
        let angle_deg = turned(feature.angle_deg);
        let off = |f: &&Feature| off_deg(f.angle_deg, angle_deg);
        let near = other.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
        prop_assert!(off(&near) < 1e-5, "{} is not at {}", near.angle_deg, angle_deg);
        prop_assert_eq!(near.kind, feature.kind);
        let unlike = |a: f64, b: f64| (a - b * grown).abs() * 50.0;
        prop_assert!(unlike(feature.curvature_per_mm, near.curvature_per_mm) < 1e-6);
        prop_assert!(unlike(feature.prominence_per_mm, near.prominence_per_mm) < 1e-6);
    }
    Ok(())
}

/// The noise that must not matter, standard deviation along the normals, mm.
const NOISE_MM: f64 = 0.3;

/// How far it may move a point in the median, mm: 6 mm would be usable still.
const MOVED_MAX_MM: f64 = 2.0;

/// The share of points that may vanish under it, and that of those that may be invented.
const UNMATCHED_MAX: f64 = 0.1;

#[test]
fn points_of_recorded_bodies_stay_where_they_are_when_the_scanner_scatters_more() {
    let mut fates: Vec<(Level, Fate)> = Level::SOUGHT.map(|level| (level, Fate::default())).into();
    for name in ["f_average_clean", "m_average_clean", "f_average_tc2"] {
        let scan = recorded::scan(name);
        let first = extract(&recorded::export(name), Format::Obj, &Method::default()).unwrap();
        for seed in 1..=3 {
            let noisy = roughened(&scan, NOISE_MM / first.body.unit.in_mm(), seed);
            let again = recorded::extract_scan(&noisy, &Method::default()).unwrap();
            for (before, after) in first.legs.iter().zip(&again.legs) {
                for (level, fate) in &mut fates {
                    let at = |leg: &gaiter_leg::LegReport| {
                        leg.level_sections.iter().find(|at| at.level == *level).cloned().unwrap()
                    };
                    let (before, after) = (at(before), at(after));
                    fate.add(&before.section, &before.features, &after.features);
                }
            }
        }
    }
    let mut firm = Fate::default();
    for (level, fate) in &fates {
        let moved_mm = quantile(&fate.moved_mm, 0.5);
        assert!(fate.counts[0] >= 4 * fate.labels[1], "{level:?}: {:?}", fate.counts);
        assert!(moved_mm < MOVED_MAX_MM, "{level:?}: {moved_mm} mm");
        // B1 is a place of a slope, not of a shape: nothing there need be firm.
        if *level != Level::B1 {
            firm.join(fate);
        }
    }
    let (vanished, invented) = (firm.vanished(), firm.invented());
    assert!(vanished <= UNMATCHED_MAX, "{vanished} of the points vanish");
    assert!(invented <= UNMATCHED_MAX, "{invented} of the points are invented");
}
