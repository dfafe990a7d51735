//! `gaiter` as a program: what the command line and `check` end with, and what they print.

#![allow(clippy::unwrap_used)]

#[path = "support/verb.rs"]
mod verb;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;
use verb::{code, gaiter, stderr, stdout};

/// A configuration over folders in `root`, of which only the export folder exists.
fn station(root: &Path, more: &str) -> PathBuf {
    let at = root.display();
    fs::create_dir_all(root.join("export")).unwrap();
    let file = root.join("station.toml");
    let text = format!(
        "[station]\nid = \"t\"\nstate_dir = \"{at}/state\"\n[scanner]\nexport_dirs = [\"{at}/export\"]\n\
         max_scan = \"1MB\"\n{more}[store.folder]\npath = \"{at}/records\"\n"
    );
    fs::write(&file, text).unwrap();
    file
}

fn check(file: &Path, more: &[&str]) -> Output {
    gaiter(&[&["check", "--config", file.to_str().unwrap()], more].concat())
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn help_and_version_are_no_fault_and_go_to_standard_output() {
    for args in [["--help"].as_slice(), &["--version"], &["help"], &["extract", "--help"]] {
        let output = gaiter(args);
        assert_eq!(code(&output), Some(0), "{args:?}");
        assert!(stdout(&output).contains("gaiter") && output.stderr.is_empty(), "{args:?}");
    }
}

#[test]
fn a_wrong_command_line_ends_with_64() {
    let wrong: [&[&str]; 6] = [
        &[],
        &["measure"],
        &["extract"],
        &["extract", "a.obj", "--unit", "ft"],
        &["extract", "a.obj", "--facing"],
        &["check", "--patient", "4711"],
    ];
    for args in wrong {
        let output = gaiter(args);
        assert_eq!(code(&output), Some(64), "{args:?}");
        assert!(output.stdout.is_empty() && !output.stderr.is_empty(), "{args:?}");
    }
}

#[test]
fn a_configuration_that_is_not_there_ends_with_66() {
    let root = TempDir::new().unwrap();
    let output = check(&root.path().join("none.toml"), &[]);
    assert_eq!(code(&output), Some(66));
    assert!(stderr(&output).contains("none.toml"), "{}", stderr(&output));
    let output = check(&root.path().join("none.toml"), &["--json"]);
    assert_eq!(code(&output), Some(66));
    assert_eq!(json(&output)["exit"], 66);
}

#[test]
fn a_configuration_that_cannot_be_read_ends_with_74() {
    let root = TempDir::new().unwrap();
    assert_eq!(code(&check(root.path(), &[])), Some(74), "a folder is no file");
}

#[test]
fn faults_of_the_configuration_end_with_78_and_are_told_with_the_name_of_the_file() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "quiet = \"2 sec\"\ncolour = 1\n");
    let output = check(&file, &[]);
    assert_eq!(code(&output), Some(78));
    assert!(output.stdout.is_empty());
    let said = stderr(&output);
    let first = format!("{}:7:9: scanner.quiet: \"2 sec\" is not a duration\n", file.display());
    assert!(said.starts_with(&first), "{said}");
    assert!(said.contains("  7 | quiet = \"2 sec\"\n    |         ^^^^^^^\n    hint: "), "{said}");
    assert!(said.ends_with("has 2 faults\n"), "{said}");

    let output = check(&file, &["--json"]);
    assert_eq!(code(&output), Some(78));
    let report = json(&output);
    assert_eq!(report["faults"].as_array().unwrap().len(), 2);
    assert_eq!(report["faults"][0]["key"], "scanner.quiet");
    assert_eq!(
        (&report["faults"][0]["line"], &report["faults"][0]["column"]),
        (&7.into(), &9.into())
    );
}

#[test]
fn a_sound_station_ends_with_0_and_the_check_leaves_nothing_behind() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "");
    let output = check(&file, &[]);
    assert_eq!(code(&output), Some(0), "{}{}", stdout(&output), stderr(&output));
    assert!(stdout(&output).contains("does not exist yet; can be made in"));
    let mut left: Vec<_> =
        fs::read_dir(root.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["export", "station.toml"]);

    fs::create_dir(root.path().join("state")).unwrap();
    let output = check(&file, &["--json"]);
    assert_eq!(code(&output), Some(0));
    let report = json(&output);
    let state =
        report["checks"].as_array().unwrap().iter().find(|row| row["check"] == "state folder");
    assert_eq!(state.unwrap()["detail"], "can be written, synced and renamed in");
    assert_eq!(fs::read_dir(root.path().join("state")).unwrap().count(), 0);
}

#[test]
fn faults_of_the_environment_end_with_74_and_are_all_told() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "");
    fs::remove_dir(root.path().join("export")).unwrap();
    fs::write(root.path().join("state"), "a file").unwrap();
    std::os::unix::fs::symlink("nowhere", root.path().join("records")).unwrap();
    let output = check(&file, &["--json"]);
    assert_eq!(code(&output), Some(74));
    let report = json(&output);
    for check in ["export folder", "state folder", "record store"] {
        let rows = report["checks"].as_array().unwrap();
        let row = rows.iter().find(|row| row["check"] == check).unwrap();
        assert_eq!(row["verdict"], "fail", "{row}");
    }
    let output = check(&file, &[]);
    assert_eq!(code(&output), Some(74));
    assert!(stdout(&output).contains("is not a folder"), "{}", stdout(&output));
}

#[test]
fn a_link_from_one_folder_into_another_is_found() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "");
    std::os::unix::fs::symlink("export", root.path().join("records")).unwrap();
    let output = check(&file, &[]);
    assert_eq!(code(&output), Some(74));
    assert!(stdout(&output).contains("folders apart"), "{}", stdout(&output));
}

#[test]
fn a_quiet_time_above_the_rescan_is_a_warning_and_no_fault() {
    let root = TempDir::new().unwrap();
    let output = check(&station(root.path(), "quiet = \"30s\"\n"), &[]);
    assert_eq!(code(&output), Some(0));
    assert!(stdout(&output).contains("warn  timing"), "{}", stdout(&output));
}

#[test]
fn a_reader_that_has_gone_is_no_fault() {
    let root = TempDir::new().unwrap();
    let file = station(root.path(), "");
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let status = Command::new(env!("CARGO_BIN_EXE_gaiter"))
        .args(["check", "--config"])
        .arg(&file)
        .stdout(writer)
        .status()
        .unwrap();
    assert_eq!(status.code(), Some(0));
}
