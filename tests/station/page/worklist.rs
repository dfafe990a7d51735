//! The worklist on the page: who may ask for it, and that a station works without it.

use rig::web::Header;

use super::*;

/// A server that is not there.
const AWAY: &str = "[patient.worklist]\naddress = \"127.0.0.1:1\"\nserver_ae_title = \"RIS\"\nencryption = \"none\"\n";

fn asked(site: &Site, headers: &[Header]) -> HttpAnswer {
    site.post("/worklist", "{\"anew\":true}", headers)
}

#[test]
fn while_the_worklist_is_away_the_station_is_ready_and_patients_are_named_as_without_it() {
    let booth = booth(AWAY);
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    booth.wait_for("the attempt", || booth.log().contains("event=\"worklist-out-of-reach\""));
    let state = site.state_of(&site.operator());
    let parts = state["parts"].as_array().unwrap();
    let part = parts.iter().find(|part| part["name"] == "Worklist").unwrap();
    assert_eq!((&part["health"], &part["word"]), (&"bad".into(), &"does not answer".into()));
    let told = booth.gaiter(&["status", "--json"]);
    assert_eq!(code(&told), Some(0), "{}", stdout(&told));
    let status: Value = serde_json::from_str(&stdout(&told)).unwrap();
    assert!(status["worklist"]["fault"].is_string() && status["worklist"]["answered"].is_null());
    booth.export("4711_a.obj", &coarse_body(0));
    booth.wait_for_records(1);
    let named = json!({ "ask": "name_next", "patient": "4712", "replace": false });
    assert_eq!(decide(&site, &named).status, 200);
    let next = stdout(&booth.gaiter(&["patient", "show"]));
    assert!(next.contains("4712"), "{next}");
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn only_who_shows_the_token_is_told_of_the_worklist() {
    let booth = booth(AWAY);
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    let operator = site.operator();
    let answer = asked(&site, &operator);
    assert_eq!((answer.status, answer.body.as_str()), (200, "{\"entries\":null}"));
    assert_eq!(asked(&site, &[]).status, 403, "another page of this machine");
    let without_token: Vec<Header> =
        operator.iter().filter(|(name, _)| *name != "Authorization").cloned().collect();
    assert_eq!(asked(&site, &without_token).status, 401);
    assert_eq!(site.get("/worklist", &operator).status, 405);
    // The page that may ask learns when there is something new; nobody else does.
    assert!(site.state_of(&operator)["worklist"].is_string());
    for query in ["/state", "/state?kiosk"] {
        let state: Value = serde_json::from_str(&site.get(query, &[]).body).unwrap();
        assert!(state["worklist"].is_null(), "{query}");
    }
    let gone = json!({ "ask": "name_listed", "entry": "0123456789abcdef", "replace": true });
    let refused = decide(&site, &gone);
    let said: Value = serde_json::from_str(&refused.body).unwrap();
    assert_eq!((refused.status, &said["code"]), (409, &"worklist-entry-gone".into()));
    assert_eq!(daemon.stop().code(), Some(0));
    // Where operators see no ids, they see no names.
    booth.reconfigure(|config| format!("{config}[page]\npatient_ids = \"nobody\"\n"));
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    assert_eq!(asked(&site, &site.operator()).status, 403);
    assert!(site.state_of(&site.operator())["worklist"].is_null());
    assert_eq!(daemon.stop().code(), Some(0));
}
