//! The real program on temporary folders: whatever a scanner writes and however it writes it,
//! every whole scan gives exactly one whole record, and nothing else appears under a final name.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs::{self, File};
use std::io::Write;
use std::os::unix::net::UnixDatagram;
use std::thread::{self, sleep};
use std::time::Duration;

use rig::invariants::PutKind;
use rig::{Booth, PATIENCE, QUIET, Setting, names, sha256};
use support::coarse_body;

/// Longer than any test.
const A_LONG_WAIT: Duration = Duration::from_secs(3600);

/// Appends to an export in pieces with a pause after each, as a slow scanner does.
fn write_slowly(path: &std::path::Path, bytes: &[u8], pieces: usize, pause: Duration) {
    let mut file = File::create(path).unwrap();
    for piece in bytes.chunks(bytes.len().div_ceil(pieces)) {
        file.write_all(piece).unwrap();
        sleep(pause);
    }
}

#[test]
fn a_slow_writer_s_scan_is_taken_once_and_whole() {
    let booth = Booth::new();
    let daemon = booth.start();
    let bytes = coarse_body(1);
    write_slowly(&booth.path("export/4711_a.obj"), &bytes, 12, QUIET / 3);
    booth.has_put("4711_a.obj", &bytes, PutKind::Whole);
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &bytes)]);
}

#[test]
fn a_writer_that_stalls_longer_than_the_quiet_time_in_the_middle_of_a_line_is_awaited() {
    // The wait for its rest does not end before the rest comes, however slow the machine is.
    let booth = Booth::set(&Setting { short_wait: A_LONG_WAIT, ..Setting::default() });
    let daemon = booth.start();
    let bytes = coarse_body(1);
    let (first, rest) = bytes.split_at(bytes.len() - 7);
    let mut file = File::create(booth.path("export/4711_a.obj")).unwrap();
    file.write_all(first).unwrap();
    booth.wait_until_explained("4711_a.obj", "is incomplete");
    file.write_all(rest).unwrap();
    booth.has_put("4711_a.obj", first, PutKind::Short);
    booth.has_put("4711_a.obj", &bytes, PutKind::Whole);
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &bytes)]);
    assert_eq!(names(&booth.path("state/quarantine")), [""; 0]);
}

#[test]
fn a_scan_written_under_another_name_and_renamed_is_taken_once() {
    let booth = Booth::new();
    let daemon = booth.start();
    for (n, unfinished) in ["4711_1.obj.part", ".4711_2.obj", "4711_3.tmp"].into_iter().enumerate()
    {
        let path = booth.path("export").join(unfinished);
        write_slowly(&path, &coarse_body(n), 3, QUIET);
        let name = format!("4711_{n}.obj");
        fs::rename(path, booth.path("export").join(&name)).unwrap();
        booth.has_put(&name, &coarse_body(n), PutKind::Whole);
    }
    booth.wait_for_records(3);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[
        ("4711", &coarse_body(0)),
        ("4711", &coarse_body(1)),
        ("4711", &coarse_body(2)),
    ]);
}

#[test]
fn a_file_replaced_by_new_bytes_is_a_new_scan() {
    let booth = Booth::new();
    let daemon = booth.start();
    booth.export("4711_scan.obj", &coarse_body(1));
    booth.wait_for_records(1);
    booth.export("4711_scan.obj", &coarse_body(2));
    booth.wait_for_records(2);
    let other = booth.path("export/.other");
    fs::write(&other, coarse_body(3)).unwrap();
    fs::rename(other, booth.path("export/4711_scan.obj")).unwrap();
    booth.has_put("4711_scan.obj", &coarse_body(3), PutKind::Whole);
    booth.wait_for_records(3);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[
        ("4711", &coarse_body(1)),
        ("4711", &coarse_body(2)),
        ("4711", &coarse_body(3)),
    ]);
}

