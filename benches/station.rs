//! What the station costs and how fast it is: `cargo bench --bench station`.
//!
//! It measures, with the real program and folders below `TMPDIR`:
//!
//! - idle: share of a core and memory over a minute;
//! - way: the time of a scan from its last byte to its record, beside quiet time and extraction, and
//!   what it costs in CPU, the daemon itself apart from its measuring processes;
//! - crowd: the same among 20 000 known files;
//! - backlog: 500 scans;
//! - trigger: what a port of the booth costs and how soon a press is seen.
//!
//! With one of these words after `--`, it measures only that part.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

#[path = "station/trigger.rs"]
mod trigger;

use std::env;
use std::fs;
use std::process::{Command, Stdio};
use std::thread::{available_parallelism, sleep};
use std::time::{Duration, Instant};

use rig::invariants::Vitals;
use rig::process::CpuTicks;
use rig::verb::program;
use rig::{Booth, Setting, names};
use support::{body, coarse_body};

/// How long the idle station is observed.
const IDLE: Duration = Duration::from_secs(60);

/// Clock ticks of /proc a second, on every Linux there is.
const TICKS_PER_S: f64 = 100.0;

/// Scans whose way is timed; the median counts.
const WAYS: usize = 20;

/// Files that lie in a crowded export folder: years of a clinic that never cleans up.
const CROWD: usize = 20_000;

/// How often it is looked whether a record has come, …
const LOOK_UP: Duration = Duration::from_millis(2);

/// … and in a backlog, where each look at hundreds of records takes from the same cores.
const LOOK_UP_BACKLOG: Duration = Duration::from_millis(50);

/// Scans of the backlog.
const BACKLOG: usize = 500;

/// The quiet time that is shipped.
const QUIET: Duration = Duration::from_secs(2);

/// The rescan that is shipped.
const RESCAN: Duration = Duration::from_secs(10);

/// A body by number: other bytes, the same shape.
type Bodies = fn(usize) -> Vec<u8>;

const BODIES: [(&str, Bodies); 2] = [("full", body), ("coarse", coarse_body)];

fn main() {
    let wanted: Vec<String> = env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let is_wanted = |part: &str| wanted.is_empty() || wanted.iter().any(|word| word == part);
    let cores = available_parallelism().map_or(1, usize::from);
    println!("{cores} cores, load before: {}", load());
    if is_wanted("idle") {
        idle("empty export folder", 0);
        idle("1000 delivered scans in it", 1000);
    }
    if is_wanted("way") {
        BODIES.into_iter().for_each(|(name, bodies)| way(name, bodies, 0));
    }
    if is_wanted("crowd") {
        way("full", body, CROWD);
    }
    if is_wanted("backlog") {
        BODIES.into_iter().for_each(|(name, bodies)| backlog(name, bodies));
    }
    if is_wanted("trigger") {
        trigger::measure();
    }
    println!("load after: {}", load());
}

fn load() -> String {
    fs::read_to_string("/proc/loadavg").unwrap_or_default().trim().to_owned()
}

/// A booth with the shipped times and files.
fn booth() -> Booth {
    Booth::set(&Setting { quiet: QUIET, rescan: RESCAN, ..Setting::default() })
}

/// Waits for so many records under their final names.
fn wait_for_records(booth: &Booth, count: usize, look_up: Duration) {
    let records = booth.path("records");
    let is_final = |name: &String| !name.starts_with('.');
    let patients = || names(&records).into_iter().map(|patient| records.join(patient));
    while patients().map(|at| names(&at).iter().filter(|n| is_final(n)).count()).sum::<usize>()
        < count
    {
        sleep(look_up);
    }
}

fn idle(what: &str, scans: usize) {
    let booth = booth();
    for n in 0..scans {
        // Refused at once, which costs less than measuring, and known from then on all the same.
        booth.export(&format!("4711_{n}.obj"), format!("garbage {n}\n").as_bytes());
    }
    let daemon = booth.start();
    let known = i64::try_from(scans).unwrap();
    booth.wait_long_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", known);
    // One scan measured: what extraction leaves behind in memory counts too.
    booth.export("4711_scan.obj", &body(0));
    wait_for_records(&booth, 1, LOOK_UP);
    sleep(QUIET * 2);
    let (before, began) = (CpuTicks::read(daemon.id()), Instant::now());
    sleep(IDLE);
    let ticks = CpuTicks::read(daemon.id()).since(before);
    let share = 100.0 * seconds(ticks.own + ticks.children);
    let vitals = Vitals::read(daemon.id()).unwrap();
    println!(
        "idle, {what}: {:.2} % of a core over {:.0} s; {:.1} MB resident, {} threads, {} files",
        share / began.elapsed().as_secs_f64(),
        began.elapsed().as_secs_f64(),
        f64::from(u32::try_from(vitals.resident_kb).unwrap()) / 1000.0,
        vitals.threads,
        vitals.files
    );
    daemon.stop();
}

