//! The journal ruined in every way: cut off, flipped, emptied, deleted, set back, of a later
//! schema. The station starts, says so, loses nothing that lies in spool, store or export folder,
//! and delivers nothing twice or to anybody else.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

use rig::faults::matrix::thinned;
use rig::invariants::PutKind;
use rig::{Booth, Setting, names, sha256};
use rusqlite::Connection;
use support::coarse_body;

/// What the log says where a journal was ruined and made anew.
const ALARM: &str = "journal-rebuilt";

/// Ruins of each kind over the whole file.
const RUINS: usize = 200;

/// At least so many where `GAITER_FAULTS` is "few".
const RUINS_MIN: usize = 40;

/// Booths that are ruined side by side: most of the time each waits for quiet time and disk.
const SIDE_BY_SIDE: usize = 4;

/// A booth with some history, and copies of its state to go back to: scans delivered, one of them
/// gone from the export folder since; one held; one refused; two that wait for their store.
struct Past {
    booth: Booth,
    /// The exports that still lie in the folder.
    exports: i64,
}

/// The copies of the state folder.
const OLDER: &str = "past/older";
const KILLED: &str = "past/killed";
const STOPPED: &str = "past/stopped";
const RECORDS: &str = "past/records";

const DUE: &str = "SELECT count(*) FROM deliveries WHERE state = 'pending'";

impl Past {
    fn new() -> Past {
        let booth = Booth::set(&Setting { files: "[]", ..Setting::default() });
        fs::create_dir(booth.path("past")).unwrap();
        let daemon = booth.start();
        for n in 1..=3 {
            booth.export(&format!("4711_{n}.obj"), &coarse_body(n));
        }
        booth.export("4711_bad.obj", b"garbage\n");
        booth.wait_for_records(3);
        booth.export("0815_1.obj", &coarse_body(1));
        booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'held'", 1);
        booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", 1);
        fs::remove_file(booth.path("export/4711_3.obj")).unwrap();
        booth.has_put("4711_3.obj", &coarse_body(3), PutKind::Whole);
        assert_eq!(daemon.stop().code(), Some(0));
        copy(&booth.path("state"), &booth.path(OLDER));

        let daemon = booth.start();
        booth.export("4712_4.obj", &coarse_body(4));
        booth.wait_for_records(4);
        booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'delivered'", 4);
        fs::rename(booth.path("records"), booth.path(RECORDS)).unwrap();
        booth.export("4713_5.obj", &coarse_body(5));
        booth.export("4714_6.obj", &coarse_body(6));
        booth.wait_for_journal(DUE, 2);
        daemon.kill();
        copy(&booth.path("state"), &booth.path(KILLED));

        let daemon = booth.start();
        let starts = || booth.log().matches("station-ready").count();
        booth.wait_for("the third start", || starts() == 3);
        assert_eq!(daemon.stop().code(), Some(0));
        fs::rename(booth.path("state"), booth.path(STOPPED)).unwrap();
        let exports = i64::try_from(names(&booth.path("export")).len()).unwrap();
        assert_eq!(exports, 7);
        Past { booth, exports }
    }

    /// Everything as it was, but for the exports, which nobody touches.
    fn restore(&self, state: &str) {
        for folder in ["state", "records"] {
            let _ = fs::remove_dir_all(self.booth.path(folder));
        }
        let _ = fs::remove_file(self.booth.path("log"));
        copy(&self.booth.path(state), &self.booth.path("state"));
        copy(&self.booth.path(RECORDS), &self.booth.path("records"));
    }

    fn journal(&self) -> PathBuf {
        self.booth.path("state/journal.db")
    }

