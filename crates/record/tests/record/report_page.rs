//! `report.html`: its figures are those of every other file, it shows hostile text as text, and needs
//! nothing from elsewhere.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::sync::LazyLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gaiter_cad::Output;
use gaiter_language::Language;
use gaiter_leg::{Level, Method, extract};
use gaiter_record::gdt::{Charset, result};
use gaiter_record::picture::figures;
use gaiter_record::report::{self, Paper, Reliability, ReportContent};
use gaiter_record::{
    Patient, Provenance, Record, RecordFile, ReportChoice, ScanFile, Source, SourceKind,
    record_files, report_files, sha256,
};
use gaiter_scan::Format;
use gaiter_sizes::Garment;
use sha2::{Digest, Sha256};
use support::page::{check_markup, words};
use support::recorded::export;

use crate::gdt_message::rules;

const LANGUAGES: [Language; 2] = [Language::En, Language::De];

/// A body with the scanner's noise and holes, of patient 4711, and the files of its folder.
static MADE: LazyLock<(Record, Vec<RecordFile>)> = LazyLock::new(|| {
    let bytes = export("f_average_tc2");
    let method = Method { at_heights_mm: vec![300.0], ..Method::default() };
    let extraction = extract(&bytes, Format::Obj, &method).unwrap();
    let mut provenance = Provenance::of_scan(sha256(&bytes));
    provenance.station = Some("booth-1".to_owned());
    let sources = vec![Source::from_kind(SourceKind::FileName)];
    provenance.patient = Some(Patient { id: "4711".to_owned(), sources });
    let scan = ScanFile { bytes: &bytes, format: Format::Obj, ord: None };
    let choice = ReportChoice { figures: true, ..german() };
    record_files(&extraction, &provenance, &method, &Output::default(), &choice, scan).unwrap()
});

fn german() -> ReportChoice {
    ReportChoice { language: Language::De, ..ReportChoice::default() }
}

fn made_page(record: &Record, language: Language) -> String {
    let content = ReportContent::from_record(record, language, &Garment::default());
    report::page(&content.document(record, &figures::all(record, language)), Paper::A4).unwrap()
}

fn file(name: &str) -> String {
    let file = MADE.1.iter().find(|file| file.name == name);
    String::from_utf8(file.unwrap_or_else(|| panic!("no {name}")).bytes.clone()).unwrap()
}

/// cm with one decimal of a figure of the record, half away from zero, by its digits: not by the code
/// under test.
fn cm(mm: f64) -> String {
    let thousandths = (mm * 1000.0).round() as i64;
    let tenths = (thousandths + 500) / 1000;
    format!("{}.{}", tenths / 10, tenths % 10)
}

#[test]
fn girths_and_lengths_agree_on_page_csv_json_gdt_and_drawing_to_the_last_digit() {
    let record: Record = serde_json::from_str(&file("record.json")).unwrap();
    let (csv, drawing) = (file("measurements.csv"), file("legs.svg"));
    let rules = rules(Charset::Utf8);
    let taken = jiff::civil::date(2026, 11, 21).at(9, 15, 0, 0);
    let gdt = String::from_utf8(result(&record, &Garment::default(), &rules, taken, &[]).unwrap())
        .unwrap();
    let [english, german] = LANGUAGES.map(|language| words(&made_page(&record, language)));
    let content = ReportContent::from_record(&record, Language::En, &Garment::default());
    let mut seen = 0;
    for (index, side) in ["right", "left"].into_iter().enumerate() {
        let leg = record.legs.iter().find(|leg| leg.side == side).unwrap();
        for (level, found) in &leg.landmarks {
            let girth = cm(found.girth_tape_mm);
            let row = content.levels.rows.iter().find(|row| row.level == *level).unwrap();
            assert_eq!(row.legs[index].girth.value, girth, "{side} {level}");
            if level != "Y" && level != "A" {
                assert_eq!(row.legs[index].height.value, cm(found.height_mm), "{side} {level}");
                assert!(english.contains(&format!("{} ±", cm(found.height_mm))));
            }
            assert!(english.contains(&format!("{girth} ")), "{side} {level}");
            assert!(german.contains(&format!("{} ", girth.replace('.', ","))), "{side} {level}");
            let line = csv.lines().find(|line| line.starts_with(&format!("{side},{level},")));
            let told: Vec<&str> = line.unwrap().split(',').collect();
            assert_eq!(told[3], girth);
            assert_eq!(cm(told[6].parse().unwrap()), girth);
            let letter = side[..1].to_uppercase();
            let block = gdt.split(&format!("8410L{level}_{letter}\r\n")).nth(1);
            let block = block.unwrap_or_else(|| panic!("no {level} of {side} in {gdt}"));
            let told = block.split("8420").nth(1).unwrap().split("\r\n").next().unwrap();
            assert_eq!(told, girth, "{side} {level}");
            // The drawing is German, and shows no foot.
            let label = format!(">{level} {}<", girth.replace('.', ","));
            assert!(level == "Y" || drawing.contains(&label), "{side} {label}");
            seen += 1;
        }
    }
    assert!(seen >= 10, "only {seen} levels");
}

