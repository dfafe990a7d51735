//! Feature points where the curvature is known, and that each is where the curvature of its own turn has
//! its extreme.

#![allow(clippy::unwrap_used)]

use gaiter_leg::features::feature::{Feature, Kind, curvatures, features};
use gaiter_leg::method::SectionFit;
use gaiter_leg::side::Side;
use gaiter_leg::{LevelSection, Method, extract};
use gaiter_scan::Format;
use nalgebra::{Point3, Vector3};
use support::noise::{quantile, roughened};
use support::recorded;
use support::solids::{REGULAR_MM, Tube, all, contour_mm, ellipse, near, off_deg, tape_mm};

use super::features::{check, found, superellipse};

#[test]
fn an_ellipse_is_most_curved_at_its_tips_and_least_at_its_sides() {
    let (long, short) = (60.0, 40.0);
    let shape = ellipse(long, short);
    let sections = Tube::upright(&shape).sections(SectionFit::Periodic);
    for section in all(&sections) {
        let found = features(&sections.axis.plane(section.along_mm), section);
        let (tip, side) = (long / short.powi(2), short / long.powi(2));
        let expected = [
            (Kind::Peak, 0.0, tip),
            (Kind::Valley, 90.0, side),
            (Kind::Peak, 180.0, tip),
            (Kind::Valley, -90.0, side),
        ];
        // The tips of so long an ellipse have waves that are taken for too fine for a leg.
        check_features(&found, &expected, 0.05 * (tip - side));
    }
}

/// Features must be these in order around, a start at the front aside: kind, angle, curvature.
#[track_caller]
fn check_features(found: &[Feature], expected: &[(Kind, f64, f64)], tolerance_per_mm: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    let order: Vec<f64> = found.iter().map(|f| f.angle_deg.rem_euclid(360.0)).collect();
    assert!(order.is_sorted(), "P1, P2, … go around from the front: {order:?}");
    for &(kind, angle_deg, curvature) in expected {
        let off = |feature: &&Feature| off_deg(feature.angle_deg, angle_deg);
        let nearest = found.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
        assert!(off(&nearest) < 2.0, "nothing at {angle_deg}°: {found:?}");
        assert_eq!(nearest.kind, kind, "at {angle_deg}°");
        near(nearest.curvature_per_mm, curvature, tolerance_per_mm, "curvature");
    }
}

#[test]
fn a_superposed_cosine_has_as_many_peaks_and_valleys_as_waves_and_they_are_where_it_turns() {
    const TURN_DEG: f64 = 20.0;
    for (waves, amplitude) in [(2, 5.0), (3, 3.0), (3, 10.0), (4, 2.0), (5, 1.5)] {
        let (n, mean) = (f64::from(waves), 50.0);
        let radius = move |t: f64| mean + amplitude * (n * (t - TURN_DEG.to_radians())).cos();
        let shape = move |angle: f64, _: f64| radius(angle);
        let sections = Tube::upright(&shape).sections(SectionFit::Periodic);
        // Where r' is 0 the curvature is 1/r − r''/r²; waves count the less the finer they are.
        let curvature = |r: f64, bend: f64| 1.0 / r - bend / (r * r);
        let kept = amplitude / (1.0 + (n / 7.5).powi(6));
        let peak = curvature(mean + kept, -kept * n * n);
        let valley = curvature(mean - kept, kept * n * n);
        let half = 180.0 / n;
        let expected: Vec<_> = (0..waves)
            .map(|wave| TURN_DEG + 2.0 * half * f64::from(wave))
            .flat_map(|at| [(Kind::Peak, at, peak), (Kind::Valley, at + half, valley)])
            .collect();
        let (contour, tape) = (contour_mm(radius), tape_mm(radius));
        for section in all(&sections) {
            near(section.girth.contour_mm, contour, REGULAR_MM, "contour");
            near(section.girth.tape_mm, tape, REGULAR_MM, "tape");
            assert!(section.r2 > 0.9999, "R² {}", section.r2);
            let found = features(&sections.axis.plane(section.along_mm), section);
            check_features(&found, &expected, 0.02 * (peak - valley));
            for feature in &found {
                near(
                    feature.prominence_per_mm,
                    peak - valley,
                    0.02 * (peak - valley),
                    "prominence",
                );
            }
        }
    }
}

