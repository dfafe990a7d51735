//! `gaiter extract` as the real program, what clinics chart: heights, volumes, differences, and the
//! scanner's own measures beside the scan.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use support::mesh::{Mesh, fixture};
use tempfile::TempDir;

fn gaiter(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(rig::verb::program());
    command.current_dir(folder).arg("extract").args(arguments).output().unwrap()
}

fn stdout(done: &Output) -> &str {
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    std::str::from_utf8(&done.stdout).unwrap()
}

fn record(folder: &Path, arguments: &[&str]) -> Value {
    serde_json::from_str(stdout(&gaiter(folder, &[arguments, &["--json"]].concat()))).unwrap()
}

/// A folder with the mannequin's scan under this name; its stature is 1700 mm.
fn folder_with(name: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join(name), Mesh::mannequin().obj()).unwrap();
    folder
}

/// Codes and severities of a record's findings that come from a second opinion.
fn opinions(record: &Value) -> Vec<String> {
    let findings = record["findings"].as_array().unwrap().iter();
    let word = |finding: &Value, key: &str| finding[key].as_str().unwrap().to_owned();
    let told = findings.map(|finding| word(finding, "code") + " " + &word(finding, "severity"));
    told.filter(|told| told.starts_with("ord-")).collect()
}

#[test]
fn heights_stand_in_the_table_the_record_and_the_csv_of_both_legs() {
    let folder = folder_with("a.obj");
    let asked = ["a.obj", "--at", "10,30.5,120"];
    let done = gaiter(folder.path(), &asked);
    let lines: Vec<&str> = stdout(&done).lines().collect();
    // The mannequin is round, narrow at 10 cm; no leg reaches 120 cm.
    let at = lines.iter().position(|line| line.trim_start().starts_with("at 10 cm")).unwrap();
    let words: Vec<&str> = lines[at].split_whitespace().collect();
    assert_eq!((words[1], words[5], words[8], words.len()), ("10", "10.0", "10.0", 9), "{lines:?}");
    assert!(lines[at + 1].trim_start().starts_with("at 30.5 cm"), "{lines:?}");
    let words: Vec<&str> = lines[at + 2].split_whitespace().collect();
    assert_eq!(words, ["at", "120", "cm", "not", "found", "not", "found"]);
    let about_it = lines[at + 3..].iter().find(|line| line.contains("[height-not-measured]"));
    assert!(about_it.is_some_and(|line| line.contains("right · left")), "{lines:?}");

    let record = record(folder.path(), &[&asked[..], &["--out", "out"]].concat());
    for leg in record["legs"].as_array().unwrap() {
        let heights = leg["at"].as_array().unwrap().iter().map(|at| at["height_mm"].as_f64());
        assert_eq!(heights.collect::<Vec<_>>(), [Some(100.0), Some(305.0), Some(1200.0)]);
        assert!(
            leg["at"][0]["girth_tape_mm"].as_f64().is_some_and(|mm| (200.0..240.0).contains(&mm))
        );
        assert!(leg["at"][2]["girth_tape_mm"].is_null());
    }
    assert_eq!(record["made_by"]["method"]["at_heights_mm"], "100, 305, 1200");
    let csv = fs::read_to_string(folder.path().join("out/a/measurements.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv
        .split("\r\n")
        .map(|line| line.split(',').collect())
        .filter(|row: &Vec<_>| row.len() > 1 && row[1] != "verdict")
        .collect();
    let levels = 9;
    assert_eq!(rows.len(), 1 + 2 * (levels + 3));
    assert!(rows.iter().all(|row| row.len() == 14), "{csv}");
    let state = |row: &[&str]| [0, 1, 2, 4, 8].map(|at: usize| row[at].to_owned());
    let measured = ["right", "at 10 cm", "measured", "10.0", "100"];
    assert_eq!(state(&rows[1 + levels]), measured);
    let measured = ["right", "at 30.5 cm", "measured", "30.5", "305"];
    assert_eq!(state(&rows[2 + levels]), measured);
    let unseen =
        ["right", "at 120 cm", "not found", "", "120.0", "height-not-measured", "", "", "1200"];
    assert_eq!(rows[3 + levels], [&unseen[..], &[""; 5]].concat());
    let is_right = |leg: &&Value| leg["side"] == "right";
    let right = record["legs"].as_array().unwrap().iter().find(is_right).unwrap();
    let tape = right["at"][1]["girth_tape_mm"].as_f64().unwrap();
    assert_eq!(rows[2 + levels][6].parse::<f64>().unwrap(), tape);
}

#[test]
fn the_configuration_asks_for_heights_and_the_command_line_for_others() {
    let folder = folder_with("a.obj");
    let shipped =
        include_str!("../../config/station.toml").replace("\nat = []", "\nat = [10, 20.5]");
    fs::write(folder.path().join("station.toml"), shipped).unwrap();
    let heights = |arguments: &[&str]| -> Vec<f64> {
        let record = record(folder.path(), &[&["a.obj"], arguments].concat());
        let at = record["legs"][0]["at"].as_array().unwrap().clone();
        at.iter().map(|at| at["height_mm"].as_f64().unwrap()).collect()
    };
    assert_eq!(heights(&[]), [0.0; 0]);
    assert_eq!(heights(&["--config", "station.toml"]), [100.0, 205.0]);
    assert_eq!(heights(&["--config", "station.toml", "--at", "30"]), [300.0]);
}

#[test]
fn volumes_and_differences_stand_in_the_record() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("a.obj"), fixture("f_average_tc2")).unwrap();
    let record = record(folder.path(), &["a.obj"]);
    for leg in record["legs"].as_array().unwrap() {
        let volume = &leg["volume"];
        for key in ["whole_ml", "from_height_mm", "to_height_mm", "sd_ml", "b_to_d_ml"] {
            assert!(volume[key].is_number(), "{key}: {volume}");
        }
        let slices = volume["slices"].as_array().unwrap();
        assert!(slices.len() > 15);
        assert!(slices[0]["ml"].is_null(), "nobody sees a sole");
        assert_eq!((&slices[2]["from_mm"], &slices[2]["to_mm"]), (&80.0.into(), &120.0.into()));
        assert!(slices[2]["ml"].is_number());
    }
    let differences = &record["differences"];
    let of = |leg: usize, level: &str| {
        record["legs"][leg]["landmarks"][level]["girth_tape_mm"].as_f64().unwrap()
    };
    let levels = differences["levels"].as_array().unwrap();
    let c = levels.iter().find(|at| at["level"] == "C").unwrap();
    let girth = c["girth_tape_mm"].as_f64().unwrap();
    assert!((girth - (of(0, "C") - of(1, "C"))).abs() < 0.002, "left minus right: {c}");
    assert!(differences["whole"]["percent"].as_f64().unwrap() > 4.0);
    assert!(!differences["slices"].as_array().unwrap().is_empty());
}

