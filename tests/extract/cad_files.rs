//! The CAD files and meshes of a record: which are made, what they are called, and what the record
//! says of those that cannot be made.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Output as Done};
use std::sync::LazyLock;

use gaiter::config::words::{FILES, meaning};
use gaiter_cad::{FileKind, Output};
use gaiter_leg::{Extraction, Method, extract};
use gaiter_record::{Provenance, Record, RecordFile, ReportChoice, ScanFile, record_files, sha256};
use gaiter_scan::Format;
use nalgebra::Vector3;
use support::recorded::export;
use support::tubes::dented;
use tempfile::TempDir;

static BYTES: LazyLock<Vec<u8>> = LazyLock::new(|| export("f_average_clean"));

static MEASURED: LazyLock<Extraction> =
    LazyLock::new(|| extract(&BYTES, Format::Obj, &Method::default()).unwrap());

fn kinds(words: &[&str]) -> BTreeSet<FileKind> {
    words.iter().map(|word| meaning(FILES, word).unwrap()).collect()
}

fn made(extraction: &Extraction, output: &Output) -> (Record, Vec<RecordFile>) {
    let sha256 = sha256(&BYTES);
    let provenance = Provenance::of_scan(sha256);
    let method = Method::default();
    let scan = ScanFile { bytes: &BYTES, format: Format::Obj, ord: None };
    record_files(extraction, &provenance, &method, output, &ReportChoice::default(), scan).unwrap()
}

/// The names of the files that are made of one leg.
fn names(files: &[RecordFile], side: &str) -> Vec<String> {
    files.iter().map(|file| &file.name).filter(|name| name.starts_with(side)).cloned().collect()
}

#[test]
fn without_a_word_each_leg_is_one_step_file() {
    let (record, files) = made(&MEASURED, &Output::default());
    assert_eq!(names(&files, "left"), ["left.step"]);
    assert_eq!(names(&files, "right"), ["right.step"]);
    let text = std::str::from_utf8(&files.iter().find(|f| f.name == "left.step").unwrap().bytes);
    assert!(text.unwrap().contains("AUTOMOTIVE_DESIGN") && text.unwrap().contains("OPEN_SHELL"));
    assert_eq!(
        record.findings,
        made(&MEASURED, &Output { files: BTreeSet::new(), ..Output::default() }).0.findings
    );
}

#[test]
fn every_word_makes_a_file_of_its_own_name() {
    let words: Vec<&str> = FILES.iter().map(|(word, _)| *word).collect();
    let output = Output { files: kinds(&words), mesh_tolerance_mm: 1.0 };
    let (_, files) = made(&MEASURED, &output);
    let mut found = names(&files, "left");
    found.sort_unstable();
    let expected = [
        "left-ap242-solid.step",
        "left-ap242.step",
        "left-solid.glb",
        "left-solid.igs",
        "left-solid.obj",
        "left-solid.step",
        "left-solid.stl",
        "left.glb",
        "left.igs",
        "left.obj",
        "left.step",
        "left.stl",
    ];
    assert_eq!(found, expected);
    assert_eq!(names(&files, "right").len(), FILES.len());
}

#[test]
fn a_coarser_mesh_has_fewer_triangles_and_exact_files_stay_as_they_are() {
    let of = |mesh_tolerance_mm| {
        made(&MEASURED, &Output { files: kinds(&["step", "stl"]), mesh_tolerance_mm }).1
    };
    let (fine, coarse) = (of(0.05), of(0.5));
    let bytes = |files: &[RecordFile], name: &str| {
        files.iter().find(|file| file.name == name).unwrap().bytes.clone()
    };
    assert!(bytes(&fine, "left.stl").len() > 4 * bytes(&coarse, "left.stl").len());
    assert_eq!(bytes(&fine, "left.step"), bytes(&coarse, "left.step"));
}

#[test]
fn a_file_that_cannot_be_made_is_a_finding_and_the_record_has_all_others() {
    let mut extraction = MEASURED.clone();
    let right = extraction.legs[1].surface.as_mut().unwrap();
    right.surface = dented(&right.surface, 0, Vector3::new(0.0, 0.0, -3.0));
    let output = Output {
        files: kinds(&["step", "step-solid", "iges-solid", "stl-solid"]),
        ..Output::default()
    };
    let (record, files) = made(&extraction, &output);
    assert_eq!(names(&files, "right"), ["right.step", "right-solid.stl"]);
    assert_eq!(names(&files, "left").len(), 4);
    let found: Vec<_> = record.findings.iter().filter(|f| f.code == "ends-not-plane").collect();
    let said: Vec<_> = found.iter().map(|note| note.message.split(':').next().unwrap()).collect();
    assert_eq!(said, ["right-solid.step was not made", "right-solid.igs was not made"]);
    assert!(found.iter().all(|note| note.leg.as_deref() == Some("right") && note.level.is_none()));
    let why = "the lower end of the surface is not plane: it leaves its plane by 2.";
    assert!(found[0].message.contains(why), "{}", found[0].message);

    let written = files.iter().find(|file| file.name == "record.json").unwrap();
    let written: Record = serde_json::from_slice(&written.bytes).unwrap();
    assert_eq!(written.findings, record.findings);
    let fine = Output { files: kinds(&["stl"]), mesh_tolerance_mm: 1e-6 };
    let (record, files) = made(&MEASURED, &fine);
    assert_eq!(names(&files, "left"), [""; 0]);
    assert_eq!(record.findings.iter().filter(|f| f.code == "mesh-not-made").count(), 2);
}

fn run(folder: &Path, arguments: &[&str]) -> Done {
    let mut command = Command::new(rig::verb::program());
    command.current_dir(folder).arg("extract").args(arguments).output().unwrap()
}

#[test]
fn the_command_line_names_files_and_the_configuration_is_under_it() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("a.obj"), &*BYTES).unwrap();
    let config = "[station]\nid = \"t\"\nstate_dir = \"/s\"\n[scanner]\nexport_dirs = [\"/e\"]\n\
                  [output]\nfiles = [\"glb\", \"iges\"]\n[store.folder]\npath = \"/r\"\n";
    fs::write(folder.path().join("station.toml"), config).unwrap();
    let cases: [(&[&str], &[&str]); 3] = [
        (&["--files", "step,stl-solid,step"], &["left-solid.stl", "left.step"]),
        (&["--config", "station.toml"], &["left.glb", "left.igs"]),
        (&["--config", "station.toml", "--files", "obj"], &["left.obj"]),
    ];
    for (options, expected) in cases {
        let done = run(folder.path(), &[&["a.obj", "--out", "out"], options].concat());
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        let made = fs::read_dir(folder.path().join("out/a")).unwrap();
        let made = made.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut made: Vec<String> = made.filter(|name| name.starts_with("left")).collect();
        made.sort_unstable();
        assert_eq!(made, expected, "{options:?}");
    }
}

#[test]
fn a_word_that_is_no_file_is_told_with_those_that_are() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("a.obj"), &*BYTES).unwrap();
    let done = run(folder.path(), &["a.obj", "--out", "out", "--files", "step,dxf"]);
    let said = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(64), "{said}");
    assert!(said.contains("'dxf'") && said.contains("step-ap242-solid"), "{said}");
    assert!(!folder.path().join("out").exists());
}
