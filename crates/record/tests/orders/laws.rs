//! What is true of every order: table and JSON say the same, nobody is named, and the files are small.

#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};

use gaiter_language::Language;
use gaiter_record::order::{
    JSON_SCHEMA, Order, OrderRef, RefFault, Row, csv, mapped, order_files, read, spreadsheet,
};
use gaiter_record::report::AgeMax;
use gaiter_record::{json, rounding};
use gaiter_sizes::mapping::parse;
use gaiter_sizes::{Garment, Mapping};
use jiff::civil::{Date, date};
use proptest::prelude::*;
use serde_json::Value;

use super::{ID, RECORD, SCANNED, garment, order};

/// The cells of a table with semicolons and quotes (RFC 4180), without gaiter's own reader.
fn cells(text: &str) -> Vec<Vec<String>> {
    let (mut rows, mut row, mut cell, mut is_quoted) =
        (Vec::new(), Vec::new(), String::new(), false);
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        match (letter, is_quoted) {
            ('"', true) if letters.peek() == Some(&'"') => {
                letters.next();
                cell.push('"');
            }
            ('"', _) => is_quoted = !is_quoted,
            (';', false) => row.push(std::mem::take(&mut cell)),
            ('\r', false) => {}
            ('\n', false) => {
                row.push(std::mem::take(&mut cell));
                rows.push(std::mem::take(&mut row));
            }
            (letter, _) => cell.push(letter),
        }
    }
    assert!(cell.is_empty() && row.is_empty() && !is_quoted, "the last line is whole");
    rows
}

/// The rows of a table by the names of their columns.
fn rows(text: &str) -> Vec<BTreeMap<String, String>> {
    let mut lines = cells(text).into_iter();
    let names = lines.next().unwrap();
    lines
        .map(|line| {
            assert_eq!(line.len(), names.len());
            names.iter().cloned().zip(line).collect()
        })
        .collect()
}

fn number(text: &str) -> Option<f64> {
    (!text.is_empty()).then(|| text.parse().unwrap())
}

/// The columns of `docs/orders.md`, as shops are told.
const COLUMNS: &str = "format;order_ref;scan_ref;side;point;girth_mm;girth_u95_mm;length_mm;length_u95_mm;\
                       length_from;basis;method;flag;printed_girth_cm;printed_length_cm;edited_by;reason\r\n";

#[test]
fn the_table_has_the_columns_that_are_documented() {
    assert!(csv(&order()).starts_with(COLUMNS), "{}", csv(&order()));
}

#[test]
fn table_and_json_say_the_same_to_the_last_digit() {
    for garment in Garment::shipped() {
        for record in [&*SCANNED, &*RECORD] {
            let order = Order::from_record(record, garment, None, 1.0);
            let again = read(&json(&order).unwrap()).unwrap();
            assert_eq!(again, order, "JSON is read back as it was");
            let table = rows(&csv(&order));
            assert_eq!(table.len(), order.rows.len());
            for (cells, row) in table.iter().zip(&order.rows) {
                let Row { girth, length, .. } = row;
                assert_eq!(
                    (cells["side"].as_str(), &cells["point"]),
                    (row.side.word(), &row.point)
                );
                for (name, figure) in [("girth", girth), ("length", length)] {
                    let figure = figure.as_ref();
                    assert_eq!(number(&cells[&format!("{name}_mm")]), figure.and_then(|of| of.mm));
                    let u95_mm = number(&cells[&format!("{name}_u95_mm")]);
                    assert_eq!(u95_mm, figure.and_then(|of| of.u95_mm));
                    let printed_cm = number(&cells[&format!("printed_{name}_cm")]);
                    assert_eq!(printed_cm, figure.and_then(|of| of.printed_cm));
                }
                assert_eq!(cells["basis"], "skin");
            }
        }
    }
}

/// The text that a cell of a table for people stands for: without `="…"`.
fn meant(cell: &str) -> String {
    let inner = cell.strip_prefix("=\"").and_then(|cell| cell.strip_suffix('"'));
    inner.map_or_else(|| cell.to_owned(), |text| text.replace("\"\"", "\""))
}

/// The cells of the German table for people; the first line has the headings.
fn for_people(order: &Order) -> Vec<Vec<String>> {
    let text = spreadsheet(order, Language::De);
    assert!(text.starts_with('\u{feff}'), "Excel takes it for no UTF-8");
    cells(text.trim_start_matches('\u{feff}'))
}

