//! Sheet, record, CSV and GDT say the same: the same levels in the same order, the same figures to the last
//! digit, the same marks and the same verdict, for every recorded body.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeMap;

use gaiter_cad::Output;
use gaiter_language::Language;
use gaiter_leg::{Level, Method, Side, extract};
use gaiter_record::completeness::Completeness;
use gaiter_record::gdt::{Charset, result};
use gaiter_record::measure::Measure;
use gaiter_record::measure::amendment::{Amendment, Deed};
use gaiter_record::report::{Reliability, ReportContent};
use gaiter_record::{
    Patient, Provenance, Record, RecordFile, ReportChoice, ScanFile, Source, SourceKind,
    amended_files, record_files, sha256,
};
use gaiter_scan::Format;
use gaiter_sizes::Garment;
use support::gdt_check::{checked, contents};
use support::recorded::export;

use crate::gdt_message::rules;

/// All bodies of `fixtures/scans`.
const BODIES: [&str; 3] = ["f_average_clean", "f_average_tc2", "m_average_clean"];

fn garment() -> Garment {
    Garment::named("AG").unwrap()
}

/// State, girth and height of a level of one leg, as words with a point; a figure that is missing is empty.
type Row = (String, [String; 3]);

/// The record of a body as it stands in its file, and its spreadsheet.
fn made(body: &str) -> (Record, String) {
    let bytes = export(body);
    let method = Method::default();
    let extraction = extract(&bytes, Format::Obj, &method).unwrap();
    let mut provenance = Provenance::of_scan(sha256(&bytes));
    let sources = vec![Source::from_kind(SourceKind::FileName)];
    provenance.patient = Some(Patient { id: "4711".to_owned(), sources });
    let choice = ReportChoice { garment: garment(), ..ReportChoice::default() };
    let scan = ScanFile { bytes: &bytes, format: Format::Obj, ord: None };
    let made = record_files(&extraction, &provenance, &method, &Output::default(), &choice, scan);
    let (_, files) = made.unwrap();
    let text = |name: &str| {
        let file = files.iter().find(|file| file.name == name).unwrap();
        String::from_utf8(file.bytes.clone()).unwrap()
    };
    (serde_json::from_str(&text("record.json")).unwrap(), text("measurements.csv"))
}

fn row(name: String, state: &str, girth: &str, height: &str) -> Row {
    (name, [state, girth, height].map(str::to_owned))
}

fn of_sheet(record: &Record) -> Vec<Row> {
    let content = ReportContent::from_record(record, Language::En, &garment());
    let of_leg = |(index, side): (usize, &str)| {
        let rows = content.levels.rows.iter().map(move |level| {
            let name = format!("{side} {}", level.level);
            let figures = &level.legs[index];
            let height = if figures.height.value == "–" { "" } else { &figures.height.value };
            match figures.girth.mark {
                Reliability::Missing if figures.girth.value == "not measurable" => {
                    row(name, "not measurable", "", "")
                }
                Reliability::Missing => row(name, "not found", "", ""),
                Reliability::Estimated => row(name, "estimated", &figures.girth.value, height),
                Reliability::ByHand => row(name, "by hand", &figures.girth.value, height),
                _ => row(name, "measured", &figures.girth.value, height),
            }
        });
        rows.collect::<Vec<_>>()
    };
    ["right", "left"].into_iter().enumerate().flat_map(of_leg).collect()
}

fn of_csv(csv: &str) -> Vec<Row> {
    let lines = csv.lines().skip(2).map(|line| line.split(',').collect::<Vec<_>>());
    lines
        .map(|cells| row(format!("{} {}", cells[0], cells[1]), cells[2], cells[3], cells[4]))
        .collect()
}

/// The figures of the record itself, half away from zero by their digits: not by the code under test.
fn cm(mm: f64) -> String {
    let thousandths = (mm * 1000.0).round() as i64;
    let tenths = (thousandths + 500) / 1000;
    format!("{}.{}", tenths / 10, tenths % 10)
}

fn of_record(record: &Record, rows: &[Row]) -> Vec<Row> {
    let of_row = |(name, [state, ..]): &Row| {
        let (side, level) = name.split_once(' ').unwrap();
        let leg = record.legs.iter().find(|leg| leg.side == side).unwrap();
        let height = |mm: f64| if ["A", "Y"].contains(&level) { String::new() } else { cm(mm) };
        match state.as_str() {
            "measured" => {
                let of = &leg.landmarks[level];
                row(name.clone(), state, &cm(of.girth_tape_mm), &height(of.height_mm))
            }
            "estimated" => {
                let of = &leg.estimates[level];
                row(name.clone(), state, &cm(of.girth_tape_mm), &height(of.height_mm))
            }
            _ => {
                assert!(!leg.landmarks.contains_key(level), "{name}");
                let below_d = |doubts: &[String]| doubts.iter().any(|doubt| doubt == "below-d");
                assert!(leg.estimates.get(level).is_none_or(|of| below_d(&of.doubts)), "{name}");
                row(name.clone(), state, "", "")
            }
        }
    };
    rows.iter().map(of_row).collect()
}

