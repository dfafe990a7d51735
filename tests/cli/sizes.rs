//! `gaiter sizes` as the real program: what it says of tables and of records, and where it stops. `gaiter order` of an
//! old scan.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use gaiter_leg::Method;
use gaiter_record::sha256;
use rig::stored::{content, store};
use rig::verb::{code, gaiter, stderr, stdout};
use serde_json::Value;
use support::coarse_body;
use tempfile::TempDir;

const EXAMPLE: &str = include_str!("../../config/sizes/invented-example.toml");
const GARMENT: &str = include_str!("../../fixtures/cases/sizes/garment_of_a_shop.toml");

fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap();
    path.display().to_string()
}

fn check(args: &[&str]) -> Output {
    gaiter(&[&["sizes", "check"], args].concat())
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A record of a body, in a folder of a store.
fn record(dir: &TempDir) -> PathBuf {
    store(dir.path(), "4711", "20261121T091500Z", &coarse_body(1), &Method::default())
}

/// `gaiter sizes` of a record, where no station is configured.
fn sizes(record: &Path, more: &[&str]) -> Output {
    gaiter(&[&["sizes", record.to_str().unwrap()], more].concat())
}

#[test]
fn every_slip_of_a_table_is_told_with_file_line_what_was_found_and_what_to_do() {
    let dir = TempDir::new().unwrap();
    let slips: [(&str, &str, &str, &str); 8] = [
        ("cB = [18, 20]", "cB = [18,0, 20,5]", "[18,0, 20,5]", "decimals with a point"),
        ("cB = [18, 20]", "cB = [180, 205]", "180 cm is no cB", "look at the decimal point"),
        (
            "cB = [18, 20]",
            "cB = [20, 18]",
            "limit 20 is not below",
            "write the lower limit first: [18, 20]",
        ),
        ("cB = [18, 20]", "cB = 18-20", "cB = 18-20", "write two numbers"),
        ("unit = \"cm\"\n", "", "unit: must be set", "write unit = \"cm\""),
        ("name = \"II\"", "name = \"I\"", "\"I\" stands twice", "rename one of the two"),
        ("unit = \"cm\"", "unit = \"mm\"", "18 mm is no cB", "unit = \"mm\""),
        ("cB = [18, 20]", "CB = [18, 20]", "CB: unknown key", "did you mean cB?"),
    ];
    for (right, slip, found, hint) in slips {
        assert!(EXAMPLE.contains(right), "{right}");
        let path = write(dir.path(), "maker.toml", EXAMPLE.replacen(right, slip, 1));
        let output = check(&[&path]);
        let said = stdout(&output).split_whitespace().collect::<Vec<_>>().join(" ");
        // A missing unit is told at the top, a wrong one where the first limit is that no leg has.
        let at = match slip {
            "" => 0,
            "unit = \"mm\"" => EXAMPLE.find("cB = [").unwrap(),
            _ => EXAMPLE.find(right).unwrap(),
        };
        let line = EXAMPLE[..at].matches('\n').count() + 1;
        assert_eq!(code(&output), Some(65), "{slip}: {said}");
        let place = format!(" {line}:");
        for part in [path.as_str(), &place, found, hint] {
            assert!(said.contains(part), "{slip}: {part}: {said}");
        }
    }
}

#[test]
fn what_a_windows_editor_writes_is_read_and_what_is_not_utf_8_is_told_with_its_line() {
    let dir = TempDir::new().unwrap();
    let windows = format!("\u{feff}{}", EXAMPLE.replace('\n', "\r\n"));
    let output = check(&[&write(dir.path(), "windows.toml", windows)]);
    assert_eq!(code(&output), Some(0), "{}", stdout(&output));
    let latin = [b"maker = \"M\n\n\xfcller\"".as_slice()].concat();
    let path = write(dir.path(), "latin.toml", latin);
    let output = check(&[&path]);
    assert_eq!(code(&output), Some(65));
    let expected = format!("gaiter: {path}:3: this is not UTF-8 text; save the file as UTF-8\n");
    assert_eq!(stderr(&output), expected);
}

#[test]
fn remarks_are_no_fault_and_come_in_both_languages_and_as_json() {
    let dir = TempDir::new().unwrap();
    write(dir.path(), "a.toml", EXAMPLE.replace("2027-01-31", "2026-01-31"));
    write(dir.path(), "shop.toml", GARMENT);
    let folder = dir.path().to_str().unwrap();
    for (language, marks) in [
        (
            "en",
            [
                "gap at cB, sizes II and III: nothing between 22.0 and 22.5 cm",
                "valid until 2026-01-31",
            ],
        ),
        (
            "de",
            [
                "Lücke bei cB, Größen II und III: nichts zwischen 22,0 und 22,5 cm",
                "sie galt bis 2026-01-31",
            ],
        ),
    ] {
        let output = check(&[folder, "--language", language]);
        assert_eq!(code(&output), Some(0), "{}", stderr(&output));
        for mark in marks {
            assert!(stdout(&output).contains(mark), "{mark}: {}", stdout(&output));
        }
    }
    let said = json(&check(&[folder, "--json"]));
    assert_eq!(said["schema"], "gaiter.size-check/1");
    let [table, garment] = [&said["files"][0], &said["files"][1]];
    assert_eq!(
        (&table["id"], &table["faults"]),
        (&"example-invented".into(), &Value::Array(vec![]))
    );
    let codes: Vec<&str> = table["remarks"]
        .as_array()
        .unwrap()
        .iter()
        .map(|of| of["code"].as_str().unwrap())
        .collect();
    assert_eq!(codes, ["test-only", "expired", "touch", "gap", "gap"]);
    assert!(garment["garment"].is_string() && garment["id"].is_null(), "{garment}");
}

#[test]
fn files_that_are_not_there_end_with_66_and_folders_without_tables_with_65() {
    let dir = TempDir::new().unwrap();
    let none = dir.path().join("none.toml");
    assert_eq!(code(&check(&[none.to_str().unwrap()])), Some(66));
    let output = check(&[dir.path().to_str().unwrap()]);
    assert_eq!(code(&output), Some(65));
    assert!(stderr(&output).contains("holds no file that ends in .toml"), "{}", stderr(&output));
}

#[test]
fn a_record_is_judged_by_every_table_with_its_id_edition_and_hash_and_no_choice() {
    let dir = TempDir::new().unwrap();
    let record = record(&dir);
    let before = content(&record);
    let other = EXAMPLE.replace("example-invented", "second").replace("\"skin\"", "\"tension\"");
    let tables = [write(dir.path(), "a.toml", EXAMPLE), write(dir.path(), "b.toml", &other)];
    let output = sizes(&record, &["--table", &tables[0], "--table", &tables[1], "--json"]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let said = json(&output);
    assert_eq!(
        (&said["schema"], &said["garment"]),
        (&"gaiter.size-verdicts/1".into(), &"AD".into())
    );
    let [first, second] = [&said["tables"][0], &said["tables"][1]];
    for (table, (id, text)) in
        [first, second].into_iter().zip([("example-invented", EXAMPLE), ("second", &other)])
    {
        assert_eq!((&table["id"], &table["edition"]), (&id.into(), &"2026-01, invented".into()));
        assert_eq!(table["sha256"], sha256(text.as_bytes()));
    }
    assert_eq!(second["not_comparable"], "tension");
    assert_eq!(second["legs"], Value::Array(vec![]));
    let names = |leg: &Value| -> Vec<String> {
        let sizes = leg["sizes"].as_array().unwrap();
        sizes.iter().map(|of| of["size"].as_str().unwrap().to_owned()).collect()
    };
    for leg in first["legs"].as_array().unwrap() {
        assert_eq!(names(leg), ["I", "II", "III"], "every size is told, in the order of the table");
    }
    // The record's own girths, to their last digit.
    let stored: Value =
        serde_json::from_slice(&fs::read(record.join("record.json")).unwrap()).unwrap();
    let mut given = 0;
    for leg in first["legs"].as_array().unwrap() {
        let legs = stored["legs"].as_array().unwrap();
        let its = legs.iter().find(|of| of["side"] == leg["side"]).unwrap();
        for point in leg["sizes"][0]["points"].as_array().unwrap() {
            let landmark =
                &its["landmarks"][point["point"].as_str().unwrap().trim_start_matches('c')];
            if point["reading"]["is"] == "given" {
                assert_eq!(point["reading"]["mm"], landmark["girth_tape_mm"]);
                let sd_mm = landmark["girth_sd_mm"].as_f64().unwrap();
                let told = point["reading"]["uncertainty_mm"].as_f64().unwrap();
                assert!(
                    (told - sd_mm.hypot(1.0)).abs() < 1e-9,
                    "the scanner's own millimetre counts"
                );
                given += 1;
            }
        }
    }
    assert!(given >= 2, "{first}");
    assert_eq!(content(&record), before, "a verdict changes no record");
}

#[test]
fn the_verdicts_are_read_in_both_languages() {
    let dir = TempDir::new().unwrap();
    let record = record(&dir);
    let table = write(dir.path(), "a.toml", EXAMPLE);
    for (language, marks) in [
        ("en", ["TEST ONLY", "gaiter chooses none", "Right leg", "Calibre jump"]),
        ("de", ["NUR ZUM TEST", "gaiter wählt keine aus", "Rechtes Bein", "Kalibersprung"]),
    ] {
        let output = sizes(&record, &["--table", &table, "--language", language]);
        assert_eq!(code(&output), Some(0), "{}", stderr(&output));
        let said = stdout(&output).split_whitespace().collect::<Vec<_>>().join(" ");
        for mark in marks {
            assert!(said.contains(mark), "{mark}: {said}");
        }
    }
}

#[test]
fn a_table_with_a_fault_judges_nothing_and_an_unknown_garment_is_a_wrong_command_line() {
    let dir = TempDir::new().unwrap();
    let record = record(&dir);
    let bad = write(dir.path(), "bad.toml", EXAMPLE.replace("[18, 20]", "[20, 18]"));
    let output = sizes(&record, &["--table", &bad]);
    assert_eq!((code(&output), stdout(&output)), (Some(65), String::new()));
    assert!(stderr(&output).contains(&format!("{bad}:38:6: size.I.cB")), "{}", stderr(&output));
    let good = write(dir.path(), "good.toml", EXAMPLE);
    let output = sizes(&record, &["--table", &good, "--garment", "BC"]);
    assert_eq!(code(&output), Some(64));
    assert!(stderr(&output).contains("known are AD, AF, AG, AT"), "{}", stderr(&output));
    let output = sizes(&dir.path().join("none"), &["--table", &good]);
    assert_eq!(code(&output), Some(66), "{}", stderr(&output));
}

/// A station whose configuration names tables.
fn station(root: &Path, more: &str) -> PathBuf {
    let at = root.display();
    fs::create_dir_all(root.join("export")).unwrap();
    let text = format!(
        "[station]\nid = \"t\"\nstate_dir = \"{at}/state\"\n[scanner]\nexport_dirs = [\"{at}/export\"]\n\
         [store.folder]\npath = \"{at}/records\"\n{more}"
    );
    let file = root.join("station.toml");
    fs::write(&file, text).unwrap();
    file
}

#[test]
fn the_tables_the_garment_and_the_error_of_the_configuration_count_where_none_is_named() {
    let dir = TempDir::new().unwrap();
    let record = record(&dir);
    write(dir.path(), "a.toml", EXAMPLE);
    let more = format!(
        "[sizes]\ntables = [\"{}/a.toml\"]\n[report]\ngarment = \"AG\"\nlanguage = \"de\"\n",
        dir.path().display()
    );
    let config = station(dir.path(), &more);
    let text = fs::read_to_string(&config).unwrap();
    fs::write(&config, text.replace("[store", "girth_error = \"4mm\"\n[store")).unwrap();
    let said = json(&sizes(&record, &["--json", "--config", config.to_str().unwrap()]));
    assert_eq!((&said["garment"], &said["scanner_girth_mm"]), (&"AG".into(), &4.0.into()));
    assert_eq!(said["tables"][0]["id"], "example-invented");
    let output = stdout(&sizes(&record, &["--config", config.to_str().unwrap()]));
    assert!(output.contains("Größen") && output.contains("4 mm"), "{output}");
}

#[test]
fn check_names_each_fault_of_a_table_with_its_place_and_warns_of_what_is_old_or_unsigned() {
    let dir = TempDir::new().unwrap();
    let bad = write(dir.path(), "bad.toml", EXAMPLE.replace("[18, 20]", "[20, 18]"));
    let config = station(dir.path(), &format!("[sizes]\ntables = [\"{bad}\"]\n"));
    let checked = |config: &Path| gaiter(&["check", "--config", config.to_str().unwrap()]);
    let output = checked(&config);
    assert_eq!(code(&output), Some(78));
    let said = stderr(&output) + &stdout(&output);
    let place = format!("{}:9:11: sizes.tables", config.display());
    for part in [place.as_str(), &format!("{bad}:38:6: size.I.cB"), "write the lower limit first"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let old = EXAMPLE.replace("2027-01-31", "2026-01-31").replace("checked_by", "note_checked_by");
    let old = write(dir.path(), "old.toml", old);
    let output = checked(&station(dir.path(), &format!("[sizes]\ntables = [\"{old}\"]\n")));
    let said = stdout(&output);
    for part in ["valid until 2026-01-31", "names are missing: checked_by", "touching limits: 3"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let twice = format!("[sizes]\ntables = [\"{old}\", \"{}/./old.toml\"]\n", dir.path().display());
    let output = checked(&station(dir.path(), &twice));
    let said = stderr(&output) + &stdout(&output);
    assert!(said.contains("\"example-invented\" stands twice"), "{said}");
    let none = format!("[sizes]\ntables = [\"{}/none.toml\"]\n", dir.path().display());
    let output = checked(&station(dir.path(), &none));
    assert_eq!(code(&output), Some(78));
    assert!((stderr(&output) + &stdout(&output)).contains("none.toml: No such file"));
}

/// A day on which no scan of today was taken.
const LONG_AGO: &str = "2016-11-21T09:14:59Z";

/// `gaiter order` of a record whose scan was taken on a day.
fn order_of(day: &str, more: &[&str]) -> Output {
    let dir = TempDir::new().unwrap();
    let text = fs::read_to_string(record(&dir).join("record.json")).unwrap();
    let of_day = write(dir.path(), "record.json", text.replace("2026-11-21T09:14:59Z", day));
    gaiter(&[&["order", of_day.as_str()], more].concat())
}

#[test]
fn the_order_of_a_scan_that_is_too_old_says_so_on_the_terminal_and_in_the_table() {
    let old = order_of(LONG_AGO, &[]);
    assert_eq!(code(&old), Some(0), "{}", stderr(&old));
    let said = stderr(&old);
    assert!(said.contains("too old for an order: its measures held until 2017-05-20"), "{said}");
    assert!(stdout(&old).contains(";scan-age;"), "{}", stdout(&old));
    let now = jiff::Timestamp::now().to_string();
    let fresh = order_of(&now, &[]);
    assert!(!stderr(&fresh).contains("too old") && !stdout(&fresh).contains("scan-age"));
}

#[test]
fn an_order_is_told_in_both_languages_and_its_table_for_people_too_but_programs_read_the_same() {
    let dir = TempDir::new().unwrap();
    let mut exact = Vec::new();
    for (language, marks, head) in [
        (
            "en",
            ["open, body: cT (no scan gives it", "too old for an order", "nothing vouches"],
            "\u{feff}Format,Order,",
        ),
        (
            "de",
            ["offen, Rumpf: cT (gibt kein Scan an", "zu alt für eine Bestellung", "bürgt nichts"],
            "\u{feff}Format;Auftrag;",
        ),
    ] {
        let out = dir.path().join(language);
        let out = out.to_str().unwrap();
        let more = ["--garment", "AT", "--ref", "3-12", "--language", language, "--out", out];
        let output = order_of(LONG_AGO, &more);
        assert_eq!(code(&output), Some(0), "{}", stderr(&output));
        for mark in marks {
            assert!(stderr(&output).contains(mark), "{mark}: {}", stderr(&output));
        }
        let read = |name: &str| fs::read_to_string(Path::new(out).join(name)).unwrap();
        let table = read("order-spreadsheet.csv");
        assert!(table.starts_with(head) && table.contains("\"=\"\"3-12\"\"\""), "{table}");
        exact.push(read("order.csv"));
    }
    assert!(exact[0].starts_with("format;order_ref;") && exact[0].contains(";3-12;"));
    assert_eq!(exact[0], exact[1]);
}

#[test]
fn an_order_has_the_language_of_the_configuration_unless_another_is_named() {
    let dir = TempDir::new().unwrap();
    let config = station(dir.path(), "[report]\nlanguage = \"de\"\n");
    let config = config.to_str().unwrap();
    let said = stderr(&order_of(LONG_AGO, &["--config", config]));
    assert!(said.contains("zu alt für eine Bestellung"), "{said}");
    let said = stderr(&order_of(LONG_AGO, &["--config", config, "--lang", "en"]));
    assert!(said.contains("too old for an order"), "{said}");
}