    /// The station on a restored state after it was ruined: all is well in the end. Says whether
    /// the station noticed.
    #[track_caller]
    fn recovers(&self, state: &str, what: &str, ruin: impl FnOnce(&Path)) -> bool {
        self.restore(state);
        ruin(&self.booth.path("state"));
        let before = self.record_folders();
        let booth = &self.booth;
        let daemon = booth.start();
        booth.wait_for(&format!("{what}: readiness"), || booth.log().contains("station-ready"));
        booth.wait_for(&format!("{what}: all exports to be looked at"), || {
            booth.journal("SELECT count(*) FROM sightings") >= Some(self.exports)
        });
        let pending = "SELECT count(*) FROM deliveries WHERE state = 'pending'";
        booth.wait_for(&format!("{what}: all deliveries"), || {
            booth.journal(pending) == Some(0) && self.record_folders().len() >= 6
        });
        booth.asks();
        assert_eq!(daemon.stop().code(), Some(0), "{what}");
        assert!(self.record_folders().is_superset(&before), "{what}: records were moved");
        let scans: Vec<Vec<u8>> = (0..=6).map(coarse_body).collect();
        let patients = ["4711", "4711", "4711", "4712", "4713", "4714"];
        let expected: Vec<(&str, &[u8])> =
            patients.into_iter().zip(scans.iter().skip(1).map(Vec::as_slice)).collect();
        let _told = InCaseOfPanic(what);
        booth.assert_settled(&expected);
        assert_eq!(
            names(&booth.path("state/spool")),
            [sha256(&coarse_body(1))],
            "{what}: the held one"
        );
        assert_eq!(names(&booth.path("state/quarantine")), [sha256(b"garbage\n")], "{what}");
        booth.reason(b"garbage\n");
        booth.log().contains(ALARM)
    }

    /// As [`Past::recovers`], and the station must notice and keep the ruin.
    #[track_caller]
    fn recovers_with_alarm(&self, state: &str, what: &str, ruin: impl FnOnce(&Path)) {
        assert!(self.recovers(state, what, ruin), "{what}: no alarm in\n{}", self.booth.log());
    }

    fn record_folders(&self) -> BTreeSet<String> {
        let root = self.booth.path("records");
        let of = |patient: String| {
            let folders = names(&root.join(&patient)).into_iter();
            folders.map(move |name| format!("{patient}/{name}"))
        };
        names(&root).into_iter().flat_map(of).filter(|name| !name.contains("/.")).collect()
    }
}

/// Says what was done to the journal where what is asserted meanwhile does not hold.
struct InCaseOfPanic<'a>(&'a str);

impl Drop for InCaseOfPanic<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            println!("after {}", self.0);
        }
    }
}

fn copy(from: &Path, to: &Path) {
    assert!(Command::new("cp").arg("-a").arg(from).arg(to).status().unwrap().success());
}

/// Ruins the journal of a booth with a past in `count` ways, several booths at a time.
fn ruin_each(count: usize, ruin: impl Fn(&Past, usize) + Sync) {
    let ruin = &ruin;
    thread::scope(|scope| {
        let workers = SIDE_BY_SIDE.min(count);
        for hand in 0..workers {
            scope.spawn(move || {
                let past = Past::new();
                (hand..count).step_by(workers).for_each(|n| ruin(&past, n));
            });
        }
    });
}

const PAGE_BYTES: usize = 4096;

/// The `n`th of `count` places spread over a file, none of them its end.
fn place(n: usize, count: usize, length: u64) -> u64 {
    length * u64::try_from(n).unwrap() / u64::try_from(count).unwrap()
}

fn cut_at_each_of(count: usize) {
    ruin_each(count, |past, n| {
        let length = fs::metadata(past.booth.path(STOPPED).join("journal.db")).unwrap().len();
        let at = place(n, count, length);
        let journal = fs::read(past.booth.path(STOPPED).join("journal.db")).unwrap();
        let gone = &journal[usize::try_from(at).unwrap()..];
        // Zeros at the end of the last page are read as such where they are missing.
        let is_loss = gone.len() >= PAGE_BYTES || gone.iter().any(|byte| *byte != 0);
        let alarmed = past.recovers(STOPPED, &format!("cut at {at} of {length}"), |state| {
            fs::write(state.join("journal.db"), &journal[..journal.len() - gone.len()]).unwrap();
        });
        assert!(alarmed || !is_loss, "cut at {at}: no alarm in\n{}", past.booth.log());
    });
}

/// Flips one bit of a file of the state: the same one each time for the same `n`.
fn flip(file: &Path, n: usize, count: usize) {
    let mut bytes = fs::read(file).unwrap();
    let length = u64::try_from(bytes.len()).unwrap();
    // An odd step beside the even spread, so that not all places are alike within their pages.
    let at = (place(n, count, length) + 37 * u64::try_from(n).unwrap()) % length;
    let byte = &mut bytes[usize::try_from(at).unwrap()];
    *byte ^= 1 << (n % 8);
    fs::write(file, bytes).unwrap();
}

