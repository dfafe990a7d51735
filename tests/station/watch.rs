//! The real program before scanners of every habit: what is taken, what is awaited, what is passed
//! over, and what an export folder must be to be believed.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs::{self, File};
use std::io::Write;
use std::os::unix::fs::{FileExt, symlink};
use std::time::{Duration, SystemTime};

use rig::invariants::PutKind;
use rig::{Booth, Setting, names, sha256};
use rustix::fs::{CWD, Mode, mkfifoat};
use support::coarse_body;

/// A booth with other lines in the section of the configuration that has this header.
fn booth_with(header: &str, lines: &str) -> Booth {
    let booth = Booth::new();
    configure(&booth, header, &format!("{header}\n{lines}"));
    booth
}

fn configure(booth: &Booth, from: &str, to: &str) {
    let file = booth.path("station.toml");
    let text = fs::read_to_string(&file).unwrap();
    assert!(text.contains(from), "{text}");
    fs::write(file, text.replace(from, to)).unwrap();
}

/// Puts an empty file that is no scan into the export folder.
fn beside(booth: &Booth, name: &str) {
    fs::write(booth.path("export").join(name), "").unwrap();
    booth.has_put(name, b"", PutKind::Beside);
}

#[test]
fn what_lies_beside_a_scan_is_kept_with_it() {
    let booth = Booth::new();
    let daemon = booth.start_ready();
    booth.take_records_away();
    booth.export("4711_a.ord", b"OPTION UNITS=cm\nMEASURE Calf=36\n");
    booth.export("4711_a.mtl", b"newmtl skin\n");
    booth.export("4711_b.ord", b"of no scan\n");
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for("the scan in the spool", || booth.log().contains("scan-spooled"));
    assert_eq!(daemon.stop().code(), Some(0));
    let kept = booth.path("state/spool").join(sha256(&coarse_body(1)));
    assert_eq!(names(&kept), ["intake.json", "scan.mtl", "scan.obj", "scan.ord"]);
    let ord = fs::read(kept.join("scan.ord")).unwrap();
    assert_eq!(ord, b"OPTION UNITS=cm\nMEASURE Calf=36\n");
}

#[test]
fn a_sub_folder_that_is_made_and_written_into_at_once_is_looked_through() {
    let booth = booth_with("[scanner]", "subfolders = true");
    let daemon = booth.start_ready();
    let scans: Vec<Vec<u8>> = (0..3).map(coarse_body).collect();
    for (n, bytes) in scans.iter().enumerate() {
        let folder = booth.path("export").join(format!("{n}/{n}"));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("4711_a.obj"), bytes).unwrap();
        booth.has_put(&format!("{n}/{n}/4711_a.obj"), bytes, PutKind::Whole);
    }
    booth.wait_for_records(scans.len());
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&scans.iter().map(|bytes| ("4711", &bytes[..])).collect::<Vec<_>>());
}

#[test]
fn a_scan_is_taken_once_its_done_file_is_there_and_waiting_for_it_is_told_once() {
    let booth = booth_with("[scanner]", "done_file = \"{name}.done\"");
    configure(&booth, "[scanner]", "[status]\noverdue = \"1s\"\n[scanner]");
    let daemon = booth.start();
    booth.export("4711_b.obj", &coarse_body(2));
    beside(&booth, "4711_b.obj.done");
    booth.wait_for_records(1);
    // On a slow machine that one was overdue, too.
    let told = || booth.log().matches("file-overdue").count();
    let before = told();
    booth.export("4711_Mustermann.obj", &coarse_body(1));
    booth.wait_for("the alarm", || told() > before);
    beside(&booth, "4711_Mustermann.obj.done");
    booth.wait_for_records(2);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1)), ("4711", &coarse_body(2))]);
    assert_eq!(told(), before + 1, "{}", booth.log());
    assert!(!booth.log().contains("Mustermann") && !booth.log().contains("files-ignored"));
}

#[test]
fn a_folder_without_its_marker_is_not_believed_and_others_do_not_notice() {
    let booth = booth_with("[scanner]", "marker = \".mounted\"");
    let (export, other) = (booth.path("export"), booth.path("other"));
    let both = format!("\"{}\", \"{}\"", export.display(), other.display());
    configure(&booth, &format!("\"{}\"", export.display()), &both);
    fs::create_dir(&other).unwrap();
    fs::write(other.join(".mounted"), "").unwrap();

    let daemon = booth.start();
    booth.export("4711_a.obj", &coarse_body(1));
    fs::write(other.join("4711_b.obj"), coarse_body(2)).unwrap();
    booth.has_put("../other/4711_b.obj", &coarse_body(2), PutKind::Whole);
    booth.wait_for_records(1);
    booth.wait_for("the alarm", || booth.log().contains("export-dir-not-mounted"));
    assert_eq!(booth.records(), [("4711".to_owned(), sha256(&coarse_body(2)))]);
    beside(&booth, ".mounted");
    booth.wait_for_records(2);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1)), ("4711", &coarse_body(2))]);
    assert!(booth.log().contains("export-dir-in-reach"));
}