/// How long `gaiter extract` takes for a file, from start to end of the process.
fn extraction(booth: &Booth, n: usize, bytes: &[u8]) -> Duration {
    // A record of another scan is never written over.
    let scan = booth.path(&format!("bench_{n}.obj"));
    fs::write(&scan, bytes).unwrap();
    let mut command = Command::new(program());
    command.arg("extract").arg(scan).arg("--out").arg(booth.path("extracted"));
    let began = Instant::now();
    assert!(command.stdout(Stdio::null()).status().unwrap().success());
    began.elapsed()
}

fn median(mut times: Vec<Duration>) -> Duration {
    times.sort_unstable();
    times[times.len() / 2]
}

fn seconds(ticks: u64) -> f64 {
    f64::from(u32::try_from(ticks).unwrap()) / TICKS_PER_S
}

/// What each of so many scans cost in CPU.
fn cpu_a_scan(ticks: CpuTicks, scans: usize) -> String {
    let ms = |ticks| 1000.0 * seconds(ticks) / f64::from(u32::try_from(scans).unwrap());
    let (all, own) = (ms(ticks.own + ticks.children), ms(ticks.own));
    format!("{all:.1} ms CPU a scan, {own:.1} of them the daemon's own")
}

fn way(name: &str, bodies: Bodies, known: usize) {
    let booth = booth();
    for n in 0..known {
        booth.export(&format!("known_{n}.obj"), b"garbage\n");
    }
    let daemon = booth.start();
    let sighted = i64::try_from(known).unwrap();
    booth.wait_long_for_journal("SELECT count(*) FROM sightings", sighted);
    booth.wait_for("the start", || booth.log().contains("station-ready"));
    let (mut ways, mut extractions) = (Vec::new(), Vec::new());
    let before = CpuTicks::read(daemon.id());
    for n in 0..WAYS {
        let bytes = bodies(n);
        extractions.push(extraction(&booth, n, &bytes));
        booth.export(&format!("4711_{n}.obj"), &bytes);
        let last_byte = Instant::now();
        wait_for_records(&booth, n + 1, LOOK_UP);
        ways.push(last_byte.elapsed());
    }
    let cpu = cpu_a_scan(CpuTicks::read(daemon.id()).since(before), WAYS);
    daemon.stop();
    let (way, extraction) = (median(ways).as_secs_f64(), median(extractions).as_secs_f64());
    let quiet = QUIET.as_secs_f64();
    println!(
        "way, {name} body among {known} known files, median of {WAYS}: {way:.3} s = quiet \
         {quiet:.1} s + extract {extraction:.3} s + {:.0} ms; {cpu}",
        1000.0 * (way - quiet - extraction)
    );
}

fn backlog(name: &str, bodies: Bodies) {
    let booth = booth();
    for n in 0..BACKLOG {
        booth.export(&format!("4711_{n}.obj"), &bodies(n));
    }
    let began = Instant::now();
    let daemon = booth.start();
    let mut peak_kb = 0;
    for tenth in 1..=10 {
        wait_for_records(&booth, BACKLOG * tenth / 10, LOOK_UP_BACKLOG);
        peak_kb = peak_kb.max(Vitals::read(daemon.id()).unwrap().resident_kb);
    }
    let took = began.elapsed().as_secs_f64();
    let cpu = cpu_a_scan(CpuTicks::read(daemon.id()), BACKLOG);
    let scans = f64::from(u32::try_from(BACKLOG).unwrap());
    println!(
        "backlog, {BACKLOG} {name} bodies: {took:.1} s with the start and the quiet time, {:.1} \
         scans/s; {cpu}; {} MB resident at most",
        scans / took,
        peak_kb / 1000
    );
    daemon.stop();
}
