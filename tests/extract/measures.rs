//! `gaiter extract` as the real program: what it prints, what it writes, how it ends.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use sha2::{Digest, Sha256};
use support::mesh::{Mesh, fixture};
use tempfile::TempDir;

/// Runs `gaiter extract` in `folder`.
fn extract<A: AsRef<OsStr>>(folder: &Path, arguments: &[A]) -> Output {
    let mut command = Command::new(rig::verb::program());
    command.current_dir(folder).arg("extract").args(arguments).output().unwrap()
}

fn stdout(done: &Output) -> &str {
    std::str::from_utf8(&done.stdout).unwrap()
}

fn stderr(done: &Output) -> &str {
    std::str::from_utf8(&done.stderr).unwrap()
}

/// A folder with the mannequin's scan under these names.
fn folder_with(names: &[&str]) -> TempDir {
    let folder = TempDir::new().unwrap();
    let bytes = Mesh::mannequin().obj();
    names.iter().for_each(|name| fs::write(folder.path().join(name), &bytes).unwrap());
    folder
}

#[test]
fn the_table_holds_every_level_of_both_legs_in_centimetres() {
    let folder = folder_with(&["a.obj"]);
    let done = extract(folder.path(), &["a.obj"]);
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    assert_eq!(stderr(&done), "");
    let lines: Vec<&str> = stdout(&done).lines().collect();
    // Its feet end in an edge; the floor is told to lie a little below.
    let stature_cm: f64 = lines[2].split_whitespace().nth(1).unwrap().parse().unwrap();
    assert!((170.0..=170.6).contains(&stature_cm), "{lines:?}");
    assert!(lines[2].contains("unit of the scan mm (found)"), "{lines:?}");
    let rows = lines.iter().map(|line| line.split_whitespace().next().unwrap());
    let levels: Vec<&str> = rows.skip(5).take(9).collect();
    assert_eq!(levels, ["G", "F", "E", "D", "C", "B1", "B", "Y", "A"], "{lines:?}");
    // The mannequin's own rings: ankle, calf and knee of both legs alike.
    let girths_cm = [("B", 20.1), ("B1", 30.2), ("C", 37.1), ("D", 32.1)];
    let row = |level: &str| {
        lines.iter().find(|line| line.split_whitespace().next() == Some(level)).unwrap()
    };
    for (level, girth_cm) in girths_cm {
        let line = row(level);
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!((words[0], words.len()), (level, 9), "{line}");
        let [right, left] = [1, 5].map(|at: usize| words[at].parse::<f64>().unwrap());
        assert!((left - girth_cm).abs() < 0.3 && (right - girth_cm).abs() < 0.3, "{line}");
    }
    // Estimates are marked, and nothing else is.
    for (level, marks) in [("A", 2), ("E", 4), ("F", 4), ("G", 0), ("foot", 0), ("B", 0)] {
        assert_eq!(row(level).matches('~').count(), marks, "{}", row(level));
    }
}

/// What a key of the record must be.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Text,
    Number,
    Flag,
    Null,
    Numbers(usize),
    Words,
    /// A number or null.
    Judged,
    /// As many numbers or nulls as the girth curve has rows.
    Column,
}

fn assert_keys(object: &Value, place: &str, keys: &[(&str, Kind)]) {
    for (key, kind) in keys {
        let value = object.get(key).unwrap_or_else(|| panic!("{place} has no {key}"));
        let numbers = |values: &Value| values.as_array().unwrap().iter().all(Value::is_number);
        let fits = match kind {
            Kind::Text => value.is_string(),
            Kind::Number => value.is_number(),
            Kind::Flag => value.is_boolean(),
            Kind::Null => value.is_null(),
            Kind::Numbers(count) => value.as_array().unwrap().len() == *count && numbers(value),
            Kind::Words => value.as_array().unwrap().iter().all(Value::is_string),
            Kind::Judged => value.is_number() || value.is_null(),
            Kind::Column => {
                let cells = value.as_array().unwrap();
                let rows = object["along_axis_mm"].as_array().unwrap().len();
                cells.len() == rows && cells.iter().all(|cell| cell.is_number() || cell.is_null())
            }
        };
        assert!(fits, "{place}.{key} is no {kind:?}: {value}");
    }
}