#[test]
fn twelve_scans_at_once_are_twelve_records() {
    let booth = Booth::new();
    let scans: Vec<(String, Vec<u8>)> =
        (0..12).map(|n| (format!("P{}", n % 5), coarse_body(n))).collect();
    let daemon = booth.start();
    thread::scope(|scope| {
        for (n, (patient, bytes)) in scans.iter().enumerate() {
            let path = booth.path(&format!("export/{patient}_{n}.obj"));
            scope.spawn(move || write_slowly(&path, bytes, 5, QUIET / 5));
        }
    });
    for (n, (patient, bytes)) in scans.iter().enumerate() {
        booth.has_put(&format!("{patient}_{n}.obj"), bytes, PutKind::Whole);
    }
    booth.wait_for_records(12);
    assert_eq!(daemon.stop().code(), Some(0));
    let expected: Vec<(&str, &[u8])> =
        scans.iter().map(|(patient, bytes)| (patient.as_str(), bytes.as_slice())).collect();
    booth.assert_settled(&expected);
}

#[test]
fn scans_that_lay_there_before_the_start_are_taken_and_not_taken_again_after_a_restart() {
    let booth = Booth::new();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.export("nobody.obj", &coarse_body(2));
    let daemon = booth.start();
    booth.wait_for_records(2);
    assert_eq!(daemon.stop().code(), Some(0));
    let daemon = booth.start();
    booth.export("0815_b.obj", &coarse_body(3));
    booth.wait_for_records(3);
    assert_eq!(daemon.stop().code(), Some(0));
    let expected =
        [("4711", coarse_body(1)), ("_unassigned", coarse_body(2)), ("0815", coarse_body(3))];
    booth.assert_settled(&expected.each_ref().map(|(id, bytes)| (*id, bytes.as_slice())));
    assert_eq!(booth.log().matches("scan-spooled").count(), 3);
    assert_eq!(booth.log().matches("scan-known").count(), 0, "no export was read twice");
}

#[test]
fn a_bad_file_is_quarantined_with_its_reason_and_does_not_stop_those_after_it() {
    let booth = Booth::new();
    let daemon = booth.start();
    let garbage = b"\x00\x01\x02 this is no scan \xff\n".to_vec();
    let empty = Vec::new();
    booth.export("4711_bad.obj", &garbage);
    booth.export("4711_empty.obj", &empty);
    booth.export("4711_good.obj", &coarse_body(1));
    booth.wait_for_records(1);
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", 2);
    booth.export("4711_later.obj", &coarse_body(2));
    booth.wait_for_records(2);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1)), ("4711", &coarse_body(2))]);
    let reason = booth.reason(&garbage);
    assert_eq!(reason["schema"], "gaiter.reason/1");
    assert_eq!(reason["stage"], "measure");
    assert!(reason["code"].as_str().unwrap().starts_with("scan-"), "{reason}");
    assert!(!reason["message"].as_str().unwrap().is_empty());
    assert_eq!(booth.reason(&empty)["code"], "scan-empty");
}

#[test]
fn an_aborted_export_is_awaited_then_quarantined_and_delivered_once_it_is_made_whole() {
    let booth = Booth::new();
    let daemon = booth.start();
    let bytes = coarse_body(1);
    let aborted = &bytes[..bytes.len() - 7];
    fs::write(booth.path("export/4711_a.obj"), aborted).unwrap();
    booth.has_put("4711_a.obj", aborted, PutKind::Short);
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", 1);
    assert_eq!(booth.records(), []);
    booth.export("4711_a.obj", &bytes);
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &bytes)]);
    assert_eq!(booth.reason(aborted)["code"], "scan-cut-short");
}

