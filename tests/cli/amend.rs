//! `gaiter amend` of a record in a folder, as the real program: what it adds, what it leaves, what it refuses.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use gaiter::store::sums;
use gaiter_leg::Method;
use rig::names;
use rig::stored::{content, store};
use rig::verb::{code, gaiter, stderr, stdout};
use serde_json::{Value, json};
use support::coarse_body;

const AT: &str = "20261121T091500Z";

/// `gaiter amend` of the right leg, with a reason and a name.
fn amend(record: &Path, more: &[&str]) -> Output {
    let record = record.to_str().unwrap();
    let said = ["--reason", "swollen", "--by", "Anna Berg"];
    gaiter(&[&["amend", record, "--leg", "right"], more, &said].concat())
}

fn record(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("record.json")).unwrap()).unwrap()
}

fn revision(folder: &Path, number: u32) -> PathBuf {
    PathBuf::from(format!("{}_r{number}", folder.display()))
}

fn is_whole(folder: &Path, bytes: &[u8]) -> bool {
    sums::check(folder, &sums::scan_id(bytes)).unwrap() == Ok(())
}

#[test]
fn a_measure_that_a_person_sets_is_a_revision_in_which_all_of_the_scan_stays() {
    let dir = tempfile::tempdir().unwrap();
    let bytes = coarse_body(1);
    let old = store(dir.path(), "4711", AT, &bytes, &Method::default());
    let before = content(&old);
    let output = amend(&old, &["--level", "C", "--girth-cm", "38.55"]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("*38.6"), "{}", stdout(&output));
    assert_eq!(content(&old), before, "the earlier revision was touched");
    let new = revision(&old, 2);
    assert!(is_whole(&new, &bytes));
    let (was, mut is) = (record(&old), record(&new));
    assert_eq!(is["revision"], 2);
    let mut set = is["amendments"][0].take();
    assert!(set["at"].take().is_string());
    let expected = json!({"leg": "right", "measure": "C", "is": "measured", "girth_mm": 385.5,
        "height_mm": null, "length_mm": null, "reason": "swollen", "by": "Anna Berg", "at": null});
    assert_eq!(set, expected);
    is.as_object_mut().unwrap().remove("amendments");
    is["revision"] = 1.into();
    assert_eq!(is, was, "the scan's values changed");
    // What does not show a measure is the same to the last byte.
    let made_again = [
        "record.json",
        "measurements.csv",
        "measurements-spreadsheet.csv",
        "legs.svg",
        "report.html",
        "report.pdf",
        "order.csv",
        "order-spreadsheet.csv",
        "order.json",
        "SHA256SUMS",
    ];
    for name in names(&old) {
        let same = fs::read(old.join(&name)).unwrap() == fs::read(new.join(&name)).unwrap();
        assert_eq!(same, !made_again.contains(&name.as_str()), "{name}");
    }
    assert_eq!(names(&old), names(&new));

    // The next one goes on from the latest, whichever revision is named.
    let output = amend(&old.join("record.json"), &["--level", "D", "--not-measurable"]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let third = record(&revision(&old, 3));
    assert_eq!(third["amendments"].as_array().unwrap().len(), 2);
    assert!(is_whole(&revision(&old, 3), &bytes));
    let output = amend(&new, &["--level", "D", "--take-back", "--json"]);
    let said: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(said["revision"], 4);
    assert_eq!(said["folder"], revision(&old, 4).display().to_string());
}

#[test]
fn measuring_the_scan_again_keeps_what_people_set() {
    let dir = tempfile::tempdir().unwrap();
    let method = Method { fit: gaiter_leg::method::SectionFit::Paper, ..Method::default() };
    let old = store(dir.path(), "4711", AT, &coarse_body(1), &method);
    assert_eq!(code(&amend(&old, &["--level", "c", "--girth-cm", "38.5", "--sure"])), Some(0));
    let output = gaiter(&["reextract", dir.path().to_str().unwrap()]);
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    let [amended, again] = [2, 3].map(|number| record(&revision(&old, number)));
    assert_ne!(amended["legs"], again["legs"], "another method gives other figures");
    assert_eq!(amended["amendments"], again["amendments"]);
    let csv = fs::read_to_string(revision(&old, 3).join("measurements.csv")).unwrap();
    assert!(csv.contains("right,C,by hand,38.5,"), "{csv}");
    // A second run finds nothing to do.
    let said = stdout(&gaiter(&["reextract", dir.path().to_str().unwrap()]));
    assert_eq!(said, "1 record: 1 unchanged\n");
}

#[test]
fn a_record_of_extract_gets_its_revisions_beside_it() {
    let dir = tempfile::tempdir().unwrap();
    let (scan, out) = (dir.path().join("4711.obj"), dir.path().join("measured"));
    fs::write(&scan, coarse_body(1)).unwrap();
    let extracted = gaiter(&["extract", scan.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert_eq!(code(&extracted), Some(0), "{}", stderr(&extracted));
    let place = out.join("4711");
    for number in [2, 3] {
        let output = amend(&place, &["--level", "foot-length", "--length-cm", "21,5"]);
        assert_eq!(code(&output), Some(0), "{}", stderr(&output));
        assert_eq!(record(&revision(&place, number))["revision"], number);
        assert!(is_whole(&revision(&place, number), &coarse_body(1)));
    }
    assert_eq!(names(&out), ["4711", "4711_r2", "4711_r3"]);
}

#[test]
fn what_is_refused_says_why_and_writes_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let old = store(dir.path(), "4711", AT, &coarse_body(1), &Method::default());
    let all = content(dir.path());
    let missing = dir.path().join("none");
    for (record, more, expected, why) in [
        (
            &old,
            &["--level", "C", "--girth-cm", "3"][..],
            64,
            "girth 3.0 cm is not between 5.0 and 150.0 cm",
        ),
        (&old, &["--level", "B", "--height-cm", "38"], 64, "height 38.0 cm is not below"),
        (&old, &["--level", "Y", "--height-cm", "4"], 64, "it has no height"),
        (&old, &["--level", "C"], 64, "no value is given"),
        (&old, &["--level", "C", "--take-back"], 64, "nothing was set by hand"),
        (&old, &["--level", "C", "--girth-cm", "15"], 64, "is far off the scan"),
        (&old, &["--level", "C", "--girth-cm", "38.5cm"], 64, "without a unit"),
        (&old.join("report.pdf"), &["--level", "C", "--girth-cm", "38"], 66, "no record there"),
        (&missing, &["--level", "C", "--girth-cm", "38"], 66, "nothing was set"),
    ] {
        let output = amend(record, more);
        assert_eq!(code(&output), Some(expected), "{more:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(why), "{more:?}: {}", stderr(&output));
    }
    assert_eq!(content(dir.path()), all);

    // A record that someone changed is not carried on.
    let csv = old.join("measurements.csv");
    fs::write(&csv, "changed").unwrap();
    let output = amend(&old, &["--level", "C", "--girth-cm", "38"]);
    assert_eq!(code(&output), Some(65), "{}", stderr(&output));
    assert!(stderr(&output).contains("record-damaged"), "{}", stderr(&output));
    assert_eq!(names(&dir.path().join("4711")).len(), 1);
}

#[test]
fn a_record_with_keys_that_this_version_does_not_know_is_not_cut_down() {
    let dir = tempfile::tempdir().unwrap();
    let bytes = coarse_body(1);
    let old = store(dir.path(), "4711", AT, &bytes, &Method::default());
    let mut newer = record(&old);
    newer["made_by"]["gaiter"] = "9.9.9".into();
    newer["body"]["weight_kg"] = 71.5.into();
    let json = serde_json::to_vec(&newer).unwrap();
    let list = fs::read_to_string(old.join("SHA256SUMS")).unwrap();
    let line = |line: &str| match line.ends_with("  record.json") {
        true => sums::line(&sums::scan_id(&json), "record.json"),
        false => format!("{line}\n"),
    };
    fs::write(old.join("SHA256SUMS"), list.lines().map(line).collect::<String>()).unwrap();
    fs::write(old.join("record.json"), &json).unwrap();
    let output = amend(&old, &["--level", "C", "--girth-cm", "38"]);
    assert_eq!(code(&output), Some(65), "{}", stderr(&output));
    assert!(stderr(&output).contains("gaiter 9.9.9"), "{}", stderr(&output));
    assert_eq!(names(&dir.path().join("4711")).len(), 1);
}
