//! What a therapist meets on the sheet: one ± a visit, sums that are the volumes, the affected leg first, and no sign that
//! does not occur.

#![allow(clippy::unwrap_used)]

use gaiter_language::Language;
use gaiter_leg::Side;
use gaiter_record::Record;
use gaiter_record::picture::{Ink, Mark};
use gaiter_record::report::content::Table;
use gaiter_record::report::document::{Block, Document};
use gaiter_record::report::{self, Paper};
use gaiter_record::rounding::ml_margin;
use gaiter_visits::schema::figures;
use gaiter_visits::{Affected, Choice, Course};
use serde_json::Value;

use crate::refusals::{PLAIN, at_day};
use crate::stance::CHOICE;
use crate::words::{document, sentences, tables, texts, verdict};
use crate::worked::{cylinders, named};

/// The marks of a picture of a report.
fn marks<'a>(document: &'a Document, name: &str) -> &'a [Mark] {
    let marks = document.blocks.iter().find_map(|block| match block {
        Block::Picture { figure, .. } if figure.name == name => Some(&figure.picture.marks),
        _ => None,
    });
    marks.unwrap()
}

/// Two visits whose legs have these standard errors of the whole leg's volume, right and left, mL.
fn with_errors(sds_ml: [f64; 2]) -> [Record; 2] {
    [0, 1].map(|at| {
        let mut record = cylinders([400.0, 400.0 + f64::from(at)], 30 * i64::from(at));
        for leg in &mut record.legs {
            leg.volume.sd_ml = Some(if leg.side == "left" { sds_ml[1] } else { sds_ml[0] });
        }
        record
    })
}

/// 5484 ± 21 in the report of a scan was 5134 ± 60 on the sheet.
#[test]
fn the_uncertainty_of_a_visits_volume_is_that_of_its_own_report_in_tables_and_in_the_json_form() {
    let sds_ml = [10.3, 11.6];
    let records = with_errors(sds_ml);
    let course = Course::comparable(&records, named(Affected::One(Side::Left))).unwrap();
    let expected = sds_ml.map(|sd_ml| Some(format!("{:.0}", ml_margin(sd_ml))));
    assert_eq!(expected, ["21", "24"].map(|margin| Some(margin.to_owned())));
    let document = document(&course, &records, Language::En);
    let mut tables = tables(&document);
    for row in &tables.next().unwrap().rows {
        let margins = [2, 3].map(|column| row.figures[column].margin.clone());
        assert_eq!(margins, expected, "of each visit");
    }
    let changes = &tables.next().unwrap().rows;
    for (row, expected) in changes.iter().zip(expected) {
        let margins = [0, 1].map(|column| row.figures[column].margin.clone());
        assert_eq!(margins, [expected.clone(), expected], "before and after");
    }
    let json = serde_json::to_value(figures(&course, &[])).unwrap();
    for visit in json["visits"].as_array().unwrap() {
        let sd = |leg: usize| visit["legs"][leg]["volume_ml"]["visit_sd"].as_f64().unwrap();
        assert_eq!([sd(1), sd(0)], sds_ml);
    }
    let said = texts(&document);
    assert!(said.iter().any(|text| text.contains("± beside a volume is the one of that report")));
    assert!(said.iter().any(|text| text.contains("± of a change is larger than those of its two")));
}

#[test]
fn a_scanner_that_is_known_less_well_lengthens_no_bar_of_a_visit_and_raises_each_limit() {
    let records = with_errors([10.0, 12.0]);
    let of = |girth_common_mm: f64| {
        let course = Course::comparable(&records, Choice { girth_common_mm, ..CHOICE }).unwrap();
        let of = course.last_compared(&course.groups[0]).remove(0);
        let limit = of.legs.left.unwrap().volume.unwrap().detectable();
        let document = document(&course, &records, Language::En);
        // Left of what the legs differ by, whose bars hold what does not cancel.
        let legs = marks(&document, "volumes").iter().filter_map(|mark| match mark {
            Mark::Lines { lines, stroke, .. } => Some((lines.clone(), *stroke)),
            _ => None,
        });
        let is_of_legs = |lines: &[Vec<[f64; 2]>]| lines.iter().flatten().all(|[x, _]| *x < 360.0);
        let legs: Vec<_> = legs.filter(|(lines, _)| is_of_legs(lines)).collect();
        assert!(!legs.is_empty());
        (legs, limit)
    };
    let ((bars, limit), (same, higher)) = (of(0.5), of(2.0));
    assert_eq!(bars, same);
    assert!(higher > 2.0 * limit, "{limit}, {higher}");
}

