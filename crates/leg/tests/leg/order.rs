//! What else a made-to-measure order asks for: the levels of knee and thigh and the lengths, on
//! tubes in place of legs, where they are closed forms.

#![allow(clippy::unwrap_used)]

use std::f64::consts::TAU;

use gaiter_leg::disturbance::Common;
use gaiter_leg::frame::body::{Body, FacingFrom};
use gaiter_leg::level::By;
use gaiter_leg::levels::landmark::{Estimate, Landmark};
use gaiter_leg::method::{LevelChoices, Unit};
use gaiter_leg::report::leg_report;
use gaiter_leg::sectioned_leg::sectioned_leg;
use gaiter_leg::side::Sides;
use gaiter_leg::{Crotch, CrotchFrom, Finding, LegReport, Level, Method, What};
use nalgebra::{Matrix4, Point2, Vector3};
use support::solids::{CROTCH_MM, STATURE_MM, Tube, near};

fn report(tube: &Tube, method: &Method) -> (LegReport, Vec<Finding>) {
    let leg = tube.leg();
    let body = Body {
        mesh: leg.mesh.clone(),
        is_whole: true,
        stature_mm: Some(STATURE_MM),
        scale_mm: STATURE_MM,
        tracking_scale_mm: STATURE_MM,
        scale_sd_share: 0.01,
        floor_doubt: None,
        floor_sd_mm: 0.0,
        shanks: Sides { left: Some(Point2::origin()), right: None },
        forward_mm: None,
        facing_deg: 0.0,
        facing_from: FacingFrom::Feet,
        is_mirror_checked: true,
        unit: Unit::Mm,
        unit_inferred: false,
        from_export: Matrix4::identity(),
    };
    let crotch = Crotch {
        height_mm: CROTCH_MM,
        sd_mm: 6.0,
        from: CrotchFrom::Saddle,
        touching_from_mm: None,
    };
    let sectioned = sectioned_leg(leg, &body, &crotch, method).unwrap();
    leg_report(sectioned, &body, &crotch, &Common::default(), method)
}

fn found(report: &LegReport, level: Level) -> &Landmark {
    report.landmarks.iter().find(|landmark| landmark.level == level).unwrap()
}

fn estimated(report: &LegReport, level: Level) -> &Estimate {
    report.estimates.iter().find(|estimate| estimate.level == level).unwrap()
}

fn below(distance_mm: f64) -> Method {
    let levels = LevelChoices { g_below_crotch_mm: distance_mm, ..LevelChoices::default() };
    Method { levels, ..Method::default() }
}

/// An upright cone, 0.05 mm wider with each mm.
fn cone(_: f64, along: f64) -> f64 {
    30.0 + 0.05 * along
}

#[test]
fn g_is_as_far_below_the_crotch_as_the_method_says() {
    for distance_mm in [20.0, 50.0, 100.0] {
        let (report, _) = report(&Tube::upright(&cone), &below(distance_mm));
        let g = found(&report, Level::G);
        near(g.height_mm, CROTCH_MM - distance_mm, 0.01, "height");
        near(g.girth_tape_mm, TAU * cone(0.0, CROTCH_MM - distance_mm), 0.1, "girth");
        assert_eq!(g.by, By::BelowCrotch { distance_mm });
        assert_eq!(g.doubts, []);
        // The girth is no better known than the crotch: 2π · 0.05 of its height's error.
        near(g.girth_of_level_sd_mm, TAU * 0.05 * g.height_sd_mm, 0.05, "standard error");
        assert!(report.level_sections.iter().any(|at| at.level == Level::G));
    }
}

#[test]
fn g_is_absent_without_a_word_where_the_leg_is_not_seen_that_high() {
    let hole = |_: f64, along: f64| along > 640.0;
    let (report, findings) =
        report(&Tube { hole: &hole, ..Tube::upright(&cone) }, &Method::default());
    assert!(report.landmarks.iter().all(|landmark| landmark.level != Level::G));
    let about_g = |finding: &&Finding| finding.level == Some(Level::G);
    assert_eq!(findings.iter().filter(about_g).count(), 0, "{findings:?}");
}

#[test]
fn a_hole_at_g_is_a_doubt_about_it() {
    let hole = |angle: f64, along: f64| angle < 0.7 && (640.0..700.0).contains(&along);
    let (report, findings) =
        report(&Tube { hole: &hole, ..Tube::upright(&cone) }, &Method::default());
    let codes: Vec<&str> = found(&report, Level::G).doubts.iter().map(|d| d.code()).collect();
    assert_eq!(codes, ["gap"]);
    let doubted = |f: &Finding| f.level == Some(Level::G) && matches!(f.what, What::Doubtful(_));
    assert!(findings.iter().any(doubted));
}

