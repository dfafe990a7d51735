//! `gaiter reextract` as the real program: what it adds, what it leaves, what it says.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread::yield_now;

use gaiter::store::sums;
use gaiter_leg::Method;
use gaiter_leg::method::SectionFit;
use rig::stored::{content, store};
use rig::verb::{code, gaiter, program, stderr, stdout};
use rig::{Booth, names, sha256};
use serde_json::Value;
use support::coarse_body;

const AT: &str = "20261121T091500Z";

/// The paper's sections instead of today's.
fn paper() -> Method {
    Method { fit: SectionFit::Paper, ..Method::default() }
}

fn reextract(records: &Path, more: &[&str]) -> Output {
    gaiter(&[&["reextract", records.to_str().unwrap()], more].concat())
}

/// The JSON lines of a run, by scan.
fn told(records: &Path, more: &[&str]) -> Vec<Value> {
    let output = reextract(records, &[more, &["--json"]].concat());
    let said = stdout(&output);
    said.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn record(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("record.json")).unwrap()).unwrap()
}

/// The folder of a later revision.
fn revision(folder: &Path, number: u32) -> PathBuf {
    PathBuf::from(format!("{}_r{number}", folder.display()))
}

/// Whether a folder is the whole record of these bytes.
fn is_whole(folder: &Path, bytes: &[u8]) -> bool {
    sums::check(folder, &sums::scan_id(bytes)).unwrap() == Ok(())
}

