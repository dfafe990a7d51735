//! The visits of a scan's patient on the operator's page.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

use rig::verb::{code, gaiter_told, stderr, stdout};
use rig::web::Site;
use rig::{Booth, Daemon, sha256};
use serde_json::{Value, json};
use support::coarse_body;

/// A station with a page and the record of one scan, the patient's only one; the scan's id.
fn with_one_record() -> (Booth, Daemon, Site, String) {
    let booth = Booth::new();
    booth.reconfigure(|config| format!("{config}[status]\nlisten = \"127.0.0.1:0\"\n"));
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let bytes = coarse_body(0);
    booth.export("4711_a.obj", &bytes);
    booth.wait_for_records(1);
    (booth, daemon, site, sha256(&bytes))
}

fn name_affected(site: &Site, patient: &str, affected: &str) -> u16 {
    let body = json!({"ask": "name_affected", "patient": patient, "affected": affected});
    site.post("/ask", &body.to_string(), &site.operator()).status
}

#[test]
fn the_affected_leg_is_named_once_and_holds_for_page_and_terminal() {
    let (booth, daemon, site, scan) = with_one_record();
    let path = format!("/scan/{scan}/visits.html");
    booth.wait_for("the record", || site.get(&path, &site.operator()).status != 404);
    earlier_visit(&record_folder(&booth), "2026-01-08", "0");
    // What names no leg, and nobody, changes nothing.
    assert_eq!(name_affected(&site, "4711", "head"), 409);
    assert_eq!(name_affected(&site, "not one", "left"), 409);
    assert_eq!(name_affected(&site, "4711", "left"), 200);
    let page = site.get(&path, &site.operator()).body;
    assert!(page.contains("Affected leg, as named: left."), "{page}");
    let config = booth.path("station.toml");
    let affected = |more: &[&str]| {
        let args = [&["patient", "visits", "--json"], more].concat();
        let said = gaiter_told(&config, &args, "4711\n");
        assert_eq!(code(&said), Some(0), "{}", stderr(&said));
        serde_json::from_str::<Value>(&stdout(&said)).unwrap()["affected"].clone()
    };
    assert_eq!(affected(&[]), "left");
    assert_eq!(affected(&["--affected", "right"]), "right", "for once");
    let named = gaiter_told(&config, &["patient", "affected", "both"], "4711\n");
    assert_eq!(code(&named), Some(0), "{}", stderr(&named));
    assert_eq!(affected(&[]), "both");
    // A stopped station is read, and a start knows it still.
    assert_eq!(daemon.stop().code(), Some(0));
    assert_eq!(affected(&[]), "both");
    let daemon = booth.start_ready();
    let named = gaiter_told(&config, &["patient", "affected", "not-named"], "4711\n");
    assert_eq!(code(&named), Some(0), "{}", stderr(&named));
    assert_eq!(affected(&[]), Value::Null);
    assert_eq!(daemon.stop().code(), Some(0));
}

/// The file of the leg that was named is cut short, as a full disk or a failing one leaves it.
#[test]
fn a_named_leg_that_cannot_be_read_keeps_no_visits_from_page_and_terminal() {
    let (booth, daemon, site, scan) = with_one_record();
    let path = format!("/scan/{scan}/visits.html");
    booth.wait_for("the record", || site.get(&path, &site.operator()).status != 404);
    earlier_visit(&record_folder(&booth), "2026-01-08", "0");
    assert_eq!(name_affected(&site, "4711", "left"), 200);
    let file = fs::read_dir(booth.path("state/affected")).unwrap().next().unwrap().unwrap().path();
    for damaged in [
        "{",
        "{\"schema\": \"gaiter.affected/1\", \"affected\": \"head\", \"at\": \"2026-01-08T08:00:00Z\"}",
    ] {
        fs::write(&file, damaged).unwrap();
        let page = site.get(&path, &site.operator());
        assert_eq!(page.status, 200, "{}", page.body);
        assert!(page.body.contains("cannot be read, so no excess volume"), "{}", page.body);
        assert!(page.body.contains("Left minus right"), "{}", page.body);
        let config = booth.path("station.toml");
        let said = gaiter_told(&config, &["patient", "visits", "--language", "de"], "4711\n");
        assert_eq!(code(&said), Some(0), "{}", stderr(&said));
        let text = stdout(&said).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains("ist nicht lesbar, daher auch kein Mehrvolumen"), "{text}");
        let said = gaiter_told(&config, &["patient", "visits", "--json"], "4711\n");
        let json: Value = serde_json::from_str(&stdout(&said)).unwrap();
        assert_eq!(
            (&json["affected"], &json["is_affected_unreadable"]),
            (&Value::Null, &true.into())
        );
    }
    // It is named anew.
    assert_eq!(name_affected(&site, "4711", "right"), 200);
    let page = site.get(&path, &site.operator()).body;
    assert!(page.contains("Affected leg, as named: right."), "{page}");
    assert_eq!(daemon.stop().code(), Some(0));
}

