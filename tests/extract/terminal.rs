//! `gaiter extract` on a terminal of the usual width: no line is wider, one unit, the scan and the written
//! files are named, and a body that lies on its side is told how it can be measured.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use rig::verb::{code, stderr, stdout};
use support::recorded::export;
use tempfile::TempDir;

/// All bodies of `fixtures/scans`.
const BODIES: [&str; 3] = ["f_average_clean", "f_average_tc2", "m_average_clean"];

/// Runs `gaiter extract` in a folder, 80 columns wide.
fn extract(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(rig::verb::program());
    command.current_dir(folder).arg("extract").args(arguments).env("COLUMNS", "80");
    command.output().unwrap()
}

fn scans() -> TempDir {
    let dir = TempDir::new().unwrap();
    let day = dir.path().join("scans of a day");
    fs::create_dir(&day).unwrap();
    for body in BODIES {
        let name = format!("{body}_with_a_name_that_is_far_too_long_for_a_table.obj");
        fs::write(day.join(name), export(body)).unwrap();
    }
    fs::write(day.join("no_scan.obj"), "v 0 0 0\n").unwrap();
    dir
}

/// The lines that are wider than the terminal.
fn too_wide(text: &str) -> Vec<&str> {
    text.lines().filter(|line| line.chars().count() > 80).collect()
}

#[test]
fn no_line_is_wider_than_the_terminal_and_all_figures_are_in_centimetres() {
    let dir = scans();
    let output = extract(dir.path(), &["scans of a day", "--at", "10,150"]);
    assert_eq!(code(&output), Some(65), "{}", stderr(&output));
    let said = stdout(&output);
    assert_eq!(too_wide(&said), [""; 0]);
    assert!(!said.contains(" mm,") && !said.contains("girth mm"), "{said}");
    assert_eq!(said.matches("scans of a day").count(), 1, "the folder is said once: {said}");
    assert!(said.contains("f_average…e.obj") || said.contains('…'), "{said}");
    let of_one = extract(dir.path(), &["scans of a day/no_scan.obj"]);
    assert_eq!((code(&of_one), stdout(&of_one).as_str()), (Some(65), ""));
}

#[test]
fn what_was_written_and_where_is_said_after_each_scan() {
    let dir = TempDir::new().unwrap();
    fs::write(dir.path().join("4711.obj"), export(BODIES[1])).unwrap();
    let output = extract(dir.path(), &["4711.obj", "--out", "measured"]);
    let said = stdout(&output);
    assert!(said.starts_with("4711.obj\n"), "{said}");
    let words = said.split_whitespace().collect::<Vec<_>>().join(" ");
    let (_, written) = words.split_once("written to measured/4711: ").unwrap();
    let mut named: Vec<&str> = written.split(", ").collect();
    named.sort_unstable();
    let entries = fs::read_dir(dir.path().join("measured/4711")).unwrap();
    let mut there: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    there.sort_unstable();
    assert_eq!(named, there);
    assert_eq!(too_wide(&said), [""; 0]);
    // A program gets the record alone.
    let output = extract(dir.path(), &["4711.obj", "--out", "measured", "--json"]);
    assert_eq!(stdout(&output).lines().count(), 1);
}

/// The export of a body with other coordinates.
fn turned(body: &str, turn: impl Fn([&str; 3]) -> String) -> String {
    let text = String::from_utf8(export(body)).unwrap();
    let line = |line: &str| match line.split_whitespace().collect::<Vec<_>>()[..] {
        ["v", x, y, z, ..] => format!("v {}\n", turn([x, y, z])),
        _ => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

#[test]
fn a_body_that_lies_on_its_side_is_told_the_option_that_measures_it_and_only_that() {
    let dir = TempDir::new().unwrap();
    let put = |name: &str, text: String| fs::write(dir.path().join(name), text).unwrap();
    put("z.obj", turned(BODIES[0], |[x, y, z]| format!("{x} -{z} {y}").replace("--", "")));
    put("x.obj", turned(BODIES[0], |[x, y, z]| format!("{y} {z} {x}")));
    // Mirrored, so that no axis makes a body of it.
    put("mirrored.obj", turned(BODIES[0], |[x, y, z]| format!("{x} {z} {y}")));
    for up in ["z", "x"] {
        let name = format!("{up}.obj");
        let refused = extract(dir.path(), &[&name]);
        assert_eq!(code(&refused), Some(65));
        let said = stderr(&refused);
        assert!(said.trim_end().ends_with(&format!("--up {up} measures it")), "{said}");
        assert_eq!(code(&extract(dir.path(), &[&name, "--up", up])), Some(0));
    }
    let refused = extract(dir.path(), &["mirrored.obj"]);
    assert_eq!(code(&refused), Some(65));
    let said = stderr(&refused);
    assert!(!said.contains("--up") && said.contains("that `up` is right"), "{said}");
}