#[test]
fn the_table_for_a_german_spreadsheet_has_commas_for_points_and_that_for_programs_never() {
    let order = order();
    let (exact, german) = (csv(&order), for_people(&order));
    assert!(!exact.starts_with('\u{feff}') && exact.contains(";371.25;"), "{exact}");
    let exact = cells(&exact);
    assert_eq!(exact.len(), german.len());
    for (exact, told) in exact[1..].concat().iter().zip(german[1..].concat()) {
        match exact.parse::<f64>() {
            Ok(_) if told.starts_with('=') => assert_eq!(&meant(&told), exact),
            Ok(_) => assert_eq!(told, exact.replace('.', ",")),
            Err(_) => assert_eq!(&told, exact),
        }
        // What German spreadsheets take for a day or for thousands.
        assert!(told.parse::<f64>().is_err() || !told.contains('.'), "{told}");
    }
    let english = spreadsheet(&order, Language::En);
    assert!(english.contains(",371.25,") && !english.contains("371,25"), "{english}");
}

#[test]
fn the_headings_for_people_are_those_of_their_language_and_programs_find_the_columns_names() {
    let order_ref = OrderRef::new("A-1042", &RECORD).unwrap();
    let again = Order::with_changes(&order(), &RECORD, &garment(), Some(&order_ref), 1.0).unwrap();
    let (names, german) = (cells(&csv(&again)).remove(0), for_people(&again).remove(0));
    assert_eq!(names.len(), german.len());
    for (name, heading) in names.iter().zip(&german) {
        let is_plain = !heading.contains('_') && !heading.starts_with(['=', '+', '-', '@', '±']);
        assert!(is_plain && heading != name, "{name}: {heading}");
    }
    let distinct: BTreeSet<&String> = german.iter().collect();
    assert_eq!(distinct.len(), german.len(), "{german:?}");
    let of = |name: &str| &german[names.iter().position(|known| known == name).unwrap()];
    assert_eq!([of("order_ref"), of("side")], ["Auftrag", "Seite"]);
    assert_eq!([of("girth_mm"), of("last_girth_mm")], ["Umfang in mm", "Letzter Umfang in mm"]);
    let english = spreadsheet(&again, Language::En);
    assert!(english.starts_with("\u{feff}Format,Order,Scan,Side,Point,Girth in mm,"), "{english}");
}

#[test]
fn a_reference_that_looks_like_a_day_or_a_number_stays_text_for_people_and_bare_for_programs() {
    for text in ["3-12", "1/4", "0012", "1E5"] {
        let order_ref = OrderRef::new(text, &RECORD).unwrap();
        let order = Order::from_record(&RECORD, &garment(), Some(&order_ref), 1.0);
        assert_eq!(rows(&csv(&order))[0]["order_ref"], text);
        assert_eq!(for_people(&order)[1][1], format!("=\"{text}\""));
        let german = mappings().remove(2);
        let of_mapping = String::from_utf8(mapped(&order, &german, None)).unwrap();
        let second = of_mapping.lines().nth(1).unwrap();
        // The scan's reference is of digits only; a day stays a day.
        let expected = format!("\"=\"\"{text}\"\"\";\"=\"\"01234567\"\"\";20.11.2026;;AD;rechts;");
        assert!(second.starts_with(&expected), "{second}");
    }
}

#[test]
fn what_a_person_set_counts_and_what_the_scan_says_stays_before_it() {
    let order = order();
    let of = |side: &str, point: &str| -> Vec<&Row> {
        order.rows.iter().filter(|row| row.side.word() == side && row.point == point).collect()
    };
    let [scanned, set] = of("right", "C")[..] else { panic!("two rows") };
    let girth = |row: &Row| row.girth.as_ref().and_then(|girth| girth.mm);
    assert_eq!((girth(scanned), scanned.counts), (Some(371.25), false));
    assert_eq!((girth(set), set.counts), (Some(380.0), true));
    assert_eq!(set.edited_by.as_deref(), Some("Jörg Øster"));
    assert_eq!(set.reason.as_deref(), Some("=swollen; \"hard\""));
    // The scan lacks B1, so there is nothing to keep; the reason holds the patient's id, and is left out.
    let [set] = of("left", "B1")[..] else { panic!("one row") };
    assert_eq!((girth(set), &set.reason), (Some(270.0), &None));
    let open: Vec<String> =
        order.open.iter().map(|of| format!("{} {}", of.side.word(), of.form_box)).collect();
    assert!(
        open.contains(&"left cD".to_owned()) && !open.contains(&"right cC".to_owned()),
        "{open:?}"
    );
    // In a spreadsheet the reason is text, not a formula.
    for text in [csv(&order), spreadsheet(&order, Language::De)] {
        assert!(text.contains("\"'=swollen; \"\"hard\"\"\""), "{text}");
    }
}

