//! The journal of the real station, where somebody or something stands in its way.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;

use gaiter::station::journal::Journal;
use rig::process;
use rig::{Booth, PATIENCE, names};
use rusqlite::Connection;
use rustix::process::{Pid, Signal, kill_process};
use support::coarse_body;

fn in_journal(booth: &Booth, sql: &str) {
    let journal = Connection::open(booth.path("state/journal.db")).unwrap();
    journal.busy_timeout(PATIENCE).unwrap();
    journal.execute_batch(sql).unwrap();
}

#[test]
fn a_sound_journal_that_refuses_a_scan_is_kept_and_the_scan_is_taken_later() {
    let booth = Booth::new();
    let daemon = booth.start();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    in_journal(
        &booth,
        "CREATE TRIGGER stubborn BEFORE INSERT ON scans BEGIN SELECT RAISE(ABORT, 'no'); END",
    );
    booth.export("4712_b.obj", &coarse_body(2));
    booth.wait_for("the word", || booth.status()["alarms"]["journal-refuses"].is_object());
    assert!(!booth.log().contains("journal-ruined"), "{}", booth.log());
    in_journal(&booth, "DROP TRIGGER stubborn");
    booth.wait_for_records(2);
    assert_eq!(daemon.stop().code(), Some(0));
    let aside = names(&booth.path("state")).into_iter().find(|name| name.contains("ruined"));
    assert_eq!(aside, None);
    booth.assert_settled(&[("4711", &coarse_body(1)), ("4712", &coarse_body(2))]);
}

/// A start that lost its journal and ended while it was filling the new one: before it said why the journal
/// is new, or after that.
#[test]
fn a_journal_that_a_start_began_anew_and_did_not_fill_is_filled_by_the_next_one() {
    for says_why in [false, true] {
        let booth = Booth::new();
        let daemon = booth.start();
        booth.export("4711_a.obj", &coarse_body(1));
        booth.export("4712_bad.obj", b"v 1 2 3\nv 4 5 6\n");
        booth.wait_for_records(1);
        booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", 1);
        assert_eq!(daemon.stop().code(), Some(0));
        let state = booth.path("state");
        for name in names(&state).iter().filter(|name| name.starts_with("journal.db")) {
            fs::remove_file(state.join(name)).unwrap();
        }
        fs::remove_file(state.join("history.head")).unwrap();
        let journal = Journal::open_anew(&state.join("journal.db")).unwrap();
        if says_why {
            journal.begin_anew(&["folder"], "a test").unwrap();
        }
        drop(journal);

        let daemon = booth.start();
        let count = |state: &str| booth.status()["scans"][state].as_u64();
        booth.wait_for("the refused scan", || count("refused") == Some(1));
        booth.wait_for("the delivered one", || count("delivered") == Some(1));
        assert_eq!(daemon.stop().code(), Some(0));
        booth.assert_settled(&[("4711", &coarse_body(1))]);
        let known = Journal::open(&state.join("journal.db")).unwrap();
        assert_eq!(known.to_fill().unwrap(), None);
    }
}

#[test]
#[ignore = "waits for the end of the grace, 20 s, run by .ci/run"]
fn a_reload_whose_work_does_not_end_ends_the_process_and_no_second_generation_begins_beside_it() {
    let booth = Booth::new();
    // At its start it tries the guards on a process of its own.
    let mut daemon = booth.start_ready();
    let scan = coarse_body(1);
    booth.export("4711_a.obj", &scan);
    let stopped = || {
        let children = process::family(daemon.id()).into_iter().filter(|pid| *pid != daemon.id());
        let stop = |pid: u32| kill_process(Pid::from_raw(pid.cast_signed()).unwrap(), Signal::STOP);
        children.map(stop).any(|sent| sent.is_ok())
    };
    booth.wait_for("a measuring process", stopped);
    kill_process(Pid::from_raw(daemon.id().cast_signed()).unwrap(), Signal::HUP).unwrap();
    booth.wait_for("its end", || daemon.has_ended());
    assert_eq!(daemon.stop().code(), Some(74));
    assert_eq!(booth.log().matches("station-open").count(), 1, "{}", booth.log());
    let daemon = booth.start();
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &scan)]);
}
