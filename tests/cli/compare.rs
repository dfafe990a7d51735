//! `gaiter compare` and `gaiter patient visits`: what they say, write and refuse.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use gaiter_leg::Method;
use gaiter_record::{Acquired, AcquiredFrom, Patient, Record, sha256};
use jiff::ToSpan;
use rig::verb::{code, gaiter, gaiter_told, stderr, stdout};
use serde_json::Value;
use support::recorded::export;
use support::records::record_of;
use tempfile::TempDir;

static BODY: LazyLock<Record> =
    LazyLock::new(|| record_of(&export("m_average_clean"), &Method::default()).1);

/// The id of a scan of a day.
fn scan(day: i64) -> String {
    format!("{day:08x}{}", "0".repeat(56))
}

/// A record of a patient so many days after the first; all girths of the left leg are larger by so much.
fn visit(patient: &str, day: i64, more_mm: f64) -> Record {
    let mut record = BODY.clone();
    record.patient = Some(Patient { id: patient.to_owned(), sources: Vec::new() });
    record.station = Some("booth-1".to_owned());
    record.scan.sha256 = scan(day);
    let first = "2026-01-08T08:00:00Z".parse::<jiff::Timestamp>().unwrap();
    let acquired = Acquired::new(first + (24 * day).hours(), AcquiredFrom::Press);
    record.acquired = Some(Acquired { utc_offset_min: Some(60), ..acquired });
    for leg in record.legs.iter_mut().filter(|leg| leg.side == "left") {
        for at in &mut leg.along {
            at.girth_tape_mm = at.girth_tape_mm.map(|mm| mm + more_mm);
        }
    }
    record
}

/// A record's folder below another one, as a store has it.
fn placed(within: &Path, record: &Record) -> PathBuf {
    let acquired = record.acquired.as_ref().unwrap();
    let time = acquired.at.strftime("%Y%m%dT%H%M%SZ").to_string();
    let begin = &record.scan.sha256[..8];
    let folder = within.join(format!("{time}_{begin}"));
    fs::create_dir_all(&folder).unwrap();
    let json = serde_json::to_vec(record).unwrap();
    fs::write(folder.join("SHA256SUMS"), format!("{}  record.json\n", sha256(&json))).unwrap();
    fs::write(folder.join("record.json"), json).unwrap();
    folder
}

/// A store with the visits of a patient: on three days, on the last one twice.
struct Store {
    folder: TempDir,
}

impl Store {
    fn new() -> Store {
        let store = Store { folder: tempfile::tempdir().unwrap() };
        for (day, more_mm) in [(0, 20.0), (30, 12.0), (60, 9.0)] {
            placed(&store.patient(), &visit("4711", day, more_mm));
        }
        let mut again = visit("4711", 60, 0.0);
        again.scan.sha256 = scan(61);
        let acquired = again.acquired.as_mut().unwrap();
        acquired.at += 1.hour();
        placed(&store.patient(), &again);
        fs::write(store.root().join(".gaiter-store"), "").unwrap();
        store
    }

    fn root(&self) -> PathBuf {
        self.folder.path().join("records")
    }

    fn patient(&self) -> PathBuf {
        self.root().join("4711")
    }

    fn config(&self) -> PathBuf {
        let at = |name: &str| self.folder.path().join(name);
        let text = format!(
            "[station]\nid = \"booth-1\"\nstate_dir = {:?}\n[scanner]\nexport_dirs = [{:?}]\n\
             [store.folder]\npath = {:?}\n[visits]\nthresholds = [\n  {{ name = \"ours\", source = \
             \"a paper\", limb = \"leg\", of = \"leg-change\", limit = \"3%\" }},\n]\n",
            at("state"),
            at("export"),
            self.root()
        );
        let path = at("station.toml");
        fs::write(&path, text).unwrap();
        path
    }
}

fn compared(paths: &[&Path], more: &[&str]) -> std::process::Output {
    let mut args = vec!["compare"];
    args.extend(paths.iter().map(|path| path.to_str().unwrap()));
    args.extend(more);
    gaiter(&args)
}