#[test]
fn a_file_too_large_is_refused_unread() {
    let booth = Booth::new();
    let daemon = booth.start();
    File::create(booth.path("export/4711_huge.obj")).unwrap().set_len(1 << 40).unwrap();
    booth.has_put("4711_huge.obj", &[], PutKind::Huge);
    booth.export("4711_good.obj", &coarse_body(1));
    booth.wait_for_records(1);
    booth.wait_for("a refusal", || names(&booth.path("state/quarantine")).len() == 1);
    assert_eq!(daemon.stop().code(), Some(0));
    let place = booth.path("state/quarantine").join(&names(&booth.path("state/quarantine"))[0]);
    assert_eq!(names(&place), ["reason.json"]);
    let reason = fs::read_to_string(place.join("reason.json")).unwrap();
    assert!(reason.contains("scan-too-large"), "{reason}");
    booth.assert_settled(&[("4711", &coarse_body(1))]);
}

#[test]
fn the_same_bytes_for_the_same_patient_are_one_record() {
    let booth = Booth::new();
    let daemon = booth.start();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    booth.export("4711_again.obj", &coarse_body(1));
    booth.export("whose.obj", &coarse_body(1));
    booth.wait_for_journal("SELECT count(*) FROM sightings", 3);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1))]);
}

#[test]
fn the_same_bytes_for_another_patient_are_held_and_no_second_record_appears() {
    let booth = Booth::new();
    let daemon = booth.start();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.export("whose.obj", &coarse_body(2));
    booth.wait_for_records(2);
    booth.export("0815_a.obj", &coarse_body(1));
    booth.export("0815_b.obj", &coarse_body(2));
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'held'", 2);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1)), ("_unassigned", &coarse_body(2))]);
    assert_eq!(booth.log().matches("same-scan-other-patient").count(), 2);
}

#[test]
fn an_export_folder_that_is_missing_or_replaced_is_taken_up_when_it_is_there() {
    let booth = Booth::new();
    fs::remove_dir(booth.path("export")).unwrap();
    let daemon = booth.start();
    booth.wait_for("the outage to be noticed", || booth.log().contains("out-of-reach"));
    fs::create_dir(booth.path("export")).unwrap();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    fs::rename(booth.path("export"), booth.path("old")).unwrap();
    booth.has_emptied_the_export();
    fs::create_dir(booth.path("export")).unwrap();
    booth.export("4711_b.obj", &coarse_body(2));
    booth.wait_for_records(2);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1)), ("4711", &coarse_body(2))]);
}

#[test]
fn an_unreachable_store_is_tried_until_it_is_back_and_nothing_is_written_in_its_place() {
    let booth = Booth::new();
    let daemon = booth.start_ready();
    booth.take_records_away();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for("the outage to be told", || booth.log().contains("store-unavailable"));
    assert!(!booth.path("records").exists());
    fs::rename(booth.path("unmounted"), booth.path("records")).unwrap();
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1))]);
}

#[test]
fn a_station_killed_at_any_moment_loses_nothing_and_delivers_nothing_twice() {
    let booth = Booth::new();
    let scans: Vec<Vec<u8>> = (0..8).map(coarse_body).collect();
    // A fixed sequence: what fails, fails again.
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = |below: u64| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let moments: Vec<Duration> = (0..24).map(|_| Duration::from_millis(random(900))).collect();
    thread::scope(|scope| {
        scope.spawn(|| {
            for (n, bytes) in scans.iter().enumerate() {
                let path = booth.path(&format!("export/4711_{n}.obj"));
                write_slowly(&path, bytes, 4, QUIET / 2);
                booth.has_put(&format!("4711_{n}.obj"), bytes, PutKind::Whole);
            }
        });
        for moment in moments {
            let daemon = booth.start();
            sleep(moment);
            daemon.kill();
            // Also between two runs nothing half made is under a final name.
            booth.records();
        }
    });
    let daemon = booth.start();
    booth.wait_for_records(scans.len());
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'delivered'", 8);
    assert_eq!(daemon.stop().code(), Some(0));
    let expected: Vec<(&str, &[u8])> =
        scans.iter().map(|bytes| ("4711", bytes.as_slice())).collect();
    booth.assert_settled(&expected);
}

