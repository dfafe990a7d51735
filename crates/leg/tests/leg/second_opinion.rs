//! The scanner's own measures (`.ord`) against a body's: what is told, and what is not.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::sync::LazyLock;

use gaiter_leg::comparison::opinion::{Measure, SecondOpinion};
use gaiter_leg::comparison::second_opinion::compare;
use gaiter_leg::finding::Severity;
use gaiter_leg::{Extraction, Finding, Level, Method, Side, What, extract};
use gaiter_scan::Format;
use gaiter_scan::ord::Ord;
use support::recorded::export;

/// A body whose left calf is 46 mm larger than the right.
static BODY: LazyLock<Extraction> =
    LazyLock::new(|| extract(&export("f_average_tc2"), Format::Obj, &Method::default()).unwrap());

fn girth(side: usize, level: Level) -> f64 {
    let leg = &BODY.legs[side];
    leg.landmarks.iter().find(|landmark| landmark.level == level).unwrap().girth_tape_mm
}

fn told(measures: &[(&str, f64)]) -> Vec<Finding> {
    told_of(&BODY, measures)
}

fn told_of(body: &Extraction, measures: &[(&str, f64)]) -> Vec<Finding> {
    let measures = measures.iter().map(|(name, mm)| ((*name).to_owned(), *mm)).collect();
    compare(body, &Ord { measures })
}

fn codes(findings: &[Finding]) -> Vec<&'static str> {
    findings.iter().map(Finding::code).collect()
}

fn opinion(finding: &Finding) -> &SecondOpinion {
    let What::SecondOpinion(opinion) = &finding.what else { panic!("{finding:?}") };
    opinion
}

#[test]
fn measures_that_agree_are_not_mentioned() {
    let [l, r] = [0, 1].map(|leg| girth(leg, Level::C));
    let b = girth(0, Level::B);
    let stature = BODY.body.scale_mm;
    let all = [
        ("Head_Top_Height", stature * 1.019),
        ("Calf_Left", l + 14.9),
        ("Calf_Right", r - 14.9),
        ("Calf_Circ", r + 14.0),
        ("Ankle_Girth_Left", b - 9.0),
        ("Ankle_Girth_Right", b * 1.5),
        ("Calf_Height", 1.0),
        ("Thigh", 1.0),
    ];
    assert_eq!(told(&all), []);
    assert_eq!(told(&[]), []);
    assert_eq!(told(&[("Calf_Left", 0.0), ("Height", -1.0)]), [], "a zero was not taken");
}

#[test]
fn a_stature_in_another_unit_is_told_and_nothing_else_is_compared() {
    let stature = BODY.body.scale_mm;
    for factor in [2.54, 10.0, 25.4, 39.37, 100.0, 1000.0] {
        for theirs in [stature * factor * 1.015, stature / factor * 0.985] {
            let found = told(&[("Height", theirs), ("Calf_Left", girth(0, Level::C) / factor)]);
            assert_eq!(codes(&found), ["ord-unit"], "{factor}");
            assert_eq!(found[0].severity(), Severity::Warning);
            let What::SecondOpinion(SecondOpinion::Unit { factor: told, .. }) = found[0].what
            else {
                panic!("{found:?}")
            };
            assert_eq!(told, factor);
        }
    }
}

#[test]
fn a_stature_that_differs_otherwise_disagrees_and_the_rest_is_compared() {
    for share in [0.97, 1.03, 3.0] {
        let found = told(&[("Stature", BODY.body.scale_mm * share), ("Calf_Left", 300.0)]);
        assert_eq!(codes(&found), ["ord-disagrees", "ord-disagrees"], "{share}");
        assert_eq!((found[0].side, found[0].level), (None, None));
        assert_eq!((found[1].side, found[1].level), (Some(Side::Left), Some(Level::C)));
    }
}