fn gdt(record: &Record) -> Vec<(String, Vec<u8>)> {
    let rules = rules(Charset::Utf8);
    let taken = jiff::civil::date(2026, 11, 21).at(9, 15, 0, 0);
    checked(&result(record, &garment(), &rules, taken, &[]).unwrap())
}

/// The rows of the table for people in a result.
fn of_gdt_table(lines: &[(String, Vec<u8>)]) -> Vec<Row> {
    let text = contents(lines, "6228");
    let head = text.iter().position(|line| line.starts_with("[cm]")).unwrap();
    let table = text[head + 2..].iter().take(9);
    let mut rows = [Vec::new(), Vec::new()];
    for line in table {
        let line = line
            .replace("nicht gefunden", "nicht -")
            .replace("nicht messbar", "nichts -")
            .replace(',', ".")
            .replace('?', "");
        let cells: Vec<&str> = line.split_whitespace().collect();
        for (leg, side) in ["right", "left"].into_iter().enumerate() {
            let [girth, height] = [cells[1 + 2 * leg], cells[2 + 2 * leg]];
            let name = format!("{side} {}", cells[0]);
            let height = if height == "-" { "" } else { height };
            let plain = [girth, height].map(|figure| figure.trim_start_matches('~'));
            rows[leg].push(match girth {
                "nicht" => row(name, "not found", "", ""),
                "nichts" => row(name, "not measurable", "", ""),
                _ if girth.starts_with('*') => {
                    row(name, "by hand", &girth[1..], height.trim_start_matches(['*', '~']))
                }
                _ if girth.starts_with('~') => row(name, "estimated", plain[0], plain[1]),
                _ => row(name, "measured", plain[0], plain[1]),
            });
        }
    }
    rows.concat()
}

#[test]
fn all_figures_of_sheet_record_csv_and_practice_software_are_the_same_in_the_same_order() {
    let mut states = BTreeMap::<String, usize>::new();
    for body in BODIES {
        let (record, csv) = made(body);
        let sheet = of_sheet(&record);
        assert_eq!(of_csv(&csv), sheet, "{body}: CSV");
        assert_eq!(of_record(&record, &sheet), sheet, "{body}: record");
        let lines = gdt(&record);
        assert_eq!(of_gdt_table(&lines), sheet, "{body}: table of the practice software");
        // The test blocks: what was measured, girth before height.
        let blocks: Vec<(String, String)> =
            contents(&lines, "8410").into_iter().zip(contents(&lines, "8420")).collect();
        let expected = sheet.iter().filter(|(_, [state, ..])| state == "measured");
        let expected = expected.flat_map(|(name, [_, girth, height])| {
            let (side, level) = name.split_once(' ').unwrap();
            let letter = side[..1].to_uppercase();
            let of =
                |kind: &str, figure: &str| (format!("{kind}{level}_{letter}"), figure.to_owned());
            [of("L", girth), of("H", height)]
        });
        let expected: Vec<_> = expected.filter(|(_, figure)| !figure.is_empty()).collect();
        assert_eq!(blocks, expected, "{body}: test blocks");
        for (_, [state, ..]) in sheet {
            *states.entry(state).or_default() += 1;
        }
    }
    let all: Vec<&str> = states.keys().map(String::as_str).collect();
    assert_eq!(all, ["estimated", "measured", "not found"], "every state was seen: {states:?}");
}

/// What a person set of a body, in cm: on the right leg C, the height of B1 and nothing of D; on the left leg
/// an estimate.
fn amended(record: &Record) -> Record {
    let set = |leg: &str, measure: &str, is, cm: [Option<f64>; 2]| Amendment {
        leg: leg.to_owned(),
        measure: measure.to_owned(),
        is,
        girth_mm: cm[0].map(|cm| 10.0 * cm),
        height_mm: cm[1].map(|cm| 10.0 * cm),
        length_mm: None,
        reason: "swollen, \"hard\"; see = notes".to_owned(),
        by: "Jürgen Müßig".to_owned(),
        at: "2026-11-25T10:00:00Z".parse().unwrap(),
    };
    let c = record.legs.iter().find(|leg| leg.side == "right").unwrap().landmarks["C"].height_mm;
    let d = record.legs.iter().find(|leg| leg.side == "left").unwrap().landmarks["D"].height_mm;
    let (measured, not) = (Deed::Measured, Deed::NotMeasurable);
    let record = match Measure::find(record, Side::Right, Level::F) {
        Ok(_) => record.amended(&[set("right", "F", measured, [Some(45.5), None])], true).unwrap(),
        Err(_) => record.clone(),
    };
    record
        .amended(
            &[
                set("right", "C", measured, [Some(41.25), Some(c / 10.0 + 0.7)]),
                set("right", "D", not, [None, None]),
                set("left", "E", measured, [Some(39.9), Some(d / 10.0 + 3.0)]),
                set("left", "A", measured, [Some(21.5), None]),
            ],
            true,
        )
        .unwrap()
}

