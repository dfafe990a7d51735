//! Records that are not compared, and visits that stand in groups of their own.

#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use gaiter_leg::Method;
use gaiter_leg::comparison::tape_volume::VolumeBy;
use gaiter_record::{Acquired, AcquiredFrom, Patient, Record};
use gaiter_visits::{Choice, Course, CourseFault};
use jiff::ToSpan;
use support::recorded::export;
use support::records::record_of;

use crate::stance::CHOICE;

/// A body's record without its shape.
pub static PLAIN: LazyLock<Record> = LazyLock::new(|| {
    let mut record = record_of(&export("m_average_clean"), &Method::default()).1;
    record.legs.iter_mut().for_each(|leg| leg.shape = None);
    record
});

/// A record of another scan, so many days after the first.
pub fn at_day(of: &Record, day: i64) -> Record {
    let mut record = of.clone();
    record.scan.sha256 = format!("{day:064x}");
    let first = "2026-01-08T08:00:00Z".parse::<jiff::Timestamp>().unwrap();
    let at = first + (24 * day).hours();
    record.acquired =
        Some(Acquired { utc_offset_min: Some(60), ..Acquired::new(at, AcquiredFrom::Press) });
    record
}

fn fault(records: &[Record]) -> CourseFault {
    Course::comparable(records, CHOICE).unwrap_err()
}

fn with_method(day: i64, key: &str, word: &str) -> Record {
    let mut record = at_day(&PLAIN, day);
    record.made_by.method.insert(key.to_owned(), word.to_owned());
    record
}

fn of_patient(day: i64, id: Option<&str>) -> Record {
    let mut record = at_day(&PLAIN, day);
    record.patient = id.map(|id| Patient { id: id.to_owned(), sources: Vec::new() });
    record
}

#[test]
fn a_comparison_needs_two_different_scans_of_one_patient() {
    let one = at_day(&PLAIN, 0);
    assert_eq!(fault(std::slice::from_ref(&one)), CourseFault::TooFew { found: 1 });
    let same = CourseFault::SameScan { first: 1, other: 2 };
    assert_eq!(fault(&[one.clone(), one.clone()]), same);
    let mut revised = one.clone();
    revised.revision = 2;
    assert_eq!(fault(&[one, revised]), same, "a revision is no other scan");
    let other = CourseFault::OtherPatient { first: 1, other: 3 };
    let [a, b] = [0, 1].map(|day| of_patient(day, Some("4711")));
    assert_eq!(fault(&[a.clone(), b.clone(), of_patient(2, Some("4712"))]), other);
    assert_eq!(fault(&[a, b, of_patient(2, None)]), other);
}

#[test]
fn girths_of_another_meaning_and_volumes_of_another_method_are_refused_and_never_mixed() {
    let first = at_day(&PLAIN, 0);
    let tape = with_method(30, "tape", "level");
    let found = fault(&[first.clone(), tape.clone()]);
    assert!(matches!(found, CourseFault::OtherDefinition { first: 1, other: 2, .. }), "{found:?}");
    let discs = with_method(30, "volume", "discs");
    let found = fault(&[first.clone(), discs.clone()]);
    let expected = CourseFault::OtherVolume { first: 1, other: 2, one: "cones", another: "discs" };
    assert_eq!(found, expected);
    let choice = Choice { volume: Some(VolumeBy::Discs), ..CHOICE };
    assert_eq!(Course::comparable(&[first.clone(), discs], choice).unwrap().groups.len(), 1);
    // Beside each other they stand in groups of their own, whose volumes are never compared.
    let course = Course::of(&[first, tape, at_day(&PLAIN, 60)], CHOICE).unwrap();
    let groups: Vec<Vec<usize>> = course.groups.iter().map(|of| of.visits.clone()).collect();
    assert_eq!(groups, [vec![0, 2], vec![1]]);
    assert_eq!(course.last_group().unwrap().visits, [0, 2]);
}

#[test]
fn a_record_without_girths_at_fixed_lengths_is_refused_by_its_place() {
    let mut older = at_day(&PLAIN, 0);
    older.legs.iter_mut().for_each(|leg| leg.along.clear());
    // It is the second that is named, although it is the older visit.
    assert_eq!(fault(&[at_day(&PLAIN, 30), older]), CourseFault::NoPlaces { at: 2 });
}

#[test]
fn only_lengths_that_all_visits_have_count_for_the_volume() {
    let mut short = at_day(&PLAIN, 30);
    short.legs.iter_mut().for_each(|leg| leg.along.retain(|at| at.along_axis_mm <= 480.0));
    let course = Course::comparable(&[at_day(&PLAIN, 0), short], CHOICE).unwrap();
    let group = &course.groups[0];
    assert_eq!(group.pieces.left.first().zip(group.pieces.left.last()), Some((&3, &11)));
    let compared = course.last_compared(group).remove(0);
    let volume = compared.legs.left.unwrap().volume.unwrap();
    assert_eq!(volume.by, 0.0, "the same girths have the same volume");
}