#[test]
fn the_visits_of_a_patient_are_compared_and_the_last_scan_of_a_day_counts() {
    let store = Store::new();
    let said = gaiter_told(&store.config(), &["patient", "visits", "--json"], "4711\n");
    assert_eq!(code(&said), Some(0), "{}", stderr(&said));
    let json: Value = serde_json::from_str(&stdout(&said)).unwrap();
    assert_eq!(json["schema"], "gaiter.visits/1");
    assert_eq!(json["patient"], "4711");
    let visits = json["visits"].as_array().unwrap();
    let scans: Vec<&str> = visits.iter().map(|of| of["scan_sha256"].as_str().unwrap()).collect();
    let expected = [0, 30, 61].map(scan);
    assert_eq!(scans, expected, "of the two scans of the last day the later one");
    let comparisons = json["comparisons"].as_array().unwrap();
    let pairs: Vec<[u64; 2]> = comparisons
        .iter()
        .map(|of| ["earlier", "later"].map(|end| of[end].as_u64().unwrap()))
        .collect();
    assert_eq!(pairs, [[0, 2], [1, 2]]);
    let left = &comparisons[0]["legs"][0];
    assert_eq!(left["side"], "left");
    assert_eq!(left["volume_ml"]["shown"], "smaller");
    assert_eq!(comparisons[0]["legs"][1]["volume_ml"]["shown"], "no-change-shown");
    let threshold = &comparisons[0]["thresholds"][0];
    assert_eq!((&threshold["name"], &threshold["source"]), (&"ours".into(), &"a paper".into()));
    assert_eq!(threshold["reached"], "not-reached", "the right leg comes first");
}

#[test]
fn the_text_says_larger_or_smaller_fits_80_columns_and_judges_nothing() {
    let store = Store::new();
    for (language, smaller) in [("en", "volume smaller"), ("de", "Volumen kleiner")] {
        let said = compared(&[&store.patient()], &["--language", language]);
        let text = stdout(&said);
        assert_eq!(code(&said), Some(0), "{}", stderr(&said));
        assert!(text.contains(smaller), "{text}");
        let widest = text.lines().map(|line| line.chars().count()).max().unwrap();
        assert!(widest <= 80, "{widest}");
        let lower = text.to_lowercase();
        for judged in ["better", "worse", "significant", "besser", "schlechter", "signifikant"] {
            assert!(!lower.contains(judged), "{judged}: {text}");
        }
    }
}

#[test]
fn no_leg_is_affected_until_a_person_names_it() {
    let store = Store::new();
    let told = |more: &[&str]| {
        let json = stdout(&compared(&[&store.patient()], &[&["--json"], more].concat()));
        let json: Value = serde_json::from_str(&json).unwrap();
        let text = stdout(&compared(&[&store.patient()], more));
        // The terminal breaks lines between words.
        (json, text.split_whitespace().collect::<Vec<_>>().join(" "))
    };
    let (json, text) = told(&[]);
    assert_eq!(
        (&json["affected"], &json["comparisons"][0]["excess"]),
        (&Value::Null, &Value::Null)
    );
    assert!(text.contains("No affected leg is named"), "{text}");
    assert!(text.contains("left minus right leg") && !text.contains("Excess volume,"), "{text}");
    let (json, text) = told(&["--affected", "left"]);
    assert_eq!(
        (&json["affected"], &json["comparisons"][0]["excess"]["affected"]),
        (&"left".into(), &"left".into())
    );
    assert!(text.contains("Excess volume, left over right leg"), "{text}");
    let (json, text) = told(&["--affected", "none"]);
    assert_eq!(
        (&json["affected"], &json["comparisons"][0]["excess"]),
        (&"none".into(), &Value::Null)
    );
    assert!(text.contains("Neither leg is affected"), "{text}");
}

#[test]
fn a_page_a_pdf_and_json_are_written_and_never_replaced_unasked() {
    let store = Store::new();
    let out = store.folder.path().join("out");
    let written = |more: &[&str]| {
        compared(&[&store.patient()], &[&["--out", out.to_str().unwrap()], more].concat())
    };
    let said = written(&[]);
    assert_eq!(code(&said), Some(0), "{}", stderr(&said));
    let names: Vec<String> = stdout(&said).lines().map(str::to_owned).collect();
    let expected = ["visits.html", "visits.pdf", "visits.json"].map(|name| out.join(name));
    assert_eq!(names, expected.clone().map(|path| path.display().to_string()));
    let [page, paper, _] = expected.map(|path| fs::read(path).unwrap());
    let page = String::from_utf8(page).unwrap();
    assert!(page.contains("4711") && page.contains("id=\"view-place\"") && page.contains("<svg"));
    assert!(paper.starts_with(b"%PDF"));
    assert!(page.contains("href=\"visits.pdf\""), "the page links to the PDF beside it");
    let again = written(&[]);
    assert_eq!(code(&again), Some(64));
    assert!(stderr(&again).contains("nothing was replaced"), "{}", stderr(&again));
    assert_eq!(code(&written(&["--force"])), Some(0));
    // The page is the same each time, up to the day on which it is read.
    assert_eq!(fs::read_to_string(out.join("visits.html")).unwrap(), page);
}