fn flip_each_of(count: usize) {
    let noticed = std::sync::atomic::AtomicUsize::new(0);
    ruin_each(count, |past, n| {
        let what = format!("flip {n} of {count}");
        // A bit that nobody reads, or that changes nothing anybody relies on, may go unnoticed.
        if past.recovers(STOPPED, &what, |state| flip(&state.join("journal.db"), n, count)) {
            noticed.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        }
    });
    println!("{} of {count} flipped bits were noticed", noticed.into_inner());
}

#[test]
fn a_journal_cut_off_anywhere_is_made_anew_sampled() {
    cut_at_each_of(8);
}

#[test]
#[ignore = "takes minutes, run by .ci/run"]
fn a_journal_cut_off_at_many_places_is_made_anew() {
    cut_at_each_of((RUINS / thinned()).max(RUINS_MIN));
}

#[test]
fn a_flipped_bit_of_the_journal_loses_and_doubles_nothing_sampled() {
    flip_each_of(8);
}

#[test]
#[ignore = "takes minutes, run by .ci/run"]
fn a_flipped_bit_at_many_places_of_the_journal_loses_and_doubles_nothing() {
    flip_each_of((RUINS / thinned()).max(RUINS_MIN));
}

#[test]
fn a_journal_that_is_not_there_or_holds_nothing_is_made_anew() {
    let past = Past::new();
    past.recovers_with_alarm(STOPPED, "emptied", |state| {
        fs::write(state.join("journal.db"), b"").unwrap();
    });
    past.recovers_with_alarm(STOPPED, "deleted", |state| {
        fs::remove_file(state.join("journal.db")).unwrap();
    });
    past.recovers_with_alarm(STOPPED, "zeros", |state| {
        let length = fs::metadata(state.join("journal.db")).unwrap().len();
        fs::write(state.join("journal.db"), vec![0; usize::try_from(length).unwrap()]).unwrap();
    });
    past.recovers_with_alarm(STOPPED, "another file", |state| {
        fs::write(state.join("journal.db"), "no journal\n".repeat(1000)).unwrap();
    });
    past.recovers_with_alarm(STOPPED, "an empty database", |state| {
        fs::remove_file(state.join("journal.db")).unwrap();
        let empty = Connection::open(state.join("journal.db")).unwrap();
        empty.execute_batch("VACUUM").unwrap();
    });
    past.recovers_with_alarm(STOPPED, "facts that are no text", |state| {
        let journal = Connection::open(state.join("journal.db")).unwrap();
        journal.execute_batch("UPDATE meta SET value = CAST(x'ff' AS TEXT)").unwrap();
    });
    past.recovers_with_alarm(STOPPED, "tables dropped", |state| {
        let journal = Connection::open(state.join("journal.db")).unwrap();
        journal.execute_batch("PRAGMA foreign_keys = OFF; DROP TABLE deliveries").unwrap();
    });
}

#[test]
fn what_a_ruined_journal_held_is_set_aside_and_not_thrown_away() {
    let past = Past::new();
    past.recovers_with_alarm(STOPPED, "another file", |state| {
        fs::write(state.join("journal.db"), "no journal\n").unwrap();
    });
    let aside: Vec<String> = names(&past.booth.path("state"))
        .into_iter()
        .filter(|name| name.starts_with("journal.ruined-"))
        .collect();
    assert!(!aside.is_empty(), "{:?}", names(&past.booth.path("state")));
    let kept = aside.iter().any(|name| {
        let aside = past.booth.path("state").join(name);
        let file = if aside.is_dir() { aside.join("journal.db") } else { aside };
        fs::read(file).is_ok_and(|bytes| bytes == b"no journal\n")
    });
    assert!(kept, "{aside:?}");
}

