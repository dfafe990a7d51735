//! What people see of whose scan it is, on the real station: held scans with their legs and their
//! candidates, who is next, and a name that is replaced.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;

use rig::verb::{gaiter_told, stdout};
use rig::web::{HttpAnswer, Site};
use rig::{Booth, sha256};
use rusqlite::Connection;
use serde_json::{Value, json};
use support::coarse_body;

/// A station with its page, which holds what nobody pressed for; `more` is added to its configuration.
fn booth(more: &str) -> Booth {
    let booth = Booth::new();
    booth.reconfigure(|config| {
        format!(
            "{config}[status]\nlisten = \"127.0.0.1:0\"\n[capture]\nwithout_trigger = \"hold\"\n{more}"
        )
    });
    booth
}

/// Waits until the operator's snapshot is as it should be.
#[track_caller]
fn wait_for_state(booth: &Booth, site: &Site, what: &str, holds: impl Fn(&Value) -> bool) -> Value {
    let mut last = Value::Null;
    booth.wait_for(what, || {
        last = site.state_of(&site.operator());
        holds(&last)
    });
    last
}

fn decide(site: &Site, body: &Value) -> HttpAnswer {
    site.post("/ask", &body.to_string(), &site.operator())
}

fn code(answer: &HttpAnswer) -> Value {
    serde_json::from_str::<Value>(&answer.body).unwrap()["code"].clone()
}

fn has_legs(state: &Value) -> bool {
    !state["undecided"][0]["measures"].is_null()
}

#[test]
fn a_held_scan_shows_whose_legs_it_may_be_of_without_a_name_until_it_is_decided() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let bytes = coarse_body(0);
    let scan = sha256(&bytes);
    booth.export("4711_a.obj", &bytes);
    let state = wait_for_state(&booth, &site, "the preview", has_legs);
    assert_eq!((&state["undecided"][0]["state"], booth.records().len()), (&"held".into(), 0));
    let folder = booth.path("state/previews").join(&scan);
    let shown: Value =
        serde_json::from_str(&stdout(&booth.gaiter(&["show", &scan, "--json"]))).unwrap();
    assert_eq!(shown["preview"], folder.to_str().unwrap());
    assert!(stdout(&booth.gaiter(&["show", &scan])).contains(folder.to_str().unwrap()));

    let get = |file: &str, as_operator: bool| {
        let headers = if as_operator { site.operator() } else { Vec::new() };
        site.get(&format!("/scan/{scan}/{file}"), &headers)
    };
    for file in ["legs.svg", "report.html", "report.pdf", "record.json"] {
        assert_eq!(get(file, false).status, 403, "{file} is for the operator as a record's is");
    }
    for file in ["legs.svg", "report.html", "record.json"] {
        assert_eq!(get(file, true).status, 200, "{file}");
        assert!(!get(file, true).body.contains("4711"), "{file} names a patient");
    }
    let record: Value = serde_json::from_str(&get("record.json", true).body).unwrap();
    assert_eq!((&record["patient"], &record["scan"]["sha256"]), (&Value::Null, &scan.into()));

    assert_eq!(decide(&site, &json!({"ask": "release", "scan": sha256(&bytes)})).status, 200);
    booth.wait_for("the preview's end", || !folder.exists());
    booth.wait_for_records(1);
    assert_eq!(booth.records(), [("4711".to_owned(), sha256(&bytes))]);
    assert_eq!(daemon.stop().code(), Some(0));
    assert!(!booth.log_names("4711"), "{}", booth.log());
}

