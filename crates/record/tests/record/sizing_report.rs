//! The sizes on the report: their section behind the sheet, in both languages, with every mark.

#![allow(clippy::unwrap_used, clippy::panic)]

use gaiter_language::Language;
use gaiter_record::picture::figures;
use gaiter_record::report::AgeMax;
use gaiter_record::report::{self, Print, ReportContent};
use gaiter_record::sizing::{SizeChoice, SizeVerdicts};
use gaiter_record::{Record, ReportChoice, report_files};
use gaiter_sizes::{Garment, parse};
use jiff::civil::date;

use crate::report_paper::Paper;
use crate::sizing::{RECORD, choice, measured, table};

const EXAMPLE: &str = include_str!("../../../../config/sizes/invented-example.toml");

fn example() -> SizeChoice {
    choice(vec![parse(EXAMPLE.as_bytes()).unwrap()])
}

fn content(
    record: &Record,
    language: Language,
    garment: &Garment,
    sizes: &SizeChoice,
) -> ReportContent {
    ReportContent::with_sizes(
        record,
        language,
        garment,
        &SizeVerdicts::new(record, garment, sizes),
        AgeMax::default(),
    )
}

fn pages(record: &Record, language: Language, sizes: &SizeChoice) -> Vec<String> {
    let content = content(record, language, &Garment::default(), sizes);
    let document = content.document(record, &figures::all(record, language));
    Paper::read(&report::paper(&document, Print::default()).unwrap()).pages()
}

fn html(record: &Record, language: Language, sizes: &SizeChoice) -> String {
    let choice = ReportChoice { language, sizes: sizes.clone(), ..ReportChoice::default() };
    let files = report_files(record, &choice).unwrap();
    let page = files.iter().find(|file| file.name == "report.html").unwrap();
    String::from_utf8(page.bytes.clone()).unwrap()
}

#[test]
fn without_tables_nothing_is_said_of_sizes() {
    let of = ReportContent::from_record(&RECORD, Language::En, &Garment::default());
    assert_eq!(of.sizes, None);
    let none = SizeChoice::default();
    assert_eq!(content(&RECORD, Language::En, &Garment::default(), &none), of);
    assert!(!html(&RECORD, Language::En, &none).contains(">Sizes</h2>"));
    assert!(html(&RECORD, Language::En, &example()).contains(">Sizes</h2>"));
}

#[test]
fn the_sizes_stand_behind_the_sheet_which_stays_one_page_and_points_to_them() {
    for (language, heading, see) in
        [(Language::En, "Sizes", "see the section"), (Language::De, "Größen", "siehe Abschnitt")]
    {
        let without = pages(&RECORD, language, &SizeChoice::default());
        let pages = pages(&RECORD, language, &example());
        assert!(pages[0].contains(see) && !without[0].contains(see), "{}", pages[0]);
        assert!(pages[0].contains(
            ReportContent::from_record(&RECORD, language, &Garment::default()).open.title.as_str()
        ));
        assert!(pages[1].contains(heading) && pages[1].contains("cB"), "{}", pages[1]);
        assert!(!without[1].contains("example-invented"));
    }
}

#[test]
fn a_table_is_named_with_edition_and_hash_and_what_it_may_not_be_used_for() {
    let mut old = example();
    old.tables[0].valid_until = Some(date(2026, 11, 24));
    let sha256 = &old.tables[0].sha256[..12];
    for (language, marks) in [
        (Language::En, ["TEST ONLY", "EXPIRED", "T1 (test only) · II"]),
        (Language::De, ["NUR ZUM TEST", "ABGELAUFEN", "T1 (nur Test) · II"]),
    ] {
        let page = html(&RECORD, language, &old);
        let paper = pages(&RECORD, language, &old).concat().replace(' ', "");
        for mark in marks.iter().chain(&["example-invented", "2026-01, invented", sha256]) {
            assert!(page.contains(mark), "{mark}");
            assert!(paper.contains(&mark.replace(' ', "")), "{mark} on paper");
        }
    }
}