#[test]
fn without_an_error_in_the_record_a_visits_volume_has_one_of_its_girths_as_if_they_were_one() {
    let mut records = with_errors([0.0; 2]);
    records.iter_mut().flat_map(|of| &mut of.legs).for_each(|leg| leg.volume.sd_ml = None);
    let course = Course::comparable(&records, CHOICE).unwrap();
    let volume = course.volume(&course.groups[0], 0, Side::Right).unwrap();
    // A cylinder of 400 mm and 480 mm: V = C² h / 4π, dV = 2 V dC / C, and dC is 0.1 mm.
    assert!((volume.sd - 2.0 * volume.value * 0.1 / 400.0).abs() < 1e-6, "{volume:?}");
}

fn slices(document: &Document, language: Language) -> Vec<&Table> {
    let slices = language.text("visits.slices").split('}').next_back().unwrap();
    tables(document).filter(|table| table.title.ends_with(slices)).collect()
}

#[test]
fn the_slices_begin_where_the_volume_does_and_their_sums_are_the_volume_and_its_change_as_told() {
    let mut later = at_day(&PLAIN, 30);
    for leg in &mut later.legs {
        leg.along.iter_mut().for_each(|at| at.girth_tape_mm = at.girth_tape_mm.map(|mm| mm - 7.0));
    }
    let records = [at_day(&PLAIN, 0), later];
    let course = Course::comparable(&records, CHOICE).unwrap();
    let measured = course.visits[0].legs.left.as_ref().unwrap().places.keys().next().unwrap();
    assert!(*measured < 3, "there is a girth below the volume");
    let json = serde_json::to_value(figures(&course, &[])).unwrap();
    for language in Language::ALL {
        let document = document(&course, &records, language);
        let of_volumes = tables(&document).nth(1).unwrap();
        for ((table, volumes), side) in
            slices(&document, language).into_iter().zip(&of_volumes.rows).zip([1, 0])
        {
            let [others @ .., lowest, sums] = table.rows.as_slice() else { panic!("{table:?}") };
            assert_eq!(lowest.head, "12–16");
            assert_eq!(sums.head, language.text("visits.sum"));
            let told = |row: &report::content::TableRow| {
                [0, 1, 2].map(|column| row.figures[column].value.clone())
            };
            assert_eq!(told(sums), told(volumes));
            let slices = json["comparisons"][0]["legs"][side]["slices_ml"].as_array().unwrap();
            assert_eq!(slices.len(), others.len() + 1);
            assert_eq!(slices[0]["along_mm"], 120.0);
        }
        assert_eq!(slices(&document, language).len(), 2);
    }
}

#[test]
fn a_slice_that_is_not_compared_counts_in_the_sums() {
    let mut records = [at_day(&PLAIN, 0), at_day(&PLAIN, 30)];
    // A knee that is bent more by 4° moves the skin around it.
    for leg in &mut records[1].legs {
        let front = leg.axis.front;
        let thigh = &mut leg.axes.as_mut().unwrap().thigh.as_mut().unwrap().direction;
        let (sin, cos) = 4.0_f64.to_radians().sin_cos();
        thigh.iter_mut().zip(front).for_each(|(along, front)| *along = cos * *along + sin * front);
    }
    let course = Course::comparable(&records, CHOICE).unwrap();
    let document = document(&course, &records, Language::En);
    let table = slices(&document, Language::En)[0];
    let (sums, rows) = table.rows.split_last().unwrap();
    assert!(rows.iter().any(|row| row.figures[2].is_missing()), "{rows:?}");
    let added: f64 = rows.iter().map(|row| row.figures[0].value.parse::<f64>().unwrap()).sum();
    let told: f64 = sums.figures[0].value.parse().unwrap();
    assert!((added - told).abs() <= rows.len() as f64 / 2.0, "{added}, {told}");
    assert!(!sums.figures[2].is_missing());
}