#[test]
fn what_cannot_be_compared_is_refused_with_the_records_and_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let one = placed(folder.path(), &visit("4711", 0, 0.0));
    let other = placed(folder.path(), &visit("4712", 30, 0.0));
    let said = compared(&[&one, &other], &[]);
    assert_eq!(code(&said), Some(65));
    let text = stderr(&said);
    assert!(text.contains("record 2 is not of the patient of record 1"), "{text}");
    assert!(text.contains(other.to_str().unwrap()), "{text}");
    assert!(!text.contains("4712"), "ids stay out of messages: {text}");
    let mut discs = visit("4711", 60, 0.0);
    discs.made_by.method.insert("volume".to_owned(), "discs".to_owned());
    let discs = placed(folder.path(), &discs);
    let said = compared(&[&one, &discs], &[]);
    assert_eq!(code(&said), Some(65));
    assert!(stderr(&said).contains("--volume"), "{}", stderr(&said));
    assert_eq!(code(&compared(&[&one, &discs], &["--volume", "cones"])), Some(0));
    let said = compared(&[&one], &[]);
    assert_eq!(code(&said), Some(65));
    assert!(stderr(&said).contains("two records or more"), "{}", stderr(&said));
    assert_eq!(code(&compared(&[&one, &folder.path().join("none")], &[])), Some(66));
}

#[test]
fn a_record_in_the_folder_of_another_patient_is_told_and_left_out() {
    let store = Store::new();
    placed(&store.patient(), &visit("4712", 90, 50.0));
    let said = gaiter_told(&store.config(), &["patient", "visits", "--json"], "4711\n");
    assert_eq!(code(&said), Some(0));
    assert!(stderr(&said).contains("names another patient than its folder"), "{}", stderr(&said));
    let json: Value = serde_json::from_str(&stdout(&said)).unwrap();
    assert_eq!(json["visits"].as_array().unwrap().len(), 3);
    assert_eq!(json["left_out"][0]["code"], "record-of-another");
    assert_eq!(
        json["comparisons"][0]["is_later_stand_in"], false,
        "it is no visit of this patient"
    );
}

#[test]
fn a_damaged_first_record_is_told_in_every_form_and_the_visit_in_its_place_is_marked() {
    let store = Store::new();
    let first = fs::read_dir(store.patient()).unwrap().map(|entry| entry.unwrap().path()).min();
    fs::write(first.unwrap().join("record.json"), "{}").unwrap();
    let out = store.folder.path().join("out");
    let place = out.to_str().unwrap();
    let told = |more: &[&str]| {
        let said = gaiter_told(&store.config(), &[&["patient", "visits"], more].concat(), "4711\n");
        assert_eq!(code(&said), Some(0), "{}", stderr(&said));
        stdout(&said)
    };
    told(&["--out", place]);
    let page = fs::read_to_string(out.join("visits.html")).unwrap();
    for text in [told(&[]), page] {
        assert!(
            text.contains("Records that are left out") && text.contains("7 Feb 2026 #"),
            "{text}"
        );
    }
    let written = fs::read_to_string(out.join("visits.json")).unwrap();
    for json in [told(&["--json"]), written] {
        let json: Value = serde_json::from_str(&json).unwrap();
        assert_eq!(json["left_out"][0]["code"], "record-damaged");
        assert_eq!(json["left_out"][0]["scan"], &scan(0)[..8]);
        assert_eq!(json["comparisons"][0]["is_earlier_stand_in"], true);
    }
}

#[test]
fn a_removed_record_is_no_visit_any_more() {
    let store = Store::new();
    let visits = || {
        let said = gaiter_told(&store.config(), &["patient", "visits", "--json"], "4711\n");
        let json: Value = serde_json::from_str(&stdout(&said)).unwrap();
        json["visits"].as_array().unwrap().len()
    };
    assert_eq!(visits(), 3);
    let first = fs::read_dir(store.patient()).unwrap().map(|entry| entry.unwrap().path()).min();
    fs::remove_dir_all(first.unwrap()).unwrap();
    assert_eq!(visits(), 2);
}

#[test]
fn the_id_is_never_an_argument_and_an_unknown_one_has_no_records() {
    let store = Store::new();
    let config = store.config();
    let said = gaiter_told(&config, &["patient", "visits", "4711"], "");
    assert_eq!(code(&said), Some(64));
    assert!(stderr(&said).contains("never an argument"), "{}", stderr(&said));
    let said = gaiter_told(&config, &["patient", "affected", "left", "4711"], "");
    assert_eq!(code(&said), Some(64));
    assert!(stderr(&said).contains("never an argument"), "{}", stderr(&said));
    let said = gaiter_told(&config, &["patient", "visits"], "9999\n");
    assert_eq!((code(&said), stdout(&said)), (Some(66), String::new()));
    assert_eq!(code(&gaiter_told(&config, &["patient", "visits"], "\n")), Some(64));
    fs::remove_file(store.root().join(".gaiter-store")).unwrap();
    let said = gaiter_told(&config, &["patient", "visits"], "4711\n");
    assert_eq!(code(&said), Some(74));
    assert!(stderr(&said).contains("out of reach"), "{}", stderr(&said));
}