#[test]
fn left_and_right_legs_that_mirror_each_other_have_the_same_labels_and_angles() {
    let shape =
        |t: f64, _: f64| 50.0 + 3.0 * (2.0 * (t - 0.6)).cos() + 2.0 * (3.0 * (t - 0.3)).cos();
    let on = |side: Side| {
        let foot = Point3::new(120.0 * side.lateral_sign(), 30.0, 0.0);
        let direction = Vector3::new(0.12 * side.lateral_sign(), -0.05, 1.0);
        let sections =
            Tube { side, foot, direction, ..Tube::upright(&shape) }.sections(SectionFit::Periodic);
        let section = all(&sections)[60].clone();
        features(&sections.axis.plane(section.along_mm), &section)
    };
    let (left, right) = (on(Side::Left), on(Side::Right));
    assert!(left.len() >= 4, "{left:?}");
    assert_eq!(left.len(), right.len());
    for (l, r) in left.iter().zip(&right) {
        assert_eq!(l.kind, r.kind);
        near(l.angle_deg, r.angle_deg, 1e-6, "angle");
        near(l.curvature_per_mm, r.curvature_per_mm, 1e-9, "curvature");
        near(l.position.x, -r.position.x, 1e-6, "x");
        near(l.position.y, r.position.y, 1e-6, "y");
        near(l.position.z, r.position.z, 1e-6, "z");
        // 0° is the front, −y; 90° is lateral, which is +x on the left leg.
        let (sin, cos) = l.angle_deg.to_radians().sin_cos();
        let axis_x = 120.0 + 0.12 * l.position.z;
        assert!(sin.abs() < 0.3 || (l.position.x - axis_x) * sin > 0.0, "{l:?}");
        let axis_y = 30.0 - 0.05 * l.position.z;
        assert!(cos.abs() < 0.3 || (l.position.y - axis_y) * cos < 0.0, "{l:?}");
    }
}

/// Two waves and, over them, six of 0.25 mm that begin elsewhere: a peak and a valley have a second,
/// smaller bump or hollow of less than the least prominence. From κ = (r² + 2r'² − rr'') / (r² + r'²)^1.5
/// with derivatives by hand, waves of 6 reduced to 1 / (1 + (6 / 7.5)⁶): maxima at −9.00° (0.025424) and
/// 46.22° (0.022475), minima at 81.75° (0.012926) and 135.20° (0.017739), all again half a turn on.
fn two_bumps(angle: f64) -> f64 {
    50.0 + 3.0 * (2.0 * angle).cos() + 0.25 * (6.0 * (angle - 50_f64.to_radians())).cos()
}

#[test]
fn of_two_bumps_on_a_turn_the_greater_has_the_point() {
    use Kind::{Peak, Valley};
    let features = found(two_bumps);
    check(&features, &[(Valley, 81.75), (Peak, 171.0), (Valley, 261.75), (Peak, 351.0)], 0.05);
    for feature in &features {
        let expected = if feature.kind == Peak { 0.025424 } else { 0.012926 };
        near(feature.curvature_per_mm, expected, 1e-5, "curvature");
    }
    // Mirrored, and the other way round the seam at the back.
    check(
        &found(|angle| two_bumps(-angle)),
        &[(Peak, 9.0), (Valley, 98.25), (Peak, 189.0), (Valley, 278.25)],
        0.05,
    );
    let turned = found(|angle| two_bumps(angle - 98.3_f64.to_radians()));
    check(&turned, &[(Valley, 0.05), (Peak, 89.3), (Valley, 180.05), (Peak, 269.3)], 0.05);
}

#[test]
fn a_section_turned_by_a_part_of_a_degree_has_its_points_turned_by_that_part() {
    // The curvature is taken at every degree; between them a place is good to 0.07 of one.
    let plain = found(two_bumps);
    for turn_deg in [0.1, 0.25, 0.5, 0.77, 7.3, 41.9] {
        let turned = found(|angle| two_bumps(angle - f64::to_radians(turn_deg)));
        assert_eq!(turned.len(), plain.len());
        for point in &plain {
            let moved = turned.iter().map(|of| off_deg(of.angle_deg, point.angle_deg + turn_deg));
            let nearest = moved.fold(f64::INFINITY, f64::min);
            assert!(nearest < 0.07, "{point:?} by {turn_deg}°: {nearest}");
        }
    }
}

