//! The operator's page of the real station: who may read, who may decide, and what it says.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod files;
mod held;
mod light;
mod visits;
mod worklist;

use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, chown};
use std::path::{Path, PathBuf};

use rig::verb::{code, stdout};
use rig::web::{HttpAnswer, Site};
use rig::{Booth, sha256};
use serde_json::{Value, json};
use support::{body, coarse_body};

/// A station whose page is served on some port of this machine.
fn booth(more: &str) -> Booth {
    let booth = Booth::new();
    booth.reconfigure(|config| format!("{config}[status]\nlisten = \"127.0.0.1:0\"\n{more}"));
    booth
}

/// Waits until the page's snapshot is as it should be.
#[track_caller]
fn wait_for_state(booth: &Booth, site: &Site, what: &str, holds: impl Fn(&Value) -> bool) -> Value {
    let mut last = Value::Null;
    booth.wait_for(what, || {
        last = site.state();
        holds(&last)
    });
    last
}

/// The first scan on the page: what a person must do something about stands above.
fn first_scan(state: &Value) -> &Value {
    let undecided = &state["undecided"][0];
    if undecided.is_null() { &state["scans"][0] } else { undecided }
}

/// The folder of the patient's only record.
fn record_of(booth: &Booth, patient: &str) -> PathBuf {
    let folders = fs::read_dir(booth.path("records").join(patient)).unwrap();
    let mut folders = folders.map(|entry| entry.unwrap().path());
    folders.find(|path| path.join("record.json").exists()).unwrap()
}

fn decide(site: &Site, body: &Value) -> HttpAnswer {
    site.post("/ask", &body.to_string(), &site.operator())
}

