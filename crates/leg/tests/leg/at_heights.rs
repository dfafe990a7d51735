//! Girths at heights that a person asked for.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::f64::consts::TAU;

use gaiter_leg::doubt::Doubt;
use gaiter_leg::levels::at_height::{AtHeight, HeightGirth, NoGirth, at_heights};
use gaiter_leg::method::SectionFit;
use gaiter_leg::{Extraction, Finding, Landmark, Level, Method, Side, What};
use nalgebra::{Point3, Vector3};
use support::recorded::export;
use support::solids::{Tube, curve_of, near, off_deg};

use crate::found::extraction_of;

fn at(tube: &Tube, heights_mm: &[f64]) -> Vec<AtHeight> {
    let sections = tube.sections(SectionFit::Skin);
    at_heights(&curve_of(&sections), heights_mm, &sections)
}

#[track_caller]
fn girth(at: &AtHeight) -> &HeightGirth {
    at.found.as_ref().unwrap()
}

#[test]
fn a_cone_has_the_girth_of_its_radius_at_every_height_asked_for_in_the_order_asked() {
    let radius = |_: f64, along: f64| 30.0 + 0.05 * along;
    let heights = [500.0, 100.0, 103.7, 100.0, 249.9];
    let found = at(&Tube::upright(&radius), &heights);
    assert_eq!(found.iter().map(|at| at.height_mm).collect::<Vec<_>>(), heights);
    for found in &found {
        let expected = TAU * radius(0.0, found.height_mm);
        near(girth(found).along_mm, found.height_mm, 0.01, "along");
        near(girth(found).girth_tape_mm, expected, 0.02, "tape");
        near(girth(found).girth_contour_mm, expected, 0.02, "contour");
        assert!(girth(found).girth_sd_mm < 0.2 && girth(found).doubts.is_empty(), "{found:?}");
    }
}

#[test]
fn a_height_is_that_of_the_section_s_centre_on_a_tilted_leg() {
    let radius = |_: f64, along: f64| 30.0 + 0.05 * along;
    let direction = Vector3::new(0.14, -0.08, 1.0);
    let foot = Point3::new(90.0, -20.0, 0.0);
    let upright = direction.normalize().z;
    for found in at(&Tube { direction, foot, ..Tube::upright(&radius) }, &[100.0, 333.3, 600.0]) {
        let along_mm = found.height_mm / upright;
        near(girth(&found).along_mm, along_mm, 0.2, "along");
        near(girth(&found).girth_tape_mm, TAU * radius(0.0, along_mm), 0.1, "tape");
    }
}

#[test]
fn what_was_not_seen_has_no_girth_and_a_gap_is_a_doubt() {
    let hole = |angle: f64, along: f64| {
        let wide = match along {
            300.0..380.0 => 170.0,
            500.0..560.0 => 40.0,
            _ => 0.0,
        };
        off_deg(angle.to_degrees(), 30.0) < wide / 2.0
    };
    let tube = Tube { columns: 360, hole: &hole, ..Tube::upright(&|_, _| 50.0) };
    let found = at(&tube, &[250.0, 340.0, 530.0, 30.0, 900.0]);
    assert!(girth(&found[0]).doubts.is_empty());
    assert_eq!(found[1].found, Err(NoGirth::NotSeen));
    let [Doubt::Gap { gap_deg }] = girth(&found[2]).doubts[..] else { panic!("{found:?}") };
    near(gap_deg, 40.0, 2.0, "gap");
    for outside in &found[3..] {
        let Err(NoGirth::Outside { from_mm, to_mm }) = outside.found else { panic!("{outside:?}") };
        near(from_mm, 60.0, 5.1, "above the foot");
        near(to_mm, 715.0, 5.1, "below the crotch");
    }
}

#[test]
fn at_the_height_of_a_level_the_girth_is_the_level_s() {
    let plain = extraction_of(&export("f_average_clean"), &Method::default());
    let across = |of: &Extraction| -> Vec<Landmark> {
        let landmarks = of.legs[0].landmarks.iter();
        landmarks.filter(|at| Level::SOUGHT.contains(&at.level)).cloned().collect()
    };
    let levels: Vec<f64> = across(&plain).iter().map(|at| at.height_mm).collect();
    let method = Method { at_heights_mm: levels, ..Method::default() };
    let found = extraction_of(&export("f_average_clean"), &method);
    let leg = &found.legs[0];
    assert_eq!(leg.landmarks, plain.legs[0].landmarks, "asking changes nothing else");
    for (found, level) in leg.at.iter().zip(&across(&found)) {
        near(girth(found).along_mm, level.along_mm, 1e-6, level.level.name());
        near(girth(found).girth_tape_mm, level.girth_tape_mm, 1e-6, level.level.name());
        near(girth(found).girth_contour_mm, level.girth_contour_mm, 1e-6, level.level.name());
    }
    assert_eq!(leg.at.len(), 4);
}

#[test]
fn a_height_that_no_leg_has_is_a_finding_of_each_leg() {
    let method = Method { at_heights_mm: vec![200.0, 900.0], ..Method::default() };
    let found = extraction_of(&export("f_average_clean"), &method);
    let is_missing = |of: &&Finding| matches!(of.what, What::HeightNotMeasured { .. });
    let missing: Vec<&Finding> = found.findings.iter().filter(is_missing).collect();
    let sides: Vec<_> = missing.iter().map(|finding| finding.side).collect();
    assert_eq!(sides, Side::BOTH.map(Some));
    let What::HeightNotMeasured { height_mm, why: NoGirth::Outside { from_mm, to_mm } } =
        missing[0].what
    else {
        panic!("{missing:?}")
    };
    assert!(
        height_mm == 900.0 && from_mm < 100.0 && (600.0..900.0).contains(&to_mm),
        "{missing:?}"
    );
    for leg in &found.legs {
        let [seen, none] = &leg.at[..] else { panic!("{:?}", leg.at) };
        assert!(girth(seen).doubts.is_empty());
        assert_eq!(none.height_mm, 900.0);
        assert!(none.found.is_err());
    }
    assert_eq!(found.legs.len(), 2);
}