#[test]
fn uncertainty_is_twice_that_of_the_girth_and_of_the_scanner_together_and_that_of_a_tape_by_hand() {
    let of = |scanner_girth_mm: f64, point: &str| {
        let order = Order::from_record(&RECORD, &garment(), None, scanner_girth_mm);
        let mut rows = order.rows.iter();
        let row = rows.find(|row| row.counts && row.side.word() == "right" && row.point == point);
        row.unwrap().girth.as_ref().unwrap().u95_mm.unwrap()
    };
    let u95 = |sd_mm: f64| rounding::mm(rounding::MARGIN_SDS * sd_mm);
    assert_eq!(of(0.0, "B"), u95(0.4));
    assert_eq!(of(1.0, "B"), u95(0.4_f64.hypot(1.0)));
    // The scanner's error is no error of a tape.
    assert_eq!(of(0.0, "C"), of(1.0, "C"));
}

/// The mappings that are shipped, and one that asks for everything an order has.
fn mappings() -> Vec<Mapping> {
    let texts = [
        include_str!("../../../../config/orders/example-points.toml"),
        include_str!("../../../../config/orders/example-wide.toml"),
        include_str!("../../../../config/orders/german-spreadsheet.toml"),
    ];
    texts.map(|text| parse(text.as_bytes()).unwrap()).into()
}

/// Two weeks, as for legs after decongestion.
const MOST: AgeMax = AgeMax(14);

/// The last day for a scan of 20 November, by the clock at the scanner.
const LAST: Date = date(2026, 12, 4);

#[test]
fn an_order_of_a_scan_that_is_too_old_says_so_in_every_file() {
    let fresh = order().on(LAST, MOST);
    assert!(!fresh.is_of_an_old_scan() && csv(&fresh) == csv(&order()));
    let old = order().on(date(2026, 12, 5), MOST);
    assert_eq!([&fresh, &old].map(|of| of.holds_until), [Some(LAST); 2]);
    let file: Value = serde_json::from_slice(&json(&old).unwrap()).unwrap();
    assert_eq!(file["holds_until"], "2026-12-04");
    assert!(file["to_check"].as_array().unwrap().contains(&"scan-age".into()), "{file}");
    for cells in rows(&csv(&old)) {
        let has_figure = !cells["girth_mm"].is_empty() || !cells["length_mm"].is_empty();
        let is_told = cells["flag"].split(' ').any(|flag| flag == "scan-age");
        assert_eq!(is_told, has_figure, "{cells:?}");
    }
    let mappings = mappings();
    let [points, _, german] = &mappings[..] else { panic!("three mappings") };
    let told = |mapping: &Mapping| String::from_utf8(mapped(&old, mapping, None)).unwrap();
    assert!(told(points).contains("A-1042,R,cB,213,3,scan-age,"), "{}", told(points));
    assert!(told(german).contains(";20.11.2026;04.12.2026;AD;"), "{}", told(german));
}

#[test]
fn the_age_of_an_order_that_is_made_again_is_that_of_its_scan_on_its_own_day() {
    let old = order().on(date(2026, 12, 5), MOST);
    let again = |day: Date| Order::exact(&old, &RECORD, &garment(), None).unwrap().on(day, MOST);
    assert!(!again(LAST).is_of_an_old_scan() && again(date(2027, 1, 1)).is_of_an_old_scan());
    let twice = again(date(2027, 1, 1)).to_check;
    assert_eq!(twice.iter().filter(|code| *code == "scan-age").count(), 1);
    let mut undated = order();
    undated.scan.acquired = None;
    let undated = undated.on(LAST, MOST);
    assert!(undated.is_of_an_old_scan() && undated.holds_until.is_none());
}

#[test]
fn no_file_of_an_order_names_the_patient_and_all_are_small_with_ascii_names() {
    for garment in Garment::shipped() {
        let order = Order::from_record(&RECORD, garment, None, 1.0);
        let files = order_files(&order, &mappings(), Language::De, Some(ID)).unwrap();
        let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
        assert_eq!(names.len(), 6);
        for file in &files {
            assert!(file.name.is_ascii() && !file.name.contains(ID), "{}", file.name);
            // A cost estimate takes 10 MB; an order is far below.
            assert!(file.bytes.len() < 100_000, "{}: {}", file.name, file.bytes.len());
            let text = String::from_utf8_lossy(&file.bytes);
            assert!(!text.contains(ID), "{}: {text}", file.name);
        }
    }
}

