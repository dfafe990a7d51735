//! Records that are left out of a course, and the visits that stand in their places.

#![allow(clippy::unwrap_used)]

use gaiter_language::Language;
use gaiter_record::Record;
use gaiter_record::report::AgeMax;
use gaiter_record::report::content::VerdictPart;
use gaiter_record::report::document::Block;
use gaiter_visits::report::ReportOf;
use gaiter_visits::schema::figures;
use gaiter_visits::{Course, LeftOut};
use jiff::ToSpan;

use crate::refusals::{PLAIN, at_day};
use crate::stance::CHOICE;

/// A record that is left out, so many days after the first visit, and so many hours later than the visits are.
fn left_out(day: i64, hours: i64) -> LeftOut {
    let seen = at_day(&PLAIN, day).acquired.unwrap().at + hours.hours();
    LeftOut { seen, scan: "0123abcd".to_owned(), code: "record-damaged", is_of_another: false }
}

/// Visits on the days 10, 40 and 70.
fn records() -> [Record; 3] {
    [10, 40, 70].map(|day| at_day(&PLAIN, day))
}

fn course(left_out: Vec<LeftOut>) -> Course {
    Course::comparable(&records(), CHOICE).unwrap().with_left_out(left_out)
}

/// Whether the ends of both comparisons stand in: with the first visit, with the one before the last.
fn stand_ins(left_out: LeftOut) -> [[bool; 2]; 2] {
    let course = course(vec![left_out]);
    let compared = course.last_compared(&course.groups[0]);
    [0, 1].map(|of| {
        let stand_ins = compared[of].stand_ins;
        [stand_ins.earlier, stand_ins.later]
    })
}

#[test]
fn a_visit_stands_in_where_the_record_that_is_left_out_would_have_been() {
    let none = [[false; 2]; 2];
    assert_eq!(stand_ins(left_out(0, 0)), [[true, false], [false, false]], "before the first");
    assert_eq!(stand_ins(left_out(20, 0)), none, "between the first and the one before the last");
    assert_eq!(stand_ins(left_out(50, 0)), [[false, false], [true, false]], "before the last");
    assert_eq!(stand_ins(left_out(80, 0)), [[false, true], [false, true]], "after the last");
    // Of each day the last scan counts.
    assert_eq!(stand_ins(left_out(10, -1)), none);
    assert_eq!(stand_ins(left_out(10, 1)), [[true, false], [false, false]]);
    assert_eq!(stand_ins(left_out(70, -1)), none);
    assert_eq!(stand_ins(left_out(70, 1)), [[false, true], [false, true]]);
    let of_another = LeftOut { is_of_another: true, ..left_out(0, 0) };
    assert_eq!(stand_ins(of_another), none, "nothing of this patient is missing");
}

#[test]
fn a_visit_without_a_time_may_stand_in() {
    let mut records = records();
    records[0].acquired = None;
    let course = Course::comparable(&records, CHOICE).unwrap();
    let course = course.with_left_out(vec![left_out(0, 0)]);
    let of = course.last_compared(&course.groups[0]).remove(0);
    assert!(of.stand_ins.earlier && of.stand_ins.later);
}

#[test]
fn what_is_left_out_is_told_in_the_report_and_in_the_json_beside_what_hangs_on_it() {
    let records = records();
    let course = course(vec![left_out(0, 0), left_out(20, 0)]);
    let json = serde_json::to_value(figures(&course, &[])).unwrap();
    let told = json["left_out"].as_array().unwrap();
    assert_eq!(told.len(), 2, "oldest first: {told:?}");
    assert_eq!(
        (&told[0]["code"], &told[0]["scan"]),
        (&"record-damaged".into(), &"0123abcd".into())
    );
    assert_eq!(told[0]["seen"], "2026-01-08T08:00:00Z");
    let ends: Vec<bool> = (0..2)
        .map(|at| json["comparisons"][at]["is_earlier_stand_in"].as_bool().unwrap())
        .collect();
    assert_eq!(ends, [true, false]);
    for (language, missing, day) in [
        (Language::En, "Records that are left out", "18 Jan 2026 #"),
        (Language::De, "Ausgelassene Messakten", "18.01.2026 #"),
    ] {
        let report = ReportOf {
            course: &course,
            records: &records,
            thresholds: &[],
            today: jiff::civil::date(2026, 4, 1),
            age_max: AgeMax::default(),
            language,
        };
        let blocks = report.document().blocks;
        let mut sections = blocks.iter().filter_map(|block| match block {
            Block::Section(section) => Some(section),
            _ => None,
        });
        let section = sections.find(|of| of.title == missing).unwrap();
        assert!(section.entries.len() == 2 && section.entries[0].contains("0123abcd"));
        let Block::Verdict(said) = &blocks[0] else { panic!("{:?}", blocks[0]) };
        // Above what the first comparison shows, and what the sign means.
        let is_signed = |of: &VerdictPart| {
            let is_headed = of.heading.as_ref().is_some_and(|heading| heading.contains(day));
            is_headed && of.sentences.iter().any(|said| said.starts_with(day))
        };
        let signed: Vec<bool> = said.parts.iter().map(is_signed).collect();
        assert_eq!(signed, [true, false, false], "{said:?}");
        let headed = blocks.iter().any(|block| match block {
            Block::Table(table) => table.columns.iter().any(|head| head == day),
            _ => false,
        });
        assert!(headed, "the table of volumes has the sign, too");
    }
}