#[test]
fn e_and_f_are_estimates_by_proportion_and_never_landmarks() {
    let (report, findings) = report(&Tube::upright(&cone), &Method::default());
    let (e_mm, g_mm) = (0.277 * STATURE_MM, CROTCH_MM - 50.0);
    let f_mm = (e_mm + g_mm) / 2.0;
    for (level, height_mm) in [(Level::E, e_mm), (Level::F, f_mm)] {
        let estimate = estimated(&report, level);
        near(estimate.height_mm, height_mm, 0.01, "height");
        near(estimate.girth_tape_mm, TAU * cone(0.0, height_mm), 0.1, "girth");
        assert!(report.landmarks.iter().all(|landmark| landmark.level != level));
        assert_eq!(estimate.doubts, []);
        assert!(findings.iter().all(|finding| finding.level != Some(level)), "{findings:?}");
    }
    let e = estimated(&report, Level::E);
    assert_eq!(e.by, By::StatureShare { share: 0.277 });
    // The spread of the share among people, and the stature's own error.
    assert!((25.0..30.0).contains(&e.height_sd_mm), "{}", e.height_sd_mm);
    assert_eq!(estimated(&report, Level::F).by, By::Between { low: Level::E, high: Level::G });
}

#[test]
fn a_tube_has_no_foot() {
    let (report, _) = report(&Tube::upright(&cone), &Method::default());
    assert_eq!(report.foot, None);
    let of_a_foot = |level: Level| level < Level::B;
    assert!(!report.landmarks.iter().any(|landmark| of_a_foot(landmark.level)));
    assert!(!report.estimates.iter().any(|estimate| of_a_foot(estimate.level)));
}

#[test]
fn only_b_b1_c_and_d_are_missed_where_they_are_absent() {
    let (_, findings) = report(&Tube::upright(&cone), &Method::default());
    let absent = findings.iter().filter(|f| matches!(f.what, What::LevelAbsent { .. }));
    let levels: Vec<Level> = absent.filter_map(|finding| finding.level).collect();
    assert_eq!(levels, Level::SOUGHT);
}

/// B1 and C of this wave are at 220 and 320 mm.
fn wave(_: f64, along: f64) -> f64 {
    45.0 - 8.0 * (TAU * (along - 120.0) / 400.0).cos()
}

#[test]
fn a_knee_that_would_lie_below_d_is_doubted_and_none_is_put_there() {
    // D is at 520 mm; the stature and D together would put E lower.
    let (report, _) = report(&Tube::upright(&wave), &Method::default());
    let d_mm = found(&report, Level::D).height_mm;
    assert!((0.277 * STATURE_MM + d_mm + 45.0) / 2.0 < d_mm, "{d_mm}");
    near(estimated(&report, Level::E).height_mm, d_mm, 0.01, "height of E");
    for level in [Level::E, Level::F] {
        let codes: Vec<&str> =
            estimated(&report, level).doubts.iter().map(|doubt| doubt.code()).collect();
        assert_eq!(codes, ["below-d"]);
    }
}

#[test]
fn the_surface_length_of_a_cone_is_that_of_its_side_and_the_way_down_to_the_floor() {
    let (report, _) = report(&Tube::upright(&cone), &Method::default());
    let lowest_mm = 0.035 * STATURE_MM;
    let side_mm = (CROTCH_MM - 50.0 - lowest_mm) * 1.0_f64.hypot(0.05);
    let length_mm = found(&report, Level::G).surface_length_mm.unwrap();
    near(length_mm, lowest_mm + side_mm, 0.1, "along the skin");
}

#[test]
fn the_surface_length_of_a_wave_is_its_arc() {
    let (report, _) = report(&Tube::upright(&wave), &Method::default());
    let lowest_mm = 0.035 * STATURE_MM;
    for level in [Level::B, Level::C, Level::D] {
        let landmark = found(&report, level);
        let steps = 10_000;
        let at =
            |i: i32| lowest_mm + (landmark.along_mm - lowest_mm) * f64::from(i) / f64::from(steps);
        let arc = (0..steps)
            .map(|i| (at(i + 1) - at(i)).hypot(wave(0.0, at(i + 1)) - wave(0.0, at(i))))
            .sum::<f64>();
        near(landmark.surface_length_mm.unwrap(), lowest_mm + arc, 0.2, level.name());
    }
}

#[test]
fn a_leaning_leg_is_longer_along_its_skin_than_it_is_high() {
    let round = |_: f64, _: f64| 50.0;
    let direction = Vector3::new(0.15, 0.0, 1.0);
    let upright = direction.normalize().z;
    let (report, _) = report(&Tube { direction, ..Tube::upright(&round) }, &Method::default());
    let g = found(&report, Level::G);
    // The medial line is parallel to the axis; below the lowest section it hangs straight down.
    let lowest_mm = 0.035 * STATURE_MM / upright;
    let medial_mm = lowest_mm * upright + 50.0 * direction.normalize().x;
    near(g.surface_length_mm.unwrap(), medial_mm + g.along_mm - lowest_mm, 0.3, "length");
    assert!(g.surface_length_mm.unwrap() > g.height_mm);
}
