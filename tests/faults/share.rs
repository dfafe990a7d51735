//! Network shares at their worst, on a mock share: without events, stalled, dead, taken away and
//! back, with the exports on it or the records.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::io::Write;
use std::thread::sleep;
use std::time::Duration;

use rig::faults::share::Share;
use rig::invariants::PutKind;
use rig::process::waits_on_share;
use rig::{Booth, QUIET, names};
use support::coarse_body;

/// The station's own grace at a stop, and as much again for a busy machine.
const STOP: Duration = Duration::from_secs(40);

/// A booth whose exports lie on a share and in a folder beside it.
fn booth_with_shared_exports() -> (Booth, Share) {
    let booth = Booth::new();
    let local = booth.path("local");
    fs::create_dir(&local).unwrap();
    let (export, both) = (booth.path("export"), local.display());
    booth.reconfigure(|text| {
        let one = format!("export_dirs = [\"{}\"]", export.display());
        assert!(text.contains(&one));
        text.replace(&one, &format!("export_dirs = [\"{}\", \"{both}\"]", export.display()))
    });
    let share = Share::mount(booth.path("back"), export).unwrap();
    (booth, share)
}

/// A booth whose records lie on a share.
fn booth_with_shared_records() -> (Booth, Share) {
    let booth = Booth::new();
    let share = Share::mount(booth.path("back"), booth.path("records")).unwrap();
    (booth, share)
}

fn export_locally(booth: &Booth, name: &str, bytes: &[u8]) {
    fs::write(booth.path("local").join(name), bytes).unwrap();
    booth.has_put_elsewhere(name, bytes);
}

/// Another machine's export. Not while the share is away: the file is looked at once.
fn export_remotely(booth: &Booth, share: &Share, name: &str, bytes: &[u8]) {
    share.write_remotely(name, bytes);
    booth.has_put(name, bytes, PutKind::Whole);
}

fn wait_for_spool(booth: &Booth, count: usize) {
    let spooled = || names(&booth.path("state/spool")).into_iter().filter(|n| !n.starts_with('.'));
    booth.wait_for(&format!("{count} scans in the spool"), || spooled().count() == count);
}

#[test]
#[ignore = "needs root and FUSE, run by .ci/run"]
fn what_another_machine_writes_is_found_without_an_event() {
    let (booth, share) = booth_with_shared_exports();
    let daemon = booth.start_ready();
    export_remotely(&booth, &share, "4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    export_remotely(&booth, &share, "4711_b.obj", &coarse_body(2));
    booth.wait_for_records(2);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1)), ("4711", &coarse_body(2))]);
}

#[test]
#[ignore = "needs root and FUSE, run by .ci/run"]
fn a_scan_that_another_machine_writes_line_by_line_is_taken_whole() {
    let (booth, share) = booth_with_shared_exports();
    let daemon = booth.start_ready();
    // The kernel keeps a share's attributes for a second: the file looks quiet while it grows, and
    // what is there ends with a line.
    let bytes = coarse_body(1);
    let mut file = fs::File::create(share.back().join("4711_a.obj")).unwrap();
    for piece in bytes.split_inclusive(|byte| *byte == b'\n').collect::<Vec<_>>().chunks(400) {
        file.write_all(&piece.concat()).unwrap();
        sleep(QUIET / 3);
    }
    drop(file);
    let whole = || fs::metadata(booth.path("export/4711_a.obj")).map(|file| file.len());
    let length = u64::try_from(bytes.len()).unwrap();
    booth.wait_for("the share to show it whole", || whole().is_ok_and(|now| now == length));
    booth.has_put("4711_a.obj", &bytes, PutKind::Whole);
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &bytes)]);
    assert_eq!(names(&booth.path("state/quarantine")), [""; 0]);
}

