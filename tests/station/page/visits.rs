//! The visits of a scan's patient on the operator's page.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

use rig::web::Site;
use rig::{Booth, sha256};
use serde_json::Value;
use support::coarse_body;

/// Puts a record of another day and scan beside one, as another visit of the patient has it.
fn earlier_visit(folder: &Path) -> PathBuf {
    let mut record: Value =
        serde_json::from_slice(&fs::read(folder.join("record.json")).unwrap()).unwrap();
    record["acquired"]["at"] = "2026-01-08T08:00:00Z".into();
    record["scan"]["sha256"] = "0".repeat(64).into();
    let place = folder.with_file_name("20260108T080000Z_00000000");
    fs::create_dir(&place).unwrap();
    let json = serde_json::to_vec(&record).unwrap();
    fs::write(place.join("SHA256SUMS"), format!("{}  record.json\n", sha256(&json))).unwrap();
    fs::write(place.join("record.json"), json).unwrap();
    place
}

#[test]
fn the_visits_of_a_patient_are_compared_for_those_who_may_see_whose_scan_it_is() {
    let booth = Booth::new();
    booth.reconfigure(|config| format!("{config}[status]\nlisten = \"127.0.0.1:0\"\n"));
    let daemon = booth.start();
    let site = Site::of(&booth, "local");
    let bytes = coarse_body(0);
    booth.export("4711_a.obj", &bytes);
    booth.wait_for_records(1);
    let (scan, operator) = (sha256(&bytes), site.operator());
    let path = |name: &str| format!("/scan/{scan}/{name}");
    booth.wait_for("the record", || site.get(&path("visits.html"), &operator).status != 404);

    // One visit is nothing to compare.
    let alone = site.get(&path("visits.html"), &operator);
    assert_eq!(alone.status, 409, "{}", alone.body);
    assert!(alone.body.contains("one day only"), "{}", alone.body);

    let mut folders = fs::read_dir(booth.path("records/4711")).unwrap();
    let folder = folders.find_map(|entry| {
        let path = entry.unwrap().path();
        path.join("record.json").exists().then_some(path)
    });
    let earlier = earlier_visit(&folder.unwrap());
    let page = site.get(&path("visits.html"), &operator);
    assert_eq!(page.status, 200, "{}", page.body);
    assert!(page.body.contains("Course of the legs") && page.body.contains("4711"));
    let policy = page.header("content-security-policy").unwrap();
    assert!(policy.starts_with("sandbox allow-scripts"), "{policy}");
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
    assert_eq!(site.get(&path("visits.html"), &operator).status, 409);
    assert_eq!(daemon.stop().code(), Some(0));
}
