//! `gaiter extract` over folders: which scans, in which order, and the summary at the end.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use rig::verb::{code, program, stderr, stdout};
use serde_json::Value;
use support::mesh::Mesh;

/// Runs `gaiter extract` in a folder.
fn extract(within: &Path, args: &[&str]) -> Output {
    Command::new(program()).current_dir(within).arg("extract").args(args).output().unwrap()
}

/// A folder of scans of the mannequin, one of them no scan, one hidden, one in a folder within.
fn scans() -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let day = dir.path().join("day");
    fs::create_dir_all(day.join("deeper")).unwrap();
    let bytes = Mesh::mannequin().obj();
    for name in ["c.obj", "a.obj", "e.OBJ", "d.obj", ".hidden.obj", "deeper/f.obj"] {
        fs::write(day.join(name), &bytes).unwrap();
    }
    fs::write(day.join("b.obj"), "no scan").unwrap();
    fs::write(day.join("notes.pdf"), "no scan").unwrap();
    (dir, day)
}

/// The JSON lines of a run without what the names of the files decide.
fn records(output: &Output) -> Vec<Value> {
    stdout(output).lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn all_scans_of_a_folder_are_measured_in_order_and_summed_up() {
    let (dir, _) = scans();
    let output = extract(dir.path(), &["day"]);
    assert_eq!(code(&output), Some(65), "{}", stderr(&output));
    let said = stdout(&output);
    let heads: Vec<&str> =
        said.lines().filter(|line| !line.is_empty() && !line.contains(' ')).collect();
    assert_eq!(heads, ["day:", "a.obj", "c.obj", "d.obj", "e.OBJ"]);
    assert_eq!(stderr(&output).lines().count(), 1, "{}", stderr(&output));
    // The summary: a row a scan, girths in cm as in the mannequin's rings, the refusal's code.
    let (_, summary) = said.rsplit_once("  verdict\n").unwrap();
    let rows: Vec<Vec<&str>> =
        summary.lines().map(|line| line.split_whitespace().collect()).collect();
    let names: Vec<&str> = rows.iter().map(|row| row[0]).collect();
    assert_eq!(names, ["a.obj", "b.obj", "c.obj", "d.obj", "e.OBJ", "5"]);
    assert_eq!(rows[1][1..], ["not", "measured", "[scan-cut-short]"], "{summary}");
    for row in [&rows[0], &rows[2], &rows[3], &rows[4]] {
        let girths: Vec<f64> = row[1..9].iter().map(|cell| cell.parse().unwrap()).collect();
        for (girth, truth) in girths.iter().zip([32.1, 37.1, 30.2, 20.1].repeat(2)) {
            assert!((girth - truth).abs() < 0.3, "{row:?}");
        }
    }
    let totals = rows.last().unwrap().join(" ");
    assert!(totals.starts_with("5 scans: 4 measured (4 "), "{summary}");
    assert!(totals.ends_with("), 1 not measured (1 scan-cut-short)"), "{summary}");
}

#[test]
fn folders_within_are_looked_at_where_that_is_asked_for() {
    let (dir, day) = scans();
    let count = |args: &[&str]| records(&extract(dir.path(), &[args, &["--json"]].concat())).len();
    assert_eq!((count(&["day"]), count(&["day", "--recursive"])), (4, 5));
    assert_eq!(count(&["day/deeper", "day/a.obj"]), 2);
    fs::create_dir(day.join("empty")).unwrap();
    let output = extract(dir.path(), &["day/empty", "day/a.obj", "--json"]);
    assert_eq!((code(&output), records(&output).len()), (Some(66), 1));
    assert!(stderr(&output).contains("day/empty: the folder holds no scan"), "{}", stderr(&output));
}

#[test]
fn as_many_at_a_time_as_one_likes_give_the_same_in_the_same_order() {
    let (dir, _) = scans();
    let run = |jobs: &str| extract(dir.path(), &["day", "--recursive", "--jobs", jobs]);
    let one = run("1");
    for jobs in ["2", "9"] {
        let several = run(jobs);
        assert_eq!((stdout(&several), stderr(&several)), (stdout(&one), stderr(&one)), "{jobs}");
    }
    assert_eq!(code(&run("0")), Some(64));
}

#[test]
fn the_records_of_a_folder_are_written_where_their_names_are_their_own() {
    let (dir, day) = scans();
    let output = extract(dir.path(), &["day", "--out", "out", "--json"]);
    assert_eq!(code(&output), Some(65), "{}", stderr(&output));
    let mut written: Vec<String> = fs::read_dir(dir.path().join("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    written.sort();
    assert_eq!(written, ["a", "c", "d", "e"]);
    fs::copy(day.join("a.obj"), day.join("deeper/a.obj")).unwrap();
    let output = extract(dir.path(), &["day", "--recursive", "--out", "other", "--json"]);
    assert_eq!((code(&output), stdout(&output).as_str()), (Some(64), ""));
    assert!(stderr(&output).contains("would both go to other/a"), "{}", stderr(&output));
}
