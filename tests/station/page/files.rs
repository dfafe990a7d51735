//! The files of a record as the operator's page hands them out.

#![allow(clippy::unwrap_used)]

use std::fs;

use rig::web::Site;
use rig::whole::names;
use rig::{Booth, sha256};
use support::coarse_body;

use super::{booth, first_scan, record_of};

#[test]
fn every_file_of_a_record_is_served_as_it_was_made_and_no_other() {
    let booth = Booth::new();
    booth.reconfigure(|config| {
        let config = config.replace(r#"files = ["step"]"#, r#"files = ["step", "glb"]"#);
        format!("{config}[status]\nlisten = \"127.0.0.1:0\"\n")
    });
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let bytes = coarse_body(0);
    booth.export("4711_a.obj", &bytes);
    booth.wait_for_records(1);
    let mut folders = fs::read_dir(booth.path("records/4711")).unwrap();
    let folder = folders.find_map(|entry| {
        let path = entry.unwrap().path();
        path.join("record.json").exists().then_some(path)
    });
    let folder = folder.unwrap();
    let (scan, operator) = (sha256(&bytes), site.operator());
    let get = |name: &str| site.get(&format!("/scan/{scan}/{name}"), &operator);

    let listed = || -> Vec<String> {
        serde_json::from_value(first_scan(&site.state())["files"].clone()).unwrap()
    };
    booth.wait_for("the files", || !listed().is_empty());
    let mut listed = listed();
    let there = names(&folder);
    assert!(there.len() > 9, "{there:?}");
    let first = [
        "report.html",
        "report.pdf",
        "legs.svg",
        "measurements-spreadsheet.csv",
        "order-spreadsheet.csv",
        "record.json",
    ];
    assert_eq!(listed[..6], first);
    listed.sort();
    assert_eq!(listed, there);
    for name in &there {
        let answer = get(name);
        assert_eq!(answer.status, 200, "{name}");
        assert!(answer.bytes == fs::read(folder.join(name)).unwrap(), "{name}");
    }
    let saved = format!("attachment; filename=\"{}_left.step\"", &scan[..8]);
    assert_eq!(get("left.step").header("content-disposition"), Some(saved));
    assert_eq!(get("report.html").header("content-disposition"), None);

    // A person's notes are no part of the record, and a changed file is not the one that was made.
    fs::write(folder.join("notes.txt"), "call back").unwrap();
    for other in ["notes.txt", "..%2Frecord.json", "%2Fetc%2Fpasswd", "SHA256SUMS%2F"] {
        assert_eq!(get(other).status, 404, "{other}");
    }
    let step = fs::read_to_string(folder.join("left.step")).unwrap();
    fs::write(folder.join("left.step"), step.replacen('1', "2", 1)).unwrap();
    assert_eq!(get("left.step").status, 409);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn files_of_a_record_are_those_of_its_latest_revision_and_no_path_leads_elsewhere() {
    let booth = booth("[page]\npatient_ids = \"everyone\"\n");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let bytes = coarse_body(0);
    booth.export("4711_a.obj", &bytes);
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'delivered'", 1);
    let scan = sha256(&bytes);
    assert_eq!(site.get(&format!("/scan/{scan}/record.json"), &[]).status, 200);
    let folder = record_of(&booth, "4711");
    let report = site.get(&format!("/scan/{scan}/report.html"), &[]);
    let policy = report.header("content-security-policy").unwrap();
    assert!(policy.starts_with("sandbox allow-scripts"), "{policy}");
    assert!(!policy.contains("allow-same-origin"), "{policy}");
    // Of a record that was measured again the latest revision is opened.
    let later = format!("{}_r2", folder.display());
    fs::create_dir(&later).unwrap();
    let page = "<title>r2</title>";
    fs::write(format!("{later}/report.html"), page).unwrap();
    let sums = format!("{}  report.html\n", sha256(page.as_bytes()));
    fs::write(format!("{later}/SHA256SUMS"), sums).unwrap();
    let report = site.get(&format!("/scan/{scan}/report.html"), &[]);
    assert!(report.body.contains("r2"), "{}", report.body);
    for path in [
        format!("/scan/{scan}/scan.obj"),
        format!("/scan/{scan}/..%2f..%2fstation.toml"),
        format!("/scan/{scan}/%2e%2e"),
        format!("/scan/{}/record.json", &scan[..8]),
        format!("/scan/{}/record.json", "0".repeat(64)),
        format!("/scan/{}/record.json", scan.to_uppercase()),
        "/scan/..%2f..%2fstate/page-token".to_owned(),
        "/scan/%00/record.json".to_owned(),
        "/page-token".to_owned(),
    ] {
        assert_eq!(site.get(&path, &[]).status, 404, "{path}");
    }
    assert_eq!(daemon.stop().code(), Some(0));
}
