//! What the station keeps is removed while it runs: it says so at once, and goes on.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;

use rig::verb::{code, stderr, stdout};
use rig::{Booth, names};
use rustix::process::{Pid, Signal, kill_process};
use support::coarse_body;

#[test]
fn a_folder_that_somebody_removed_is_a_fault_at_once_and_made_anew() {
    for folder in ["spool", "quarantine", "decisions", "affected"] {
        let booth = Booth::new();
        let daemon = booth.start_ready();
        fs::remove_dir_all(booth.path("state").join(folder)).unwrap();
        let told = booth.status();
        let alarm = told["alarms"]["custody-made-anew"]["message"].as_str().unwrap_or_default();
        assert!(alarm.contains(folder), "{told}");
        booth.export("4711_a.obj", &coarse_body(1));
        booth.wait_for_records(1);
        assert!(booth.status()["alarms"]["custody-made-anew"].is_object());
        assert_eq!(daemon.stop().code(), Some(0));
        booth.assert_settled(&[("4711", &coarse_body(1))]);
    }
}

#[test]
fn every_folder_that_was_removed_since_the_start_is_named() {
    let booth = Booth::new();
    let daemon = booth.start_ready();
    for folders in [&["spool"][..], &["quarantine", "spool"]] {
        fs::remove_dir_all(booth.path("state").join(folders[0])).unwrap();
        let told = booth.status();
        let alarm = told["alarms"]["custody-made-anew"]["message"].as_str().unwrap_or_default();
        assert!(alarm.contains(&folders.join(", ")), "{told}");
    }
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_scan_that_was_lost_with_the_spool_is_taken_in_again_when_it_is_exported_again() {
    let booth = Booth::new();
    let daemon = booth.start_ready();
    booth.take_records_away();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for("the spool", || booth.log().contains("scan-spooled"));
    // At once: the station may be writing there.
    fs::rename(booth.path("state/spool"), booth.path("removed")).unwrap();
    fs::rename(booth.path("unmounted"), booth.path("records")).unwrap();
    booth.wait_for("its refusal", || booth.log().contains("spool-lost"));
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_eq!(booth.records()[0].0, "4711");
}

#[test]
fn a_second_station_on_an_export_folder_says_so_and_ends() {
    let (booth, other) = (Booth::new(), Booth::new());
    let daemon = booth.start_ready();
    let own = other.path("export").display().to_string();
    let shared = booth.path("export").display().to_string();
    other.reconfigure(|config| config.replace(&own, &shared));
    let ended = other.gaiter(&["run"]);
    assert_eq!(code(&ended), Some(74));
    assert!(stderr(&ended).contains("station on this machine already uses"), "{}", stderr(&ended));
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_eq!(names(&other.path("records")), Vec::<String>::new());
    // Then the other may have it.
    let daemon = other.start();
    other.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn an_export_folder_that_another_station_has_is_left_alone_after_a_reload() {
    let (booth, other) = (Booth::new(), Booth::new());
    let daemon = booth.start_ready();
    let second = other.start_ready();
    let (own, shared) = (other.path("export"), booth.path("export"));
    let both = format!("[\"{}\", \"{}\"]", own.display(), shared.display());
    other.reconfigure(|config| config.replace(&format!("[\"{}\"]", own.display()), &both));
    kill_process(Pid::from_raw(second.id().cast_signed()).unwrap(), Signal::HUP).unwrap();
    let told = || stdout(&other.gaiter(&["status"]));
    other.wait_for("the word", || told().contains("[source-taken]"));
    other.export("4712_b.obj", &coarse_body(2));
    other.wait_for_records(1);
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    other.wait_for("the folder", || !told().contains("[source-taken]"));
    assert_eq!(second.stop().code(), Some(0));
}
