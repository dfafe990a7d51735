//! The words of a report of visits: their figures agree with each other and with those of the JSON form.

#![allow(clippy::unwrap_used)]

use gaiter_language::Language;
use gaiter_leg::Side;
use gaiter_record::picture::Mark;
use gaiter_record::report::AgeMax;
use gaiter_record::report::content::{Table, VerdictPart};
use gaiter_record::report::document::{Block, Document};
use gaiter_record::{Acquired, AcquiredFrom, Record};
use gaiter_visits::report::ReportOf;
use gaiter_visits::schema::figures;
use gaiter_visits::{Affected, Course};
use serde_json::Value;

use crate::worked::{cylinders, girth_mm, named};

pub fn document(course: &Course, records: &[Record], language: Language) -> Document {
    let report = ReportOf {
        course,
        records,
        thresholds: &[],
        today: jiff::civil::date(2026, 2, 10),
        age_max: AgeMax::default(),
        language,
    };
    report.document()
}

/// What matters most, in its parts.
pub fn verdict(document: &Document) -> &[VerdictPart] {
    let said = document.blocks.iter().find_map(|block| match block {
        Block::Verdict(said) => Some(said.parts.as_slice()),
        _ => None,
    });
    said.unwrap()
}

/// The sentences of what matters most.
pub fn sentences(document: &Document) -> Vec<&str> {
    verdict(document).iter().flat_map(|part| &part.sentences).map(String::as_str).collect()
}

/// Every text of a report.
pub fn texts(document: &Document) -> Vec<String> {
    let of = |block: &Block| -> Vec<String> {
        match block {
            Block::Verdict(said) => {
                said.parts.iter().flat_map(|part| part.sentences.clone()).collect()
            }
            Block::Section(of) => of.entries.clone(),
            Block::Table(of) => {
                let figures = of.rows.iter().flat_map(|row| &row.figures);
                let figures = figures.map(|of| format!("{} ± {:?}", of.value, of.margin));
                let around = of.explanation.iter().chain(&of.below).cloned();
                figures.chain(around).chain(of.columns.clone()).collect()
            }
            Block::Picture { figure, caption, .. } => {
                let words = figure.picture.marks.iter().filter_map(|mark| match mark {
                    Mark::Words { words, .. } => Some(words.clone()),
                    _ => None,
                });
                words.chain([caption.clone()]).collect()
            }
            _ => Vec::new(),
        }
    };
    document.blocks.iter().flat_map(of).collect()
}

/// The volumes that a sentence names, in its order: each figure before `mL`, and its decimals.
fn volumes(sentence: &str) -> Vec<(f64, i32)> {
    let words: Vec<&str> = sentence.split_whitespace().collect();
    let named = words.windows(2).filter(|pair| pair[1].starts_with("mL"));
    let figure = |pair: &[&str]| {
        let text = pair[0].trim_start_matches('(').replace('\u{2212}', "-").replace(',', ".");
        let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        (text.parse().unwrap(), i32::try_from(decimals).unwrap())
    };
    named.map(figure).collect()
}

/// Beside a ± of tens of mL, decimals that only make figures add up say nothing.
#[test]
fn volumes_and_their_change_are_whole_ml_and_each_is_the_figure_of_the_json_form() {
    for step in 0..40 {
        let after = 6.3 * f64::from(step) - 20.0;
        let ends = [538.83, after];
        let records =
            [0, 1].map(|at| cylinders([5000.0, 5000.0 + ends[at]].map(girth_mm), 30 * at as i64));
        let course = Course::comparable(&records, named(Affected::One(Side::Left))).unwrap();
        let json = serde_json::to_value(figures(&course, &[])).unwrap();
        let exact = [
            &json["comparisons"][0]["excess"]["volume_ml"]["change"],
            &json["visits"][0]["excess"]["volume_ml"]["value"],
            &json["visits"][1]["excess"]["volume_ml"]["value"],
        ];
        let exact = exact.map(|of: &Value| of.as_f64().unwrap());
        for language in Language::ALL {
            let document = document(&course, &records, language);
            let excess = language.word("visits.excess", "smaller").split('{').next().unwrap();
            let said = sentences(&document);
            let sentence = said.iter().find(|of| of.starts_with(excess)).unwrap();
            let told = volumes(sentence);
            for ((told, decimals), exact) in told.iter().zip(exact) {
                assert_eq!(*decimals, 0, "{sentence}");
                assert!((told - exact).abs() <= 0.5 + 6e-4, "{sentence}: {exact}");
            }
        }
    }
}

