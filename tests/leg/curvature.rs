//! Feature points of tubes whose curvature is a closed form.

#![allow(clippy::unwrap_used)]

use gaiter::leg::features::feature::{Feature, Kind, features};
use gaiter::leg::method::SectionFit;
use gaiter::leg::side::Side;
use nalgebra::{Point3, Vector3};
use support::geometry::solids::{
    REGULAR_MM, Tube, all, contour_mm, ellipse, near, off_deg, tape_mm,
};

#[test]
fn an_ellipse_is_most_curved_at_its_tips_and_least_at_its_sides() {
    let (long, short) = (60.0, 40.0);
    let shape = ellipse(long, short);
    let sections = Tube::of(&shape).sections(SectionFit::Periodic);
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
        let sections = Tube::of(&shape).sections(SectionFit::Periodic);
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
            Tube { side, foot, direction, ..Tube::of(&shape) }.sections(SectionFit::Periodic);
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
