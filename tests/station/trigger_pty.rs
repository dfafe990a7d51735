//! The serial port of the running station, on a real pseudo-terminal.

#![allow(clippy::unwrap_used)]

use std::fs;

use rig::pty;
use rig::{Booth, Daemon, PATIENCE, verb};
use serde_json::Value;

/// A booth whose station attends the port behind `button`.
fn booth(more: &str) -> Booth {
    let booth = Booth::new();
    let port = booth.path("button");
    booth.reconfigure(|config| {
        format!(
            "{config}[trigger]\nsettle = \"100ms\"\nlock_out = \"0s\"\n[trigger.serial]\n\
             port = \"{}\"\n{more}",
            port.display()
        )
    });
    booth
}

const TOKENS: &str = "tokens = [\"PRESS\"]\n";

fn trigger(booth: &Booth) -> Value {
    let output = verb::gaiter_told(&booth.path("station.toml"), &["status", "--json"], "");
    let status: Value = serde_json::from_slice(&output.stdout).unwrap_or_default();
    status["triggers"]["serial"].clone()
}

#[track_caller]
fn wait_for_state(booth: &Booth, state: &str) {
    booth.wait_for(state, || trigger(booth)["state"] == state);
}

#[track_caller]
fn wait_for_presses(booth: &Booth, presses: u64) {
    booth.wait_for("presses", || trigger(booth)["presses"] == presses);
}

/// A started station that listens to its port.
fn listening(booth: &Booth) -> Daemon {
    let daemon = booth.start();
    wait_for_state(booth, "open");
    daemon
}

#[test]
fn a_press_is_heard_through_garbage_and_the_light_is_told() {
    let booth = booth(&format!("{TOKENS}[trigger.say]\nready = 'G\\r\\n'\n"));
    let mut button = pty::Box::behind(&booth.path("button"));
    let daemon = listening(&booth);
    let mut told = Vec::new();
    booth.wait_for("the light", || {
        told.extend(button.was_told());
        told == b"G\r\n"
    });
    button.sends(b"AT\r\0\xff\xffPRESS\r\npress\r\n");
    button.sends(b"PRESS\r\n");
    wait_for_presses(&booth, 1);
    assert_eq!(trigger(&booth)["garbage"], 15);
    assert!(booth.log().contains("pressed"));
    assert!(daemon.stop().success());
}

#[test]
fn a_port_that_comes_back_under_another_number_is_found_behind_its_name() {
    let booth = booth(TOKENS);
    let link = booth.path("button");
    let mut first = pty::Box::behind(&link);
    let daemon = listening(&booth);
    first.sends(b"PRESS\r\n");
    wait_for_presses(&booth, 1);
    // Pulled out: the line is hung up, the name is gone.
    drop(first);
    fs::remove_file(&link).unwrap();
    wait_for_state(&booth, "absent");
    let mut second = pty::Box::behind(&link);
    wait_for_state(&booth, "open");
    second.sends(b"PRESS\r\n");
    wait_for_presses(&booth, 2);
    // Its name goes to another port while this one stays silent, as some drivers leave it.
    let mut third = pty::Box::behind(&link);
    booth.wait_for("a press on the third", || {
        third.pours(b"PRESS\r\n");
        trigger(&booth)["presses"].as_u64() > Some(2)
    });
    second.pours(b"PRESS\r\n");
    assert!(daemon.stop().success());
}

#[test]
fn a_port_that_another_program_has_is_busy_until_it_is_let_go() {
    let booth = booth(TOKENS);
    let mut button = pty::Box::behind(&booth.path("button"));
    let path = button.port.to_string_lossy().into_owned();
    let other = serialport::TTYPort::open(&serialport::new(path, 9600)).unwrap();
    let daemon = booth.start();
    wait_for_state(&booth, "busy");
    drop(other);
    wait_for_state(&booth, "open");
    button.sends(b"PRESS\r\n");
    wait_for_presses(&booth, 1);
    // And nobody else gets it meanwhile.
    let path = button.port.to_string_lossy().into_owned();
    assert!(serialport::TTYPort::open(&serialport::new(path, 9600)).is_err());
    assert!(daemon.stop().success());
}

#[test]
fn wires_that_a_port_lacks_cost_no_press_and_a_contact_on_them_is_told() {
    let with_wires = booth(&format!("{TOKENS}dtr = \"on\"\n"));
    let mut button = pty::Box::behind(&with_wires.path("button"));
    let daemon = listening(&with_wires);
    button.sends(b"PRESS\r\n");
    wait_for_presses(&with_wires, 1);
    assert!(daemon.stop().success());

    let with_contact = booth("contact = \"cts\"\n");
    let _button = pty::Box::behind(&with_contact.path("button"));
    let daemon = with_contact.start();
    with_contact.wait_for("the fault", || {
        let why = trigger(&with_contact)["why"].to_string();
        why.contains("modem lines cannot be read")
    });
    assert!(daemon.stop().success());
}

#[test]
fn a_flood_takes_no_memory_and_the_press_after_it_is_heard() {
    let booth = booth(TOKENS);
    let mut button = pty::Box::behind(&booth.path("button"));
    let daemon = listening(&booth);
    let resident = || rig::invariants::Vitals::read(daemon.id()).unwrap().resident_kb;
    let before = resident();
    let noise: Vec<u8> = (0..4096_u32).map(|n| (n * 37 % 251) as u8 | 0x80).collect();
    let mut poured = 0;
    while poured < 8_000_000 {
        poured += button.pours(&noise);
    }
    booth.wait_for("the flood's end", || {
        trigger(&booth)["garbage"].as_u64().unwrap() + 64 >= poured as u64
    });
    let grown = resident().saturating_sub(before);
    assert!(grown < 4000, "{grown} kB more after {poured} bytes");
    button.sends(b"\r\nPRESS\r\n");
    wait_for_presses(&booth, 1);
    assert!(daemon.stop().success());
}

#[test]
fn a_station_without_its_port_stops_at_once_and_one_without_usb_runs() {
    let booth = booth(&format!("{TOKENS}[trigger.usb]\ndevice = \"1d34:000d\"\n"));
    let mut daemon = booth.start();
    wait_for_state(&booth, "absent");
    let said = || verb::stdout(&booth.gaiter(&["status"]));
    booth.wait_for("the other port", || said().contains("usb: absent"));
    assert!(daemon.stop_within(PATIENCE).unwrap().success());
}

#[test]
fn a_reload_keeps_the_port() {
    let booth = booth(TOKENS);
    let mut button = pty::Box::behind(&booth.path("button"));
    let daemon = listening(&booth);
    let pid = rustix::process::Pid::from_raw(daemon.id().cast_signed()).unwrap();
    rustix::process::kill_process(pid, rustix::process::Signal::HUP).unwrap();
    booth.wait_for("the reload", || booth.log().contains("configuration-reloaded"));
    booth.wait_for("both openings", || booth.log().matches("trigger-open").count() == 2);
    button.sends(b"PRESS\r\n");
    wait_for_presses(&booth, 1);
    assert!(!booth.log().contains("trigger-busy"), "{}", booth.log());
    assert!(daemon.stop().success());
}
