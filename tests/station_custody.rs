//! What the station keeps is removed while it runs: it says so at once, and goes on.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "support/station.rs"]
mod support;

use std::fs;

use serde_json::Value;
use support::{Booth, Daemon, coarse_body};

fn status(booth: &Booth) -> Value {
    serde_json::from_slice(&booth.gaiter(&["status", "--json"]).stdout).unwrap_or_default()
}

fn start(booth: &Booth) -> Daemon {
    let daemon = booth.start();
    booth.wait_for("the start", || booth.log().contains("station-ready"));
    daemon
}

#[test]
fn a_folder_that_somebody_removed_is_a_fault_at_once_and_made_anew() {
    for folder in ["spool", "quarantine", "decisions"] {
        let booth = Booth::new();
        let daemon = start(&booth);
        fs::remove_dir_all(booth.path("state").join(folder)).unwrap();
        let told = status(&booth);
        let alarm = told["alarms"]["custody-made-anew"]["message"].as_str().unwrap_or_default();
        assert!(alarm.contains(folder), "{told}");
        booth.export("4711_a.obj", &coarse_body(1));
        booth.wait_for_records(1);
        assert!(status(&booth)["alarms"]["custody-made-anew"].is_object());
        assert_eq!(daemon.stop().code(), Some(0));
        booth.assert_settled(&[("4711", &coarse_body(1))]);
    }
}

#[test]
fn a_scan_that_was_lost_with_the_spool_is_taken_in_again_when_it_is_exported_again() {
    let booth = Booth::new();
    let daemon = start(&booth);
    fs::rename(booth.path("records"), booth.path("unmounted")).unwrap();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for("the spool", || booth.log().contains("scan-spooled"));
    fs::remove_dir_all(booth.path("state/spool")).unwrap();
    fs::rename(booth.path("unmounted"), booth.path("records")).unwrap();
    booth.wait_for("its refusal", || booth.log().contains("spool-lost"));
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_eq!(booth.records()[0].0, "4711");
}
