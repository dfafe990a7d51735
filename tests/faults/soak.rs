//! Many scans end to end on the real program: memory, open files and threads stay flat, the journal
//! grows by a fixed number of bytes a scan, and every scan has its one whole record.
//!
//! `GAITER_SOAK_SCANS=10000 cargo test --release --test faults soak:: -- --ignored --nocapture` is the real
//! run; it takes half a megabyte of `TMPDIR` a scan.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use std::env;
use std::fs;
use std::time::Instant;

use rig::invariants::{Delivered, Vitals};
use rig::{Booth, Setting, names, sha256};
use support::coarse_body;

/// Scans where the environment says nothing else: enough for a tenth to fill the journal's pages.
const SCANS: usize = 600;

/// Scans that lie in the export folder together before their records are awaited.
const BATCH: usize = 20;

/// Readings taken over the run, in even steps.
const READINGS: usize = 10;

/// How far memory may be above its highest of the first half, kB: one more thread's arena. Over
/// 10 000 scans a leak of 1 kB a scan shows.
const MEMORY_UNREST_KB: usize = 5_000;

/// How far the journal's growth a scan may be above that of the first half: pages fill unevenly.
const GROWTH_UNREST: f64 = 1.25;

/// What SQLite lets the write-ahead log grow to before it is written back, 1000 pages of 4 kB, and
/// what may be written in the meantime.
const LOG_MOST_BYTES: u64 = 8_000_000;

/// What the run costs at one moment.
#[derive(Clone, Copy)]
struct Reading {
    scans: usize,
    vitals: Vitals,
    journal_bytes: u64,
    log_bytes: u64,
}

fn reading(booth: &Booth, pid: u32, scans: usize) -> Reading {
    let pragma = |name: &str| booth.journal(&format!("PRAGMA {name}")).unwrap().cast_unsigned();
    let log = booth.path("state/journal.db-wal");
    // What is still in the write-ahead log counts too.
    let journal_bytes = pragma("page_count") * pragma("page_size");
    let log_bytes = fs::metadata(log).map_or(0, |file| file.len());
    Reading { scans, vitals: Vitals::read(pid).unwrap(), journal_bytes, log_bytes }
}

fn count_from_environment() -> usize {
    let count = env::var("GAITER_SOAK_SCANS").map_or(SCANS, |text| text.parse().unwrap());
    // Each tenth is made of whole batches.
    count.next_multiple_of(BATCH * READINGS)
}

/// One batch of the scanner: exports, waits for the records, and cleans up half of what it
/// exported: some exports lie there for long.
fn batch(booth: &Booth, first: usize) -> Vec<Delivered> {
    let mut expected = Vec::new();
    for n in first..first + BATCH {
        let (patient, bytes) = (format!("P{}", n % 97), coarse_body(n));
        booth.export(&format!("{patient}_{n}.obj"), &bytes);
        expected.push((patient, sha256(&bytes)));
    }
    let delivered = i64::try_from(first + BATCH).unwrap();
    let query = "SELECT count(*) FROM deliveries WHERE state = 'delivered'";
    booth.wait_long_for_journal(query, delivered);
    let lying = names(&booth.path("export"));
    for name in lying.iter().take(lying.len().saturating_sub(BATCH / 2)) {
        fs::remove_file(booth.path("export").join(name)).unwrap();
    }
    expected
}

#[test]
#[ignore = "takes minutes, run by .ci/run"]
fn thousands_of_scans_leave_memory_files_and_threads_flat() {
    let count = count_from_environment();
    let booth = Booth::set(&Setting { files: "[]", ..Setting::default() });
    let daemon = booth.start();
    let (mut expected, mut readings) = (Vec::new(), Vec::new());
    let began = Instant::now();
    for first in (0..count).step_by(BATCH) {
        expected.extend(batch(&booth, first));
        let scans = first + BATCH;
        if scans.is_multiple_of(count / READINGS) {
            let now = reading(&booth, daemon.id(), scans);
            report(&now, began);
            readings.push(now);
        }
    }
    assert_eq!(daemon.stop().code(), Some(0));
    assert_flat(&readings);
    expected.sort();
    assert_eq!(booth.records(), expected);
    assert_eq!(names(&booth.path("state/spool")), [""; 0]);
    assert_eq!(names(&booth.path("state/quarantine")), [""; 0]);
}

fn report(now: &Reading, began: Instant) {
    let Reading { scans, vitals: Vitals { resident_kb, files, threads }, .. } = *now;
    let (count, journal) = (as_f64(scans), as_f64(now.journal_bytes));
    println!(
        "{scans:6} scans: {resident_kb} kB resident, {files} files, {threads} threads, journal \
         {} kB ({:.0} bytes a scan), write-ahead log {} kB, {:.2} scans/s",
        now.journal_bytes / 1000,
        journal / count,
        now.log_bytes / 1000,
        count / began.elapsed().as_secs_f64()
    );
}

fn as_f64(number: impl TryInto<u32>) -> f64 {
    f64::from(number.try_into().ok().unwrap())
}

/// The second half of the run needs no more than the first.
#[track_caller]
fn assert_flat(readings: &[Reading]) {
    let (early, late) = readings.split_at(READINGS / 2);
    let most = |half: &[Reading], of: fn(&Reading) -> usize| half.iter().map(of).max().unwrap();
    let resident_kb = |half| most(half, |now| now.vitals.resident_kb);
    assert!(resident_kb(late) <= resident_kb(early) + MEMORY_UNREST_KB, "memory grows");
    let files = |half| most(half, |now| now.vitals.files);
    assert!(files(late) <= files(early) + 2, "open files grow");
    let threads = |half| most(half, |now| now.vitals.threads);
    assert!(threads(late) <= threads(early) + 2, "threads grow");
    let is_bounded = |now: &Reading| now.log_bytes <= LOG_MOST_BYTES;
    assert!(readings.iter().all(is_bounded), "the write-ahead log grows");
    let grown = |from: &Reading, to: &Reading| {
        as_f64(to.journal_bytes - from.journal_bytes) / as_f64(to.scans - from.scans)
    };
    let (first, middle, last) = (&readings[0], &early[early.len() - 1], &readings[READINGS - 1]);
    let (before, after) = (grown(first, middle), grown(middle, last));
    println!("the journal grows by {before:.0}, then {after:.0} bytes a scan");
    assert!(after <= GROWTH_UNREST * before, "the journal grows faster and faster");
}