#[test]
fn the_log_beside_the_journal_deleted_cut_or_swapped_loses_and_doubles_nothing() {
    let past = Past::new();
    past.recovers(KILLED, "nothing ruined", |state| {
        assert!(fs::metadata(state.join("journal.db-wal")).unwrap().len() > 0);
    });
    past.recovers(KILLED, "no write-ahead log", |state| {
        fs::remove_file(state.join("journal.db-wal")).unwrap();
    });
    past.recovers(KILLED, "no shared memory", |state| {
        fs::remove_file(state.join("journal.db-shm")).unwrap();
    });
    past.recovers(KILLED, "neither", |state| {
        fs::remove_file(state.join("journal.db-wal")).unwrap();
        fs::remove_file(state.join("journal.db-shm")).unwrap();
    });
    for n in 0..6 {
        past.recovers(KILLED, &format!("write-ahead log cut, {n} sixths left"), |state| {
            let log = fs::File::options().write(true).open(state.join("journal.db-wal")).unwrap();
            log.set_len(place(n, 6, log.metadata().unwrap().len())).unwrap();
        });
        past.recovers(KILLED, &format!("write-ahead log flipped, place {n}"), |state| {
            flip(&state.join("journal.db-wal"), n, 6);
        });
    }
    past.recovers(KILLED, "the journal of before, the write-ahead log of now", |state| {
        fs::copy(past.booth.path(OLDER).join("journal.db"), state.join("journal.db")).unwrap();
    });
    past.recovers(STOPPED, "the journal of now, a write-ahead log of before", |state| {
        let from = past.booth.path(KILLED);
        fs::copy(from.join("journal.db-wal"), state.join("journal.db-wal")).unwrap();
    });
    past.recovers(KILLED, "shared memory flipped", |state| {
        flip(&state.join("journal.db-shm"), 3, 100);
    });
}

#[test]
fn an_older_copy_of_the_journal_is_brought_up_to_date_from_spool_and_store() {
    let past = Past::new();
    past.recovers(STOPPED, "an older copy", |state| {
        fs::copy(past.booth.path(OLDER).join("journal.db"), state.join("journal.db")).unwrap();
    });
}

#[test]
fn an_older_copy_in_which_a_delivered_scan_was_still_to_be_delivered_doubles_nothing() {
    let past = Past::new();
    // All six delivered by now, but the journal is of a time when two were not.
    past.recovers(STOPPED, "nothing ruined", |_| {});
    let booth = &past.booth;
    fs::copy(booth.path(STOPPED).join("journal.db"), past.journal()).unwrap();
    let before = past.record_folders();
    let daemon = booth.start();
    let known = "SELECT count(*) FROM deliveries WHERE state = 'delivered'";
    booth.wait_for_journal(known, 6);
    booth.wait_for("the start", || booth.log().matches("station-ready").count() == 2);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_eq!(past.record_folders(), before);
    assert_eq!(names(&booth.path("state/quarantine")), [sha256(b"garbage\n")]);
}

#[test]
fn a_journal_of_a_later_schema_is_refused_by_its_number_and_left_as_it_is() {
    let past = Past::new();
    past.restore(STOPPED);
    let journal = Connection::open(past.journal()).unwrap();
    journal.pragma_update(None, "user_version", 4242).unwrap();
    // No write-ahead log is left behind: the file alone is the journal.
    journal.pragma_update(None, "journal_mode", "DELETE").unwrap();
    journal.pragma_update(None, "journal_mode", "WAL").unwrap();
    drop(journal);
    let before = fs::read(past.journal()).unwrap();
    let ended = past.booth.command().status().unwrap();
    assert!(ended.code().is_some_and(|code| code != 0), "{ended:?}");
    assert!(past.booth.log().contains("4242"), "{}", past.booth.log());
    assert!(!past.booth.log().contains(ALARM), "{}", past.booth.log());
    assert_eq!(fs::read(past.journal()).unwrap(), before);
    let state = names(&past.booth.path("state"));
    assert!(!state.iter().any(|name| name.contains("ruined")), "{state:?}");
}

#[test]
fn a_journal_deleted_under_the_running_station_loses_and_doubles_nothing() {
    let past = Past::new();
    let booth = &past.booth;
    past.restore(STOPPED);
    let daemon = booth.start_ready();
    booth.wait_for_records(6);
    for file in ["journal.db", "journal.db-wal", "journal.db-shm"] {
        fs::remove_file(booth.path("state").join(file)).unwrap();
    }
    booth.export("4715_7.obj", &coarse_body(7));
    booth.wait_for_records(7);
    let before = past.record_folders();
    assert_eq!(daemon.stop().code(), Some(0));
    let starts = booth.log().matches("station-ready").count();
    let daemon = booth.start();
    booth.wait_for("the last start", || booth.log().matches("station-ready").count() > starts);
    booth.wait_for("all exports to be looked at", || {
        booth.journal("SELECT count(*) FROM sightings") >= Some(past.exports + 1)
    });
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'pending'", 0);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_eq!(past.record_folders(), before);
    assert!(booth.log().contains(ALARM), "no alarm in\n{}", booth.log());
    fs::remove_file(booth.path("export/4715_7.obj")).unwrap();
}