/// The folder of the patient's only record.
fn record_folder(booth: &Booth) -> PathBuf {
    let mut folders = fs::read_dir(booth.path("records/4711")).unwrap();
    let folder = folders.find_map(|entry| {
        let path = entry.unwrap().path();
        path.join("record.json").exists().then_some(path)
    });
    folder.unwrap()
}

/// Puts a record of another day and scan beside one, as another visit of the patient has it.
fn earlier_visit(folder: &Path, day: &str, digit: &str) -> PathBuf {
    let mut record: Value =
        serde_json::from_slice(&fs::read(folder.join("record.json")).unwrap()).unwrap();
    record["acquired"]["at"] = format!("{day}T08:00:00Z").into();
    record["scan"]["sha256"] = digit.repeat(64).into();
    let (day, scan) = (day.replace('-', ""), digit.repeat(8));
    let place = folder.with_file_name(format!("{day}T080000Z_{scan}"));
    fs::create_dir(&place).unwrap();
    let json = serde_json::to_vec(&record).unwrap();
    fs::write(place.join("SHA256SUMS"), format!("{}  record.json\n", sha256(&json))).unwrap();
    fs::write(place.join("record.json"), json).unwrap();
    place
}

#[test]
fn the_visits_of_a_patient_are_compared_for_those_who_may_see_whose_scan_it_is() {
    let (booth, daemon, site, scan) = with_one_record();
    let operator = site.operator();
    let path = |name: &str| format!("/scan/{scan}/{name}");
    booth.wait_for("the record", || site.get(&path("visits.html"), &operator).status != 404);

    // One visit is nothing to compare.
    let alone = site.get(&path("visits.html"), &operator);
    assert_eq!(alone.status, 409, "{}", alone.body);
    assert!(alone.body.contains("one day only"), "{}", alone.body);

    let folder = record_folder(&booth);
    let earlier = earlier_visit(&folder, "2026-01-08", "0");
    let page = site.get(&path("visits.html"), &operator);
    assert_eq!(page.status, 200, "{}", page.body);
    assert!(page.body.contains("Course of the legs") && page.body.contains("4711"));
    let policy = page.header("content-security-policy").unwrap();
    assert!(policy.starts_with("sandbox allow-scripts"), "{policy}");
    assert!(page.body.contains("No affected leg is named"), "{}", page.body);
    let paper = site.get(&path("visits.pdf"), &operator);
    assert_eq!(paper.status, 200);
    assert!(paper.bytes.starts_with(b"%PDF"));
    for name in ["visits.html", "visits.pdf"] {
        assert_eq!(site.get(&path(name), &[]).status, 403, "{name}");
    }
    let unknown = format!("/scan/{}/visits.html", "1".repeat(64));
    assert_eq!(site.get(&unknown, &operator).status, 404);

    // A record that was changed after it was made is no visit.
    let changed = fs::read_to_string(earlier.join("record.json")).unwrap();
    fs::write(earlier.join("record.json"), changed.replacen("2026-01-08", "2026-02-08", 1))
        .unwrap();
    let alone = site.get(&path("visits.html"), &operator);
    assert_eq!(alone.status, 409);
    assert!(alone.body.contains("Only one visit"), "{}", alone.body);
    // Where two others are left, it is told, and the first of them is marked.
    earlier_visit(&folder, "2026-03-08", "1");
    let page = site.get(&path("visits.html"), &operator).body;
    assert!(page.contains("Records that are left out") && page.contains("8 Mar 2026 #"), "{page}");
    // So is a record that the station delivered and that somebody removed.
    earlier_visit(&folder, "2026-04-08", "2");
    fs::remove_dir_all(&folder).unwrap();
    let page = site.get(&path("visits.html"), &operator).body;
    assert!(page.contains("no longer in the store") && page.contains("8 Apr 2026 #"), "{page}");
    assert_eq!(daemon.stop().code(), Some(0));
}
