//! The light of the real station: it says what is, for whose scan, and no longer than it is so.

use rig::booth::Room;
use rig::verb::{code, stderr};
use rig::web::Site;
use rig::{Booth, sha256};
use serde_json::{Value, json};
use support::{body, coarse_body};

use super::{booth, decide, wait_for_state};

/// Waits until the light shows this signal, and the sentence with ids begins so.
#[track_caller]
fn wait_for_light(booth: &Booth, site: &Site, signal: &str, said: &str) {
    let operator = site.operator();
    let mut last = Value::Null;
    booth.wait_for(&format!("{signal}: {said}"), || {
        last = site.state_of(&operator)["light"].clone();
        let sentence = last["sentence"].as_str().unwrap();
        last["signal"] == signal && sentence.starts_with(said)
    });
}

/// Whether patients' ids are kept from those who may not know them.
fn names_nobody(site: &Site, id: &str) -> bool {
    !site.get("/state", &[]).body.contains(id)
}

#[test]
fn an_export_that_stopped_is_told_as_such_until_its_rest_comes() {
    let booth = booth("");
    booth.reconfigure(|config| config.replace("short_wait = \"3000ms\"", "short_wait = \"1m\""));
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let bytes = coarse_body(0);
    booth.wait_for_look();
    booth.export("4711_a.obj", &bytes[..bytes.len() / 2]);
    wait_for_light(&booth, &site, "receiving", "The export stopped halfway.");
    assert_eq!(site.state()["light"]["word"], "Export stopped");
    booth.export("4711_a.obj", &bytes);
    booth.wait_for_records(1);
    assert_eq!(booth.records(), [("4711".to_owned(), sha256(&bytes))]);
    wait_for_light(&booth, &site, "attention", "The scan of 4711 lacks measures. Measure by hand:");
    assert!(names_nobody(&site, "4711"));
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_held_scan_that_a_person_decided_on_is_not_held_at_the_light() {
    let booth = booth("[capture]\nwithout_trigger = \"hold\"\n");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    for (n, ask, after, said) in [
        (0, "release", "done", "The record of 4711 is stored."),
        (1, "give_up", "ready", "Scan the next patient."),
    ] {
        let bytes = body(n);
        booth.export(&format!("4711_{n}.obj"), &bytes);
        wait_for_light(&booth, &site, "attention", "The scan of 4711 is held.");
        assert_eq!(decide(&site, &json!({"ask": ask, "scan": sha256(&bytes)})).status, 200);
        wait_for_light(&booth, &site, after, said);
    }
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn what_a_person_must_see_is_told_after_a_start_as_before_it() {
    let booth = booth("[capture]\nwithout_trigger = \"hold\"\n");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let bytes = body(0);
    booth.export("4711_a.obj", &bytes);
    wait_for_light(&booth, &site, "attention", "The scan of 4711 is held.");
    assert_eq!(daemon.stop().code(), Some(0));
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    wait_for_light(&booth, &site, "attention", "The scan of 4711 is held.");
    assert_eq!(code(&booth.gaiter(&["release", &sha256(&bytes)])), Some(0));
    wait_for_light(&booth, &site, "done", "The record of 4711 is stored.");
    assert_eq!(daemon.stop().code(), Some(0));
    // What is done needs nobody, and is not told again.
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    wait_for_light(&booth, &site, "ready", "Scan the next patient.");
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_scan_without_a_patient_is_not_done_until_a_person_has_said_whose_it_is() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let bytes = body(0);
    booth.export("body.obj", &bytes);
    let said = "The record of the last scan is stored, but without a patient.";
    wait_for_light(&booth, &site, "attention", said);
    let ask = json!({"ask": "assign", "scan": sha256(&bytes), "patient": "4711"});
    assert_eq!(decide(&site, &ask).status, 200);
    wait_for_light(&booth, &site, "done", "The record of 4711 is stored.");
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_refused_scan_that_may_come_again_is_told_to_hold_the_next_until_it_is_given_up() {
    let mut room = Room::with_button("[status]\nlisten = \"127.0.0.1:0\"\n");
    let daemon = room.start();
    let site = Site::open(&room.booth, "local");
    let bytes = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    room.name("4711");
    room.press();
    room.wait_for_look();
    room.booth.export("4711_a.obj", bytes);
    wait_for_light(&room.booth, &site, "attention", "The scan of 4711 cannot be used.");
    let sentence = || site.state_of(&site.operator())["light"]["sentence"].to_string();
    assert!(sentence().contains("Or give it up on the page. Until then"), "{}", sentence());
    room.name("0815");
    room.press();
    let said = "Scan now, then export. You will be asked whose scan it is.";
    wait_for_light(&room.booth, &site, "armed", said);
    assert!(names_nobody(&site, "4711"));
    assert_eq!(code(&room.booth.gaiter(&["give-up", &sha256(bytes)])), Some(0));
    assert_eq!(code(&room.booth.gaiter(&["patient", "clear"])), Some(0));
    room.name("0815");
    wait_for_light(&room.booth, &site, "ready", "Press the button, then scan the patient");
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_refused_scan_that_a_person_gave_up_is_told_no_longer() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let bytes = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    booth.export("4711_a.obj", bytes);
    wait_for_light(&booth, &site, "attention", "The scan of 4711 cannot be used.");
    assert!(names_nobody(&site, "4711"));
    assert_eq!(code(&booth.gaiter(&["give-up", &sha256(bytes)])), Some(0));
    wait_for_light(&booth, &site, "ready", "Scan the next patient.");
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn an_old_scan_that_is_exported_for_the_next_patient_is_told_with_whose_it_is_and_the_name_waits() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let old = body(0);
    booth.export("4711_a.obj", &old);
    wait_for_light(&booth, &site, "done", "The record of 4711 is stored.");
    assert_eq!(decide(&site, &json!({"ask": "name_next", "patient": "0815"})).status, 200);
    booth.wait_for_look();
    booth.export("again.obj", &old);
    let said = "The scanner has exported an old scan again, that of 4711.";
    wait_for_light(&booth, &site, "attention", said);
    assert!(names_nobody(&site, "4711"));
    let next = site.state_of(&site.operator())["next"]["sentence"].clone();
    assert_eq!(next, "0815's export is expected.");
    booth.export("new.obj", &body(1));
    wait_for_light(&booth, &site, "done", "The record of 0815 is stored.");
    wait_for_state(&booth, &site, "nobody named", |state| {
        state["next"]["sentence"] == "No patient is named."
    });
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_record_that_lacks_measures_stands_with_what_a_person_must_do_and_marks_what_is_asked() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    // Of this body's ankle and heel too little is to be seen.
    let bytes = coarse_body(0);
    booth.export("4711_a.obj", &bytes);
    let state = wait_for_state(&booth, &site, "the task", |state| {
        state["undecided"][0]["measures"]["verdict"] == "by-hand"
    });
    assert_eq!((&state["undecided"][0]["task"], &state["scans"]), (&json!("complete"), &json!([])));
    // It waits for no decision, so nobody is sent to decide.
    let sentence = site.state()["light"]["sentence"].clone();
    assert!(!sentence.to_string().contains("decision"), "{sentence}");
    let sheet = site.get(&format!("/scan/{}/measures", sha256(&bytes)), &site.operator());
    let sheet: Value = serde_json::from_str(&sheet.body).unwrap();
    let asked = |measure: &str| {
        let line = sheet.as_array().unwrap().iter().find(|line| line["measure"] == measure);
        line.unwrap()["right"]["asked"].clone()
    };
    assert_eq!(asked("B"), json!(["girth", "height"]));
    assert_eq!((asked("Y"), asked("B1")), (json!(["girth"]), json!([])));
    // What is settled leaves the list.
    let scan = sha256(&bytes);
    for (level, girth_cm, height_cm) in [("B", "20", Some("11")), ("Y", "31", None)] {
        for leg in ["right", "left"] {
            let mut set = vec!["amend", "--leg", leg, "--level", level, "--girth-cm", girth_cm];
            set.extend(height_cm.into_iter().flat_map(|height| ["--height-cm", height]));
            set.extend(["--reason", "swollen", "--by", "Anna", "--sure", &scan]);
            let set = booth.gaiter(&set);
            assert_eq!(code(&set), Some(0), "{}", stderr(&set));
        }
    }
    wait_for_state(&booth, &site, "the end of the task", |state| {
        state["undecided"] == json!([]) && state["scans"][0]["task"] == "nothing"
    });
    assert_eq!(daemon.stop().code(), Some(0));
}