#[test]
fn another_method_adds_a_revision_beside_the_old_record_once() {
    let dir = tempfile::tempdir().unwrap();
    let bytes = coarse_body(1);
    let old = store(dir.path(), "4711", AT, &bytes, &paper());
    let before = content(&old);

    let output = reextract(dir.path(), &[]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let said = stdout(&output);
    assert!(said.starts_with("1 record: 0 unchanged, 1 with a new revision\n"), "{said}");
    assert!(said.contains(&format!("{}  1 > 2", &sha256(&bytes)[..8])), "{said}");
    assert!(!said.contains("4711"), "the patient is named:\n{said}");
    let new = revision(&old, 2);
    assert!(is_whole(&new, &bytes));
    assert_eq!(content(&old), before, "the old record was touched");
    let (was, is) = (record(&old), record(&new));
    assert_eq!(is["revision"], 2);
    for key in ["station", "patient", "acquired", "scan"] {
        assert_eq!(was[key], is[key], "{key}");
    }
    assert_ne!(was["legs"], is["legs"]);
    let inode = |folder: &Path| fs::metadata(folder.join("scan.obj")).unwrap().ino();
    assert_ne!(inode(&old), inode(&new), "a change of one scan would change the other");

    let all = content(dir.path());
    for records in [dir.path(), &dir.path().join("4711"), &old, &new] {
        let said = stdout(&reextract(records, &[]));
        assert_eq!(said, "1 record: 1 unchanged\n");
    }
    assert_eq!(content(dir.path()), all, "it was done again");
}

#[test]
fn what_changed_is_told_with_the_old_figure_and_the_new() {
    let dir = tempfile::tempdir().unwrap();
    let old = store(dir.path(), "4711", AT, &coarse_body(1), &paper());
    let told = told(dir.path(), &["--dry-run"]);
    assert_eq!(names(&dir.path().join("4711")).len(), 1, "a dry run wrote");
    reextract(dir.path(), &[]);
    let [line] = &told[..] else { panic!("{told:?}") };
    assert_eq!((&line["outcome"], &line["from_revision"]), (&"would_be_revised".into(), &1.into()));
    assert!(line["revision"].is_null() && line.get("folder").is_none(), "{line}");
    let (was, is) = (record(&old), record(&revision(&old, 2)));
    let levels = line["levels"].as_array().unwrap();
    let count = |place: &str| line[place].as_array().unwrap().len();
    let held = |record: &Value| -> usize {
        let legs = record["legs"].as_array().unwrap().iter();
        legs.map(|leg| leg["landmarks"].as_object().unwrap().len()).sum()
    };
    assert_eq!(levels.len() + count("went"), held(&was), "{line}");
    assert_eq!(levels.len() + count("came"), held(&is), "{line}");
    for level in levels {
        let place = ["leg", "level"].map(|key| level[key].as_str().unwrap());
        for (record, which) in [(&was, "old"), (&is, "new")] {
            let legs = record["legs"].as_array().unwrap();
            let leg = legs.iter().find(|leg| leg["side"] == place[0]).unwrap();
            let landmark = &leg["landmarks"][place[1]];
            assert_eq!(level["girth_mm"][which], landmark["girth_tape_mm"], "{level}");
            assert_eq!(level["height_mm"][which], landmark["height_mm"], "{level}");
        }
    }
    assert!(levels.iter().any(|level| level["girth_mm"]["old"] != level["girth_mm"]["new"]));
}

#[test]
fn a_configuration_is_obeyed_and_without_one_what_was_asked_for_stays() {
    let booth = Booth::new();
    let root = booth.path("records");
    let asked = Method { at_heights_mm: vec![300.0], ..Method::default() };
    let old = store(&root, "4711", AT, &coarse_body(1), &asked);
    assert_eq!(stdout(&reextract(&root, &[])), "1 record: 1 unchanged\n");
    booth.reconfigure(|text| text + "[method]\nb1 = \"80mm\"\n");
    let config = booth.path("station.toml");
    let output = reextract(&root, &["--config", config.to_str().unwrap()]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let new = record(&revision(&old, 2));
    assert_eq!(new["made_by"]["method"]["b1_above_b"], "80mm");
    for leg in new["legs"].as_array().unwrap() {
        let height = |level: &str| leg["landmarks"][level]["height_mm"].as_f64().unwrap();
        assert!((height("B1") - height("B") - 80.0).abs() < 1.0, "{leg}");
    }
    // What that revision was asked for holds for the next.
    assert_eq!(stdout(&reextract(&root, &[])), "1 record: 1 unchanged\n");
}

#[test]
fn a_damaged_record_is_refused_and_the_others_are_measured() {
    let dir = tempfile::tempdir().unwrap();
    let [damaged, strange, good] =
        [1, 2, 3].map(|n| store(dir.path(), "4711", AT, &coarse_body(n), &paper()));
    let csv = damaged.join("measurements.csv");
    fs::write(&csv, "changed by hand").unwrap();
    // Somebody has moved a record into another patient's folder.
    let elsewhere = dir.path().join("4712").join(strange.file_name().unwrap());
    fs::create_dir(dir.path().join("4712")).unwrap();
    fs::rename(&strange, &elsewhere).unwrap();
    let output = reextract(dir.path(), &[]);
    assert_eq!(code(&output), Some(65), "{}", stdout(&output));
    let said = stderr(&output);
    assert!(said.contains("[record-damaged]") && said.contains("measurements.csv"), "{said}");
    assert!(said.contains("[record-of-another]"), "{said}");
    assert_eq!(said.lines().count(), 2, "{said}");
    assert!(!said.contains("4711"), "{said}");
    assert!(is_whole(&revision(&good, 2), &coarse_body(3)));
    assert!(!revision(&damaged, 2).exists() && !revision(&elsewhere, 2).exists());
    assert!(stdout(&output).starts_with("3 records: 0 unchanged, 1 with a new revision, 2 not"));
    let for_programs = reextract(dir.path(), &["--dry-run", "--json"]);
    assert_eq!(code(&for_programs), Some(65), "{}", stdout(&for_programs));
    let named = stderr(&reextract(dir.path(), &["--names"]));
    assert!(named.contains("4711/"), "folders are named where that is asked for: {named}");
}

#[test]
fn what_an_older_gaiter_did_not_write_is_completed_only_where_that_is_asked_for() {
    let dir = tempfile::tempdir().unwrap();
    let old = store(dir.path(), "4711", AT, &coarse_body(1), &Method::default());
    let path = old.join("record.json");
    let before = fs::read(&path).unwrap();
    let mut older = record(&old);
    for leg in older["legs"].as_array_mut().unwrap() {
        leg.as_object_mut().unwrap().remove("axes").unwrap();
    }
    let after = serde_json::to_vec(&older).unwrap();
    fs::write(&path, &after).unwrap();
    let sums = fs::read_to_string(old.join("SHA256SUMS")).unwrap();
    fs::write(old.join("SHA256SUMS"), sums.replace(&sha256(&before), &sha256(&after))).unwrap();
    assert_eq!(stdout(&reextract(dir.path(), &[])), "1 record: 1 unchanged\n");
    assert!(!revision(&old, 2).exists());
    let said = stdout(&reextract(dir.path(), &["--complete"]));
    assert!(said.starts_with("1 record: 0 unchanged, 1 with a new revision\n"), "{said}");
    assert_eq!(record(&revision(&old, 2))["revision"], 2);
}

#[test]
fn scans_seen_before_a_day_are_left_out() {
    let dir = tempfile::tempdir().unwrap();
    let early = store(dir.path(), "4711", "20251121T235959Z", &coarse_body(1), &paper());
    let late = store(dir.path(), "4711", "20251122T000000Z", &coarse_body(2), &paper());
    let output = reextract(dir.path(), &["--since", "2025-11-22"]);
    let said = stdout(&output);
    assert!(said.starts_with("1 record: 0 unchanged, 1 with a new revision; 1 were"), "{said}");
    assert!(!revision(&early, 2).exists() && revision(&late, 2).exists());
}

#[test]
fn a_place_without_records_is_said_to_be_none() {
    let dir = tempfile::tempdir().unwrap();
    for place in [dir.path().to_owned(), dir.path().join("missing")] {
        let output = reextract(&place, &[]);
        assert_eq!(code(&output), Some(66), "{}", stderr(&output));
    }
    assert_eq!(code(&reextract(dir.path(), &["--since", "yesterday"])), Some(64));
}

#[test]
fn a_run_that_is_killed_anywhere_leaves_only_whole_records() {
    let dir = tempfile::tempdir().unwrap();
    let scans = [1, 2, 3].map(coarse_body);
    let olds = [0, 1, 2].map(|n| store(dir.path(), "4711", AT, &scans[n], &paper()));
    let patient = dir.path().join("4711");
    let staged = |file: &str| {
        let names = names(&patient).into_iter().filter(|name| name.starts_with('.'));
        names.map(|name| patient.join(name).join(file)).any(|path| path.exists())
    };
    let revisions = || names(&patient).iter().filter(|name| name.contains("_r")).count();
    // Each run goes on where the last was cut off; one that is too quick to be seen ends by itself.
    let moments: [&dyn Fn() -> bool; 5] = [
        &|| staged(""),
        &|| staged("record.json"),
        &|| revisions() == 1 && staged("scan.obj"),
        &|| staged("SHA256SUMS"),
        &|| revisions() == 2,
    ];
    for (number, moment) in moments.iter().enumerate() {
        let mut command = Command::new(program());
        command.arg("reextract").arg(dir.path()).args(["--jobs", "1"]);
        let mut run = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        while !moment() && run.try_wait().unwrap().is_none() {
            yield_now();
        }
        run.kill().unwrap();
        run.wait().unwrap();
        for folder in names(&patient).into_iter().filter(|name| !name.starts_with('.')) {
            let whole = scans.iter().any(|scan| is_whole(&patient.join(&folder), scan));
            assert!(whole, "{folder} after kill {number}");
        }
    }
    let left = patient.join(".reextract.1.20261121T091500Z_01234567_r2");
    fs::create_dir(&left).unwrap();
    assert_eq!(code(&reextract(dir.path(), &[])), Some(0));
    assert_eq!(names(&patient).len(), 6, "{:?}", names(&patient));
    assert!(olds.iter().zip(&scans).all(|(old, scan)| is_whole(&revision(old, 2), scan)));
}

#[test]
fn a_station_knows_its_records_with_revisions_and_takes_them_back_whole() {
    let booth = Booth::new();
    let daemon = booth.start();
    let bytes = coarse_body(1);
    booth.export("4711_a.obj", &bytes);
    booth.wait_for_records(1);
    // Beside the running station.
    let config = booth.path("other.toml");
    let text = fs::read_to_string(booth.path("station.toml")).unwrap();
    fs::write(&config, text + "[method]\ntape = \"leg\"\n").unwrap();
    let (root, patient) = (booth.path("records"), booth.path("records/4711"));
    let output = reextract(&root, &["--config", config.to_str().unwrap()]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    assert_eq!(names(&patient).len(), 2, "{:?}", names(&patient));

    // A station that lost its journal finds one record in two folders.
    assert_eq!(daemon.stop().code(), Some(0));
    fs::remove_dir_all(booth.path("state")).unwrap();
    let daemon = booth.start();
    let delivered =
        "SELECT count(*) FROM deliveries WHERE state = 'delivered' AND patient = '4711'";
    booth.wait_for_journal(delivered, 1);
    fs::remove_file(booth.path("export/4711_a.obj")).unwrap();
    booth.export("4711_again.obj", &bytes);
    booth.wait_until_explained("4711_again.obj", "was delivered");
    assert_eq!(names(&patient).len(), 2, "{:?}", names(&patient));

    // The scan was not this patient's after all.
    let output = booth.gaiter(&["unassign", &sha256(&bytes)[..8]]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    booth.wait_for("the withdrawal", || names(&patient).is_empty());
    assert_eq!(names(&booth.path("records/_unassigned")).len(), 1);
    assert_eq!(daemon.stop().code(), Some(0));
}