#[test]
fn every_figure_of_the_landmarks_stands_in_the_page_as_in_the_record() {
    let json: serde_json::Value = serde_json::from_str(&file("record.json")).unwrap();
    for language in LANGUAGES {
        let words = words(&made_page(&MADE.0, language));
        for leg in json["legs"].as_array().unwrap() {
            for (level, figures) in leg["landmarks"].as_object().unwrap() {
                for (name, figure) in figures.as_object().unwrap() {
                    if figure.is_number() {
                        let figure = figure.to_string();
                        assert!(words.contains(&figure), "{level} {name} {figure}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_page_is_whole_and_needs_nothing_from_elsewhere() {
    for language in LANGUAGES {
        let page = made_page(&MADE.0, language);
        check_markup(&page);
        assert!(page.starts_with(&format!("<!doctype html>\n<html lang=\"{}\">", language.tag())));
        // Half of what is allowed: bodies differ.
        assert!(page.len() < 900_000, "{} bytes", page.len());
        for elsewhere in ["src=", "url(", "@import", "<link", "<iframe", "<img", " style=\""] {
            assert!(!page.contains(elsewhere), "{elsewhere}");
        }
        for link in page.split("href=\"").skip(1) {
            assert!(link.starts_with('#'), "{:?}", &link[..40]);
        }
    }
}

#[test]
fn nothing_runs_or_paints_but_what_the_policy_names_by_its_hash() {
    let page = made_page(&MADE.0, Language::En);
    let inside = |begin: &str, end: &str| {
        let rest = page.split(begin).nth(1).unwrap();
        rest.split(end).next().unwrap().to_owned()
    };
    let policy = inside("Content-Security-Policy\" content=\"", "\"");
    assert!(policy.starts_with("default-src 'none'; "), "{policy}");
    for (kind, text) in [
        ("style-src", inside("<style>", "</style>")),
        ("script-src", inside("<script>", "</script>")),
    ] {
        let hash = STANDARD.encode(Sha256::digest(text.as_bytes()));
        assert!(policy.contains(&format!("{kind} 'sha256-{hash}';")), "{kind}: {policy}");
    }
    assert_eq!(page.matches("<script").count(), 2, "the record and the view");
}

#[test]
fn hostile_ids_are_text_and_nothing_in_them_is_hidden() {
    let long = "9".repeat(500);
    for (id, shown) in [
        ("<script>alert(1)</script>", "<script>alert(1)</script>"),
        ("</script><script>", "</script><script>"),
        ("\"'&lt;<!--", "\"'&lt;<!--"),
        ("1\u{202E}23", "1[U+202E]23"),
        ("שלום 12", "שלום 12"),
        ("a\u{0}\r\nb", "a[U+0000][U+000D][U+000A]b"),
        (long.as_str(), long.as_str()),
    ] {
        let mut record = MADE.0.clone();
        record.patient.as_mut().unwrap().id = id.to_owned();
        record.station = Some(id.to_owned());
        record.findings[0].message = id.to_owned();
        record.findings[0].level = Some(id.to_owned());
        record.scan.unit = id.to_owned();
        record.made_by.gaiter = id.to_owned();
        for language in LANGUAGES {
            let page = made_page(&record, language);
            check_markup(&page);
            assert_eq!(page.matches("<script").count(), 2, "{id}");
            assert_eq!(page.matches("</script").count(), 2, "{id}");
            let heading = page.split("<h1>").nth(1).unwrap().split("</h1>").next().unwrap();
            assert!(heading.starts_with("<bdi>") && heading.ends_with("</bdi>"), "{heading}");
            assert_eq!(words(heading).trim(), shown);
            let json = page.split("id=\"record\">").nth(1).unwrap().split("</script>").next();
            let back: Record = serde_json::from_str(json.unwrap()).unwrap();
            assert_eq!(back, record);
        }
    }
}

#[test]
fn what_is_missing_is_said_with_its_reason_and_never_left_blank() {
    let lone = Record { legs: MADE.0.legs[..1].to_vec(), differences: None, ..MADE.0.clone() };
    let mut refused = lone.clone();
    refused.findings.push(gaiter_record::schema::FindingNote {
        says: None,
        code: "leg-not-measured".to_owned(),
        severity: "error".to_owned(),
        leg: Some("right".to_owned()),
        level: None,
        message: "the leg was not measured: the leg has too few points".to_owned(),
    });
    let mut bare = MADE.0.clone();
    for leg in &mut bare.legs {
        leg.landmarks.clear();
        leg.estimates.clear();
        leg.sections.clear();
        (leg.foot, leg.surface) = (None, None);
        (leg.shape, leg.volume) = Default::default();
    }
    let none = Record { legs: Vec::new(), differences: None, ..MADE.0.clone() };
    for (record, reason) in [
        (&lone, "leg not in the scan"),
        (&refused, "leg not measured"),
        (&bare, "foot not seen"),
        (&none, "leg not in the scan"),
    ] {
        for language in LANGUAGES {
            let page = made_page(record, language);
            check_markup(&page);
            for blank in ["<td></td>", "<dd></dd>", "<p></p>", "<span class=\"value\"></span>"] {
                assert!(!page.contains(blank), "{reason}: {blank}");
            }
        }
        assert!(words(&made_page(record, Language::En)).contains(reason), "{reason}");
        let content = ReportContent::from_record(record, Language::En, &Garment::default());
        let names: Vec<&str> = content.levels.rows.iter().map(|row| row.level.as_str()).collect();
        for level in Level::SOUGHT.map(Level::name) {
            assert!(names.contains(&level), "{reason}: no row for {level}");
        }
    }
    let content = ReportContent::from_record(&refused, Language::En, &Garment::default());
    assert_eq!(content.notes.entries[0].code, "leg-not-measured", "the heaviest note comes first");
    assert!(content.levels.rows.iter().all(|row| row.legs[0].girth.mark == Reliability::Missing));
    assert!(content.levels.rows.iter().any(|row| row.legs[1].girth.mark != Reliability::Missing));
}

#[test]
fn the_right_leg_is_on_the_left_and_a_swapped_record_swaps_every_figure() {
    let mut swapped = MADE.0.clone();
    for leg in &mut swapped.legs {
        leg.side = if leg.side == "left" { "right" } else { "left" }.to_owned();
    }
    let [rows, other] = [&MADE.0, &swapped]
        .map(|of| ReportContent::from_record(of, Language::En, &Garment::default()).levels.rows);
    for (row, other) in rows.iter().zip(&other) {
        assert_eq!(
            [&row.legs[0].girth, &row.legs[1].girth],
            [&other.legs[1].girth, &other.legs[0].girth]
        );
    }
    let page = made_page(&MADE.0, Language::En);
    let [right, left] = ["class=\"right\"", "class=\"left\""].map(|of| page.find(of).unwrap());
    assert!(right < left);
}

#[test]
fn a_difference_is_real_where_it_is_told_larger_than_its_uncertainty() {
    for (mm, sd_mm, value, margin, mark) in [
        (-4.2, Some(2.2), "\u{2212}0.4", "0.5", Reliability::Sure),
        (-4.2, Some(1.4), "\u{2212}0.4", "0.3", Reliability::Real),
        (12.0, None, "+1.2", "?", Reliability::Sure),
        (0.2, Some(0.01), "0.0", "0.1", Reliability::Sure),
    ] {
        let mut record = MADE.0.clone();
        for leg in &mut record.legs {
            let is_left = leg.side == "left";
            leg.profile.truncate(1);
            let at = &mut leg.profile[0];
            at.girth_tape_mm = Some(if is_left { 200.0 + mm } else { 200.0 });
            at.girth_sd_mm = sd_mm.map(|sd_mm| if is_left { sd_mm } else { 0.0 });
        }
        let content = ReportContent::from_record(&record, Language::En, &Garment::default());
        let told = &content.tables[0].rows[0].figures[2];
        assert_eq!(
            (told.value.as_str(), told.margin.as_deref(), told.mark),
            (value, Some(margin), mark)
        );
    }
}

#[test]
fn the_folder_holds_the_page_in_its_language_and_the_figures_that_were_asked_for() {
    let own = report_files(&MADE.0, &german()).unwrap();
    for file in &own {
        assert!(MADE.1.contains(file), "{}", file.name);
    }
    let names: Vec<&str> = MADE.1.iter().map(|file| file.name.as_str()).collect();
    for figure in ["views", "girths", "differences", "sections", "fit", "error"] {
        assert!(names.contains(&format!("figure-{figure}.svg").as_str()), "{names:?}");
    }
    let sums = file("SHA256SUMS");
    for name in names.iter().filter(|name| **name != "SHA256SUMS") {
        assert!(sums.contains(&format!("  {name}\n")), "{name}");
    }
}