#[test]
fn no_figure_has_a_hyphen_for_a_minus() {
    // An excess that is negative, one that grows, and a leg that shrinks.
    for girths in [[380.0, 395.0], [410.0, 425.0], [420.0, 405.0]] {
        let records = [0, 1].map(|at| cylinders([400.0, girths[at]], 30 * at as i64));
        let course = Course::comparable(&records, named(Affected::One(Side::Left))).unwrap();
        for language in Language::ALL {
            for text in texts(&document(&course, &records, language)) {
                let signs = text.split('-').skip(1);
                let mut behind = signs.filter_map(|rest| rest.chars().next());
                assert!(!behind.any(|sign| sign.is_ascii_digit()), "{text}");
            }
        }
    }
}

#[test]
fn what_can_be_shown_is_not_told_as_what_is_shown() {
    let records = [0, 1].map(|at| cylinders([400.0; 2], 30 * i64::from(at)));
    let course = Course::comparable(&records, named(Affected::Both)).unwrap();
    let document = document(&course, &records, Language::De);
    let said = sentences(&document);
    assert!(said[0].contains("nachweisbar ab") && !said[0].contains("nachgewiesen ab"), "{said:?}");
}

#[test]
fn what_bounds_the_limit_is_told_as_the_json_form_has_it() {
    let records = [0, 1].map(|at| cylinders([400.0, 410.0], 30 * i64::from(at)));
    let course = Course::comparable(&records, named(Affected::Both)).unwrap();
    let json = serde_json::to_value(figures(&course, &[])).unwrap();
    let share = |side: usize| {
        let volume = &json["visits"][1]["legs"][side]["volume_ml"];
        100.0 * volume["common_sd"].as_f64().unwrap() / volume["value"].as_f64().unwrap()
    };
    let expected = format!("right leg {:.2} %, left leg {:.2} %", share(1), share(0));
    let document = document(&course, &records, Language::En);
    let said = texts(&document);
    assert!(said.iter().any(|text| text.contains(&expected)), "{expected}: {said:?}");
}

/// The tables of a report.
pub fn tables(document: &Document) -> impl Iterator<Item = &Table> {
    document.blocks.iter().filter_map(|block| match block {
        Block::Table(table) => Some(table),
        _ => None,
    })
}

#[test]
fn the_first_page_holds_words_the_curves_and_where_girths_changed_and_no_table() {
    let records = [0, 1, 2].map(|at| cylinders([400.0, 410.0 - f64::from(at)], 30 * i64::from(at)));
    let course = Course::comparable(&records, named(Affected::One(Side::Left))).unwrap();
    let document = document(&course, &records, Language::En);
    let turn = document.blocks.iter().position(|block| *block == Block::Turn).unwrap();
    let (first, others) = document.blocks.split_at(turn);
    let name = |block: &Block| match block {
        Block::Verdict(_) => "verdict",
        Block::Section(_) => "section",
        Block::Table(_) => "table",
        Block::Picture { figure, .. } => figure.name,
        Block::View(_) => "view",
        Block::Turn => "turn",
        _ => "of a record",
    };
    let names: Vec<&str> = first.iter().map(name).collect();
    assert_eq!(names, ["verdict", "section", "volumes", "changes"]);
    assert_eq!(others.iter().filter(|block| name(block) == "turn").count(), 1);
}