#[test]
fn a_calf_beyond_15_mm_disagrees_on_its_own_side() {
    let right = girth(1, Level::C);
    for off in [15.5, -15.5] {
        let found = told(&[("RCalf", right + off)]);
        assert_eq!(codes(&found), ["ord-disagrees"]);
        assert_eq!((found[0].side, found[0].level), (Some(Side::Right), Some(Level::C)));
        let theirs_mm = right + off;
        let expected =
            SecondOpinion::Disagrees { measure: Measure::Calf, theirs_mm, ours_mm: right };
        assert_eq!(*opinion(&found[0]), expected);
    }
}

#[test]
fn a_calf_of_no_side_disagrees_only_where_it_fits_neither_leg() {
    let [l, r] = [0, 1].map(|leg| girth(leg, Level::C));
    assert_eq!(told(&[("Calf", l + 10.0)]), []);
    assert_eq!(told(&[("Calf", r - 10.0)]), []);
    let found = told(&[("Calf", (l + r) / 2.0)]);
    assert_eq!(codes(&found), ["ord-disagrees"]);
    assert_eq!((found[0].side, found[0].level), (None, Some(Level::C)));
    let SecondOpinion::Disagrees { ours_mm, .. } = *opinion(&told(&[("Calf", l + 20.0)])[0]) else {
        panic!("{found:?}")
    };
    assert_eq!(ours_mm, l, "the nearer leg's");
}

#[test]
fn an_ankle_lies_over_b_and_below_what_only_a_heel_has() {
    let b = girth(0, Level::B);
    for ankle in [b - 9.9, b, b * 1.3, b * 1.59] {
        assert_eq!(told(&[("Left_Ankle", ankle)]), [], "{ankle}");
    }
    for ankle in [b - 10.1, b * 1.61] {
        let found = told(&[("Left_Ankle", ankle)]);
        assert_eq!(codes(&found), ["ord-disagrees"], "{ankle}");
        assert_eq!((found[0].side, found[0].level), (Some(Side::Left), Some(Level::B)));
    }
}

#[test]
fn calves_that_each_fit_the_other_leg_doubt_the_sides_and_nothing_more_is_said_of_them() {
    let [l, r] = [0, 1].map(|leg| girth(leg, Level::C));
    for common in [-8.0, 0.0, 8.0] {
        let found = told(&[("CalfLeft", r + common), ("CalfRight", l + common)]);
        assert_eq!(codes(&found), ["ord-sides"], "{common}");
        assert_eq!(found[0].severity(), Severity::Error);
        assert_eq!((found[0].side, found[0].level), (None, None));
    }
}

#[test]
fn sides_are_not_doubted_on_one_calf_or_on_legs_that_are_nearly_alike() {
    let [l, r] = [0, 1].map(|leg| girth(leg, Level::C));
    // Only their left fits the other leg.
    assert_eq!(codes(&told(&[("CalfLeft", r), ("CalfRight", r)])), ["ord-disagrees"]);
    assert_eq!(codes(&told(&[("CalfLeft", r)])), ["ord-disagrees"]);
    // This body's calves differ by 13 mm: the noise of 5 mm of two programs cannot swap them.
    let clean = export("f_average_clean");
    let alike = extract(&clean, Format::Obj, &Method::default()).unwrap();
    let [a, b] = [0, 1].map(|leg: usize| {
        let levels = &alike.legs[leg].landmarks;
        levels.iter().find(|landmark| landmark.level == Level::C).unwrap().girth_tape_mm
    });
    assert!((b - a - 12.5).abs() < 0.5, "{a} {b}");
    assert_eq!(told_of(&alike, &[("CalfLeft", a + 10.0), ("CalfRight", b - 10.0)]), []);
    assert_eq!(codes(&told_of(&alike, &[("CalfLeft", b), ("CalfRight", a)])), ["ord-sides"]);
    assert!((l - r).abs() > 40.0);
}

#[test]
fn what_was_not_measured_here_is_not_compared() {
    let mut body = BODY.clone();
    body.legs.remove(0);
    body.legs[0].landmarks.retain(|landmark| landmark.level != Level::C);
    let theirs = [("CalfLeft", 100.0), ("CalfRight", 100.0), ("Calf", 100.0), ("LAnkle", 100.0)];
    assert_eq!(told_of(&body, &theirs), []);
}