#[test]
fn a_scan_is_shown_with_its_measures_as_its_record_has_them() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    assert_eq!(site.state()["light"]["signal"], "ready");
    let bytes = coarse_body(0);
    booth.export("4711_a.obj", &bytes);
    let state =
        wait_for_state(&booth, &site, "measures", |state| !first_scan(state)["measures"].is_null());
    let shown = first_scan(&state);
    assert_eq!((&shown["scan"], &shown["state"]), (&sha256(&bytes).into(), &"delivered".into()));
    let record: Value =
        serde_json::from_slice(&fs::read(record_of(&booth, "4711").join("record.json")).unwrap())
            .unwrap();
    for (row, level) in ["D", "C", "B1", "B"].into_iter().enumerate() {
        assert_eq!(shown["measures"]["levels"][row]["level"], level);
        for leg in record["legs"].as_array().unwrap() {
            let side = leg["side"].as_str().unwrap();
            let shown = &shown["measures"]["levels"][row][side];
            let Some(landmark) = leg["landmarks"].get(level) else {
                assert!(shown.is_null());
                continue;
            };
            for (text, figure) in [("girth_cm", "girth_tape_mm"), ("height_cm", "height_mm")] {
                // Half a millimetre, rounded as tapes are read.
                let mm = landmark[figure].as_f64().unwrap();
                let text: f64 = shown[text].as_str().unwrap().parse().unwrap();
                assert!((text * 10.0 - mm).abs() <= 0.5 + 1e-9, "{side} {level}: {text} of {mm}");
            }
        }
    }
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn only_those_with_the_token_learn_whose_a_scan_is() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let bytes = coarse_body(0);
    booth.export("4711_a.obj", &bytes);
    wait_for_state(&booth, &site, "measures", |state| !first_scan(state)["measures"].is_null());
    let scan = sha256(&bytes);
    let record = format!("/scan/{scan}/record.json");
    assert!(!site.get("/state", &[]).body.contains("4711"));
    for file in ["record.json", "report.html", "report.pdf", "legs.svg", "left.step", "scan.obj"] {
        assert_eq!(site.get(&format!("/scan/{scan}/{file}"), &[]).status, 403, "{file}");
    }

    let operator = site.operator();
    assert!(site.get("/state", &operator).body.contains("\"4711\""));
    assert!(!site.get("/state?kiosk", &operator).body.contains("4711"), "everybody sees the kiosk");
    let kiosk = site.stream_of("/stream?kiosk", &operator).next().unwrap();
    assert!(kiosk["ids"] == false && !kiosk.to_string().contains("4711"), "{kiosk}");
    let entered = site.post("/enter", "{}", &operator);
    assert_eq!(entered.status, 200);
    let cookie = entered.header("set-cookie").unwrap();
    assert!(cookie.contains("HttpOnly") && cookie.contains("SameSite=Strict"), "{cookie}");
    assert!(!cookie.contains(&site.token), "a cookie is sent to every port of this machine");
    let reader = [("Cookie", cookie.split(';').next().unwrap().to_owned())];
    let answer = site.get(&record, &reader);
    assert_eq!(answer.status, 200);
    let record: Value = serde_json::from_str(&answer.body).unwrap();
    assert_eq!(record["patient"]["id"], "4711");
    let mut own = site.operator();
    own.retain(|(name, _)| *name != "Authorization");
    own.extend(reader.clone());
    assert_eq!(site.post("/ask", "{\"ask\":\"pause\"}", &own).status, 401, "reading decides not");
    assert_eq!(daemon.stop().code(), Some(0));
    booth.reconfigure(|config| format!("{config}[page]\npatient_ids = \"everyone\"\n"));
    let daemon = booth.start();
    assert!(Site::open(&booth, "local").get("/state?kiosk", &[]).body.contains("\"4711\""));
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_decision_needs_the_token_from_the_station_s_own_page_and_says_what_it_did() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let body = "{\"ask\":\"pause\"}";
    let own = |site: &Site| {
        vec![
            ("Origin", site.origin()),
            ("Authorization", format!("Bearer {}", site.token)),
            ("Content-Type", "application/json".to_owned()),
        ]
    };
    let with = |name: &str, value: &str| {
        let mut headers = own(&site);
        headers.iter_mut().filter(|(of, _)| *of == name).for_each(|(_, of)| *of = value.to_owned());
        site.post("/ask", body, &headers).status
    };
    assert_eq!(with("Origin", "http://evil.example"), 403);
    assert_eq!(with("Origin", "null"), 403);
    assert_eq!(with("Authorization", ""), 401);
    assert_eq!(with("Authorization", &format!("Bearer {}", "0".repeat(64))), 401);
    assert_eq!(with("Content-Type", "text/plain"), 415);
    assert_eq!(site.request("PUT", "/ask", body, &own(&site)).status, 405);
    assert_eq!(site.get("/ask", &own(&site)).status, 405);
    let large = format!("{{\"ask\":\"name_next\",\"patient\":\"{}\"}}", "1".repeat(20_000));
    assert_eq!(site.post("/ask", &large, &own(&site)).status, 413);
    for body in [
        "",
        "{}",
        "[]",
        "{\"ask\":\"status\"}",
        "{\"ask\":\"page\"}",
        "{\"ask\":\"show\",\"scan\":\"abcd\"}",
    ] {
        assert_eq!(site.post("/ask", body, &own(&site)).status, 400, "{body}");
    }
    assert_eq!(site.state()["paused"], false, "nothing of this was a decision");

    let answer = site.post("/ask", body, &own(&site));
    assert_eq!((answer.status, site.state()["paused"].clone()), (200, true.into()));
    assert!(answer.body.contains("Paused"), "{}", answer.body);
    assert_eq!(site.post("/ask", "{\"ask\":\"resume\"}", &own(&site)).status, 200);
    assert!(booth.log().contains("station-paused") && booth.log().contains("station-resumed"));
    let named = json!({"ask": "name_next", "patient": "not one"});
    let refused = site.post("/ask", &named.to_string(), &own(&site));
    assert_eq!(refused.status, 409);
    assert!(refused.body.contains("patient-id-not-allowed"), "{}", refused.body);
    assert!(!booth.log().contains(&site.token), "the token is in the log");
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn who_calls_the_station_by_another_name_is_not_answered() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    for path in ["/", "/state", "/stream", "/metrics", "/healthz", "/page.js"] {
        let asked = |host: &str| site.exchange("GET", path, host, "", &[]).status;
        assert_eq!(asked("evil.example"), 421, "{path}");
        assert_eq!(asked(&format!("evil.example:{}", site.port)), 421, "{path}");
        if path != "/stream" {
            assert_eq!(asked("localhost"), 200, "{path}");
        }
    }
    let none = site.get("/elsewhere", &[]);
    assert_eq!(none.status, 404);
    assert!(none.body.contains("There is no such page.") && none.body.contains("href=\"/\""));
    let page = site.get("/", &[]);
    let policy = page.header("content-security-policy").unwrap();
    assert!(policy.starts_with("default-src 'none'; script-src 'self'"), "{policy}");
    for (name, value) in [
        ("x-content-type-options", "nosniff"),
        ("referrer-policy", "no-referrer"),
        ("cache-control", "no-store"),
        ("cross-origin-resource-policy", "same-origin"),
    ] {
        assert_eq!(page.header(name).as_deref(), Some(value));
    }
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_stream_tells_of_changes_and_ends_with_the_station() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let mut stream = site.stream(&site.operator());
    let first = stream.find(|state| state["light"]["signal"] == "ready").unwrap();
    assert_eq!(first["ids"], true);
    assert_eq!(decide(&site, &json!({"ask": "name_next", "patient": "4711"})).status, 200);
    // What is first seen before could have lain there when the patient was named, and is held.
    booth.wait_for_look();
    let armed = stream.find(|state| state["light"]["signal"] == "armed").unwrap();
    assert_eq!(armed["next"]["can_be_called_off"], true);
    booth.export("4711_a.obj", &body(0));
    let done = stream.find(|state| state["light"]["signal"] == "done");
    assert!(done.is_some(), "the stream ended");
    assert_eq!(daemon.stop().code(), Some(0));
    // What was still to be told is; a stream that does not end is read in vain until its time is over.
    stream.for_each(drop);
}

