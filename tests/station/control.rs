//! Asking the real station, as a technician does: what it says, to whom, and what it bears.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs::{self, File};
use std::io::{Read, Write};
use std::os::unix::fs::{FileTypeExt, PermissionsExt};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::Output;
use std::thread;

use rig::verb::{self, code, stderr, stdout};
use rig::{Booth, sha256};
use serde_json::Value;
use support::coarse_body;

fn gaiter(booth: &Booth, args: &[&str]) -> Output {
    booth.gaiter(args)
}

fn json(booth: &Booth, args: &[&str]) -> Value {
    let output = gaiter(booth, &[args, &["--json"]].concat());
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{args:?}: {output:?}"))
}

/// Adds keys to the configuration.
fn configure(booth: &Booth, more: &str) {
    let mut config = File::options().append(true).open(booth.path("station.toml")).unwrap();
    config.write_all(more.as_bytes()).unwrap();
}

/// What the station answers at its socket.
fn answer(socket: &Path, request: &str, body: &str) -> String {
    let mut stream = UnixStream::connect(socket).unwrap();
    let head = format!("{request} HTTP/1.1\r\nHost: station\r\nContent-Length: {}", body.len());
    stream.write_all(format!("{head}\r\n\r\n{body}").as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

fn wait_until_ready(booth: &Booth) {
    booth.wait_for("readiness", || code(&gaiter(booth, &["status"])) == Some(0));
}

#[test]
fn an_idle_station_is_ready_and_says_so_on_one_screen() {
    let booth = Booth::new();
    let daemon = booth.start();
    wait_until_ready(&booth);
    let said = stdout(&gaiter(&booth, &["status"]));
    assert!(said.starts_with("ready\n"), "{said}");
    assert!(said.lines().count() <= 24, "{said}");
    assert!(said.contains("\nstation    booth-1, gaiter "), "{said}");
    let status = json(&booth, &["status"]);
    assert_eq!((&status["schema"], &status["ready"]), (&"gaiter.status/1".into(), &true.into()));
    assert_eq!((&status["oldest"], &status["last"]), (&Value::Null, &Value::Null));
    assert_eq!(status["scans"]["spooled"], 0);
    assert_eq!(status["sources"].as_array().unwrap().len(), 1);
    assert!(status["disk_free_bytes"].as_u64().unwrap() > 0);
    assert_eq!(stdout(&gaiter(&booth, &["scans"])), "No scan to show.\n");
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn the_socket_is_for_the_station_s_user_only_and_goes_with_the_station() {
    let booth = Booth::new();
    let path = booth.path("state/control.sock");
    let daemon = booth.start();
    wait_until_ready(&booth);
    let metadata = fs::symlink_metadata(&path).unwrap();
    assert!(metadata.file_type().is_socket());
    assert_eq!(metadata.permissions().mode() & 0o777, 0o600);
    assert!(answer(&path, "GET /healthz", "").ends_with("\r\n\r\nready\n"));
    daemon.kill();
    assert!(path.exists(), "a killed station leaves its socket");
    assert_eq!(code(&gaiter(&booth, &["status"])), Some(74));
    let daemon = booth.start();
    wait_until_ready(&booth);
    assert_eq!(daemon.stop().code(), Some(0));
    assert!(!path.exists());
}

#[test]
fn without_a_station_every_verb_says_so_and_how_to_start_it() {
    let booth = Booth::new();
    for args in [["status"].as_slice(), &["scans"], &["show", "abcd"], &["explain", "abcd"]] {
        let output = gaiter(&booth, args);
        assert_eq!(code(&output), Some(74), "{args:?}");
        let said = stderr(&output);
        assert!(said.contains("no station runs on "), "{said}");
        assert!(said.contains("systemctl start gaiter"), "{said}");
        let fault = json(&booth, args);
        assert_eq!(
            (&fault["fault"]["code"], &fault["fault"]["exit"]),
            (&"no-station".into(), &74.into())
        );
    }
    fs::remove_file(booth.path("station.toml")).unwrap();
    assert_eq!(code(&gaiter(&booth, &["status"])), Some(66));
}

#[test]
fn a_store_that_is_gone_makes_the_station_not_ready_until_it_is_back() {
    let booth = Booth::new();
    configure(&booth, "[status]\noverdue = \"1s\"\n");
    let daemon = booth.start();
    // A store that has taken a record is one the station knows.
    booth.export("4711_0.obj", &coarse_body(0));
    booth.wait_for_records(1);
    wait_until_ready(&booth);
    booth.take_records_away();
    let bytes = coarse_body(1);
    booth.export("4711_a.obj", &bytes);
    booth.wait_for("the complaint", || code(&gaiter(&booth, &["status"])) == Some(74));
    let said = stdout(&gaiter(&booth, &["status"]));
    assert!(said.starts_with("not ready: "), "{said}");
    assert!(said.lines().nth(1).unwrap().starts_with("    do: "), "{said}");
    let scan = &sha256(&bytes)[..8];
    booth.wait_for("being overdue", || {
        let status = json(&booth, &["status"]);
        let complaints = status["complaints"].as_array().unwrap().clone();
        complaints.iter().any(|complaint| complaint["code"] == "delivery-overdue")
            && status["oldest"]["scan"] == *scan
    });
    let mut said = String::new();
    booth.wait_for("the reason", || {
        said = stdout(&gaiter(&booth, &["explain", scan]));
        said.contains("waits for the store")
    });
    assert_eq!(said.lines().count(), 1, "{said}");
    fs::rename(booth.path("unmounted"), booth.path("records")).unwrap();
    booth.wait_for_records(2);
    wait_until_ready(&booth);
    assert_eq!(json(&booth, &["status"])["last"]["scan"], *scan);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_file_says_why_it_is_where_it_is() {
    let booth = Booth::new();
    let daemon = booth.start();
    wait_until_ready(&booth);
    let explained = |name: &str| {
        let path = booth.path("export").join(name);
        stdout(&gaiter(&booth, &["explain", path.to_str().unwrap()]))
    };
    let bytes = coarse_body(1);
    booth.export("4711_a.obj", &bytes);
    booth.wait_until_explained("4711_a.obj", "was delivered");
    let said = explained("4711_a.obj");
    assert!(said.contains(&sha256(&bytes)[..8]) && said.contains("was delivered"), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(explained("nowhere.obj").contains("No scan of that name"));
    assert!(explained(".hidden.obj").contains("is hidden"));
    assert!(explained("x.obj.tmp").contains("unfinished"));
    let outside = stdout(&gaiter(&booth, &["explain", "/elsewhere.obj"]));
    assert!(outside.contains("is not in an export folder"), "{outside}");
    booth.export("4711_bad.obj", b"no scan\n");
    booth.wait_until_explained("4711_bad.obj", "was refused");
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn refused_and_held_scans_are_listed_shown_and_explained() {
    let booth = Booth::new();
    let daemon = booth.start();
    let (good, garbage) = (coarse_body(1), b"no scan at all\n".to_vec());
    booth.export("990011_Mustermann.obj", &good);
    booth.export("990012_Mustermann-bad.obj", &garbage);
    booth.wait_for_records(1);
    booth.export("990013_Mustermann.obj", &good);
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'held'", 1);
    booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'refused'", 1);

    let (good, garbage) = (sha256(&good), sha256(&garbage));
    let scans = |args: &[&str]| -> Vec<String> {
        let rows = json(&booth, &[&["scans"], args].concat());
        let rows = rows.as_array().unwrap().clone();
        rows.iter().map(|row| row["scan"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(scans(&[]).len(), 2);
    assert_eq!(scans(&["--state", "refused"]), [&garbage[..8]]);
    assert_eq!(scans(&["--state", "held"]), [&good[..8]]);
    assert_eq!(scans(&["--state", "spooled"]), [""; 0]);
    assert_eq!(scans(&["--limit", "1"]).len(), 1);
    let table = stdout(&gaiter(&booth, &["scans"]));
    assert!(table.contains("held") && table.contains("same-scan-other-patient"), "{table}");
    let shown = stdout(&gaiter(&booth, &["show", &good[..8]]));
    assert!(shown.contains("state        held"), "one state everywhere: {shown}");

    let said = stdout(&gaiter(&booth, &["explain", &garbage[..8]]));
    assert!(said.contains("lies in quarantine [scan-"), "{said}");
    let said = stdout(&gaiter(&booth, &["explain", &good[..8].to_uppercase()]));
    assert!(said.contains("is held"), "{said}");
    let shown = json(&booth, &["show", &good[..12]]);
    assert_eq!(shown["scan"], *good);
    let patients: Vec<&str> = shown["deliveries"]
        .as_array()
        .unwrap()
        .iter()
        .map(|delivery| delivery["patient"].as_str().unwrap())
        .collect();
    assert_eq!(patients, ["990011", "990013"]);
    assert!(stdout(&gaiter(&booth, &["show", &garbage[..4]])).contains("refused      [scan-"));
    let status = json(&booth, &["status"]);
    assert_eq!(
        status["ready"], true,
        "a scan that was refused is no fault of the station: {status}"
    );
    assert_eq!((&status["scans"]["refused"], &status["scans"]["held"]), (&1.into(), &1.into()));

    // What a patient's name could be in is not shown by what everybody may see.
    for args in [["status"].as_slice(), &["scans"], &["status", "--json"], &["scans", "--json"]] {
        let said = stdout(&gaiter(&booth, args));
        for planted in ["99001", "Mustermann", "/export", "/records"] {
            assert!(!said.contains(planted), "{planted} is in {args:?}:\n{said}");
        }
    }
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_scan_is_named_by_digits_that_are_its_own() {
    let booth = Booth::new();
    let daemon = booth.start();
    wait_until_ready(&booth);
    for verb in ["show", "explain"] {
        let output = gaiter(&booth, &[verb, "00c0ffee"]);
        assert_eq!(code(&output), Some(66));
        assert!(stderr(&output).contains("knows no scan"), "{}", stderr(&output));
    }
    for digits in ["abc", "xyz", "12 4"] {
        assert_eq!(code(&gaiter(&booth, &["show", digits])), Some(64), "{digits}");
        let said = stdout(&gaiter(&booth, &["explain", digits]));
        assert!(said.contains("is not in an export folder"), "{digits}: {said}");
    }
    // Two ids that begin alike are too rare to wait for.
    let journal = rusqlite::Connection::open(booth.path("state/journal.db")).unwrap();
    for last in ["1", "2"] {
        let scan = format!("c0ffee{last:0>58}");
        let insert = "INSERT INTO scans (sha256, format, size, first_seen, state, seal)
                      VALUES (?1, 'obj', 1, '2026-11-21T09:15:00Z', 'delivered', '')";
        journal.execute(insert, [scan]).unwrap();
    }
    let output = gaiter(&booth, &["show", "c0ffee"]);
    assert_eq!(code(&output), Some(64));
    assert!(stderr(&output).contains("give more digits"), "{}", stderr(&output));
    let second = format!("c0ffee{:0>58}", "2");
    assert_eq!(code(&gaiter(&booth, &["show", &second])), Some(0));
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn whoever_hangs_on_the_socket_or_floods_it_harms_nobody() {
    let booth = Booth::new();
    let daemon = booth.start();
    wait_until_ready(&booth);
    let path = booth.path("state/control.sock");
    // More than may connect at a time, and they never say a word.
    let silent: Vec<UnixStream> = (0..300).map(|_| UnixStream::connect(&path).unwrap()).collect();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    // The oldest makes room for one who asks.
    assert_eq!(code(&gaiter(&booth, &["status"])), Some(0));
    drop(silent);

    let mut endless = UnixStream::connect(&path).unwrap();
    let flood = thread::spawn(move || while endless.write_all(&[b'x'; 4096]).is_ok() {});
    for body in ["", "{}", "{\"ask\":\"fly\"}", "[[[[", "{\"ask\":\"show\",\"scan\":\"' OR\"}"] {
        let answer = answer(&path, "POST /ask", body);
        assert!(answer.contains("\r\n\r\n{\"is\":\"fault\""), "{body}: {answer}");
    }
    flood.join().unwrap();
    wait_until_ready(&booth);
    assert_eq!(daemon.stop().code(), Some(0));
}

/// As [`gaiter`], with a line on standard input.
fn gaiter_told(booth: &Booth, args: &[&str], line: &str) -> Output {
    verb::gaiter_told(&booth.path("station.toml"), args, line)
}

#[test]
fn a_paused_station_is_not_ready_and_takes_nothing_until_it_is_resumed() {
    let booth = Booth::new();
    let daemon = booth.start();
    wait_until_ready(&booth);
    assert_eq!(code(&gaiter(&booth, &["pause"])), Some(0));
    assert!(stdout(&gaiter(&booth, &["status"])).starts_with("not ready: the operator has paused"));
    assert_eq!(daemon.stop().code(), Some(0));
    let daemon = booth.start();
    booth.wait_for("the pause after a restart", || {
        json(&booth, &["status"])["complaints"][0]["code"] == "paused"
    });
    assert_eq!(code(&gaiter(&booth, &["resume", "--json"])), Some(0));
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    wait_until_ready(&booth);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_scan_for_nobody_is_assigned_by_standard_input_and_a_held_one_released() {
    let booth = Booth::new();
    let daemon = booth.start();
    let (nobody, twice) = (coarse_body(1), coarse_body(2));
    booth.export("nobody.obj", &nobody);
    booth.export("4711_a.obj", &twice);
    booth.wait_for_records(2);
    booth.export("4712_a.obj", &twice);
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'held'", 1);
    let (nobody, twice) = (sha256(&nobody), sha256(&twice));

    for (line, expected) in [("", 64), ("\n", 64), ("no id\n", 64), ("../etc\n", 64)] {
        let output = gaiter_told(&booth, &["assign", &nobody[..8]], line);
        assert_eq!(code(&output), Some(expected), "{line:?}: {}", stderr(&output));
    }
    assert_eq!(code(&gaiter_told(&booth, &["assign", &nobody[..8], "4713"], "4713\n")), Some(64));
    let output = gaiter_told(&booth, &["assign", &nobody[..8]], "4713\n");
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
    assert!(!stdout(&output).contains("4713"), "{}", stdout(&output));
    assert_eq!(code(&gaiter(&booth, &["release", &twice[..8]])), Some(0));
    // What was unassigned is being taken back meanwhile: not every record is whole at every moment.
    let whose = |patient: &str| booth.path("records").join(patient).is_dir();
    booth.wait_for("the records", || whose("4712") && whose("4713"));

    let output = gaiter(&booth, &["release", &twice[..8], "--json"]);
    assert_eq!(code(&output), Some(64), "it is not held any more: {}", stdout(&output));
    assert_eq!(code(&gaiter(&booth, &["retry", "00c0ffee"])), Some(66));
    assert!(stdout(&gaiter(&booth, &["show", &nobody[..8]])).contains("assigned"));
    // Without the times: their microseconds can have the same digits.
    let log = booth.log();
    let said =
        |line: &str| line.split_once(' ').map_or(String::new(), |(_, said)| format!("{said}\n"));
    let log: String = log.lines().map(said).collect();
    for planted in ["4713", "4712"] {
        assert!(!log.contains(planted), "{planted} is in the log:\n{log}");
    }
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_station_that_reloads_can_be_asked_all_the_while() {
    let booth = Booth::new();
    let daemon = booth.start();
    wait_until_ready(&booth);
    let pid = fs::read_to_string(booth.path("state/lock")).unwrap().trim().parse().unwrap();
    let pid = rustix::process::Pid::from_raw(pid).unwrap();
    for _ in 0..3 {
        rustix::process::kill_process(pid, rustix::process::Signal::HUP).unwrap();
        for _ in 0..5 {
            let output = gaiter(&booth, &["status"]);
            assert_eq!(code(&output), Some(0), "{}", stderr(&output));
        }
    }
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_station_whose_configuration_was_spoilt_can_still_be_asked() {
    let booth = Booth::new();
    let daemon = booth.start();
    wait_until_ready(&booth);
    configure(&booth, "colour = 1\n");
    assert_eq!(code(&gaiter(&booth, &["check"])), Some(78));
    assert_eq!(code(&gaiter(&booth, &["status"])), Some(0));
    assert_eq!(daemon.stop().code(), Some(0));
}
