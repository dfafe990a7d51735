//! The files of a record as the operator's page hands them out.

#![allow(clippy::unwrap_used)]

use std::fs;

use support::web::Site;
use support::whole::names;
use support::{Booth, coarse_body, sha256};

#[test]
fn every_file_of_a_record_is_served_as_it_was_made_and_no_other() {
    let booth = Booth::new();
    booth.reconfigure(|config| {
        let config = config.replace(r#"files = ["step"]"#, r#"files = ["step", "glb"]"#);
        format!("{config}[status]\nlisten = \"127.0.0.1:0\"\n")
    });
    let daemon = booth.start();
    let site = Site::of(&booth, "local");
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
        serde_json::from_value(site.state()["scans"][0]["files"].clone()).unwrap()
    };
    booth.wait_for("the files", || !listed().is_empty());
    let mut listed = listed();
    let there = names(&folder);
    assert!(there.len() > 9, "{there:?}");
    assert_eq!(listed[..4], ["report.html", "report.pdf", "legs.svg", "record.json"]);
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