#[test]
fn the_affected_leg_comes_first_below_a_heading_for_each_pair_of_days() {
    let records =
        [0, 1, 2].map(|at| cylinders([400.0, 430.0 - 8.0 * f64::from(at)], 30 * i64::from(at)));
    for (affected, legs) in [
        (Affected::One(Side::Left), ["Left leg: ", "Right leg: "]),
        (Affected::One(Side::Right), ["Right leg: ", "Left leg: "]),
        (Affected::Both, ["Right leg: ", "Left leg: "]),
    ] {
        let course = Course::comparable(&records, named(affected)).unwrap();
        let document = document(&course, &records, Language::En);
        let parts = verdict(&document);
        let pairs: Vec<_> = parts.iter().filter(|part| part.heading.is_some()).collect();
        let headings: Vec<_> = pairs.iter().flat_map(|part| &part.heading).collect();
        assert_eq!(headings, ["8 Jan 2026 to 9 Mar 2026", "7 Feb 2026 to 9 Mar 2026"]);
        for pair in pairs {
            for (sentence, leg) in pair.sentences.iter().zip(legs) {
                assert!(sentence.starts_with(leg), "{affected:?}: {sentence}");
            }
        }
        let is_one = matches!(affected, Affected::One(_));
        assert_eq!(parts[0].heading.is_none(), is_one, "which leg it is stands before all");
    }
}

#[test]
fn why_the_legs_differ_by_more_though_neither_changed_is_said_beside_the_figure() {
    let why = |later_mm: f64, affected: Affected| {
        let records = [cylinders([400.0, 420.0], 0), cylinders([400.0, later_mm], 30)];
        let course = Course::comparable(&records, named(affected)).unwrap();
        Language::ALL.map(|language| {
            let document = document(&course, &records, language);
            let why = language.text("visits.cancels");
            let is_said = sentences(&document).iter().any(|said| said.ends_with(why));
            let below = tables(&document).nth(1).unwrap().below.as_ref().unwrap();
            assert_eq!(below.contains(why), is_said, "{below}");
            is_said
        })
    };
    for affected in [Affected::One(Side::Left), Affected::Both] {
        assert_eq!(why(421.0, affected), [true; 2], "neither leg is shown to have changed");
        assert_eq!(why(400.0, affected), [false; 2], "the left leg is");
    }
}

#[test]
fn the_lines_below_a_chart_are_explained_in_the_colours_of_that_chart() {
    let records =
        [0, 1, 2].map(|at| cylinders([400.0, 430.0 - 8.0 * f64::from(at)], 30 * i64::from(at)));
    let course = Course::comparable(&records, CHOICE).unwrap();
    let document = document(&course, &records, Language::En);
    for (name, below) in [("changes", 240.0), ("profiles", 450.0)] {
        let strokes = |is_right: bool| -> Vec<Ink> {
            let drawn = marks(&document, name).iter().filter_map(|mark| match mark {
                Mark::Lines { lines, stroke: Some(stroke), .. } => Some((lines, stroke.ink)),
                _ => None,
            });
            // The right leg's chart is on the left.
            let is_there = |[x, y]: &[f64; 2]| *y > below && (*x < 366.0) == is_right;
            let there = drawn.filter(|(lines, _)| lines.iter().flatten().all(is_there));
            there.map(|(_, ink)| ink).collect()
        };
        let (right, left) = (strokes(true), strokes(false));
        assert!(right.contains(&Ink::Right) && !right.contains(&Ink::Left), "{name}: {right:?}");
        assert!(left.contains(&Ink::Left) && !left.contains(&Ink::Right), "{name}: {left:?}");
    }
}