#[test]
fn a_record_that_lacks_measures_ends_in_attention_with_what_to_measure_by_hand() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    assert_eq!(decide(&site, &json!({"ask": "name_next", "patient": "4711"})).status, 200);
    booth.wait_for_look();
    let stream = site.stream(&site.operator());
    // Of this body's ankle and heel too little is to be seen.
    booth.export("4711_a.obj", &coarse_body(0));
    let light = stream.map(|state| state["light"].clone());
    let mut after_receipt = light.skip_while(|light| light["signal"] != "receiving");
    let end = after_receipt.find(|light| light["signal"] != "receiving").unwrap();
    assert_eq!(end["signal"], "attention");
    let to_do = "Measure by hand: right leg: B and Y; left leg: B and Y.";
    assert_eq!(end["sentence"], format!("The scan of 4711 lacks measures. {to_do}"));
    booth.wait_for("the measures", || {
        let state = site.state_of(&site.operator());
        let measures = &first_scan(&state)["measures"];
        measures["verdict"] == "by-hand" && measures["to_do"][0] == to_do
    });
    assert_eq!(daemon.stop().code(), Some(0));
    after_receipt.for_each(drop);
}

#[test]
fn a_ninth_stream_is_told_to_ask_instead_and_eight_hold_up_nobody() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let mut streams: Vec<_> = (0..8).map(|_| site.stream(&[])).collect();
    streams.iter_mut().for_each(|stream| assert!(stream.next().is_some()));
    assert_eq!(site.get("/stream", &[]).status, 503);
    // Streams take no places of those who ask once.
    for _ in 0..20 {
        assert_eq!(site.get("/state", &[]).status, 200);
    }
    streams.pop();
    booth.wait_for("a free place", || site.stream(&[]).status() == 200);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn the_link_opens_a_station_again_after_a_restart_and_is_for_its_user_only() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let said = booth.gaiter(&["page"]);
    let link = format!("http://127.0.0.1:{}/#token={}\n", site.port, site.token);
    assert_eq!((code(&said), stdout(&said)), (Some(0), link));
    let file = booth.path("state/page-token");
    assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o600);
    assert_eq!(daemon.stop().code(), Some(0));
    let daemon = booth.start();
    let again = Site::open(&booth, "local");
    assert_eq!(again.token, site.token);
    assert_eq!(decide(&again, &json!({"ask": "call_off"})).status, 200);
    assert_eq!(daemon.stop().code(), Some(0));
    booth.reconfigure(|config| config.replace("127.0.0.1:0", "off"));
    let daemon = booth.start();
    booth.wait_for("an answer", || code(&booth.gaiter(&["status"])) == Some(0));
    assert_eq!(code(&booth.gaiter(&["page"])), Some(74));
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_token_that_somebody_planted_in_an_open_state_folder_opens_nothing() {
    let booth = booth("");
    let (state, file) = (booth.path("state"), booth.path("state/page-token"));
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    let set = |path: &Path, mode| fs::set_permissions(path, Permissions::from_mode(mode)).unwrap();
    fs::create_dir(&state).unwrap();
    set(&state, 0o777);
    let planted = "ab".repeat(32);
    fs::write(&file, &planted).unwrap();
    set(&file, 0o600);
    // Who is not root plants one that others can read.
    if chown(&file, Some(65_534), None).is_err() {
        set(&file, 0o644);
    }
    let daemon = booth.start_ready();
    let token = || fs::read_to_string(&file).is_ok_and(|token| token.trim() != planted);
    booth.wait_for("a token of its own", token);
    let site = Site::open(&booth, "local");
    assert_eq!((mode(&state), mode(&file)), (0o700, 0o600));
    for event in ["state-folder-closed", "page-token-refused"] {
        assert_eq!(booth.log().matches(event).count(), 1, "{event}");
    }
    let intruder = Site { port: site.port, token: planted };
    assert_eq!(decide(&intruder, &json!({"ask": "call_off"})).status, 401);
    assert_eq!(decide(&site, &json!({"ask": "call_off"})).status, 200);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn over_the_network_the_page_is_for_reading_only() {
    // Every address of this machine, loopback among them: a network is not to be had everywhere.
    let booth = booth("[page]\nnetwork = \"0.0.0.0:0\"\n");
    let daemon = booth.start();
    let local = Site::open(&booth, "local");
    let network = Site::open(&booth, "network");
    assert_eq!(network.get("/", &[]).status, 200);
    assert_eq!(network.get("/state", &local.operator()).status, 200);
    assert_eq!(network.state_of(&local.operator())["ids"], false, "the token counts for nothing");
    for path in ["/metrics", "/healthz"] {
        assert_eq!(network.get(path, &[]).status, 404, "{path}");
    }
    for (method, path) in [("POST", "/ask"), ("POST", "/enter"), ("PUT", "/"), ("DELETE", "/state")]
    {
        let answer = network.request(method, path, "{\"ask\":\"pause\"}", &network.operator());
        assert_eq!(answer.status, 403, "{method} {path}");
        assert!(answer.body.contains("TLS"), "{}", answer.body);
    }
    assert_eq!(network.exchange("GET", "/", "booth.example", "", &[]).status, 421);
    assert_eq!(local.state()["paused"], false);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn ids_of_any_kind_come_as_they_are_and_what_would_hide_or_turn_letters_by_its_code_point() {
    let booth = booth("");
    booth.reconfigure(|config| {
        let pattern = "pattern = '^P?[0-9]{1,12}$'";
        assert!(config.contains(pattern));
        config.replace(pattern, "pattern = '^[^/.\\n][^/\\n]*$'")
    });
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let ids = ["<script>alert(1)<", "\"'`&amp;", "\u{202e}4711\u{2066}", "ab\u{300}\u{1f600}"];
    for (n, id) in ids.into_iter().enumerate() {
        let seen = id.replace('\u{202e}', "[U+202E]").replace('\u{2066}', "[U+2066]");
        let answer = decide(&site, &json!({"ask": "name_next", "patient": id}));
        assert_eq!(answer.status, 200, "{id}: {}", answer.body);
        booth.wait_for_look();
        wait_for_state(&booth, &site, "the light", |state| state["light"]["signal"] == "armed");
        booth.export(&format!("x{n}.obj"), &body(n));
        booth.wait_for("the scan", || {
            first_scan(&site.state_of(&site.operator()))["patients"][0] == seen
        });
        wait_for_state(&booth, &site, "its end", |state| state["light"]["signal"] == "done");
    }
    let long = "7".repeat(500);
    assert_eq!(decide(&site, &json!({"ask": "name_next", "patient": long})).status, 409);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_page_that_comes_later_is_told_of_what_was_decided_meanwhile() {
    let booth = booth("");
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let mut stream = site.stream(&[]);
    assert!(stream.next().is_some());
    drop(stream);
    assert_eq!(decide(&site, &json!({"ask": "pause"})).status, 200);
    assert!(site.stream(&[]).any(|state| state["paused"] == true));
    assert_eq!(daemon.stop().code(), Some(0));
}
