//! The station and a server that is slow, refuses, or owes an answer: a receiver of HL7 v2 of these tests' own.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex};
use std::thread;

use rig::verb::{code, gaiter_told, stderr, stdout};
use rig::{Booth, Daemon, names, sha256};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use support::coarse_body;

/// What a receiver answers to each message: a code, or nothing.
type Says = Arc<Mutex<Option<&'static str>>>;

const ACCEPTED: Option<&str> = Some("AA");
const REFUSED: Option<&str> = Some("AR");

/// Not now: the record is locked.
const LOCKED: Option<&str> = Some("AE");

/// A receiver: its port, and what it says.
fn receiver() -> (u16, Says) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    let says: Says = Arc::new(Mutex::new(ACCEPTED));
    let shared = Arc::clone(&says);
    thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let says = Arc::clone(&shared);
            thread::spawn(move || receive(stream, &says));
        }
    });
    (port, says)
}

/// A booth whose records also go to a receiver that is waited for so long, and what the receiver says.
fn booth_with_receiver(timeout: &str) -> (Booth, Says) {
    let (port, says) = receiver();
    (booth_with(port, timeout), says)
}

/// A booth whose records also go to this port.
fn booth_with(port: u16, timeout: &str) -> Booth {
    let booth = Booth::new();
    booth.reconfigure(|text| {
        format!(
            "{text}[store.hl7]\naddress = \"127.0.0.1:{port}\"\nencryption = \"none\"\n\
             timeout = \"{timeout}\"\n"
        )
    });
    booth
}

/// Reads a message and answers it, or holds the connection until the station gives up.
fn receive(mut stream: TcpStream, says: &Says) {
    let (mut message, mut part) = (Vec::new(), [0; 4096]);
    while !message.ends_with(b"\x1c\r") {
        match stream.read(&mut part) {
            Ok(0) | Err(_) => return,
            Ok(count) => message.extend_from_slice(&part[..count]),
        }
    }
    let said = *says.lock().unwrap();
    let Some(said) = said else {
        let _ = stream.read_to_end(&mut Vec::new());
        return;
    };
    let message = String::from_utf8_lossy(&message);
    let control = message.split('|').nth(9).unwrap();
    let error = if Some(said) == LOCKED { "ERR|||206^Application record locked\r" } else { "" };
    let answer = format!(
        "\x0bMSH|^~\\&|R|H|GAITER|booth-1|20260101000000||ACK^R01|1|P|2.5\r\
         MSA|{said}|{control}|not today\r{error}\x1c\r"
    );
    let _ = stream.write_all(answer.as_bytes());
}

fn becomes(says: &Says, said: Option<&'static str>) {
    *says.lock().unwrap() = said;
}

fn complaints(booth: &Booth) -> Vec<String> {
    let status = booth.status();
    let complaints = status["complaints"].as_array().unwrap().iter();
    complaints.map(|complaint| complaint["code"].as_str().unwrap().to_owned()).collect()
}

#[track_caller]
fn told(booth: &Booth, args: &[&str]) -> String {
    let output = booth.gaiter(args);
    assert_eq!(code(&output), Some(0), "{args:?}: {}", stderr(&output));
    stdout(&output)
}

const DELIVERED: &str = "SELECT count(*) FROM scans WHERE state = 'delivered'";
const OWED: &str = "SELECT count(*) FROM deliveries WHERE amended <> ''";

