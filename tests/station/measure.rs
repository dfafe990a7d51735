//! The measuring process of the real station: whatever a scan does to it, it costs that one scan.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use std::fs::{self, File};
use std::io::{BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use gaiter::config;
use gaiter::station::measure::{Inspection, Job, JobAnswer, Limits, Purpose, RecordJob};
use gaiter_flow::confinement::Confine;
use gaiter_record::Provenance;
use gaiter_scan::End;
use rig::{Booth, Daemon, PATIENCE, sha256};
use rustix::process::{Pid, Signal, kill_process};
use support::{body, coarse_body};

/// A configuration with these lines more.
fn booth(more: &str) -> Booth {
    let booth = Booth::new();
    let mut config = File::options().append(true).open(booth.path("station.toml")).unwrap();
    config.write_all(more.as_bytes()).unwrap();
    booth
}

/// The measuring processes on this machine that measure this scan. The tests run side by side, so
/// each has its own.
fn measuring(hash: &str) -> Vec<Pid> {
    let processes = fs::read_dir("/proc").unwrap().flatten();
    let measures = |pid: &i32| {
        let line = fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
        line.split(|byte| *byte == 0).any(|argument| argument == hash.as_bytes())
    };
    let ids = processes.filter_map(|entry| entry.file_name().to_str()?.parse::<i32>().ok());
    ids.filter(measures).filter_map(Pid::from_raw).collect()
}

/// Whether the last thing that a process does before it reads a scan is done.
fn is_confined(pid: Pid) -> bool {
    let status = fs::read_to_string(format!("/proc/{}/status", pid.as_raw_nonzero()));
    status.is_ok_and(|status| status.lines().any(|line| line == "Seccomp:\t2"))
}

/// Waits for the measuring process of a scan and sends it a signal.
fn signal(booth: &Booth, hash: &str, signal: Signal) {
    booth.wait_for("a measuring process", || {
        let found = measuring(hash);
        // It may have ended between the two.
        found.iter().any(|pid| kill_process(*pid, signal).is_ok())
    });
}

/// A process that is to make a record, and has been told all but the scan's bytes.
fn begun(limits: Limits, scan: &[u8]) -> Child {
    let config = config::load(include_str!("../../config/station.toml")).unwrap();
    let purpose = Purpose::Record(Box::new(RecordJob {
        report: config.report_choice(jiff::civil::date(2026, 11, 25)),
        method: config.method,
        output: config.output,
        provenance: Provenance::of_scan(sha256(scan)),
        ord_files: 0,
    }));
    begun_for(purpose, &["measure", &sha256(scan)], limits, scan)
}

/// A process that was given a job, and has been told all but the scan's bytes.
fn begun_for(purpose: Purpose, args: &[&str], limits: Limits, scan: &[u8]) -> Child {
    let mut child = Command::new(rig::verb::program())
        .args(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let job = Job {
        purpose,
        ending: "obj".to_owned(),
        scan_bytes: scan.len() as u64,
        ord_bytes: 0,
        threads: 2,
        limits,
        confine: Confine::Required,
    };
    job.write(child.stdin.as_mut().unwrap()).unwrap();
    child
}

fn generous() -> Limits {
    Limits { memory_bytes: 2_000_000_000, wall: Duration::from_secs(60) }
}

fn answer(mut child: Child, bytes: &[u8]) -> JobAnswer {
    child.stdin.take().unwrap().write_all(bytes).unwrap();
    let answer = JobAnswer::read(&mut BufReader::new(child.stdout.take().unwrap()), 1 << 30);
    child.wait().unwrap();
    answer.unwrap()
}

#[test]
fn the_process_is_confined_before_it_reads_the_first_byte_of_the_scan() {
    let mut child = begun(Limits { memory_bytes: 300_000_000, ..generous() }, b"v 0 0 0\n");
    let file = |name: &str| fs::read_to_string(Path::new("/proc").join(name)).unwrap();
    let status = || file(&format!("{}/status", child.id()));
    let deadline = std::time::Instant::now() + PATIENCE;
    while !status().contains("Seccomp:\t2") {
        assert!(std::time::Instant::now() < deadline, "{}", status());
        std::thread::yield_now();
    }
    assert!(status().contains("NoNewPrivs:\t1"), "{}", status());
    let limits = file(&format!("{}/limits", child.id()));
    let limit = |name: &str| {
        let line = limits.lines().find(|line| line.starts_with(name)).unwrap();
        line[name.len()..].split_whitespace().next().unwrap().to_owned()
    };
    assert_eq!(limit("Max address space"), "300000000");
    assert_eq!(limit("Max core file size"), "0");
    assert_eq!(limit("Max file size"), "0");
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn bytes_that_are_not_those_of_the_hash_are_not_measured() {
    let JobAnswer::Refused { code, .. } = answer(begun(generous(), b"v 0 0 0\n"), b"v 0 0 1\n")
    else {
        panic!("it was measured");
    };
    assert_eq!(code, "spool-damaged");
}

#[test]
fn an_inspection_says_how_a_file_ends_and_what_identifies_its_scan() {
    let inspected = |scan: &[u8]| {
        let child = begun_for(Purpose::Inspection, &["measure"], generous(), scan);
        let JobAnswer::Inspected(Inspection { end, fingerprint }) = answer(child, scan) else {
            panic!("it was not inspected");
        };
        (end, fingerprint)
    };
    let whole = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    let (end, fingerprint) = inspected(whole.as_bytes());
    assert_eq!(end, End::Whole);
    assert!(fingerprint.is_some());
    // The same scan in other bytes.
    let other = whole.replace('\n', "\r\n");
    assert_eq!(inspected(other.as_bytes()), (End::Whole, fingerprint.clone()));
    assert_eq!(inspected(whole.trim_end().as_bytes()), (End::NoLineEnd, fingerprint));
    assert_eq!(inspected(&whole.as_bytes()[..whole.len() - 3]), (End::CutShort, None));
    // No scan, and nothing shows that more is to come.
    assert_eq!(inspected(b"v 0 0 nan\n"), (End::Whole, None));
}

#[test]
fn the_answer_is_the_record_that_extract_makes() {
    let scan = coarse_body(31);
    let JobAnswer::Files { files, .. } = answer(begun(generous(), &scan), &scan) else {
        panic!("it was refused");
    };
    let booth = Booth::new();
    fs::write(booth.path("a.obj"), &scan).unwrap();
    let (scan_path, out) = (booth.path("a.obj"), booth.path("out"));
    let status = Command::new(rig::verb::program())
        .args([Path::new("extract"), &scan_path, Path::new("--out"), &out])
        .stdout(Stdio::null())
        .status()
        .unwrap();
    assert!(status.success());
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    assert!(names.contains(&"left.step") && names.contains(&"measurements.csv"), "{names:?}");
    for file in files.iter().filter(|file| !file.name.starts_with("record.json")) {
        let made = fs::read(out.join("a").join(&file.name)).unwrap();
        // The record tells when it was acquired, the list of sums tells the record's.
        if file.name != "SHA256SUMS" {
            assert_eq!(made, file.bytes, "{}", file.name);
        }
    }
}

#[test]
fn a_process_that_wants_too_much_memory_costs_that_scan_only() {
    let booth = booth("[measure]\nmemory = \"256MB\"\n");
    booth.reconfigure(|config| config.replace("\"20MB\"", "\"60MB\""));
    let daemon = booth.start();
    // 8 bytes a point in the file, 24 and more in memory.
    let bomb = "v 1 2 3\n".repeat(7_000_000).into_bytes();
    booth.export("4711_bomb.obj", &bomb);
    booth.export("4711_good.obj", &coarse_body(41));
    booth.wait_for_records(1);
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", 1);
    assert_eq!(daemon.stop().code(), Some(0));
    let code = booth.reason(&bomb)["code"].as_str().unwrap().to_owned();
    assert!(["measuring-too-large", "scan-no-faces"].contains(&code.as_str()), "{code}");
    booth.assert_settled(&[("4711", &coarse_body(41))]);
}

#[test]
fn a_process_that_stands_still_is_ended_in_time_and_begun_again() {
    // However slow the machine is, a process that does not stand still ends before that.
    let booth = booth("[measure]\nwall = \"15s\"\n");
    let daemon = booth.start();
    let (good, mut scans) = (coarse_body(90), Vec::new());
    let was_ended = || booth.log().contains("measuring-too-long");
    // One that has its answer already when it is stopped does not stand still: then the next one.
    while !was_ended() {
        let scan = body(51 + scans.len());
        booth.export(&format!("4711_hangs{}.obj", scans.len()), &scan);
        signal(&booth, &sha256(&scan), Signal::STOP);
        if scans.is_empty() {
            booth.export("4711_good.obj", &good);
        }
        scans.push(scan);
        let all_done = || booth.records().len() == scans.len() + 1;
        booth.wait_for("its end", || was_ended() || all_done());
    }
    booth.wait_for_records(scans.len() + 1);
    assert_eq!(daemon.stop().code(), Some(0));
    // It computed nothing meanwhile, so it was not the scan that took so long.
    assert_eq!(scans.last().map_or(Vec::new(), |scan| measuring(&sha256(scan))), []);
    let all = scans.iter().chain([&good]);
    booth.assert_settled(&all.map(|scan| ("4711", scan.as_slice())).collect::<Vec<_>>());
}

#[test]
fn a_process_that_somebody_kills_is_begun_again_however_often() {
    let booth = Booth::new();
    let daemon = booth.start();
    let scan = body(61);
    booth.export("4711_a.obj", &scan);
    let put_off = || booth.log().matches("measuring-killed").count();
    // One that was killed when it had just answered is the last.
    booth.wait_for("the fourth end", || {
        for pid in measuring(&sha256(&scan)) {
            let _ = kill_process(pid, Signal::KILL);
        }
        put_off() >= 4 || !booth.records().is_empty()
    });
    booth.wait_for_records(1);
    booth.wait_for("the all-clear", || booth.status()["alarms"]["measuring-impaired"].is_null());
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &scan)]);
}