#[test]
#[ignore = "needs root and FUSE, run by .ci/run"]
fn a_stalled_share_holds_up_no_other_folder_and_goes_on_by_itself() {
    let (booth, share) = booth_with_shared_exports();
    let daemon = booth.start();
    export_remotely(&booth, &share, "4711_before.obj", &coarse_body(1));
    booth.wait_for_records(1);
    let stall = share.stall();
    share.write_remotely("4711_meanwhile.obj", &coarse_body(2));
    booth.wait_for("a look that hangs", || waits_on_share(daemon.id()));
    export_locally(&booth, "4711_local.obj", &coarse_body(3));
    booth.wait_for_records(2);
    drop(stall);
    booth.has_put("4711_meanwhile.obj", &coarse_body(2), PutKind::Whole);
    booth.wait_for_records(3);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[
        ("4711", &coarse_body(1)),
        ("4711", &coarse_body(2)),
        ("4711", &coarse_body(3)),
    ]);
}

#[test]
#[ignore = "needs root and FUSE, run by .ci/run"]
fn a_share_that_stalls_at_the_start_keeps_no_other_folder_from_starting() {
    let (booth, share) = booth_with_shared_exports();
    export_remotely(&booth, &share, "4711_before.obj", &coarse_body(1));
    // It stalls before the first look. Declared first, the station ends last where the test fails: a process
    // that waits for a share cannot be killed.
    let mut daemon;
    let stall = share.stall();
    daemon = booth.start();
    export_locally(&booth, "4711_local.obj", &coarse_body(2));
    booth.wait_for("the local scan", || {
        booth.records().contains(&("4711".to_owned(), rig::sha256(&coarse_body(2))))
    });
    booth.wait_for("readiness", || booth.log().contains("station-ready"));
    drop(stall);
    booth.wait_for_records(2);
    assert_eq!(daemon.stop_within(STOP).and_then(|ended| ended.code()), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1)), ("4711", &coarse_body(2))]);
}

#[test]
#[ignore = "needs root and FUSE, run by .ci/run"]
fn a_stop_while_a_share_stalls_ends_in_time_and_the_next_start_goes_on() {
    let (booth, share) = booth_with_shared_exports();
    let mut daemon = booth.start();
    booth.wait_for("the start", || booth.log().contains("station-ready"));
    let stall = share.stall();
    share.write_remotely("4711_a.obj", &coarse_body(1));
    booth.wait_for("a look that hangs", || waits_on_share(daemon.id()));
    let ended = daemon.stop_within(STOP);
    assert_eq!(ended.and_then(|ended| ended.code()), Some(0), "log:\n{}", booth.log());
    drop(stall);
    booth.has_put("4711_a.obj", &coarse_body(1), PutKind::Whole);
    let daemon = booth.start();
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1))]);
}

