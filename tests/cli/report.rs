//! `gaiter report`: made anew from `record.json` byte for byte. Of what is no record, of a record that was changed and of one that no leg can have, no report is
//! made: the refusal names what is wrong.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::sync::LazyLock;

use gaiter_language::Language;
use gaiter_leg::Method;
use gaiter_record::{Record, ReportChoice, report_files, sha256};
use rig::stored::{content, store};
use rig::verb::{code, gaiter, stderr, stdout};
use serde_json::Value;
use support::recorded::export;
use support::records::record_of;

static RECORD: LazyLock<Record> =
    LazyLock::new(|| record_of(&export("f_average_tc2"), &Method::default()).1);

/// A change of a record by hand, and what the refusal names.
type Change = (fn(&mut Value), &'static str);

/// What no leg can have, each where a report would draw or tell it.
const IMPOSSIBLE: [Change; 12] = [
    (|r| r["legs"][0]["landmarks"]["C"]["girth_tape_mm"] = (-337.0).into(), "girth of C"),
    (|r| r["legs"][0]["landmarks"]["C"]["girth_tape_mm"] = 1e300.into(), "girth of C"),
    (|r| r["legs"][0]["landmarks"]["C"]["girth_sd_mm"] = (-3.0).into(), "standard errors of C"),
    (|r| r["legs"][0]["landmarks"]["B"]["height_mm"] = 1e5.into(), "height of B"),
    (|r| r["legs"][0]["side"] = "right".into(), "legs[1]"),
    (|r| r["legs"][1]["side"] = "middle".into(), "legs[1]"),
    (|r| r["legs"][0]["girth_curve"]["tape_mm"][5] = 1e9.into(), "girth_curve.tape_mm"),
    (|r| r["legs"][0]["girth_curve"]["tape_mm"] = [1.0].as_slice().into(), "girth_curve.tape_mm"),
    (|r| r["legs"][1]["sections"][2]["outline"]["radius_mm"][7] = 1e12.into(), "outline of"),
    (|r| r["legs"][1]["sections"][2]["outline"]["curvature_per_mm"][7] = 1e5.into(), "outline of"),
    (emptied, "radius_mm: 0 figures"),
    (|r| r["legs"][0]["shape"]["skin"]["rows"] = 1_000_000_000.into(), "skin of its shape"),
];

fn emptied(record: &mut Value) {
    let outline = record["legs"][1]["sections"][2]["outline"].as_object_mut().unwrap();
    let places = ["centre_mm", "front", "lateral"];
    let rows = outline.iter_mut().filter(|(name, _)| !places.contains(&name.as_str()));
    rows.for_each(|(_, row)| *row = Value::Array(Vec::new()));
}

#[test]
fn a_record_that_was_changed_or_that_no_leg_can_have_gives_no_report() {
    let place = tempfile::tempdir().unwrap();
    let path = |name: &str| place.path().join(name).to_str().unwrap().to_owned();
    let whole = serde_json::to_value(&*RECORD).unwrap();
    let refused = |what: &str, changed: &Value, names: &str| {
        fs::write(path("record.json"), serde_json::to_vec(changed).unwrap()).unwrap();
        let said = gaiter(&["report", &path("record.json"), "--out", &path("out")]);
        assert_eq!(code(&said), Some(65), "{what}: {}", stderr(&said));
        assert!(stderr(&said).contains(names), "{what}: {}", stderr(&said));
        assert!(!place.path().join("out").exists(), "{what}");
    };
    for (index, (change, names)) in IMPOSSIBLE.into_iter().enumerate() {
        let mut changed = whole.clone();
        change(&mut changed);
        refused(&format!("change {index}"), &changed, names);
    }
    // A girth that can be, beside the sums of what was written.
    let written = sha256(&serde_json::to_vec(&whole).unwrap());
    fs::write(path("SHA256SUMS"), format!("{written}  record.json\n")).unwrap();
    let mut changed = whole.clone();
    changed["legs"][0]["landmarks"]["C"]["girth_tape_mm"] = 351.2.into();
    refused("another girth", &changed, "does not match SHA256SUMS");
    fs::write(path("SHA256SUMS"), "no sums\n").unwrap();
    refused("sums that cannot be read", &whole, "is not a checksum and a name");
}

#[test]
fn what_is_no_record_is_refused_with_the_code_of_its_kind() {
    let place = tempfile::tempdir().unwrap();
    let path = |name: &str| place.path().join(name).to_str().unwrap().to_owned();
    fs::write(path("text.json"), "no record").unwrap();
    let mut later = RECORD.clone();
    later.schema = "gaiter.leg-record/2".to_owned();
    fs::write(path("later.json"), serde_json::to_vec(&later).unwrap()).unwrap();
    for (name, exit) in [("text.json", 65), ("later.json", 65), ("missing.json", 66)] {
        let said = gaiter(&["report", &path(name), "--out", &path("out")]);
        assert_eq!(code(&said), Some(exit), "{name}: {}", stderr(&said));
        assert!(stderr(&said).contains(name));
        assert!(!place.path().join("out").exists(), "{name}");
    }
}

#[test]
fn a_report_of_a_lone_record_says_that_nothing_vouches_for_it_and_replaces_no_other() {
    let place = tempfile::tempdir().unwrap();
    let path = |name: &str| place.path().join(name).to_str().unwrap().to_owned();
    let written = serde_json::to_vec(&*RECORD).unwrap();
    fs::write(path("record.json"), &written).unwrap();
    let report = |out: &str, more: &[&str]| {
        let (record, out) = (path("record.json"), path(out));
        let said =
            gaiter(&[&["report", &record, "--out", &out, "--language", "de"], more].concat());
        (code(&said), stderr(&said))
    };
    let page = |out: &str| fs::read_to_string(place.path().join(out).join("report.html")).unwrap();
    let title = Language::De.text("finding.not-vouched.title");
    assert_eq!(report("lone", &[]).0, Some(0));
    assert!(page("lone").contains(title));
    let head = |out: &str| page(out).split("</header>").next().unwrap().to_owned();
    let warning = Language::De.text("report.title_not_vouched");
    assert!(head("lone").contains(warning), "the warning stands above every figure");

    let sum = sha256(&written);
    fs::write(path("SHA256SUMS"), format!("{sum}  record.json\n")).unwrap();
    assert_eq!(report("vouched", &[]).0, Some(0));
    assert!(!page("vouched").contains(title) && !head("vouched").contains(warning));
    fs::write(path("SHA256SUMS"), format!("{sum}  other.json\n")).unwrap();
    let (exit, said) = report("vouched", &[]);
    assert_eq!(exit, Some(64), "{said}");
    assert!(said.contains("--force") && !page("vouched").contains(title), "{said}");
    assert_eq!(report("vouched", &["--force"]).0, Some(0));
    assert!(page("vouched").contains(title), "the sums are those of another file");
}

#[test]
fn the_report_of_a_record_read_back_is_that_of_its_folder_byte_for_byte() {
    let place = tempfile::tempdir().unwrap();
    let at = "20261121T091500Z";
    let folder = store(place.path(), "4711", at, &export("f_average_tc2"), &Method::default());
    let (before, out) = (content(&folder), place.path().join("out"));
    let [folder_arg, out_arg] = [&folder, &out].map(|path| path.to_str().unwrap());
    let json = folder.join("record.json");
    for record in [folder_arg, json.to_str().unwrap()] {
        // The second time in the place of the first.
        let made = gaiter(&["report", record, "--out", out_arg, "--force"]);
        assert_eq!(code(&made), Some(0), "{}", stderr(&made));
        for name in ["report.html", "report.pdf"] {
            assert!(stdout(&made).contains(name));
            assert!(fs::read(out.join(name)).unwrap() == fs::read(folder.join(name)).unwrap());
        }
    }
    let told = gaiter(&["report", folder_arg, "--out", out_arg, "--json", "--force"]);
    let told: Value = serde_json::from_slice(&told.stdout).unwrap();
    let paths = ["report.html", "report.pdf"].map(|name| out.join(name).display().to_string());
    assert_eq!(told, serde_json::json!({ "files": paths }));
    let record: Record = serde_json::from_slice(&fs::read(&json).unwrap()).unwrap();
    let made = report_files(&record, &ReportChoice::default()).unwrap();
    assert_eq!(fs::read_dir(&out).unwrap().count(), made.len(), "nothing is left over");
    let refused = gaiter(&["report", folder_arg, "--out", folder_arg]);
    assert_eq!(code(&refused), Some(64), "a record's folder stays as its sums say");
    assert_eq!(content(&folder), before);
}