#[test]
fn the_json_record_is_one_line_with_every_key_of_the_contract() {
    use Kind::{Column, Flag, Judged, Null, Number, Numbers, Text, Words};
    let folder = TempDir::new().unwrap();
    // The fixture with a gap at the calf, so that there is a finding.
    let bytes = fixture("f_average_tc2");
    fs::write(folder.path().join("4711_a.obj"), &bytes).unwrap();
    let done = extract(folder.path(), &["4711_a.obj", "--json"]);
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    assert!(stdout(&done).ends_with("}\n"));
    assert_eq!(stdout(&done).lines().count(), 1);
    let record: Value = serde_json::from_str(stdout(&done)).unwrap();

    let top = [("schema", Text), ("revision", Number), ("station", Null), ("patient", Null)];
    assert_keys(&record, "record", &top);
    assert_keys(&record, "record", &[("acquired", Null)]);
    assert_eq!(record["schema"], "gaiter.leg-record/1");
    assert_eq!(record["made_by"]["gaiter"], env!("CARGO_PKG_VERSION"));
    assert!(record["made_by"]["method"].is_object());
    let scan = &record["scan"];
    assert_keys(
        scan,
        "scan",
        &[("unit_inferred", Flag), ("points", Number), ("triangles", Number)],
    );
    assert_eq!(scan["sha256"], sha256(&bytes));
    assert_eq!((&scan["format"], &scan["unit"]), (&Value::from("obj"), &Value::from("cm")));
    let body = [
        ("stature_mm", Number),
        ("crotch_height_mm", Number),
        ("facing_deg", Number),
        ("facing_from", Text),
        ("from_export", Numbers(16)),
    ];
    assert_keys(&record["body"], "body", &body);

    let legs = record["legs"].as_array().unwrap();
    let sides: Vec<&str> = legs.iter().map(|leg| leg["side"].as_str().unwrap()).collect();
    assert_eq!(sides, ["left", "right"]);
    for leg in legs {
        assert_keys(leg, "leg", &[("tilt_deg", Number)]);
        let levels: Vec<&String> = leg["landmarks"].as_object().unwrap().keys().collect();
        assert_eq!(levels, ["B", "B1", "C", "D", "G", "Y"]);
        let place = [
            ("by", Text),
            ("height_mm", Number),
            ("along_axis_mm", Number),
            ("girth_tape_mm", Number),
            ("height_sd_mm", Judged),
            ("girth_sd_mm", Judged),
            ("doubts", Words),
        ];
        let lengths = ["surface_length_mm", "girth_per_deg_mm"].map(|key| (key, Judged));
        for at in leg["landmarks"].as_object().unwrap().values() {
            assert_keys(at, "landmark", &place);
            assert_keys(at, "landmark", &[("girth_contour_mm", Number)]);
            assert_keys(at, "landmark", &lengths);
        }
        let estimates = leg["estimates"].as_object().unwrap();
        assert!(estimates.keys().eq(["A", "E", "F"]), "{estimates:?}");
        estimates.values().for_each(|at| assert_keys(at, "estimate", &place));
        assert_keys(&leg["foot"], "foot", &[("length_mm", Number), ("breadth_mm", Number)]);
        let curve = &leg["girth_curve"];
        let columns = ["height_mm", "along_axis_mm", "tape_mm", "contour_mm"];
        assert_keys(curve, "girth_curve", &columns.map(|key| (key, Column)));
        assert_keys(curve, "girth_curve", &[("r2", Number)]);
        // Planes are 5 mm apart; about the knee the centres of neighbours lie aside of each other.
        for (column, most_mm) in [("height_mm", 5.1), ("along_axis_mm", 6.0)] {
            let rows = curve[column].as_array().unwrap();
            let steps = rows.windows(2).filter_map(|row| Some(row[1].as_f64()? - row[0].as_f64()?));
            assert!(steps.into_iter().all(|step| (0.0..most_mm).contains(&step)), "{column}");
        }
        assert_keys(&leg["axes"], "axes", &[("bend_deg", Number)]);
        let line = [("through_mm", Numbers(3)), ("direction", Numbers(3))];
        ["shank", "thigh"].iter().for_each(|part| assert_keys(&leg["axes"][part], part, &line));
        let section = [("level", Text), ("height_mm", Number), ("r2", Number), ("rms_mm", Number)];
        for at in leg["sections"].as_array().unwrap() {
            assert_keys(at, "section", &section);
            assert_keys(at, "section", &[("largest_gap_deg", Number)]);
        }
        let feature = [
            ("level", Text),
            ("label", Text),
            ("kind", Text),
            ("angle_deg", Number),
            ("position_mm", Numbers(3)),
            ("curvature_per_mm", Number),
        ];
        let features = leg["features"].as_array().unwrap();
        assert!(!features.is_empty());
        features.iter().for_each(|at| assert_keys(at, "feature", &feature));
        let surface = &leg["surface"];
        let extent = [
            ("control_points", Numbers(2)),
            ("degree", Numbers(2)),
            ("from_height_mm", Number),
            ("to_height_mm", Number),
        ];
        assert_keys(surface, "surface", &extent);
        for distances in ["to_sections", "to_points"] {
            let error = [("mean_relative", Number), ("rms_mm", Number), ("max_mm", Number)];
            assert_keys(&surface[distances], distances, &error);
        }
    }
    let findings = record["findings"].as_array().unwrap();
    assert!(!findings.is_empty());
    for finding in findings {
        assert_keys(finding, "finding", &["code", "severity", "message"].map(|key| (key, Text)));
        let whose = ["leg", "level"].map(|key| &finding[key]);
        assert!(whose.iter().all(|place| place.is_string() || place.is_null()), "{finding}");
    }
}

