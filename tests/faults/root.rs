//! The export folder itself replaced: removed and made again, renamed away, a link in its place,
//! another file system mounted over it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use std::fs;
use std::os::unix::fs::symlink;
use std::path::PathBuf;
use std::process::Command;

use rig::invariants::PutKind;
use rig::verb::stdout;
use rig::{Booth, names};
use support::coarse_body;

/// A station that has delivered one scan, `4711_1.obj`, that still lies in the export folder.
fn booth_at_work() -> (Booth, rig::Daemon) {
    let booth = Booth::new();
    let daemon = booth.start();
    booth.export("4711_1.obj", &coarse_body(1));
    booth.wait_for_records(1);
    (booth, daemon)
}

fn settles(booth: &Booth, daemon: rig::Daemon, scans: usize) {
    assert_eq!(daemon.stop().code(), Some(0));
    let scans: Vec<Vec<u8>> = (1..=scans).map(coarse_body).collect();
    let expected: Vec<(&str, &[u8])> = scans.iter().map(|scan| ("4711", scan.as_slice())).collect();
    booth.assert_settled(&expected);
}

#[test]
fn a_folder_removed_and_made_again_is_watched_again() {
    let (booth, daemon) = booth_at_work();
    for n in 2..=4 {
        fs::remove_dir_all(booth.path("export")).unwrap();
        booth.has_emptied_the_export();
        if n == 3 {
            booth.wait_for("the outage", || booth.log().contains("out-of-reach"));
        }
        fs::create_dir(booth.path("export")).unwrap();
        booth.export(&format!("4711_{n}.obj"), &coarse_body(n));
        booth.wait_for_records(n);
    }
    settles(&booth, daemon, 4);
}

#[test]
fn what_happens_in_a_folder_that_was_renamed_away_is_no_business_of_the_station() {
    let (booth, daemon) = booth_at_work();
    fs::rename(booth.path("export"), booth.path("old")).unwrap();
    booth.has_emptied_the_export();
    fs::write(booth.path("old/4711_ghost.obj"), coarse_body(99)).unwrap();
    fs::create_dir(booth.path("export")).unwrap();
    for n in 2..=3 {
        booth.export(&format!("4711_{n}.obj"), &coarse_body(n));
        booth.wait_for_records(n);
    }
    settles(&booth, daemon, 3);
}

#[test]
fn a_folder_renamed_away_and_back_gives_no_scan_twice() {
    let (booth, daemon) = booth_at_work();
    fs::rename(booth.path("export"), booth.path("old")).unwrap();
    booth.wait_for("the outage", || booth.log().contains("out-of-reach"));
    fs::rename(booth.path("old"), booth.path("export")).unwrap();
    booth.export("4711_2.obj", &coarse_body(2));
    booth.wait_for_records(2);
    settles(&booth, daemon, 2);
    assert_eq!(booth.log().matches("scan-known").count(), 0, "no export was read twice");
}

#[test]
fn a_link_in_the_folder_s_place_is_followed_wherever_it_leads_next() {
    let (booth, daemon) = booth_at_work();
    for n in 2..=3 {
        let target = booth.path(&format!("target-{n}"));
        fs::create_dir(&target).unwrap();
        fs::write(target.join("4711_1.obj"), coarse_body(1)).unwrap();
        let link = booth.path(&format!("link-{n}"));
        symlink(&target, &link).unwrap();
        if n == 2 {
            fs::rename(booth.path("export"), booth.path("old")).unwrap();
        }
        fs::rename(link, booth.path("export")).unwrap();
        booth.has_emptied_the_export();
        booth.has_put("4711_1.obj", &coarse_body(1), PutKind::Whole);
        booth.export(&format!("4711_{n}.obj"), &coarse_body(n));
        booth.wait_for_records(n);
    }
    settles(&booth, daemon, 3);
}

/// A file system in memory over a folder; taken away at the end of the test at the latest.
pub struct Overlay(PathBuf);

impl Overlay {
    pub fn mount(on: PathBuf) -> Option<Overlay> {
        Overlay::of_size(on, "64m")
    }

    pub fn of_size(on: PathBuf, size: &str) -> Option<Overlay> {
        let mut command = Command::new("mount");
        command.args(["-t", "tmpfs", "-o", &format!("size={size}"), "none"]).arg(&on);
        if !command.status().is_ok_and(|status| status.success()) {
            println!("mounting needs root");
            return None;
        }
        Some(Overlay(on))
    }
}

impl Overlay {
    fn grow(&self, size: &str) {
        let mut command = Command::new("mount");
        command.args(["-o", &format!("remount,size={size}")]).arg(&self.0);
        assert!(command.status().unwrap().success());
    }
}

impl Drop for Overlay {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(&self.0).status();
    }
}

#[test]
#[ignore = "needs root to mount, run by .ci/run"]
fn what_is_mounted_over_the_folder_is_looked_at_and_what_lies_below_is_not_taken_twice() {
    let (booth, daemon) = booth_at_work();
    let overlay = Overlay::mount(booth.path("export")).unwrap();
    booth.export("4711_2.obj", &coarse_body(2));
    booth.wait_for_records(2);
    drop(overlay);
    booth.has_put("4711_2.obj", &coarse_body(2), PutKind::Whole);
    assert_eq!(names(&booth.path("export")), ["4711_1.obj"]);
    booth.export("4711_3.obj", &coarse_body(3));
    booth.wait_for_records(3);
    settles(&booth, daemon, 3);
}

#[test]
fn a_file_in_the_folder_s_place_is_an_outage() {
    let (booth, daemon) = booth_at_work();
    fs::rename(booth.path("export"), booth.path("old")).unwrap();
    fs::write(booth.path("export"), "no folder").unwrap();
    booth.wait_until_explained("4711_2.obj", "Not a directory");
    fs::remove_file(booth.path("export")).unwrap();
    fs::rename(booth.path("old"), booth.path("export")).unwrap();
    booth.export("4711_2.obj", &coarse_body(2));
    booth.wait_for_records(2);
    settles(&booth, daemon, 2);
}

#[test]
#[ignore = "needs root to mount, run by .ci/run"]
fn a_record_folder_that_is_full_is_a_fault_however_often_it_is_reached() {
    let booth = Booth::new();
    let disk = Overlay::of_size(booth.path("records"), "200k").unwrap();
    let daemon = booth.start();
    booth.export("4711_1.obj", &coarse_body(1));
    let is_reported = || {
        let status = stdout(&booth.gaiter(&["status"]));
        status.contains("[store-fault]") && status.contains("No space left on device")
    };
    booth.wait_for("the fault", is_reported);
    let tried = "SELECT count(*) FROM deliveries WHERE attempts >= 4";
    booth.wait_for_journal(tried, 1);
    assert!(is_reported(), "{}", stdout(&booth.gaiter(&["status"])));
    disk.grow("64m");
    booth.wait_for_records(1);
    booth.wait_for("the station", || !is_reported());
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1))]);
}