#[test]
#[ignore = "needs root and FUSE, run by .ci/run"]
fn a_share_that_dies_is_taken_up_when_it_is_back_and_no_scan_is_taken_twice() {
    let (booth, mut share) = booth_with_shared_exports();
    let daemon = booth.start();
    export_remotely(&booth, &share, "4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    // In the middle of a copy.
    let bytes = coarse_body(2);
    let half = bytes[..bytes.len() / 2].iter().rposition(|byte| *byte == b'\n').unwrap();
    share.write_remotely("4711_b.obj", &bytes[..=half]);
    booth.has_put("4711_b.obj", &bytes[..=half], PutKind::Short);
    share.die();
    booth.wait_for("the outage to be noticed", || booth.log().contains("out-of-reach"));
    export_locally(&booth, "4711_local.obj", &coarse_body(3));
    booth.wait_for_records(2);
    share.write_remotely("4711_b.obj", &bytes);
    share.revive();
    booth.has_put("4711_b.obj", &bytes, PutKind::Whole);
    booth.wait_for_records(3);
    export_remotely(&booth, &share, "4711_c.obj", &coarse_body(4));
    booth.wait_for_records(4);
    assert_eq!(daemon.stop().code(), Some(0));
    let scans = [coarse_body(1), bytes, coarse_body(3), coarse_body(4)];
    booth.assert_settled(&scans.each_ref().map(|bytes| ("4711", bytes.as_slice())));
    assert_eq!(booth.log().matches("scan-spooled").count(), 4);
}

#[test]
#[ignore = "needs root and FUSE, run by .ci/run"]
fn an_unmounted_share_is_no_empty_folder_and_no_scan_is_taken_twice() {
    let (booth, mut share) = booth_with_shared_exports();
    let daemon = booth.start();
    export_remotely(&booth, &share, "4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    share.unmount_lazily();
    for n in [2, 3] {
        export_locally(&booth, &format!("4711_local{n}.obj"), &coarse_body(n));
        booth.wait_for_records(n);
    }
    share.write_remotely("4711_meanwhile.obj", &coarse_body(4));
    share.serve();
    booth.has_put("4711_meanwhile.obj", &coarse_body(4), PutKind::Whole);
    booth.wait_for_records(4);
    export_remotely(&booth, &share, "4711_later.obj", &coarse_body(5));
    booth.wait_for_records(5);
    assert_eq!(daemon.stop().code(), Some(0));
    let scans: Vec<Vec<u8>> = (1..=5).map(coarse_body).collect();
    let expected: Vec<(&str, &[u8])> = scans.iter().map(|scan| ("4711", scan.as_slice())).collect();
    booth.assert_settled(&expected);
    assert_eq!(booth.log().matches("scan-spooled").count(), 5);
}

#[test]
#[ignore = "needs root and FUSE, run by .ci/run"]
fn records_wait_in_the_spool_while_their_share_is_dead() {
    let (booth, mut share) = booth_with_shared_records();
    let daemon = booth.start();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    share.die();
    for n in 2..=4 {
        booth.export(&format!("4711_{n}.obj"), &coarse_body(n));
    }
    wait_for_spool(&booth, 3);
    booth.wait_for_journal("SELECT count(*) > 0 FROM deliveries WHERE attempts > 0", 1);
    share.revive();
    booth.wait_for_records(4);
    wait_for_spool(&booth, 0);
    assert_eq!(daemon.stop().code(), Some(0));
    let scans: Vec<Vec<u8>> = (1..=4).map(coarse_body).collect();
    let expected: Vec<(&str, &[u8])> = scans.iter().map(|scan| ("4711", scan.as_slice())).collect();
    booth.assert_settled(&expected);
}

#[test]
#[ignore = "needs root and FUSE, run by .ci/run"]
fn scans_are_taken_in_while_the_records_share_stalls_and_a_stop_ends_in_time() {
    let (booth, share) = booth_with_shared_records();
    let mut daemon = booth.start();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    let stall = share.stall();
    for n in 2..=4 {
        booth.export(&format!("4711_{n}.obj"), &coarse_body(n));
    }
    wait_for_spool(&booth, 3);
    booth.wait_for("a delivery that hangs", || waits_on_share(daemon.id()));
    let ended = daemon.stop_within(STOP);
    assert_eq!(ended.and_then(|ended| ended.code()), Some(0), "log:\n{}", booth.log());
    let next = booth.start();
    drop(stall);
    booth.wait_for_records(4);
    wait_for_spool(&booth, 0);
    assert_eq!(next.stop().code(), Some(0));
    let scans: Vec<Vec<u8>> = (1..=4).map(coarse_body).collect();
    let expected: Vec<(&str, &[u8])> = scans.iter().map(|scan| ("4711", scan.as_slice())).collect();
    booth.assert_settled(&expected);
}

#[test]
#[ignore = "needs root and FUSE, run by .ci/run"]
fn nothing_is_written_where_the_records_share_is_not_mounted() {
    let (booth, mut share) = booth_with_shared_records();
    let daemon = booth.start();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    share.unmount_lazily();
    booth.export("4711_b.obj", &coarse_body(2));
    let put_off = "SELECT count(*) FROM deliveries WHERE state = 'delivered' OR attempts > 0";
    booth.wait_for_journal(put_off, 2);
    assert_eq!(names(&booth.path("records")), [""; 0], "in the bare mount point");
    share.serve();
    booth.wait_for_records(2);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &coarse_body(1)), ("4711", &coarse_body(2))]);
}