#[test]
fn of_several_scans_all_are_measured_and_the_worst_decides_the_exit_code() {
    let folder = folder_with(&["a.obj", "z.obj"]);
    fs::write(folder.path().join("bad.obj"), "v 0 0 0\n").unwrap();
    let codes = |names: &[&str]| {
        let done = extract(folder.path(), &[names, &["--json"]].concat());
        let lines: Vec<&str> = stdout(&done).lines().collect();
        assert!(lines.iter().all(|line| serde_json::from_str::<Value>(line).is_ok()), "{lines:?}");
        (done.status.code().unwrap(), lines.len(), stderr(&done).lines().count())
    };
    assert_eq!(codes(&["a.obj", "z.obj"]), (0, 2, 0));
    assert_eq!(codes(&["a.obj", "bad.obj", "z.obj"]), (65, 2, 1));
    assert_eq!(codes(&["missing.obj", "a.obj", "bad.obj"]), (66, 1, 2));
    assert_eq!(codes(&["/dev/null", "missing.obj", "bad.obj", "a.obj"]), (74, 1, 3));
    let done = extract(folder.path(), &["a.obj", "z.obj"]);
    let names: Vec<&str> = stdout(&done).lines().filter(|line| line.ends_with(".obj")).collect();
    assert_eq!(names, ["a.obj", "z.obj"], "the table says which scan is whose");
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// File names in a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let name = |entry: fs::DirEntry| entry.file_name().into_string().unwrap();
    let mut names: Vec<String> = fs::read_dir(folder).unwrap().map(|e| name(e.unwrap())).collect();
    names.sort();
    names
}

/// As `sha256sum -c` does, and that no file is left out.
fn assert_sums(folder: &Path) {
    let sums = fs::read_to_string(folder.join("SHA256SUMS")).unwrap();
    let mut listed = Vec::new();
    for line in sums.lines() {
        let (sum, name) = line.split_once("  ").unwrap();
        assert_eq!(sha256(&fs::read(folder.join(name)).unwrap()), sum, "{name}");
        listed.push(name.to_owned());
    }
    listed.push("SHA256SUMS".to_owned());
    listed.sort();
    assert_eq!(listed, names(folder));
}

#[test]
fn the_record_folder_holds_the_record_the_surfaces_and_the_scan_under_their_sums() {
    let folder = folder_with(&["4711_a.obj", "4711_b.obj"]);
    fs::write(folder.path().join("4711_a.ord"), "OPTION UNITS=mm\nMEASURE Calf=340\n").unwrap();
    let arguments = ["4711_a.obj", "4711_b.obj", "--out", "deep/records", "--json"];
    let done = extract(folder.path(), &arguments);
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    for (line, stem) in stdout(&done).lines().zip(["4711_a", "4711_b"]) {
        let record = folder.path().join("deep/records").join(stem);
        assert_sums(&record);
        let held = names(&record);
        for name in ["left.step", "measurements.csv", "record.json", "right.step", "scan.obj"] {
            assert!(held.iter().any(|file| file == name), "{name} is not among {held:?}");
        }
        let scan = fs::read(folder.path().join(format!("{stem}.obj"))).unwrap();
        assert_eq!(fs::read(record.join("scan.obj")).unwrap(), scan);
        assert_eq!(record.join("scanner.ord").exists(), stem == "4711_a", "{held:?}");
        let written: Value =
            serde_json::from_slice(&fs::read(record.join("record.json")).unwrap()).unwrap();
        assert_eq!(written, serde_json::from_str::<Value>(line).unwrap());
    }
}

#[test]
fn a_later_record_of_a_scan_replaces_the_earlier_one_whole() {
    let folder = folder_with(&["a.obj"]);
    let record = folder.path().join("out/a");
    fs::create_dir_all(&record).unwrap();
    let run = || extract(folder.path(), &["a.obj", "--out", "out", "--json"]);
    assert_eq!(run().status.code(), Some(0), "an empty folder is in nobody's way");
    // As an earlier gaiter would have left it, with a file that is no longer written.
    fs::write(record.join("report.txt"), "old").unwrap();
    let sums = fs::read_to_string(record.join("SHA256SUMS")).unwrap();
    let earlier = format!("{}  report.txt\n{sums}", sha256(b"old"));
    fs::write(record.join("SHA256SUMS"), earlier).unwrap();
    assert_eq!(run().status.code(), Some(0), "{}", stderr(&run()));
    assert_sums(&record);
    assert!(!record.join("report.txt").exists());
    assert_eq!(names(&folder.path().join("out")), ["a"], "nothing is left beside it");
}