#[test]
fn a_disk_that_is_nearly_full_stops_the_intake_and_leaves_exports_where_they_are() {
    let booth = booth_with("[station]", "disk_floor = \"1000GB\"");
    let daemon = booth.start();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for("the alarm", || booth.log().contains("disk-low"));
    assert_eq!(daemon.stop().code(), Some(0));
    assert_eq!(names(&booth.path("state/spool")), [""; 0]);
    assert_eq!(fs::read(booth.path("export/4711_a.obj")).unwrap(), coarse_body(1));
    assert_eq!(booth.log().matches("disk-low").count(), 1);

    configure(&booth, "disk_floor = \"1000GB\"", "disk_floor = \"0B\"");
    let daemon = booth.start();
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1))]);
}

#[test]
fn what_is_no_regular_file_is_passed_over_and_a_second_name_of_a_scan_is_no_second_scan() {
    let booth = Booth::new();
    let at = |name: &str| booth.path("export").join(name);
    booth.export("4711_a.obj", &coarse_body(1));
    fs::hard_link(at("4711_a.obj"), at("4711_again.obj")).unwrap();
    for name in ["4711_a.obj", "4711_again.obj"] {
        booth.has_put(name, &coarse_body(1), PutKind::Whole);
    }
    symlink(at("4711_a.obj"), at("4711_link.obj")).unwrap();
    mkfifoat(CWD, at("4711_pipe.obj"), Mode::RUSR | Mode::WUSR).unwrap();
    fs::create_dir(at("4711_folder.obj")).unwrap();
    for name in ["4711_link.obj", "4711_pipe.obj"] {
        booth.has_put(name, b"", PutKind::Beside);
    }
    let daemon = booth.start();
    booth.wait_for_records(1);
    booth.wait_for_journal("SELECT count(*) FROM sightings", 2);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1))]);
    let log = booth.log();
    assert_eq!(log.matches("files-ignored").count(), 1, "{log}");
    assert_eq!(log.matches("scan-known").count(), 1, "{log}");
}

#[test]
fn a_file_reserved_at_its_full_size_is_awaited_until_it_is_filled() {
    // The wait for its rest does not end before the rest comes, however slow the machine is.
    let short_wait = Duration::from_secs(3600);
    let booth = Booth::set(&Setting { short_wait, ..Setting::default() });
    let bytes = coarse_body(1);
    let (path, half) = (booth.path("export/4711_a.obj"), bytes.len() / 2);
    let file = File::create(&path).unwrap();
    file.set_len(bytes.len() as u64).unwrap();
    file.write_all_at(&bytes[..half], 0).unwrap();
    let daemon = booth.start();
    booth.wait_until_explained("4711_a.obj", "is incomplete");
    let times = fs::metadata(&path).unwrap().modified().unwrap();
    file.write_all_at(&bytes[half..], half as u64).unwrap();
    // As copies do that keep the time of what they copy.
    file.set_modified(times).unwrap();
    booth.has_put("4711_a.obj", &bytes, PutKind::Whole);
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &bytes)]);
    assert_eq!(names(&booth.path("state/quarantine")), [""; 0]);
}

#[test]
fn whatever_a_file_s_own_times_say_it_is_taken_and_taken_again_when_rewritten() {
    let booth = Booth::new();
    let daemon = booth.start();
    let future = SystemTime::now() + Duration::from_secs(400_000_000);
    for (n, time) in [SystemTime::UNIX_EPOCH, future].into_iter().enumerate() {
        let mut file = File::create(booth.path(&format!("export/4711_{n}.obj"))).unwrap();
        file.write_all(&coarse_body(n)).unwrap();
        file.set_modified(time).unwrap();
        booth.has_put(&format!("4711_{n}.obj"), &coarse_body(n), PutKind::Whole);
    }
    booth.wait_for_records(2);
    // The same size and time of change, in place.
    let file = File::options().write(true).open(booth.path("export/4711_0.obj")).unwrap();
    file.write_all_at(&coarse_body(2), 0).unwrap();
    file.set_modified(SystemTime::UNIX_EPOCH).unwrap();
    booth.has_put("4711_0.obj", &coarse_body(2), PutKind::Whole);
    booth.wait_for_records(3);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[
        ("4711", &coarse_body(0)),
        ("4711", &coarse_body(1)),
        ("4711", &coarse_body(2)),
    ]);
}
