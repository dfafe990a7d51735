//! Metrics, health and the log of the real station, as a monitor sees them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs::{self, File, Permissions};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rig::{Booth, PATIENCE};
use rusqlite::Connection;
use rustix::process::{Pid, Signal, kill_process};

/// A small scan that can be measured.
fn coarse() -> Vec<u8> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/coarse/f_average.obj.gz");
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(File::open(file).unwrap()).read_to_end(&mut bytes).unwrap();
    bytes
}

fn booth(more: &str) -> Booth {
    let booth = Booth::new();
    let mut config = File::options().append(true).open(booth.path("station.toml")).unwrap();
    config.write_all(more.as_bytes()).unwrap();
    booth
}

/// The port that the station says it listens on.
fn port(booth: &Booth) -> u16 {
    let said = |booth: &Booth| {
        let log = booth.log();
        let line = log.lines().rfind(|line| line.contains("http-listening"))?.to_owned();
        line.split("port=").nth(1)?.trim().parse().ok()
    };
    booth.wait_for("a port", || said(booth).is_some());
    said(booth).unwrap()
}

/// A page's status and body.
fn page(port: u16, path: &str) -> (u16, String) {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    write!(stream, "GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    (head.split(' ').nth(1).unwrap().parse().unwrap(), body.to_owned())
}

#[test]
fn metrics_and_health_follow_the_station_and_name_nobody() {
    let booth = booth("[status]\nlisten = \"127.0.0.1:0\"\noverdue = \"1s\"\n");
    let daemon = booth.start();
    let port = port(&booth);
    assert_eq!(page(port, "/healthz"), (200, "ready\n".to_owned()));
    assert_eq!(page(port, "/nowhere").0, 404);
    booth.export("990011_Mustermann.obj", &coarse());
    booth.export("990012_Mustermann.obj", b"no scan\n");
    booth.wait_for_records(1);
    for state in ["refused", "delivered"] {
        booth.wait_for_journal(&format!("SELECT count(*) FROM scans WHERE state = '{state}'"), 1);
    }
    // A slow machine may have let the scan become overdue before it was delivered.
    booth.wait_for("good health", || page(port, "/healthz").0 == 200);
    let (status, text) = page(port, "/metrics");
    assert_eq!(status, 200);
    for line in [
        "gaiter_up 1.0",
        "gaiter_ready 1.0",
        "gaiter_scans{state=\"delivered\"} 1.0",
        "gaiter_scans{state=\"refused\"} 1.0",
        "gaiter_dispositions{disposition=\"refused\"} 1.0",
        "gaiter_dispositions{disposition=\"held\"} 0.0",
        "gaiter_deliveries{store=\"folder\",state=\"delivered\"} 1.0",
        "gaiter_oldest_undelivered_seconds 0.0",
    ] {
        assert!(text.lines().any(|found| found == line), "no {line} in\n{text}");
    }
    assert!(text.contains("\ngaiter_disk_free_bytes "), "{text}");

    booth.take_records_away();
    let other = support::coarse_body(1);
    booth.export("990013_Mustermann.obj", &other);
    booth.wait_for("ill health", || {
        let (status, codes) = page(port, "/healthz");
        status == 503 && codes.lines().any(|code| code == "delivery-overdue")
    });
    let (_, text) = page(port, "/metrics");
    assert!(text.contains("\ngaiter_ready 0.0\n"), "{text}");
    assert!(text.contains("\ngaiter_complaint{code=\"delivery-overdue\"} 1.0\n"), "{text}");
    for planted in ["99001", "Mustermann", "export/", "/records", ".obj"] {
        assert!(!text.contains(planted), "{planted} is in the metrics:\n{text}");
    }
    fs::rename(booth.path("unmounted"), booth.path("records")).unwrap();
    booth.wait_for("good health", || page(port, "/healthz").0 == 200);
    assert_eq!(daemon.stop().code(), Some(0));
}

/// Connections that say nothing, half a head, or a head byte by byte.
fn idle(port: u16, count: usize) -> Vec<TcpStream> {
    let begun = |n: usize| {
        let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        let said: &[u8] = match n % 3 {
            0 => b"",
            1 => b"GET / HTTP/1.1\r\nHost: local",
            _ => b"G",
        };
        // It may have been sent away already.
        let _ = stream.write_all(said);
        stream
    };
    (0..count).map(begun).collect()
}

#[test]
fn however_many_hang_on_the_port_others_are_answered_at_once() {
    let booth = booth("[status]\nlisten = \"127.0.0.1:0\"\n");
    let daemon = booth.start();
    let port = port(&booth);
    let mut silent = Vec::new();
    for path in ["/healthz", "/", "/state", "/metrics"] {
        // A connection that says nothing is ended after 5 s: nobody waits for that. A busy machine is slow
        // once; a station that lets people wait does so each time.
        let is_at_once = |_| {
            silent.clear();
            silent.extend(idle(port, 700));
            let began = Instant::now();
            assert_eq!(page(port, path).0, 200, "{path}");
            began.elapsed() < Duration::from_secs(4)
        };
        assert!((0..5).any(is_at_once), "{path}");
    }
    booth.export("4711_a.obj", &coarse());
    booth.wait_for_records(1);
    drop(silent);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn those_who_ask_all_at_once_are_all_answered() {
    let booth = booth("[status]\nlisten = \"127.0.0.1:0\"\n");
    let daemon = booth.start();
    let port = port(&booth);
    let ask = |path: &'static str| thread::spawn(move || page(port, path).0);
    let asked: Vec<_> = (0..60).map(|n| ask(["/healthz", "/state", "/"][n % 3])).collect();
    for asked in asked {
        assert_eq!(asked.join().unwrap(), 200);
    }
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn nobody_else_gets_the_port_while_the_station_reloads() {
    let booth = booth("[status]\nlisten = \"127.0.0.1:0\"\n");
    let daemon = booth.start();
    let port = port(&booth);
    let is_over = Arc::new(AtomicBool::new(false));
    let watched = Arc::clone(&is_over);
    let thief = thread::spawn(move || {
        let mut got = 0;
        while !watched.load(Ordering::Relaxed) {
            got += usize::from(TcpListener::bind(("127.0.0.1", port)).is_ok());
        }
        got
    });
    let pid = Pid::from_raw(daemon.id().cast_signed()).unwrap();
    for reloads in 1..=5 {
        kill_process(pid, Signal::HUP).unwrap();
        let heard = || booth.log().matches("http-listening").count();
        booth.wait_for("a reload", || heard() > reloads);
        assert_eq!(page(port, "/nowhere").0, 404);
    }
    is_over.store(true, Ordering::Relaxed);
    assert_eq!(thief.join().unwrap(), 0);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn between_two_generations_monitors_and_browsers_are_told_so_at_once() {
    let booth = booth("[status]\nlisten = \"127.0.0.1:0\"\n");
    let daemon = booth.start();
    let port = port(&booth);
    booth.wait_for("the start", || page(port, "/healthz") == (200, "ready\n".to_owned()));
    // The next generation waits for its journal while another program writes to it.
    let journal = Connection::open(booth.path("state/journal.db")).unwrap();
    journal.busy_timeout(PATIENCE).unwrap();
    journal.execute_batch("BEGIN IMMEDIATE").unwrap();
    kill_process(Pid::from_raw(daemon.id().cast_signed()).unwrap(), Signal::HUP).unwrap();
    let between = (503, "station-changes-over\n".to_owned());
    booth.wait_for("the end of the first", || page(port, "/healthz") == between);
    let (status, html) = page(port, "/");
    assert_eq!(status, 503);
    assert!(html.contains("This page comes back by itself."), "{html}");
    assert_eq!(page(port, "/state"), between);
    drop(journal);
    booth.wait_for("the second", || page(port, "/healthz") == (200, "ready\n".to_owned()));
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_port_that_is_taken_is_a_fault_and_keeps_no_scan_waiting_and_its_link_is_new_afterwards() {
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    let booth = booth(&format!("[status]\nlisten = \"127.0.0.1:{port}\"\n"));
    let old = "a".repeat(64);
    fs::create_dir_all(booth.path("state")).unwrap();
    let file = booth.path("state/page-token");
    fs::write(&file, format!("{old}\n")).unwrap();
    fs::set_permissions(&file, Permissions::from_mode(0o600)).unwrap();
    let daemon = booth.start();
    booth.export("4711_a.obj", &coarse());
    booth.wait_for_records(1);
    let told = || String::from_utf8(booth.gaiter(&["status"]).stdout).unwrap();
    booth.wait_for("the fault", || told().contains("[page-unavailable]"));
    drop(taken);
    booth.wait_for("the port", || booth.log().contains("http-listening"));
    assert_eq!(booth.log().matches("http-unavailable").count(), 1);
    booth.wait_for("good health", || page(port, "/healthz") == (200, "ready\n".to_owned()));
    let link = booth.gaiter(&["page"]);
    assert!(!String::from_utf8(link.stdout).unwrap().contains(&old));
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_socket_of_the_service_manager_is_served_although_the_station_listens_nowhere() {
    // The service manager opens the socket as file descriptor 3 and says whose it is; a shell can do
    // both, since the process that it becomes keeps its number.
    let booth = Booth::new();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let script = "exec 3<&0 0</dev/null; LISTEN_FDS=1 LISTEN_PID=$$ exec \"$@\"";
    let station = booth.command();
    let mut command = std::process::Command::new("sh");
    command.args(["-c", script, "sh"]).arg(station.get_program()).args(station.get_args());
    command.stdin(std::os::fd::OwnedFd::from(listener));
    command.stderr(File::options().append(true).open(booth.path("log")).unwrap());
    let mut child = command.spawn().unwrap();
    // The connection waits in the kernel until the station serves it.
    let answer = page(port, "/healthz");
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(answer, (200, "ready\n".to_owned()), "log:\n{}", booth.log());
}