#[test]
fn a_scan_whose_server_is_slow_is_measured_once() {
    let (booth, says) = booth_with_receiver("2s");
    becomes(&says, None);
    let daemon = booth.start();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    booth.wait_for("the fault", || booth.log().contains("store-unavailable"));
    let fault = &booth.status()["stores"]["hl7"]["fault"];
    assert_eq!(fault, "no whole answer within 2 s", "a sentence for people, without a code");
    becomes(&says, ACCEPTED);
    booth.wait_for_journal(DELIVERED, 1);
    assert_eq!(booth.status()["measured"], 1);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_revision_that_a_server_refuses_is_a_notice_until_a_person_has_it_sent_again() {
    let (booth, says) = booth_with_receiver("10s");
    let daemon = booth.start();
    let scan = coarse_body(1);
    booth.export("4711_a.obj", &scan);
    booth.wait_for_journal(DELIVERED, 1);
    becomes(&says, REFUSED);
    let id = &sha256(&scan)[..8];
    let what = ["--leg", "right", "--level", "C", "--girth-cm", "36.7"];
    let said = ["--reason", "geschwollen", "--by", "Quastenflosser"];
    told(&booth, &[&["amend", id][..], &what, &said].concat());
    booth.wait_for("the notice", || complaints(&booth) == ["revision-refused"]);
    assert_eq!(booth.status()["ready"], true);
    let shown = told(&booth, &["show", id]);
    assert!(shown.contains("hl7: delivered [revision-refused]"), "{shown}");
    assert!(told(&booth, &["scans"]).contains("revision-refused"));
    becomes(&says, ACCEPTED);
    let retried = booth.gaiter(&["retry", id]);
    // A station that has offered it again by itself, on a busy machine, owes none.
    let is_owed = booth.journal(OWED) != Some(0);
    assert!(code(&retried) == Some(0) || !is_owed, "{}", stderr(&retried));
    booth.wait_for_journal(OWED, 0);
    assert_eq!(complaints(&booth), Vec::<String>::new());
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_record_that_is_locked_at_a_server_is_no_fault_of_the_server_until_several_are() {
    let (booth, says) = booth_with_receiver("10s");
    becomes(&says, LOCKED);
    let daemon = booth.start();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for("two tries", || booth.log().matches("not-taken-now").count() > 1);
    assert!(booth.status()["stores"]["hl7"]["fault"].is_null(), "{}", booth.status());
    for n in 2..=3 {
        booth.export(&format!("471{n}_a.obj"), &coarse_body(n));
    }
    let fault = || booth.status()["stores"]["hl7"]["fault"].as_str().map(str::to_owned);
    booth.wait_for("the fault", || fault().is_some_and(|fault| fault.contains("several records")));
    becomes(&says, ACCEPTED);
    booth.wait_for_journal(DELIVERED, 3);
    assert_eq!(fault(), None);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn after_a_restart_a_server_is_given_the_record_of_the_folder_and_nothing_is_measured_again() {
    let (booth, says) = booth_with_receiver("10s");
    becomes(&says, LOCKED);
    let daemon = booth.start();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    booth.wait_for("a try", || booth.log().contains("not-taken-now"));
    assert_eq!(daemon.stop().code(), Some(0));
    becomes(&says, ACCEPTED);
    let daemon = booth.start();
    booth.wait_for_journal(DELIVERED, 1);
    assert_eq!(booth.status()["measured"], 0);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_take_back_at_a_server_whose_address_was_changed_is_done_there_and_nowhere_else() {
    let ((port, says), (other, _)) = (receiver(), receiver());
    let booth = booth_with(port, "10s");
    let daemon = booth.start();
    let scan = coarse_body(1);
    booth.export("4711_a.obj", &scan);
    booth.wait_for_journal(DELIVERED, 1);
    becomes(&says, REFUSED);
    told(&booth, &["unassign", &sha256(&scan)[..8]]);
    booth.wait_for("the fault", || complaints(&booth).contains(&"record-kept".to_owned()));
    let moves = |from: u16, to: u16| {
        booth.reconfigure(|text| text.replace(&from.to_string(), &to.to_string()));
        let starts = || booth.log().matches("station-ready").count();
        let before = starts();
        kill_process(Pid::from_raw(daemon.id().cast_signed()).unwrap(), Signal::HUP).unwrap();
        booth.wait_for("the next generation", || starts() > before);
    };
    moves(port, other);
    booth.wait_for("the notice", || complaints(&booth).contains(&"store-moved".to_owned()));
    let moved = || booth.log().contains("an earlier address of the store");
    booth.wait_for("a try at the other address", moved);
    let check = stdout(&booth.gaiter(&["check"]));
    assert!(check.contains("earlier address"), "{check}");
    let withdrawn = "SELECT count(*) FROM deliveries WHERE store = 'hl7' AND state = 'withdrawn'";
    booth.wait_for_journal(withdrawn, 0);
    becomes(&says, ACCEPTED);
    moves(other, port);
    booth.wait_for_journal(withdrawn, 1);
    assert!(!complaints(&booth).contains(&"store-moved".to_owned()));
    assert_eq!(daemon.stop().code(), Some(0));
}

const ENDED: &str = "SELECT count(*) FROM history WHERE event = 'erasure-ended'";

/// A booth whose receiver does not take the take-back of a scan from 4711.
fn booth_that_owes_a_take_back() -> (Booth, Says, Daemon) {
    let (booth, says) = booth_with_receiver("10s");
    let daemon = booth.start_ready();
    let scan = coarse_body(1);
    booth.export("4711_a.obj", &scan);
    booth.wait_for_journal(DELIVERED, 1);
    becomes(&says, LOCKED);
    told(&booth, &["unassign", &sha256(&scan)[..8]]);
    booth.wait_for("a try", || booth.log().contains("not-taken-now"));
    (booth, says, daemon)
}

fn erase(booth: &Booth, args: &[&str]) -> (Option<i32>, String, String) {
    let args = [&["patient", "erase"][..], args].concat();
    let output = gaiter_told(&booth.path("station.toml"), &args, "4711\n4711\n");
    (code(&output), stdout(&output), stderr(&output))
}

/// The only erasure, as its file has it.
fn erasure(booth: &Booth) -> Value {
    let folder = booth.path("state/erasures");
    let names = names(&folder);
    let name = names.iter().find(|name| name.ends_with(".json")).unwrap();
    serde_json::from_slice(&fs::read(folder.join(name)).unwrap()).unwrap()
}

#[test]
fn an_erasure_waits_for_a_take_back_at_a_server_and_then_ends_by_itself() {
    let (booth, says, daemon) = booth_that_owes_a_take_back();
    let (exit, said, shown) = erase(&booth, &[]);
    assert_eq!(exit, Some(74), "{said}{shown}");
    assert!(shown.contains("This is done first"), "{shown}");
    assert!(shown.contains("is to be taken back: it is of the wrong patient"), "{shown}");
    assert!(said.contains("nothing is erased yet") && said.contains("wrong patient"), "{said}");
    let alarm = booth.status()["alarms"]["erasure-pending"]["message"].to_string();
    assert!(alarm.contains("hl7") && !alarm.contains("4711"), "{alarm}");
    let at_receiver = "SELECT count(*) FROM deliveries WHERE patient = '4711' AND store = 'hl7'";
    assert_eq!(booth.journal(at_receiver), Some(1));
    becomes(&says, ACCEPTED);
    booth.wait_for_journal(ENDED, 1);
    let done = "SELECT count(*) FROM history WHERE event = 'withdrawn' AND detail LIKE '%hl7%'";
    assert_eq!(booth.journal(done), Some(1), "the receiver was told first");
    assert_eq!(booth.journal(at_receiver), Some(0));
    assert_eq!(erasure(&booth)["left"], serde_json::json!([]));
    let is_over = || booth.status()["alarms"]["erasure-pending"].is_null();
    booth.wait_for("the end of the alarm", is_over);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn an_erasure_leaves_a_take_back_undone_by_decision_only_and_writes_it_down() {
    let (booth, _says, daemon) = booth_that_owes_a_take_back();
    // A station that does not run does nothing at servers.
    assert_eq!(daemon.stop().code(), Some(0));
    let (exit, said, shown) = erase(&booth, &[]);
    assert_eq!(exit, Some(74), "{said}{shown}");
    assert_eq!(booth.journal(ENDED), Some(0));
    let (exit, said, shown) = erase(&booth, &["--leave-at-servers"]);
    assert_eq!(exit, Some(0), "{said}{shown}");
    assert!(shown.contains("will now not be done"), "{shown}");
    assert!(said.contains("Erased.") && said.contains("is to be taken back"), "{said}");
    assert_eq!(booth.journal(ENDED), Some(1));
    let erasure = erasure(&booth);
    assert!(erasure["patient"].is_null(), "{erasure}");
    let left = erasure["left"].as_array().unwrap();
    assert_eq!(left.len(), 1, "{erasure}");
    assert_eq!(
        (left[0]["store"].as_str(), left[0]["step"].as_str()),
        (Some("hl7"), Some("take_back"))
    );
    assert!(left[0]["reference"].is_string(), "{erasure}");
}

#[test]
#[ignore = "waits for an answer that never comes, 25 s, run by .ci/run"]
fn a_reload_waits_for_a_server_that_owes_an_answer_and_files_are_taken_in_meanwhile() {
    let (booth, says) = booth_with_receiver("25s");
    becomes(&says, None);
    let mut daemon = booth.start_ready();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    kill_process(Pid::from_raw(daemon.id().cast_signed()).unwrap(), Signal::HUP).unwrap();
    booth.wait_for("the reload", || booth.log().contains("configuration-reloaded"));
    booth.export("4712_b.obj", &coarse_body(2));
    booth.wait_for_journal("SELECT count(*) FROM scans", 2);
    let generations = || booth.log().matches("station-open").count();
    assert_eq!(generations(), 1, "{}", booth.log());
    booth.wait_for("the next generation", || generations() == 2);
    becomes(&says, ACCEPTED);
    booth.wait_for_journal(DELIVERED, 2);
    assert!(!daemon.has_ended());
    assert_eq!(daemon.stop().code(), Some(0));
    assert!(!booth.log().contains("stop-grace-over"), "{}", booth.log());
}