#[test]
fn the_measures_beside_a_scan_are_found_whatever_joins_the_words_of_its_name() {
    for ord in ["first visit.ord", "first+visit.ORD", "first_visit.Ord"] {
        let folder = folder_with("first visit.obj");
        let wrong = "OPTION UNITS=cm\r\nMEASURE Stature=1700,0\r\n";
        fs::write(folder.path().join(ord), wrong).unwrap();
        fs::write(folder.path().join("other.ord"), "nonsense").unwrap();
        let record = record(folder.path(), &["first visit.obj"]);
        assert_eq!(opinions(&record), ["ord-unit warning"], "{ord}");
        // From another folder too.
        let path = folder.path().join("first visit.obj");
        let elsewhere = TempDir::new().unwrap();
        let record = self::record(elsewhere.path(), &[path.to_str().unwrap()]);
        assert_eq!(opinions(&record), ["ord-unit warning"], "{ord}");
    }
}

#[test]
fn measures_that_agree_and_no_measures_say_nothing() {
    let folder = folder_with("a.obj");
    let plain = record(folder.path(), &["a.obj"]);
    assert_eq!(opinions(&plain), [""; 0]);
    let agrees = "OPTION UNITS=in\nMEASURE Head_Top_Height=66.9\nMEASURE Calf_Left=14.6\n";
    fs::write(folder.path().join("a.ord"), agrees).unwrap();
    assert_eq!(record(folder.path(), &["a.obj"]), plain);
    fs::write(folder.path().join("a.ord"), agrees.replace("14.6", "16.6")).unwrap();
    assert_eq!(opinions(&record(folder.path(), &["a.obj"])), ["ord-disagrees warning"]);
}

#[test]
fn measures_that_cannot_be_read_or_told_apart_do_not_keep_the_scan_from_being_measured() {
    let folder = folder_with("a b.obj");
    let spoilt = |bytes: &[u8]| {
        fs::write(folder.path().join("a b.ord"), bytes).unwrap();
        let record = record(folder.path(), &["a b.obj"]);
        assert_eq!(record["legs"].as_array().unwrap().len(), 2);
        assert_eq!(opinions(&record), ["ord-unreadable warning"]);
        record["findings"].to_string()
    };
    assert!(spoilt(b"OPTION UNITS=cm\nMEASURE Calf=3x\n").contains("line 2"));
    assert!(spoilt(&[0; 40]).contains("binary"));
    assert!(spoilt(&vec![b'\n'; 2 << 20]).contains("bytes"));
    fs::remove_file(folder.path().join("a b.ord")).unwrap();
    fs::create_dir(folder.path().join("a b.ord")).unwrap();
    let record = record(folder.path(), &["a b.obj"]);
    assert_eq!(opinions(&record), ["ord-unreadable warning"]);
    fs::write(folder.path().join("a_b.ord"), "OPTION UNITS=cm\nMEASURE Stature=17\n").unwrap();
    let record = self::record(folder.path(), &["a b.obj"]);
    assert_eq!(opinions(&record), ["ord-ambiguous warning"]);
}