#[test]
fn only_a_mapping_that_asks_for_the_id_writes_it() {
    let text = include_str!("../../../../fixtures/cases/orders/asks_for_the_id.toml");
    let mapping = parse(text.as_bytes()).unwrap();
    let files = order_files(&order(), &[mapping], Language::En, Some(ID)).unwrap();
    let by_mapping = files.last().unwrap();
    assert!(String::from_utf8_lossy(&by_mapping.bytes).contains(ID));
    assert!(!by_mapping.name.contains(ID));
}

#[test]
fn two_mappings_that_fill_their_name_alike_have_files_of_their_own() {
    let mut twin = mappings().remove(0);
    twin.id = "EXAMPLE-points".to_owned();
    let mappings = vec![mappings().remove(0), twin];
    let files = order_files(&order(), &mappings, Language::En, Some(ID)).unwrap();
    let names: Vec<&str> = files[3..].iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, ["order-example-points.csv", "order-EXAMPLE-points-2.csv"]);
}

#[test]
fn a_reference_names_no_patient_and_fits_a_line() {
    let of = |text: &str| OrderRef::new(text, &RECORD).map(|of| of.as_str().to_owned());
    assert_eq!(of("  A-1042 "), Ok("A-1042".to_owned()));
    assert_eq!(of("A-47110"), Ok("A-47110".to_owned()), "a longer number is another");
    for text in ["4711", "A-4711", "x 4711.", "(4711)"] {
        assert_eq!(of(text), Err(RefFault::HoldsId), "{text}");
    }
    for text in ["", "  ", "a\nb", "a\u{202e}b", &"x".repeat(61)] {
        assert_eq!(of(text), Err(RefFault::NotALine), "{text:?}");
    }
}

#[test]
fn the_json_keeps_to_its_schema() {
    let schema: Value = serde_json::from_str(JSON_SCHEMA).unwrap();
    let order: Value = serde_json::from_slice(&json(&order()).unwrap()).unwrap();
    let required = schema["required"].as_array().unwrap();
    let keys: Vec<&String> = order.as_object().unwrap().keys().collect();
    assert_eq!(keys.len(), schema["properties"].as_object().unwrap().len());
    for key in required {
        assert!(keys.iter().any(|known| *known == key.as_str().unwrap()), "{key}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn any_words_of_a_person_are_read_back_from_the_table(
        reason in "[=+@'\"; ,a-zäß\u{2019}-]{1,40}",
    ) {
        let mut order = order();
        for row in &mut order.rows {
            row.reason = Some(reason.clone());
        }
        for cells in rows(&csv(&order)) {
            let told = &cells["reason"];
            let is_formula = told.trim_start_matches('\'').starts_with(['=', '+', '-', '@']);
            prop_assert!(!is_formula || told.starts_with('\''), "{told}");
            let meant = if is_formula { told.strip_prefix('\'').unwrap() } else { told };
            prop_assert_eq!(meant, &reason);
        }
    }

    #[test]
    fn any_reference_is_read_back_from_the_table_for_people_and_is_no_value_there(
        text in "\\PC{1,60}|[0-9Ee/.,:+='\" -]{1,20}|(Mai|Mar|Mo|EUR)[ -]?[0-9]{1,4}",
    ) {
        let Ok(order_ref) = OrderRef::new(&text, &RECORD) else { return Ok(()) };
        let order = Order::from_record(&RECORD, &garment(), Some(&order_ref), 1.0);
        for cells in &for_people(&order)[1..] {
            let told = &cells[1];
            let is_guarded = told.trim_start_matches('\'').starts_with(['=', '+', '-', '@'])
                && !told.starts_with("=\"");
            let text = match told.strip_prefix('\'') {
                Some(text) if is_guarded => text.to_owned(),
                _ => meant(told),
            };
            prop_assert_eq!(text.as_str(), order_ref.as_str());
            let is_bare = !is_guarded && !told.starts_with("=\"");
            // Numerals that are letters, as Ⅷ, are no digits to a spreadsheet.
            let is_digit = |letter: char| letter.is_numeric() && !letter.is_alphabetic();
            let first = told.chars().find(|letter| letter.is_alphanumeric());
            prop_assert!(!is_bare || !first.is_some_and(is_digit), "{}", told);
            prop_assert!(!told.starts_with(['+', '-', '@']), "{}", told);
        }
    }
}