#[test]
fn what_is_no_record_of_this_scan_stays_as_it_is() {
    let occupied = |why: &str, change: &dyn Fn(&Path)| {
        let folder = folder_with(&["a.obj"]);
        let run = || extract(folder.path(), &["a.obj", "--out", "out", "--json"]);
        assert_eq!(run().status.code(), Some(0));
        let record = folder.path().join("out/a");
        change(folder.path());
        let held = names(&folder.path().join("out"));
        let done = run();
        let said = stderr(&done);
        assert_eq!(done.status.code(), Some(74), "{why}: {said}");
        assert!(said.starts_with("gaiter: a.obj: out/a is not") && said.contains(why), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
        assert_eq!(names(&folder.path().join("out")), held, "{why}");
        record
    };
    let other = |at: &Path| {
        let scan = [b"# other\n".as_slice(), &Mesh::mannequin().obj()].concat();
        fs::write(at.join("a.obj"), scan).unwrap();
    };
    occupied("another scan", &other);
    occupied("its notes\\n.txt does not belong", &|at| {
        fs::write(at.join("out/a/notes\n.txt"), "").unwrap()
    });
    occupied("its deeper does not belong", &|at| fs::create_dir(at.join("out/a/deeper")).unwrap());
    occupied("legs.svg was changed", &|at| fs::write(at.join("out/a/legs.svg"), "mine").unwrap());
    occupied("SHA256SUMS", &|at| fs::remove_file(at.join("out/a/SHA256SUMS")).unwrap());
    occupied("not a folder", &|at| {
        fs::rename(at.join("out/a"), at.join("elsewhere")).unwrap();
        std::os::unix::fs::symlink(at.join("elsewhere"), at.join("out/a")).unwrap();
    });
}

#[test]
fn a_folder_that_cannot_be_written_ends_as_input_output_fault() {
    let folder = folder_with(&["a.obj", "occupied"]);
    let done = extract(folder.path(), &["a.obj", "--out", "occupied"]);
    assert_eq!(done.status.code(), Some(74));
    assert!(stderr(&done).starts_with("gaiter: a.obj: "), "{}", stderr(&done));
}

#[test]
fn a_reader_that_goes_away_is_no_fault() {
    let folder = folder_with(&["a.obj", "b.obj"]);
    let mut gaiter = Command::new(rig::verb::program())
        .current_dir(folder.path())
        .args(["extract", "a.obj", "b.obj", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Nobody reads: the first line already finds the pipe closed.
    drop(gaiter.stdout.take());
    let done = gaiter.wait_with_output().unwrap();
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    assert_eq!(stderr(&done), "");
}

#[test]
fn a_full_disk_behind_standard_output_is_a_fault() {
    let Ok(full) = fs::OpenOptions::new().write(true).open("/dev/full") else { return };
    let folder = folder_with(&["a.obj"]);
    let done = Command::new(rig::verb::program())
        .current_dir(folder.path())
        .args(["extract", "a.obj", "--json"])
        .stdout(full)
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(74), "{}", stderr(&done));
}

#[test]
fn names_of_all_kinds_are_taken() {
    let folder = TempDir::new().unwrap();
    let bytes = Mesh::mannequin().obj();
    let odd: [&[u8]; 6] = [
        "Jürgen Müßig – Kabine 2.obj".as_bytes(),
        "扫描.obj".as_bytes(),
        b"two  spaces and 'quotes\".obj",
        b"a.b.c.obj",
        b"-dash.obj",
        b"M\xfcller in Latin-1.obj",
    ];
    let names = odd.map(|name| PathBuf::from(OsStr::from_bytes(name)));
    names.iter().for_each(|name| fs::write(folder.path().join(name), &bytes).unwrap());
    let mut arguments: Vec<&OsStr> = ["--json", "--out", "out", "--"].map(OsStr::new).to_vec();
    arguments.extend(names.iter().map(|name| name.as_os_str()));
    let done = extract(folder.path(), &arguments);
    assert_eq!(done.status.code(), Some(0), "{}", stderr(&done));
    assert_eq!(stdout(&done).lines().count(), odd.len());
    for name in &names {
        assert_sums(&folder.path().join("out").join(name.file_stem().unwrap()));
    }
}