#[test]
fn on_a_long_flat_side_that_the_curve_hollows_twice_the_point_is_in_a_hollow_and_not_between() {
    // Without fine waves the sides of |x / 60|⁴ + |y / 40|⁴ = 1 are hollow 16.85° from their middles,
    // with −0.1285 of the mean curvature 0.017829, and 0.0995 in the middle; the ends have one bottom.
    let features = found(superellipse(4.0, 60.0, 40.0));
    let valleys: Vec<_> = features.iter().filter(|feature| feature.kind == Kind::Valley).collect();
    assert_eq!((features.len(), valleys.len()), (8, 4), "{features:#?}");
    for (end, side) in [(0.0, 90.0), (180.0, -90.0)] {
        let nearest = |at: f64| {
            let off = |deg: f64| off_deg(deg, at);
            valleys.iter().min_by(|a, b| off(a.angle_deg).total_cmp(&off(b.angle_deg))).unwrap()
        };
        assert!(off_deg(nearest(end).angle_deg, end) < 0.05, "{:?}", nearest(end));
        let hollow = nearest(side);
        near(off_deg(hollow.angle_deg, side), 16.85, 0.1, "off the middle");
        near(hollow.curvature_per_mm, -0.1285 * 0.017829, 2e-5, "curvature");
    }
}

#[test]
fn on_recorded_bodies_each_point_has_the_extreme_curvature_of_its_own_turn() {
    let mut off = Vec::new();
    for name in ["f_average_clean", "m_average_clean", "f_average_tc2"] {
        let scan = recorded::scan(name);
        for noise_mm in [0.0, 0.5] {
            let first = extract(&recorded::export(name), Format::Obj, &Method::default()).unwrap();
            let noisy = roughened(&scan, noise_mm / first.body.unit.in_mm(), 1);
            let again = recorded::extract_scan(&noisy, &Method::default()).unwrap();
            for at in again.legs.iter().flat_map(|leg| &leg.level_sections) {
                let curvatures = curvatures(&at.section, 360);
                let mean = curvatures.iter().sum::<f64>() / 360.0;
                for index in 0..at.features.len() {
                    let turn = TurningPoint::new(at, index, &curvatures);
                    let short = (turn.extreme - turn.own) / mean;
                    let place = (name, noise_mm, at.level, index);
                    assert!(short < 0.01, "{place:?}: {short} of the mean curvature from it");
                    let told = at.features[index].curvature_per_mm * turn.sign;
                    assert!((told - turn.extreme).abs() < 1e-12, "{place:?}: {told}");
                    off.push(turn.off_deg);
                }
            }
        }
    }
    assert!(off.len() > 200, "{}", off.len());
    // Flat bottoms with a ripple aside.
    assert!(quantile(&off, 0.98) <= 1.0, "{}", quantile(&off, 0.98));
}

/// The curvatures between the points before and after one, positive towards its extreme.
struct TurningPoint {
    sign: f64,
    extreme: f64,
    /// At the point.
    own: f64,
    /// From the point to the extreme.
    off_deg: f64,
}

impl TurningPoint {
    fn new(at: &LevelSection, index: usize, curvatures: &[f64]) -> TurningPoint {
        let count = at.features.len();
        let [before, own, after] =
            [count - 1, 0, 1].map(|step| at.features[(index + step) % count]);
        let sign = if own.kind == Kind::Peak { 1.0 } else { -1.0 };
        let size = |index: usize| sign * curvatures[index % 360];
        let first = (before.angle_deg + 180.0).ceil() as usize;
        let length = (after.angle_deg - before.angle_deg).rem_euclid(360.0) as usize;
        let places = first..first + length;
        let most = places.max_by(|a, b| size(*a).total_cmp(&size(*b))).unwrap();
        let place = (own.angle_deg + 180.0).rem_euclid(360.0);
        let (below, part) = (place as usize, place.fract());
        TurningPoint {
            sign,
            extreme: size(most),
            own: size(below) * (1.0 - part) + size(below + 1) * part,
            off_deg: off_deg(most as f64 - 180.0, own.angle_deg),
        }
    }
}
