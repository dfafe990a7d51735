//! The operator's way on the running station: a name, a press, an export, the patient's folder, and
//! the light. The button is on a pseudo-terminal.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::time::Duration;

use rig::pty;
use rig::verb::{code, gaiter_told, stderr};
use rig::{Booth, Daemon, Setting, sha256};
use serde_json::Value;
use support::{body, coarse_body};

/// The light in letters, one a signal.
const SAY: &str = "[trigger.say]\nready = 'g'\narmed = 'a'\nreceiving = 'r'\ndone = 'd'\n\
                   attention = '!'\nno_export = 'n'\n";

/// A booth with a button, whose scans' names say nothing.
fn booth() -> Booth {
    // The window begins with a press, and its export comes after two looks: these are quick.
    let booth = Booth::set(&Setting { rescan: Duration::from_millis(300), ..Setting::default() });
    let port = booth.path("button");
    booth.reconfigure(|config| {
        let lines = config.lines().filter(|line| !line.starts_with("file_name"));
        let config: String = lines.map(|line| format!("{line}\n")).collect();
        format!(
            "{config}[capture]\nwindow = \"12s\"\nlate = \"0s\"\n[trigger]\nsettle = \"0s\"\n\
             lock_out = \"0s\"\n[trigger.serial]\nport = \"{}\"\ntokens = [\"PRESS\"]\n\
             long_tokens = [\"LONG\"]\n{SAY}",
            port.display()
        )
    });
    booth
}

/// A started station that has listened for long enough to believe that it hears every press.
#[track_caller]
fn listening(booth: &Booth) -> Daemon {
    let daemon = booth.start();
    booth.wait_for("a sure booth", || {
        let status = booth.status();
        status["triggers"]["serial"]["state"] == "open" && status["booth"]["in_doubt"] == false
    });
    daemon
}

fn name(booth: &Booth, id: &str) {
    let output = gaiter_told(&booth.path("station.toml"), &["patient", "set"], &format!("{id}\n"));
    assert_eq!(code(&output), Some(0), "{}", stderr(&output));
}

/// Presses, and waits until the station has looked for what lay there before.
#[track_caller]
fn press(booth: &Booth, button: &mut pty::Box) {
    let captures = || booth.journal("SELECT count(*) FROM captures").unwrap();
    let before = captures();
    button.sends(b"PRESS\r\n");
    booth.wait_for("the press", || captures() > before);
    booth.wait_for_look();
}

fn held(booth: &Booth) -> Vec<String> {
    let output = booth.gaiter(&["scans", "--state", "held", "--json"]);
    let scans: Value = serde_json::from_slice(&output.stdout).unwrap();
    let codes = scans.as_array().unwrap().iter();
    codes.map(|scan| scan["code"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn a_name_a_press_and_an_export_are_the_patients_record_and_the_light_tells_it() {
    let booth = booth();
    let mut button = pty::Box::behind(&booth.path("button"));
    let daemon = listening(&booth);
    name(&booth, "4711");
    press(&booth, &mut button);
    let scan = body(1);
    booth.export("a.obj", &scan);
    booth.wait_for_records(1);
    assert_eq!(booth.records(), [("4711".to_owned(), sha256(&scan))]);
    let mut light = Vec::new();
    booth.wait_for("done", || {
        light.extend(button.was_told());
        light.ends_with(b"d")
    });
    // Each sign stands for a second at least: that of a scan which is measured sooner is left out.
    light.retain(|sign| *sign != b'r');
    assert_eq!(String::from_utf8(light).unwrap(), "gad");
    let place = fs::read_dir(booth.path("records/4711")).unwrap().next().unwrap().unwrap().path();
    let record = fs::read(place.join("record.json")).unwrap();
    let record: Value = serde_json::from_slice(&record).unwrap();
    assert_eq!(record["acquired"]["from"], "press");
    assert_eq!(record["patient"]["sources"][0]["kind"], "operator");
    assert!(daemon.stop().success());
    assert!(!booth.log_names("4711"));
}

#[test]
fn a_press_without_an_export_is_an_alarm_until_the_next_press() {
    let booth = booth();
    let mut button = pty::Box::behind(&booth.path("button"));
    let daemon = listening(&booth);
    press(&booth, &mut button);
    booth.wait_for("the alarm", || booth.status()["alarms"]["no-export"].is_object());
    booth.wait_for("the light", || booth.status()["booth"]["light"] == "no_export");
    press(&booth, &mut button);
    booth.wait_for("its end", || booth.status()["alarms"]["no-export"].is_null());
    booth.export("a.obj", &coarse_body(2));
    booth.wait_for_records(1);
    assert!(daemon.stop().success());
    let states = "SELECT count(*) FROM captures WHERE state IN ('answered', 'over')";
    assert_eq!(booth.journal(states), Some(2));
}

#[test]
fn two_patients_who_may_both_be_meant_get_nothing_before_a_person_decides() {
    let booth = booth();
    let mut button = pty::Box::behind(&booth.path("button"));
    let daemon = listening(&booth);
    for id in ["4711", "0815"] {
        name(&booth, id);
        press(&booth, &mut button);
    }
    booth.export("a.obj", &coarse_body(3));
    booth.wait_for("the hold", || held(&booth) == ["capture-ambiguous"]);
    booth.wait_for("the light", || booth.status()["booth"]["light"] == "attention");
    assert_eq!(booth.records(), []);
    assert!(daemon.stop().success());
}

#[test]
fn a_long_press_calls_off_what_waits() {
    let booth = booth();
    let mut button = pty::Box::behind(&booth.path("button"));
    let daemon = listening(&booth);
    name(&booth, "4711");
    press(&booth, &mut button);
    button.sends(b"LONG\r\n");
    booth.wait_for("its end", || booth.status()["booth"]["awaited"] == 0);
    assert!(daemon.stop().success());
    assert_eq!(booth.journal("SELECT count(*) FROM captures WHERE state = 'called_off'"), Some(1));
    assert_eq!(booth.journal("SELECT count(*) FROM history WHERE event = 'called-off'"), Some(1));
}

#[test]
fn a_port_that_is_pulled_out_holds_the_scan_of_the_patient_who_was_named() {
    let booth = booth();
    let link = booth.path("button");
    let mut button = pty::Box::behind(&link);
    let daemon = listening(&booth);
    name(&booth, "4711");
    press(&booth, &mut button);
    drop(button);
    fs::remove_file(&link).unwrap();
    booth.wait_for("its absence", || booth.status()["triggers"]["serial"]["state"] == "absent");
    booth.export("a.obj", &coarse_body(4));
    booth.wait_for("the hold", || held(&booth) == ["press-unheard"]);
    assert!(daemon.stop().success());
}