#[test]
fn a_table_explains_the_signs_that_occur_in_it_and_no_others() {
    let mut doubted = cylinders([400.0, 410.0], 60);
    doubted.legs[0].along.iter_mut().for_each(|at| at.doubts = vec!["gap".into()]);
    let plain = [0, 1].map(|at| cylinders([400.0; 2], 30 * i64::from(at)));
    let signed = [plain[0].clone(), plain[1].clone(), doubted];
    for (records, is_signed) in [(&plain[..], false), (&signed[..], true)] {
        let course = Course::comparable(records, CHOICE).unwrap();
        let document = document(&course, records, Language::En);
        let has = |table: &Table, mark: report::Reliability| {
            table.rows.iter().flat_map(|row| &row.figures).any(|of| of.mark == mark)
        };
        let mut told = 0;
        for table in tables(&document).filter(|table| table.explanation.is_some()) {
            let explanation = table.explanation.as_ref().unwrap();
            for (sign, mark) in [
                ("Bold:", report::Reliability::Real),
                (" ?:", report::Reliability::Doubtful),
                ("~:", report::Reliability::Estimated),
                ("*:", report::Reliability::ByHand),
            ] {
                assert_eq!(explanation.contains(sign), has(table, mark), "{sign} {table:?}");
                told += usize::from(sign == "Bold:" && explanation.contains(sign));
            }
            if explanation.contains("–:") {
                assert!(has(table, report::Reliability::Missing), "{table:?}");
            }
        }
        assert_eq!(told > 0, is_signed);
    }
}

#[test]
fn what_a_sheet_does_not_tell_is_not_explained() {
    let records = [0, 1].map(|at| cylinders([400.0, 420.0], 30 * i64::from(at)));
    let told = |affected: Option<Affected>| {
        let course = Course::comparable(&records, Choice { affected, ..CHOICE }).unwrap();
        texts(&document(&course, &records, Language::En)).join("\n")
    };
    let foreign =
        ["Excess", "Percent reduction", "†", "Phantom: ", "A dot", "Hollow", "dashed upright"];
    let without = told(None);
    for words in foreign {
        assert!(!without.contains(words), "{words}: {without}");
    }
    let with = told(Some(Affected::One(Side::Left)));
    assert!(with.contains("Excess volume: volume of the leg") && !with.contains("It is negative"));
    assert!(!with.contains("Percent reduction"), "none is told: {with}");
}

#[test]
fn no_figure_of_running_text_can_be_parted_from_its_unit_at_a_line_end() {
    let records = [cylinders([400.0, 420.0], 0), cylinders([400.0, 410.0], 30)];
    let course = Course::comparable(&records, named(Affected::One(Side::Left))).unwrap();
    for language in Language::ALL {
        let page = report::page(&document(&course, &records, language), Paper::A4).unwrap();
        let mut held = 0;
        for part in page.split('<') {
            let Some((tag, text)) = part.split_once('>') else { continue };
            if !["p", "li", "figcaption"].contains(&tag.split(' ').next().unwrap()) {
                continue;
            }
            held += text.matches('\u{a0}').count();
            for unit in [" mL", " %", " mm", " cm", " ±"] {
                let mut before: Vec<&str> = text.split(unit).collect();
                before.pop();
                let is_parted =
                    before.iter().any(|of| of.ends_with(|last: char| last.is_ascii_digit()));
                assert!(!is_parted, "{unit}: {text}");
            }
        }
        assert!(held > 10, "{held}");
    }
}

#[test]
fn a_named_leg_that_cannot_be_read_is_told_and_the_visits_are_compared_without_one() {
    let records = [cylinders([400.0, 420.0], 0), cylinders([400.0, 410.0], 30)];
    let course = Course::comparable(&records, CHOICE).unwrap().with_affected_unreadable(true);
    let json = serde_json::to_value(figures(&course, &[])).unwrap();
    assert_eq!((&json["affected"], &json["is_affected_unreadable"]), (&Value::Null, &true.into()));
    for language in Language::ALL {
        let document = document(&course, &records, language);
        let said = sentences(&document);
        assert_eq!(said[0], language.text("visits.affected.unreadable"));
        assert!(said.len() > 3, "{said:?}");
    }
    // A leg that is chosen for once needs none that is kept.
    let chosen = Course::comparable(&records, named(Affected::One(Side::Left))).unwrap();
    let json = serde_json::to_value(figures(&chosen.with_affected_unreadable(true), &[])).unwrap();
    assert_eq!(
        (&json["affected"], &json["is_affected_unreadable"]),
        (&"left".into(), &false.into())
    );
}