/// A centimetre on one leg: the scale of girths has 20 px for it, that of changes at least 60.
#[test]
fn a_centimetre_can_be_seen_in_the_picture_of_changes() {
    let records =
        [0, 1].map(|at| cylinders([400.0, 410.0 - 10.0 * f64::from(at)], 30 * i64::from(at)));
    let course = Course::comparable(&records, named(Affected::Both)).unwrap();
    let document = document(&course, &records, Language::En);
    let marks = document.blocks.iter().find_map(|block| match block {
        Block::Picture { figure, .. } if figure.name == "changes" => Some(&figure.picture.marks),
        _ => None,
    });
    // The dots of changes that are shown, left of the middle of the left leg's chart.
    let dots = marks.unwrap().iter().filter_map(|mark| match mark {
        Mark::Dots { at, .. } => Some(at),
        _ => None,
    });
    let dots: Vec<[f64; 2]> = dots.flatten().copied().collect();
    assert!(!dots.is_empty() && dots.iter().all(|[x, _]| 552.0 - x > 60.0), "{dots:?}");
}

/// The second of four visits was in the afternoon; it is neither the first nor one of the last two.
#[test]
fn a_visit_at_another_time_of_day_is_marked_in_curve_and_table_and_in_the_json_form() {
    let mut records = [0, 30, 60, 90].map(|day| cylinders([400.0, 410.0], day));
    let at = "2026-02-07T14:10:00Z".parse().unwrap();
    let acquired = Acquired::new(at, AcquiredFrom::Press);
    records[1].acquired = Some(Acquired { utc_offset_min: Some(60), ..acquired });
    let course = Course::comparable(&records, named(Affected::Both)).unwrap();
    assert!(
        course.last_compared(&course.groups[0]).iter().all(|of| {
            of.cautions.iter().all(|caution| caution.code() != "time-of-day-differs")
        })
    );
    let json = serde_json::to_value(figures(&course, &[])).unwrap();
    let told = |at: usize| json["visits"][at]["cautions"].clone();
    assert_eq!(told(1), serde_json::json!(["time-of-day-differs"]));
    assert!([0, 2, 3].map(told).into_iter().all(|of| of == serde_json::json!([])), "{json}");
    for language in Language::ALL {
        let document = document(&course, &records, language);
        let all = tables(&document).next().unwrap();
        let signed: Vec<bool> = all.rows.iter().map(|row| row.head.ends_with(" †")).collect();
        assert_eq!(signed, [false, false, true, false], "newest first: {:?}", all.rows);
        assert!(all.explanation.as_ref().unwrap().contains("†: "));
        let hollow = document.blocks.iter().filter_map(|block| match block {
            Block::Picture { figure, .. } if figure.name == "volumes" => Some(&figure.picture),
            _ => None,
        });
        let hollow = hollow.flat_map(|picture| &picture.marks).filter_map(|mark| match mark {
            Mark::Dots { at, stroke: Some(_), .. } => Some(at.len()),
            _ => None,
        });
        assert_eq!(hollow.sum::<usize>(), 3, "both legs, and what they differ by");
    }
}

/// A figure in words, without its sign for a minus.
fn figure(text: &str) -> f64 {
    text.replace('\u{2212}', "-").replace(',', ".").parse().unwrap()
}