#[test]
fn every_candidate_is_shown_with_margins_and_probability_and_none_is_chosen() {
    let record = measured(&RECORD, "B", Some(200.0), None);
    let of = content(&record, Language::En, &Garment::default(), &example()).sizes.unwrap();
    let right = &of.tables[0];
    let heads: Vec<&str> = right.rows.iter().map(|row| row.head.as_str()).collect();
    assert_eq!(heads[..2], ["T1 (test only) · I", "T1 (test only) · II"]);
    let cells: Vec<Vec<&str>> = right.rows[..2]
        .iter()
        .map(|row| row.figures.iter().map(|figure| figure.value.as_str()).collect())
        .collect();
    assert_eq!(cells[0][1], "+2.0 / 0.0 * (50\u{a0}%)");
    assert_eq!(cells[1][1], "0.0 / +2.0 * (50\u{a0}%)");
    assert_eq!(cells[1][0], "fits within uncertainty");
    let said = of.about.concat();
    assert!(said.contains("chooses none") && said.contains("2.5 mm"), "{said}");
    let whole = format!("{of:?}").to_lowercase();
    assert!(!whole.contains("recommend") && !whole.contains("best"), "{whole}");
}

#[test]
fn a_missing_point_leaves_the_size_open_and_says_what_to_measure() {
    let mut record = RECORD.clone();
    record.legs.iter_mut().for_each(|leg| drop(leg.landmarks.remove("C")));
    let verdict = |language: Language| {
        let of = content(&record, language, &Garment::default(), &example()).sizes.unwrap();
        of.tables[0].rows[0].figures[0].value.clone()
    };
    assert_eq!(verdict(Language::En), "not decided, still to measure by hand: cC");
    assert_eq!(verdict(Language::De), "nicht entschieden, noch von Hand messen: cC");
}

#[test]
fn a_value_in_a_gap_is_told_with_its_nearest_sizes() {
    let record = measured(&RECORD, "B", Some(222.0), None);
    let gap = table(
        "[[size]]\nname = \"I\"\ncB = [180, 200]\n[[size]]\nname = \"II\"\ncB = [240, 260]\n",
    );
    let of = content(&record, Language::En, &Garment::default(), &choice(vec![gap])).sizes.unwrap();
    let said = of.tables[0].explanation.as_deref().unwrap();
    let expected = "T1: sizes and lengths together: does not fit. No size allows this cB; nearest: I \
                    (\u{2212}2.2), II (\u{2212}1.8) cm.";
    assert_eq!(said, expected);
}

#[test]
fn a_form_of_one_s_own_is_printed_in_its_order_names_and_steps_and_exports_keep_all_digits() {
    let text = include_str!("../../../../fixtures/cases/sizes/garment_of_a_shop.toml");
    let garment = Garment::read(text.as_bytes()).unwrap();
    let of = content(&RECORD, Language::De, &garment, &SizeChoice::default()).sizes.unwrap();
    let heads: Vec<&str> = of.form.rows.iter().map(|row| row.head.as_str()).collect();
    assert_eq!(heads[..4], ["Fuß", "U Y", "U B", "H B"]);
    let mm =
        RECORD.legs.iter().find(|leg| leg.side == "right").unwrap().landmarks["B"].girth_tape_mm;
    let printed = format!("{}", (mm / 5.0).round() * 5.0);
    assert_eq!(of.form.rows[2].figures[0].value, printed);
    let said = of.form.explanation.unwrap();
    assert!(said.contains("In mm, Umfänge im Druck auf 5 mm"), "{said}");
    let choice = ReportChoice { garment, language: Language::De, ..ReportChoice::default() };
    let page = report_files(&RECORD, &choice).unwrap().swap_remove(0);
    let page = String::from_utf8(page.bytes).unwrap();
    assert!(page.contains(&format!("\"girth_tape_mm\":{mm}")), "the record has all digits");
    let is_there = |title: &str| page.contains(&format!(">{title}</h2>"));
    assert!(is_there(&of.form.title) && !is_there(&of.title), "only the form");
}

#[test]
fn the_calibre_is_a_hint_in_words_with_its_place() {
    let b1 = RECORD.legs.iter().find(|leg| leg.side == "right").unwrap().landmarks["B1"].clone();
    let swollen = measured(&RECORD, "C", Some(b1.girth_tape_mm + 200.0), None);
    let entries = |record: &Record, language: Language| {
        let of = content(record, language, &Garment::default(), &example()).sizes.unwrap();
        of.calibre.unwrap().entries
    };
    let said = entries(&swollen, Language::De);
    assert!(said[1].starts_with("Rechtes Bein, B1–C: 1,"), "{said:?}");
    assert!(said[0].contains("ein Hinweis, keine Entscheidung"), "{said:?}");
    let said = entries(&RECORD, Language::En);
    assert!(said.len() == 2 && said[1].starts_with("None: the largest change is 0."), "{said:?}");
}