#[test]
fn a_stop_in_the_middle_of_work_ends_with_0_and_the_next_start_goes_on() {
    let booth = Booth::new();
    let scans: Vec<Vec<u8>> = (0..6).map(coarse_body).collect();
    let daemon = booth.start();
    for (n, bytes) in scans.iter().enumerate() {
        booth.export(&format!("4711_{n}.obj"), bytes);
    }
    booth.wait_for("the first scan in the spool", || booth.log().contains("scan-spooled"));
    assert_eq!(daemon.stop().code(), Some(0));
    let daemon = booth.start();
    booth.wait_for_records(scans.len());
    assert_eq!(daemon.stop().code(), Some(0));
    let expected: Vec<(&str, &[u8])> =
        scans.iter().map(|bytes| ("4711", bytes.as_slice())).collect();
    booth.assert_settled(&expected);
}

#[test]
fn a_second_station_on_the_same_state_refuses_and_names_the_first() {
    let booth = Booth::new();
    let daemon = booth.start_ready();
    let pid = fs::read_to_string(booth.path("state/lock")).unwrap();
    let second = booth.command().status().unwrap();
    assert!(second.code().is_some_and(|code| code != 0), "{second:?}");
    let expected = format!("in use by the process {}", pid.trim());
    assert!(booth.log().contains(&expected), "{}", booth.log());
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn the_service_manager_is_told_ready_and_stopping() {
    let booth = Booth::new();
    let path = booth.path("notify");
    let manager = UnixDatagram::bind(&path).unwrap();
    manager.set_read_timeout(Some(PATIENCE)).unwrap();
    let mut child = booth.command().env("NOTIFY_SOCKET", &path).spawn().unwrap();
    let told = || loop {
        let mut message = [0; 256];
        let length = manager.recv(&mut message).unwrap();
        let message = String::from_utf8_lossy(&message[..length]).trim().to_owned();
        // That it is fed and told how the station is are other claims' matters.
        if message != "WATCHDOG=1" && !message.starts_with("STATUS=") {
            break message;
        }
    };
    assert_eq!(told(), "READY=1");
    let pid = rustix::process::Pid::from_child(&child);
    rustix::process::kill_process(pid, rustix::process::Signal::TERM).unwrap();
    assert_eq!(told(), "STOPPING=1");
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn the_log_names_no_patient_no_file_and_no_folder() {
    let booth = Booth::new();
    let daemon = booth.start();
    let garbage = b"Mustermann\n".to_vec();
    booth.export("990011_Mustermann.obj", &coarse_body(1));
    booth.export("990011_Mustermann-bad.obj", &garbage);
    booth.export("1234567890123_Mustermann.obj", &coarse_body(2));
    booth.wait_for_records(2);
    booth.export("990012_Mustermann.obj", &coarse_body(1));
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'held'", 1);
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", 1);
    booth.take_records_away();
    booth.export("990013_Mustermann.obj", &coarse_body(3));
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE attempts > 0", 1);
    fs::rename(booth.path("unmounted"), booth.path("records")).unwrap();
    booth.wait_for_records(3);
    assert_eq!(daemon.stop().code(), Some(0));
    let log = booth.log();
    assert!(log.contains(&sha256(&coarse_body(1))[..8]), "the log speaks of scans:\n{log}");
    for planted in ["99001", "123456789", "Mustermann", "/export", "/records"] {
        assert!(!log.contains(planted), "{planted} is in the log:\n{log}");
    }
}

#[test]
fn the_record_holds_the_files_that_the_configuration_asks_for() {
    let files = r#"["iges-solid", "stl"]"#;
    let booth = Booth::set(&Setting { files, ..Setting::default() });
    let daemon = booth.start();
    let bytes = coarse_body(1);
    booth.export("4711_a.obj", &bytes);
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &bytes)]);
    let patient = booth.path("records/4711");
    let record = patient.join(&names(&patient)[0]);
    let made: Vec<String> =
        names(&record).into_iter().filter(|name| name.starts_with("left")).collect();
    assert_eq!(made, ["left-solid.igs", "left.stl"]);
}