/// A station in surroundings in which nothing can be read leaves an export where it is, says so, and measures it
/// once they are as usual.
fn waits_behind(front: &[&str], more: &str) {
    let booth = booth(more);
    let scan = coarse_body(65);
    booth.export("4711_a.obj", &scan);
    let daemon = Daemon::start(booth.command_behind(front));
    // The scan has failed more often than any scan may by its own fault.
    let put_off = || booth.log().matches("intake-failed").count();
    booth.wait_for("its failures", || put_off() > 4);
    let told = booth.status();
    assert!(told["alarms"]["measuring-impaired"].is_object(), "{told}");
    assert_eq!(told["scans"]["refused"], 0, "{}", booth.log());
    assert_eq!(daemon.stop().code(), Some(0));
    let daemon = booth.start();
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.assert_settled(&[("4711", &scan)]);
}

#[test]
fn where_measuring_may_not_have_the_memory_it_is_configured_for_scans_wait() {
    let shell = ["sh", "-c", r#"ulimit -v 3000000; exec "$0" "$@""#];
    // Root may raise its limits again, unless it has given that up.
    let front = ["setpriv", "--bounding-set", "-sys_resource"];
    let front = if rustix::process::getuid().is_root() { &front[..] } else { &[] };
    waits_behind(&[front, &shell[..]].concat(), "[measure]\nmemory = \"4GB\"\n");
}

#[test]
#[ignore = "needs root to take /proc away, run by .ci/run"]
fn without_proc_scans_wait() {
    let front = ["unshare", "-m", "sh", "-c", r#"umount -l /proc && exec "$0" "$@""#];
    waits_behind(&front, "");
}

#[test]
fn a_process_does_not_outlive_its_station() {
    let booth = Booth::new();
    let daemon = booth.start();
    let scan = body(71);
    booth.export("4711_a.obj", &scan);
    // Stopped before, it could not have asked to be ended with its station.
    booth.wait_for("a confined process", || {
        let mut found = measuring(&sha256(&scan)).into_iter();
        found.any(|pid| is_confined(pid) && kill_process(pid, Signal::STOP).is_ok())
    });
    daemon.kill();
    booth.wait_for("its end", || measuring(&sha256(&scan)).is_empty());
}

#[test]
fn what_the_process_is_told_names_nobody() {
    let booth = Booth::new();
    let daemon = booth.start();
    let scan = body(81);
    booth.export("990011_Mustermann.obj", &scan);
    signal(&booth, &sha256(&scan), Signal::STOP);
    for pid in measuring(&sha256(&scan)) {
        for name in ["cmdline", "environ", "comm"] {
            let path = format!("/proc/{}/{name}", pid.as_raw_nonzero());
            let mut told = Vec::new();
            // It may have ended.
            let Ok(mut file) = File::open(path) else { continue };
            let _ = file.read_to_end(&mut told);
            let told = String::from_utf8_lossy(&told);
            assert!(!told.contains("99001") && !told.contains("Muster"), "{name}: {told}");
        }
    }
    signal(&booth, &sha256(&scan), Signal::CONT);
    booth.wait_for_records(1);
    assert_eq!(daemon.stop().code(), Some(0));
}
