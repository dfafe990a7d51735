//! Records that are not compared, and visits that stand in groups of their own.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::sync::LazyLock;

use gaiter_language::Language;
use gaiter_leg::comparison::tape_volume::VolumeBy;
use gaiter_leg::{Method, Side};
use gaiter_record::report::AgeMax;
use gaiter_record::report::document::Block;
use gaiter_record::shape::ShapeFigures;
use gaiter_record::{Acquired, AcquiredFrom, Patient, Record};
use gaiter_visits::report::ReportOf;
use gaiter_visits::schema::figures;
use gaiter_visits::threshold::{Limited, Threshold};
use gaiter_visits::{Affected, Caution, Choice, Comparison, Course, CourseFault};
use jiff::ToSpan;
use support::recorded::export;
use support::records::record_of;

use crate::stance::CHOICE;

/// A body's record without its shape.
pub static PLAIN: LazyLock<Record> = LazyLock::new(|| {
    let mut record = record_of(&export("m_average_clean"), &Method::default()).1;
    record.legs.iter_mut().for_each(|leg| leg.shape = ShapeFigures::default());
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
    let course = Course::from_records(&[first, tape, at_day(&PLAIN, 60)], CHOICE).unwrap();
    let groups: Vec<Vec<usize>> = course.groups.iter().map(|of| of.visits.clone()).collect();
    assert_eq!(groups, [vec![0, 2], vec![1]]);
    assert_eq!(course.last_group().unwrap().visits, [0, 2]);
}

#[test]
fn in_another_posture_neither_girths_nor_the_volumes_made_of_them_are_compared() {
    let posture = |day: i64, word: &str| with_method(day, "posture", word);
    let records = [posture(0, "both-legs"), posture(30, "sitting"), posture(60, "both-legs")];
    let choice = Choice { affected: Some(Affected::One(Side::Left)), ..CHOICE };
    let course = Course::comparable(&records, choice).unwrap();
    let group = &course.groups[0];
    let [with_first, with_last]: [Comparison; 2] = course.last_compared(group).try_into().unwrap();
    let is_compared = |of: &Comparison| {
        let legs = Side::BOTH.map(|side| of.legs.get(side).clone().unwrap());
        let apart = [of.excess.is_some(), of.left_minus_right.is_some()];
        let of_legs = legs
            .iter()
            .flat_map(|leg| [leg.volume.is_some(), !leg.girths.is_empty(), !leg.pieces.is_empty()]);
        of_legs.chain(apart).collect::<BTreeSet<bool>>()
    };
    assert_eq!(is_compared(&with_first), [true].into(), "the posture is the same");
    assert_eq!(is_compared(&with_last), [false].into(), "nothing of another posture is compared");
    assert!(with_last.cautions.contains(&Caution::Posture));
    // A visit's own figures stay, and so does what a threshold says of them.
    assert!(course.volume(group, 1, Side::Left).is_some() && course.excess(group, 1).is_some());
    let (name, source) = ("mild".to_owned(), "a paper".to_owned());
    let mild = Threshold { name, source, of: Limited::Excess, limit: 3.0 };
    let json = serde_json::to_value(figures(&course, &[mild])).unwrap();
    for compared in json["comparisons"].as_array().unwrap() {
        assert_eq!(compared["thresholds"][0]["of"], "excess", "{compared}");
    }
}

#[test]
fn a_comparison_of_another_posture_says_so_first_and_shows_no_volumes() {
    let records =
        [("both-legs", 0), ("sitting", 30)].map(|(word, day)| with_method(day, "posture", word));
    let course = Course::comparable(&records, CHOICE).unwrap();
    let report = ReportOf {
        course: &course,
        records: &records,
        thresholds: &[],
        today: jiff::civil::date(2026, 2, 10),
        age_max: AgeMax::default(),
        language: Language::En,
    };
    let blocks = report.document().blocks;
    let Block::Verdict(said) = &blocks[0] else { panic!("{:?}", blocks[0]) };
    let said: Vec<&String> = said.parts.iter().flat_map(|part| &part.sentences).collect();
    assert!(said[0].contains("neither girths nor volumes are compared"), "{said:?}");
    assert!(!said.iter().any(|said| said.contains("Percent change")), "{said:?}");
    let mut tables = blocks.iter().filter_map(|block| match block {
        Block::Table(table) => Some(table.title.as_str()),
        _ => None,
    });
    assert!(!tables.any(|title| title.starts_with("Volumes in mL")));
}

#[test]
fn a_record_without_girths_at_fixed_lengths_is_refused_by_its_place() {
    let mut bare = at_day(&PLAIN, 0);
    bare.legs.iter_mut().for_each(|leg| leg.along.clear());
    // It is the second that is named, although it is the older visit.
    assert_eq!(fault(&[at_day(&PLAIN, 30), bare]), CourseFault::NoPlaces { at: 2 });
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
