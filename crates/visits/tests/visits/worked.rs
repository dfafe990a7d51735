//! Worked examples: percentages by their full names, cones and discs of records.

#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;

use gaiter_leg::Side;
use gaiter_leg::comparison::tape_volume::VolumeBy;
use gaiter_record::{Acquired, AcquiredFrom, Record};
use gaiter_visits::excess::NoReduction;
use gaiter_visits::schema::figures;
use gaiter_visits::threshold::{Limited, Threshold};
use gaiter_visits::{Affected, Choice, Course, Shown};
use serde_json::Value;

use crate::refusals::{PLAIN, at_day};
use crate::stance::CHOICE;

/// A record whose legs are cylinders of these girths, right and left, mm, at every length from 12 to 60 cm.
pub fn cylinders([right_mm, left_mm]: [f64; 2], day: i64) -> Record {
    let mut record = at_day(&PLAIN, day);
    for leg in &mut record.legs {
        let girth_mm = if leg.side == "left" { left_mm } else { right_mm };
        leg.along.retain(|at| (120.0..=600.0).contains(&at.along_axis_mm));
        for at in &mut leg.along {
            (at.girth_tape_mm, at.girth_sd_mm) = (Some(girth_mm), Some(0.1));
        }
    }
    record
}

/// The girth of a cylinder of this volume and of 48 cm length: C = √(4 π V / h).
pub fn girth_mm(ml: f64) -> f64 {
    (4.0 * std::f64::consts::PI * ml * 1000.0 / 480.0).sqrt()
}

/// The same leg can have a percent change of 8 % and a percent reduction of the excess of 35 %, as the means of
/// nine patients had (EWMA Journal 2014).
#[test]
fn percent_change_of_the_leg_and_percent_reduction_of_the_excess_are_different_figures() {
    // The other leg has 5000 mL. The swollen one has E₀ more and then 0.65 E₀, which is 8 % less of it:
    // 0.35 E₀ = 0.08 (5000 + E₀).
    let excess = 0.08 * 5000.0 / (0.35 - 0.08);
    let first = cylinders([5000.0, 5000.0 + excess].map(girth_mm), 0);
    let last = cylinders([5000.0, 5000.0 + 0.65 * excess].map(girth_mm), 30);
    let course = Course::comparable(&[first, last], named(Affected::One(Side::Left))).unwrap();
    let of = course.last_compared(&course.groups[0]).remove(0);
    let left = of.legs.left.as_ref().unwrap().volume.unwrap();
    assert!((left.percent + 8.0).abs() < 1e-3, "{left:?}");
    let change = of.excess.unwrap();
    assert_eq!(change.later.affected, Side::Left);
    assert!((change.earlier.ml.value - excess).abs() < 1e-3);
    assert!((change.reduction.unwrap().percent - 35.0).abs() < 1e-3, "{change:?}");
    assert!((change.earlier.percent - 100.0 * excess / 5000.0).abs() < 1e-3);
    let right = of.legs.right.as_ref().unwrap().volume.unwrap();
    assert!(right.by.abs() < 1e-6);
}

pub fn named(affected: Affected) -> Choice {
    Choice { affected: Some(affected), ..CHOICE }
}

#[test]
fn the_affected_leg_can_be_chosen_and_both_or_neither_have_no_excess() {
    let records = [cylinders([400.0, 420.0], 0), cylinders([400.0, 410.0], 30)];
    let excess = |affected: Affected| {
        let course = Course::comparable(&records, named(affected)).unwrap();
        course.last_compared(&course.groups[0]).remove(0).excess
    };
    let right = excess(Affected::One(Side::Right)).unwrap();
    assert!(right.earlier.ml.value < 0.0);
    assert_eq!(right.reduction, Err(NoReduction::SmallerLeg));
    assert!(excess(Affected::Both).is_none() && excess(Affected::Neither).is_none());
}

/// The left leg was the swollen one; treatment made it the smaller one before the first visit, and smaller still
/// after it. A guess would call the healthy right leg affected, with an excess that has grown.
#[test]
fn no_leg_is_guessed_to_be_affected_and_the_difference_is_told_with_its_sign() {
    let records = [cylinders([400.0, 395.0], 0), cylinders([400.0, 380.0], 30)];
    let course = Course::comparable(&records, CHOICE).unwrap();
    let group = &course.groups[0];
    let of = course.last_compared(group).remove(0);
    assert_eq!(of.excess, None);
    let difference = of.left_minus_right.unwrap();
    assert_eq!(difference.shown(), Shown::Smaller);
    let ml = |left_mm: f64| (left_mm.powi(2) - 400.0_f64.powi(2)) * 480.0 / (4e3 * PI);
    let found = [0, 1].map(|visit| course.left_minus_right(group, visit).unwrap().value);
    for (found, expected) in found.into_iter().zip([395.0, 380.0].map(ml)) {
        assert!((found - expected).abs() < 1e-6, "{found}, {expected} are true");
    }
    let json = serde_json::to_value(figures(&course, &[])).unwrap();
    assert_eq!(json["affected"], Value::Null);
    let compared = &json["comparisons"][0];
    assert_eq!((&compared["excess"], &json["visits"][0]["excess"]), (&Value::Null, &Value::Null));
    assert_eq!(compared["left_minus_right_ml"]["shown"], "smaller");
    assert_eq!(compared["left_minus_right_ml"]["percent_change"], Value::Null);
}