#[test]
fn each_figure_of_the_tables_of_volumes_is_that_of_the_json_form() {
    let records = [0, 1, 2].map(|at| {
        let at_mm = f64::from(at);
        cylinders([400.3 + 0.7 * at_mm, 411.1 - 1.9 * at_mm], 30 * i64::from(at))
    });
    let course = Course::comparable(&records, named(Affected::Both)).unwrap();
    let json = serde_json::to_value(figures(&course, &[])).unwrap();
    let number = |of: &Value| of.as_f64().unwrap();
    let is_rounded = |text: &str, exact: f64| {
        let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        // The JSON form has percentages to 0.01 %.
        let half = 0.5 * 0.1_f64.powi(i32::try_from(decimals).unwrap()) + 6e-3;
        assert!((figure(text) - exact).abs() <= half, "{text}: {exact}");
    };
    let document = document(&course, &records, Language::En);
    let mut tables = tables(&document);
    let all = tables.next().unwrap();
    for (row, visit) in all.rows.iter().rev().zip(json["visits"].as_array().unwrap()) {
        // Right leg before the left one.
        for (cell, leg) in row.figures[2..4].iter().zip([1, 0]) {
            let volume = &visit["legs"][leg]["volume_ml"];
            is_rounded(&cell.value, number(&volume["value"]));
            let sd = number(&volume["visit_sd"]);
            assert!((figure(cell.margin.as_ref().unwrap()) - 2.0 * sd).abs() <= 1.0, "{cell:?}");
        }
        is_rounded(&row.figures[4].value, number(&visit["left_minus_right_ml"]["value"]));
    }
    for (table, compared) in tables.by_ref().take(2).zip(json["comparisons"].as_array().unwrap()) {
        for (row, leg) in table.rows.iter().zip([1, 0]) {
            let change = &compared["legs"][leg]["volume_ml"];
            is_rounded(&row.figures[2].value, number(&change["change"]));
            is_rounded(&row.figures[3].value, number(&change["percent_change"]));
            let [before, after, by] = [0, 1, 2].map(|column| figure(&row.figures[column].value));
            assert!((before + by - after).abs() <= 1.0, "each is rounded by itself: {row:?}");
            assert!(table.below.as_ref().unwrap().contains("rounded by itself"));
        }
    }
}

#[test]
fn an_affected_leg_that_was_the_smaller_one_is_told_as_such_and_its_change_has_no_percentage() {
    let records = [cylinders([400.0, 420.0], 0), cylinders([400.0, 410.0], 30)];
    let course = Course::comparable(&records, named(Affected::One(Side::Right))).unwrap();
    let report = document(&course, &records, Language::En);
    let said = sentences(&report);
    let said = said.iter().find(|said| said.starts_with("The affected leg (right)")).unwrap();
    assert!(said.contains("was the smaller one before") && !said.contains("larger"), "{said}");
    let json = serde_json::to_value(figures(&course, &[])).unwrap();
    let excess = &json["comparisons"][0]["excess"];
    assert_eq!(excess["no_percent_reduction"], "smaller-leg");
    assert_eq!(excess["volume_ml"]["percent_change"], Value::Null);
}

#[test]
fn slices_beside_a_doubtful_girth_and_their_changes_bear_the_sign_of_doubt() {
    let mut records = [cylinders([400.0, 420.0], 0), cylinders([400.0, 410.0], 30)];
    for leg in &mut records[1].legs {
        for at in leg.along.iter_mut().filter(|at| at.along_axis_mm == 320.0) {
            at.doubts = vec!["gap".into()];
        }
    }
    let course = Course::comparable(&records, named(Affected::One(Side::Left))).unwrap();
    let report = document(&course, &records, Language::En);
    let tables = report.blocks.iter().filter_map(|block| match block {
        Block::Table(table) => Some(table),
        _ => None,
    });
    let rows: Vec<_> = tables.flat_map(|table| &table.rows).collect();
    for (head, is_doubted) in [("24–28", false), ("28–32", true), ("32–36", true), ("36–40", false)]
    {
        let slices: Vec<_> = rows.iter().filter(|row| row.head == head).collect();
        assert_eq!(slices.len(), 2, "{head}: one of each leg");
        for row in slices {
            let [earlier, later, change] = &row.figures[..] else { panic!("{row:?}") };
            assert_eq!(earlier.mark.sign(), "", "{head}");
            assert_eq!(later.mark.sign(), if is_doubted { "?" } else { "" }, "{head}");
            assert_eq!(change.value.ends_with('?'), is_doubted, "{head}: {}", change.value);
        }
    }
}
