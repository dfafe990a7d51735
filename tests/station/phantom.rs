//! The real program and a body of known girths: checked at once, kept as a series, named in each record,
//! and of no patient.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::TAU;
use std::fs;

use rig::Booth;
use rig::invariants::PutKind;
use serde_json::Value;
use support::coarse_body;
use support::mesh::{Mesh, Ring};

/// Two cylinders on top of each other, radius 80 mm up to 250 mm and 50 mm above; `scale` is the scanner's.
fn phantom(scale: f64) -> Vec<u8> {
    let ring = |i: u32| {
        let y = f64::from(i) * 4.0;
        Ring { y, middle: [0.0; 2], half: [if y < 250.0 { 80.0 } else { 50.0 }; 2] }
    };
    Mesh::tube(&(0..=125).map(ring).collect::<Vec<_>>(), 100).scaled(scale).obj()
}

fn booth() -> Booth {
    let booth = Booth::new();
    let girths = [8.0, 17.0, 33.0, 42.0].map(|height_cm: f64| {
        format!("{height_cm}:{:.2}", TAU * if height_cm < 25.0 { 8.0 } else { 5.0 })
    });
    booth.reconfigure(|text| text + &format!("[phantom]\ngirths = \"{}\"\n", girths.join(", ")));
    booth
}

fn checks(booth: &Booth) -> Vec<Value> {
    booth.status()["phantom"]["checks"].as_array().cloned().unwrap_or_default()
}

fn complains(booth: &Booth) -> bool {
    let status = booth.status();
    let mut complaints = status["complaints"].as_array().into_iter().flatten();
    complaints.any(|complaint| complaint["code"] == "phantom-check")
}

#[test]
fn a_check_is_in_the_series_and_in_the_next_record_and_in_no_store() {
    let booth = booth();
    let daemon = booth.start_ready();
    assert!(booth.status()["phantom"]["due"] == true && checks(&booth).is_empty());
    fs::write(booth.path("export/PHANTOM_1.obj"), phantom(1.0)).unwrap();
    booth.has_put("PHANTOM_1.obj", &phantom(1.0), PutKind::Beside);
    booth.wait_for("the check", || checks(&booth).len() == 1);
    let first = checks(&booth)[0].clone();
    assert!(
        first["result"] == "within" && first["worst_mm"].as_f64().unwrap().abs() < 0.3,
        "{first}"
    );
    assert_eq!(booth.status()["phantom"]["due"], false);
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    let folder = fs::read_dir(booth.path("records/4711")).unwrap().next().unwrap().unwrap().path();
    let record: Value =
        serde_json::from_slice(&fs::read(folder.join("record.json")).unwrap()).unwrap();
    assert_eq!(record["phantom_check"], first);
    booth.wait_until_explained("PHANTOM_1.obj", "known body");
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1))]);
}

#[test]
fn a_scanner_that_is_off_raises_an_alarm_until_a_check_is_good_again() {
    let booth = booth();
    let daemon = booth.start_ready();
    fs::write(booth.path("export/phantom.obj"), phantom(0.97)).unwrap();
    booth.wait_for("the alarm", || complains(&booth));
    assert_eq!(daemon.stop().code(), Some(0));
    let daemon = booth.start();
    booth.wait_for("the alarm after a start", || complains(&booth));
    assert_eq!(checks(&booth).len(), 1, "a start measures nothing again");
    fs::write(booth.path("export/Phantom-2.obj"), phantom(1.0)).unwrap();
    booth.wait_for("its end", || checks(&booth).len() == 2 && !complains(&booth));
    // The same bytes again are the same check.
    fs::write(booth.path("export/Phantom-3.obj"), phantom(1.0)).unwrap();
    booth.wait_until_explained("Phantom-3.obj", "known body");
    assert_eq!(checks(&booth).len(), 2);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn what_is_not_the_phantom_is_no_check_and_says_so() {
    let booth = booth();
    let daemon = booth.start_ready();
    fs::write(booth.path("export/PHANTOM.obj"), coarse_body(1)).unwrap();
    booth.wait_for("the alarm", || complains(&booth));
    assert_eq!(checks(&booth)[0]["result"], "not_measured");
    assert!(booth.path("export/PHANTOM.obj").exists());
    assert_eq!(daemon.stop().code(), Some(0));
    assert!(booth.records().is_empty());
}

#[test]
fn cameras_that_do_not_meet_on_most_scans_are_told_and_a_check_is_asked_for_also_after_a_start() {
    let booth = booth();
    let daemon = booth.start_ready();
    fs::write(booth.path("export/PHANTOM_1.obj"), phantom(1.0)).unwrap();
    booth.wait_for("the check", || checks(&booth).len() == 1);
    let notice = || {
        let status = booth.status();
        let complaints = status["complaints"].as_array().cloned().unwrap_or_default();
        complaints.into_iter().find(|complaint| complaint["code"] == "scanner-views-apart")
    };
    let off = |by_mm: f64| Mesh::of_obj(&coarse_body(1)).with_camera_off(0.4, 1.0, by_mm).obj();
    for (number, by_mm) in [(1, 4.0), (2, 4.2), (3, 4.4)] {
        assert!(notice().is_none(), "{number}");
        booth.export(&format!("471{number}_a.obj"), &off(by_mm));
        booth.wait_for_records(number);
    }
    booth.wait_for("the notice", || notice().is_some());
    let status = booth.status();
    assert!(status["ready"] == true && status["phantom"]["due"] == true, "{status}");
    assert_eq!(daemon.stop().code(), Some(0));
    let daemon = booth.start_ready();
    assert_eq!(notice().unwrap()["figures"]["count"], 3);
    assert_eq!(booth.status()["views"].as_array().unwrap().len(), 3);
    fs::write(booth.path("export/PHANTOM_2.obj"), phantom(1.0001)).unwrap();
    booth.wait_for("its end", || notice().is_none());
    assert_eq!(booth.status()["phantom"]["due"], false);
    assert_eq!(daemon.stop().code(), Some(0));
}