/// A healthy person, whose legs differ by little: no percent reduction of nothing.
#[test]
fn a_reduction_is_told_only_of_a_change_that_is_shown_and_the_json_says_why_not() {
    let records = [cylinders([400.0, 401.0], 0), cylinders([400.0, 400.98], 30)];
    let course = Course::comparable(&records, named(Affected::One(Side::Left))).unwrap();
    let excess = course.last_compared(&course.groups[0]).remove(0).excess.unwrap();
    assert!(excess.earlier.ml.value > excess.earlier.ml.expanded(), "{excess:?}");
    assert_eq!(excess.change.shown(), Shown::NoChange);
    assert_eq!(excess.reduction, Err(NoReduction::NoChange));
    let json = serde_json::to_value(figures(&course, &[])).unwrap();
    let told = &json["comparisons"][0]["excess"];
    assert_eq!(told["percent_reduction"], Value::Null);
    assert_eq!(told["no_percent_reduction"], "no-change-shown");
}

#[test]
fn an_affected_leg_that_is_the_smaller_one_reaches_no_threshold() {
    let records = [cylinders([400.0, 380.0], 0), cylinders([400.0, 380.0], 30)];
    let mild = Threshold {
        name: "mild".to_owned(),
        source: "a paper".to_owned(),
        of: Limited::Excess,
        limit: 3.0,
    };
    let reached = |affected: Affected| {
        let course = Course::comparable(&records, named(affected)).unwrap();
        let json = serde_json::to_value(figures(&course, std::slice::from_ref(&mild))).unwrap();
        json["comparisons"][0]["thresholds"][0]["reached"].clone()
    };
    assert_eq!(reached(Affected::One(Side::Left)), "not-reached");
    assert_eq!(reached(Affected::One(Side::Right)), "reached");
    assert_eq!(reached(Affected::Neither), Value::Null);
}

/// Discs take 13 of the girths, cones the 12 pieces between them; a cylinder has the same volume a piece.
#[test]
fn cones_and_discs_of_cylinders_are_the_cylinder() {
    let records = [cylinders([400.0, 400.0], 0), cylinders([400.0, 400.0], 30)];
    let ml = |by: VolumeBy| {
        let choice = Choice { volume: Some(by), ..CHOICE };
        let course = Course::comparable(&records, choice).unwrap();
        let group = &course.groups[0];
        (course.volume(group, 0, Side::Left).unwrap().value, group.pieces.left.len())
    };
    let piece = 400.0_f64.powi(2) / (4.0 * std::f64::consts::PI) * 40.0 / 1000.0;
    for (by, pieces) in [(VolumeBy::Cones, 12), (VolumeBy::Discs, 13)] {
        let (found, count) = ml(by);
        assert_eq!(count, pieces, "{by:?}");
        assert!((found - pieces as f64 * piece).abs() < 1e-6, "{by:?}: {found}");
    }
}

#[test]
fn visits_stand_in_the_order_of_their_times_also_if_they_are_given_in_another() {
    let days = [60, 0, 30];
    let records = days.map(|day| cylinders([400.0, 400.0 + day as f64], day));
    let course = Course::comparable(&records, CHOICE).unwrap();
    let order: Vec<usize> = course.visits.iter().map(|visit| visit.record).collect();
    assert_eq!(order, [1, 2, 0]);
    let compared = course.last_compared(&course.groups[0]);
    let pairs: Vec<[usize; 2]> = compared.iter().map(|of| [of.earlier, of.later]).collect();
    assert_eq!(pairs, [[0, 2], [1, 2]], "with the first, and with the one before");
}

#[test]
fn a_time_of_day_more_than_three_hours_apart_is_told_also_across_midnight() {
    let hours = |day: i64, time: &str, offset_min: i16| {
        let mut record = at_day(&cylinders([400.0; 2], 0), day);
        let at = time.parse().unwrap();
        let acquired = Acquired::new(at, AcquiredFrom::Press);
        record.acquired = Some(Acquired { utc_offset_min: Some(offset_min), ..acquired });
        record
    };
    let told = |one: Record, other: Record| {
        let course = Course::comparable(&[one, other], CHOICE).unwrap();
        let of = course.last_compared(&course.groups[0]).remove(0);
        of.cautions.iter().any(|caution| caution.code() == "time-of-day-differs")
    };
    let morning = || hours(0, "2026-01-08T08:00:00Z", 60);
    assert!(told(morning(), hours(30, "2026-02-08T11:01:00Z", 60)));
    assert!(!told(morning(), hours(30, "2026-02-08T10:59:00Z", 60)));
    let night = || hours(0, "2026-01-08T22:00:00Z", 60);
    assert!(!told(night(), hours(30, "2026-02-08T00:30:00Z", 60)));
    // 9:00 in winter is 9:00 in summer.
    assert!(!told(morning(), hours(180, "2026-07-08T07:00:00Z", 120)));
}