#[test]
fn a_held_scan_that_cannot_be_measured_says_why_and_stays_held() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    booth.export("4711_a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let unmeasured = |state: &Value| !state["undecided"][0]["unmeasured"].is_null();
    let state = wait_for_state(&booth, &site, "the reason", unmeasured);
    let held = &state["undecided"][0];
    let said = held["unmeasured"].as_str().unwrap();
    assert!(said.starts_with("There is no picture of its legs. ") && said.ends_with(']'), "{said}");
    assert_eq!((&held["state"], &held["files"]), (&"held".into(), &json!([])));
    let what = held["advice"]["what"].as_str().unwrap();
    wait_for_state(&booth, &site, "the same at the light", |state| {
        state["light"]["sentence"].as_str().unwrap().contains(what)
    });
    assert_eq!(held["acts"][0], "give_up");
    assert_eq!(booth.journal("SELECT count(*) FROM deliveries WHERE state = 'held'"), Some(1));
    assert_eq!(booth.journal("SELECT count(*) FROM scans WHERE state = 'refused'"), Some(0));
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_preview_that_is_missing_is_made_again_but_not_while_the_station_is_paused() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let place = |bytes: &[u8]| booth.path("state/previews").join(sha256(bytes));
    let (bytes, others) = (coarse_body(1), [2, 3].map(coarse_body));
    booth.export("4711_a.obj", &bytes);
    let folder = place(&bytes);
    booth.wait_for("the preview", || folder.exists());
    for (n, other) in others.iter().enumerate() {
        booth.export(&format!("4712_{n}.obj"), other);
        booth.wait_for("another preview", || place(other).exists());
    }
    fs::remove_dir_all(&folder).unwrap();
    booth.wait_for("the preview again", || folder.exists());
    assert_eq!(decide(&site, &json!({"ask": "pause"})).status, 200);
    fs::remove_dir_all(&folder).unwrap();
    // The worker that makes previews removes those that nobody needs: with the first, what is missing was looked at,
    // and before the second it would have been made.
    for other in &others {
        let released = decide(&site, &json!({"ask": "release", "scan": sha256(other)}));
        assert_eq!(released.status, 200, "{}", released.body);
        booth.wait_for("the end of a preview", || !place(other).exists());
    }
    assert!(!folder.exists(), "it was measured while the station was paused");
    assert_eq!(decide(&site, &json!({"ask": "resume"})).status, 200);
    booth.wait_for("the preview again", || folder.exists());
    assert_eq!(daemon.stop().code(), Some(0));
    // What lies there is never older than the station that shows it.
    fs::write(folder.join("legs.svg"), "<svg/>").unwrap();
    let daemon = booth.start();
    let drawing = folder.join("legs.svg");
    let is_new = || fs::read(&drawing).is_ok_and(|bytes| bytes.len() > 1000);
    booth.wait_for("a new preview", is_new);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn the_candidates_of_a_held_scan_are_for_those_who_may_know_them_and_one_of_them_gets_it() {
    let booth = booth("");
    let daemon = booth.start();
    let bytes = coarse_body(2);
    let scan = sha256(&bytes);
    booth.export("4711_a.obj", &bytes);
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'held'", 1);
    assert_eq!(daemon.stop().code(), Some(0));
    let journal = Connection::open(booth.path("state/journal.db")).unwrap();
    let candidates = "UPDATE scans SET candidates = '[\"4711\",\"0815\"]'";
    assert_eq!(journal.execute(candidates, []).unwrap(), 1);
    drop(journal);
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let state = wait_for_state(&booth, &site, "the preview", has_legs);
    let held = &state["undecided"][0];
    let patient = |id: &str| json!({"id": id, "shown": id});
    assert_eq!(held["candidates"], json!([patient("4711"), patient("0815")]));
    assert_eq!(held["acts"], json!(["assign", "give_up"]), "a release would be a guess");
    assert_eq!(site.state()["undecided"][0]["candidates"], json!([]));
    let shown: Value =
        serde_json::from_str(&stdout(&booth.gaiter(&["show", &scan, "--json"]))).unwrap();
    assert_eq!(shown["candidates"], json!(["4711", "0815"]));
    let answer = decide(&site, &json!({"ask": "assign", "scan": scan, "patient": "0815"}));
    assert_eq!(answer.status, 200, "{}", answer.body);
    booth.wait_for_records(1);
    assert_eq!(booth.records(), [("0815".to_owned(), scan)]);
    assert_eq!(daemon.stop().code(), Some(0));
}

/// Names the next patient as the page does.
fn name(site: &Site, patient: &str, replace: bool) -> HttpAnswer {
    decide(site, &json!({"ask": "name_next", "patient": patient, "replace": replace}))
}

fn next(booth: &Booth) -> String {
    stdout(&booth.gaiter(&["patient", "show"])).trim().to_owned()
}

#[test]
fn who_is_named_without_a_button_is_shown_and_not_replaced_unasked() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    assert_eq!(next(&booth), "No patient is named.");
    assert_eq!(code(&name(&site, "no one", false)), "patient-id-not-allowed");
    assert_eq!(name(&site, "4711", false).status, 200);
    assert_eq!(next(&booth), "4711's export is expected.");
    let refused = name(&site, "0815", false);
    assert_eq!((refused.status, code(&refused)), (409, "another-is-named".into()));
    assert!(!refused.body.contains("4711"), "{}", refused.body);
    assert_eq!(code(&name(&site, "no one", false)), "patient-id-not-allowed");
    assert_eq!(next(&booth), "4711's export is expected.", "nothing was changed");
    assert_eq!(name(&site, "4711", false).status, 200, "it is the same patient");
    let of_operator = site.state_of(&site.operator())["next"]["sentence"].clone();
    assert_eq!(of_operator, "4711's export is expected.");
    for query in ["/state", "/state?kiosk"] {
        let state: Value = serde_json::from_str(&site.get(query, &[]).body).unwrap();
        assert_eq!(state["next"]["sentence"], "The next patient is named.", "{query}");
        assert!(!state.to_string().contains("4711"), "{query}");
    }
    assert_eq!(name(&site, "0815", true).status, 200);
    assert!(next(&booth).contains("0815"), "{}", next(&booth));
    assert_eq!(daemon.stop().code(), Some(0));
    booth.reconfigure(|config| format!("{config}[page]\npatient_ids = \"everyone\"\n"));
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let kiosk: Value = serde_json::from_str(&site.get("/state?kiosk", &[]).body).unwrap();
    assert!(kiosk["next"]["sentence"].as_str().unwrap().contains("0815"), "{kiosk}");
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn who_is_named_for_the_next_press_is_shown_and_replaced_by_the_one_who_is_named_after() {
    // The port is not there: nobody presses.
    let booth = booth("[trigger.serial]\nport = \"/dev/gaiter/none\"\ntokens = [\"PRESS\"]\n");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    assert_eq!(name(&site, "111", false).status, 200);
    assert_eq!(next(&booth), "Next: 111.");
    assert_eq!(code(&name(&site, "222", false)), "another-is-named");
    assert_eq!(next(&booth), "Next: 111.");
    assert_eq!(name(&site, "222", true).status, 200);
    assert_eq!(next(&booth), "Next: 222.");
    // A person at the terminal who names somebody means it.
    gaiter_told(&booth.path("station.toml"), &["patient", "set"], "333\n");
    assert_eq!(next(&booth), "Next: 333.");
    let state = site.state_of(&site.operator());
    assert_eq!(state["next"]["who"], json!([{"id": "333", "shown": "333"}]));
    assert_eq!(daemon.stop().code(), Some(0));
}
