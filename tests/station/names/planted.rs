//! Patients' names and numbers planted wherever a scanner could put them never appear in the logs,
//! at whatever level, nor in what everybody on the machine can read of the station's processes.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{scope, sleep};
use std::time::Duration;

use rig::process::{family, public_words};
use rig::{Booth, Daemon, sha256};
use support::coarse_body;

/// What may never appear. The numbers are ids, one of them none that is allowed; the names stand in
/// file names, folders, contents and companions.
const PLANTED: [&str; 4] = ["770099", "880011", "quastenflosser", "hammerhai"];

/// Pause between two readings of /proc: less than a child lives.
const BLINK: Duration = Duration::from_millis(2);

/// A scan with a patient in its comments, its groups, its objects and its material.
fn planted_body(n: usize) -> Vec<u8> {
    let head = format!(
        "# Patient: Quastenflosser, Hanna, 77009900{n}\nmtllib Quastenflosser.mtl\n\
         o Quastenflosser_77009900{n}\ng Hammerhai 77009900{n}\nusemtl Hammerhai\n"
    );
    [head.into_bytes(), coarse_body(n), b"# Quastenflosser, Hanna\n".to_vec()].concat()
}

/// A booth whose folders are named after patients, too.
fn planted_booth() -> Booth {
    let booth = Booth::new();
    booth.reconfigure(|text| {
        text.replace("/export\"", "/export-Hammerhai\"").replace("/records\"", "/store-Hammerhai\"")
    });
    for (from, to) in [("export", "export-Hammerhai"), ("records", "store-Hammerhai")] {
        fs::rename(booth.path(from), booth.path(to)).unwrap();
    }
    booth
}

fn export(booth: &Booth, name: &str, bytes: &[u8]) {
    fs::write(booth.path("export-Hammerhai").join(name), bytes).unwrap();
}

/// Everything that can happen to a scan, with a name in it each time.
fn misfortunes(booth: &Booth) {
    let deliveries = |count, state| {
        let query = format!("SELECT count(*) FROM deliveries WHERE state = '{state}'");
        booth.wait_for_journal(&query, count);
    };
    export(booth, "770099001_Quastenflosser.obj", &planted_body(1));
    export(booth, "770099001_Quastenflosser.ord", b"Quastenflosser\tHanna\t770099001\n");
    export(booth, "770099001_Quastenflosser.mtl", b"newmtl Hammerhai\n");
    export(booth, "7700990000000000001_Quastenflosser.obj", &planted_body(2));
    export(booth, "Hammerhai.pdf", b"Quastenflosser");
    deliveries(2, "delivered");
    // Refused: nonsense at each place of a line, a scan cut short, one too large, one empty.
    export(booth, "770099003_Quastenflosser.obj", b"v 1 2 Quastenflosser-770099003\n");
    export(booth, "770099004_Quastenflosser.obj", b"Quastenflosser 770099004 1 2\n");
    export(booth, "770099005_Quastenflosser.stl", b"solid Quastenflosser\nfacet 770099005\n");
    export(booth, "770099006_Quastenflosser.ply", b"ply\nformat ascii 1.0\ncomment 770099006\n");
    export(booth, "770099007_Quastenflosser.wrl", b"#VRML V2.0 utf8\n# 770099007 Hammerhai {\n");
    export(booth, "770099008_Quastenflosser.obj", b"");
    let short = planted_body(9);
    export(booth, "770099009_Quastenflosser.obj", &short[..short.len() / 2 - 3]);
    let large = fs::File::create(booth.path("export-Hammerhai/770099010_Hammerhai.obj")).unwrap();
    large.set_len(1 << 40).unwrap();
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", 7);
    // Held, and put off because the store is away; then the export folder is away.
    export(booth, "880011001_Quastenflosser.obj", &planted_body(1));
    deliveries(1, "held");
    fs::rename(booth.path("store-Hammerhai"), booth.path("away")).unwrap();
    export(booth, "770099011_Quastenflosser.obj", &planted_body(11));
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE attempts > 0", 1);
    fs::rename(booth.path("away"), booth.path("store-Hammerhai")).unwrap();
    deliveries(3, "delivered");
    fs::rename(booth.path("export-Hammerhai"), booth.path("away")).unwrap();
    booth.wait_for("the outage", || booth.log().contains("out-of-reach"));
    fs::rename(booth.path("away"), booth.path("export-Hammerhai")).unwrap();
    export(booth, "770099012_Quastenflosser.obj", &planted_body(12));
    deliveries(4, "delivered");
}

/// Reads what everybody can read of the station and its children until it is told to stop.
fn watch_processes(pid: u32, stop: &AtomicBool, seen: &Mutex<BTreeSet<Vec<u8>>>) {
    while !stop.load(Ordering::Relaxed) {
        let words: Vec<Vec<u8>> = family(pid).into_iter().map(public_words).collect();
        seen.lock().unwrap().extend(words);
        sleep(BLINK);
    }
}

#[track_caller]
fn assert_clean(what: &str, text: &[u8]) {
    let text = String::from_utf8_lossy(text);
    let lower = text.to_lowercase();
    for planted in PLANTED {
        let Some(at) = lower.find(planted) else { continue };
        let line = lower[..at].lines().count().max(1);
        panic!("{planted} is in {what}: {}", lower.lines().nth(line - 1).unwrap_or_default());
    }
}

/// What may be said of a station whose log has this level.
fn nothing_planted_is_seen(level: &str) {
    let booth = planted_booth();
    let mut command: Command = booth.command();
    command.env("RUST_LOG", level);
    let daemon = Daemon::start(command);
    let (stop, seen) = (AtomicBool::new(false), Mutex::new(BTreeSet::new()));
    scope(|scope| {
        let watching = scope.spawn(|| watch_processes(daemon.id(), &stop, &seen));
        misfortunes(&booth);
        stop.store(true, Ordering::Relaxed);
        watching.join().unwrap();
    });
    assert_eq!(daemon.stop().code(), Some(0));
    let log = booth.log();
    assert!(log.contains(&sha256(&planted_body(1))[..8]), "the log speaks of scans:\n{log}");
    assert_clean("the log", log.as_bytes());
    let seen = seen.into_inner().unwrap();
    assert!(!seen.is_empty());
    for words in seen {
        assert_clean("a process", &words);
    }
}

#[test]
fn nothing_planted_is_in_the_log_or_the_processes() {
    nothing_planted_is_seen("info");
}

#[test]
fn nothing_planted_is_in_the_log_or_the_processes_at_the_finest_level() {
    nothing_planted_is_seen("trace");
}