#[test]
fn what_a_person_set_is_the_same_on_every_surface_with_its_mark_and_the_scans_value_beside_it() {
    let mut with_f = 0;
    for body in BODIES {
        let (before, _) = made(body);
        let record = amended(&before);
        assert_eq!(record.legs, before.legs, "{body}: the scan's values");
        let choice = ReportChoice { garment: garment(), ..ReportChoice::default() };
        let old = ["record.json", "measurements.csv"]
            .map(|name| RecordFile { name: name.to_owned(), bytes: Vec::new() });
        let files = amended_files(&record, &choice, old.into()).unwrap();
        let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
        // The older record had no table for people.
        assert_eq!(
            names,
            [
                "record.json",
                "measurements.csv",
                "measurements-spreadsheet.csv",
                "order.csv",
                "order-spreadsheet.csv",
                "order.json",
                "SHA256SUMS"
            ]
        );
        let csv = String::from_utf8(files[1].bytes.clone()).unwrap();
        let sheet = of_sheet(&record);
        assert_eq!(of_csv(&csv), sheet, "{body}: CSV");
        let lines = gdt(&record);
        assert_eq!(of_gdt_table(&lines), sheet, "{body}: table of the practice software");
        let state = |name: &str| {
            let row = sheet.iter().find(|(row, _)| row == name).unwrap();
            row.1.each_ref().map(String::as_str)
        };
        assert_eq!(state("right C")[..2], ["by hand", "41.3"]);
        assert_eq!(state("right D"), ["not measurable", "", ""]);
        assert_eq!(state("left E")[..2], ["by hand", "39.9"]);
        // The scan's own figures stand in their own columns.
        let c = &before.legs.iter().find(|leg| leg.side == "right").unwrap().landmarks["C"];
        let line = csv.lines().find(|line| line.starts_with("right,C,")).unwrap();
        assert!(line.ends_with(&format!(",{},{}", c.girth_tape_mm, c.height_mm)), "{line}");
        assert!(
            line.contains("by hand, Jürgen Müßig, 2026-11-25T10:00:00Z: swollen, \"\"hard\"\"")
        );
        // A test block says so, and the comments say by whom.
        let at = lines.iter().position(|(field, text)| field == "8410" && text == b"LC_R").unwrap();
        let mark = lines[at..].iter().find(|(field, _)| field == "8470").unwrap();
        assert_eq!(String::from_utf8_lossy(&mark.1), "von Hand eingetragen", "{body}");
        let blocks = contents(&lines, "8410");
        assert!(!blocks.contains(&"LD_R".to_owned()) && blocks.contains(&"LE_L".to_owned()));
        // Of an estimate only what was set goes out.
        let goes_out = |block: &str| blocks.iter().any(|its| its == block);
        let has_f = state("right F")[0] == "by hand";
        assert!(goes_out("LA_L") && goes_out("LF_R") == has_f, "{blocks:?}");
        assert!(!["HF_R", "LA_R", "LF_L"].into_iter().any(goes_out), "{blocks:?}");
        with_f += usize::from(has_f);
        let comments = contents(&lines, "6227").join(" ");
        for said in ["C: Umfang 41,3 cm (Scan: ", "Jürgen Müßig", "D: nicht messbar"] {
            assert!(comments.contains(said), "{said}: {comments}");
        }
        let verdict =
            Completeness::from_record(&record, &garment()).sentences(Language::En).join(" ");
        assert!(verdict.contains("Not measurable: right leg: D."), "{verdict}");
    }
    assert!(with_f > 0, "a girth was set in place of an estimate");
}

#[test]
fn spreadsheet_and_practice_software_say_the_verdict_of_the_sheet() {
    for body in BODIES {
        let (record, csv) = made(body);
        let verdict = Completeness::from_record(&record, &garment());
        let said = verdict.sentences(Language::En).join(" ");
        let line = csv.lines().nth(1).unwrap();
        assert!(line.starts_with(&format!(",verdict,{},", verdict.kind().word())), "{line}");
        assert!(line.ends_with(&format!("\"{said}\",,")), "{line}");
        let text = contents(&gdt(&record), "6228");
        let before: Vec<String> =
            text.into_iter().take_while(|line| !line.starts_with("[cm]")).collect();
        assert_eq!(before.join(" "), verdict.sentences(Language::De).join(" "), "{body}");
    }
}
