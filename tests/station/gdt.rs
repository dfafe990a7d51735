//! The station and practice software, as real programs over real folders: an order comes in, a result
//! goes out, and nobody's name gets anywhere.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use gaiter_record::gdt::{Charset, message};
use rig::Booth;
use rig::verb::{code, stderr, stdout};
use rig::web::Site;
use serde_json::{Value, json};
use support::gdt_check;
use support::gdt_check::{checked, contents};
use support::{body, coarse_body};

/// What stands in orders and may appear nowhere.
const PLANTED: [&str; 3] = ["Quastenflosser", "Hammerhai", "03021960"];

/// A booth beside a practice whose software fetches results from one folder and puts orders into
/// another; `extra` goes into `[store.gdt]`.
pub fn practice(extra: &str) -> Booth {
    let booth = Booth::new();
    for folder in ["results", "orders"] {
        fs::create_dir(booth.path(folder)).unwrap();
    }
    let (results, orders) = (booth.path("results"), booth.path("orders"));
    booth.reconfigure(|text| {
        format!(
            "{text}[store.gdt]\npath = \"{}\"\n{extra}\n[patient.orders]\npath = \"{}\"\n\
             quiet = \"100ms\"\n",
            results.display(),
            orders.display()
        )
    });
    booth
}

fn order(kind: u16, id: &str) -> Vec<u8> {
    let fields = [
        (8315, "LEGSCAN1"),
        (8316, "PRAX_EDV"),
        (9206, "3"),
        (9218, "02.10"),
        (3000, id),
        (3101, "Quastenflosser"),
        (3102, "Hammerhai"),
        (3103, "03021960"),
        (8402, "ALLG00"),
    ];
    message(kind, Charset::Cp1252, &fields.map(|(field, text)| (field, text.to_owned()))).unwrap()
}

/// Puts an order into its folder in one step: of a slow writer the station would hear half.
fn put(booth: &Booth, name: &str, bytes: &[u8]) {
    let new = booth.path("new-order");
    fs::write(&new, bytes).unwrap();
    fs::rename(new, booth.path("orders").join(name)).unwrap();
}

pub fn visible(folder: &Path) -> Vec<PathBuf> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let hidden = |path: &PathBuf| path.file_name().unwrap().to_str().unwrap().starts_with('.');
    let mut paths: Vec<PathBuf> = paths.filter(|path| !hidden(path)).collect();
    paths.sort();
    paths
}

/// Waits for the next result and fetches it, as practice software does.
#[track_caller]
pub fn fetch(booth: &Booth) -> Vec<gdt_check::Line> {
    let waiting = || {
        let files = visible(&booth.path("results")).into_iter();
        files.filter(|path| path.is_file()).collect::<Vec<PathBuf>>()
    };
    booth.wait_for("a result", || !waiting().is_empty());
    let path = waiting().remove(0);
    let bytes = fs::read(&path).unwrap();
    fs::remove_file(path).unwrap();
    checked(&bytes)
}

#[track_caller]
fn events(booth: &Booth, event: &str) -> usize {
    booth.log().matches(event).count()
}

#[track_caller]
fn assert_nothing_planted(what: &str, text: &str) {
    for planted in PLANTED {
        assert!(!text.contains(planted), "{planted} is in {what}:\n{text}");
    }
}

#[test]
fn an_order_is_heard_once_and_deleted_and_one_that_is_none_is_set_aside() {
    let booth = practice("");
    let orders = booth.path("orders");
    fs::write(orders.join("PRAXLEGS.GDT"), order(6310, "4711")).unwrap();
    fs::write(orders.join("notes.txt"), "Quastenflosser").unwrap();
    let daemon = booth.start();
    put(&booth, "LEGSPRAX.GDT", &order(6302, "4711"));
    booth.wait_for("the patient", || events(&booth, "patient-named") == 1);
    booth.wait_for("its removal", || !orders.join("LEGSPRAX.GDT").exists());
    let mut cut = order(6302, "4711");
    cut.truncate(cut.len() - 30);
    put(&booth, "cut.gdt", &cut);
    let refused = booth.path("state/orders-refused");
    booth.wait_for("the refusal", || refused.exists() && !orders.join("cut.gdt").exists());
    let place = visible(&refused).remove(0);
    assert_eq!(fs::read(place.join("order.gdt")).unwrap(), cut);
    let reason = fs::read_to_string(place.join("reason.json")).unwrap();
    assert!(reason.contains("order-line-malformed"), "{reason}");
    let status = || stdout(&booth.gaiter(&["status", "--json"]));
    booth.wait_for("the alarm", || status().contains("order-refused"));
    // A good one follows; the alarm goes.
    put(&booth, "LEGSPRAX.GDT", &order(6302, "0815"));
    booth.wait_for("the next patient", || events(&booth, "patient-named") == 2);
    booth.wait_for("its end", || booth.status()["alarms"]["order-refused"].is_null());
    let status = status();
    assert!(!status.contains("order-refused"), "{status}");
    assert_eq!(daemon.stop().code(), Some(0));
    // What is another program's lies there as it did.
    let left: Vec<PathBuf> = visible(&orders);
    assert_eq!(left, ["PRAXLEGS.GDT", "notes.txt"].map(|name| orders.join(name)));
    let told = [reason, status, booth.log()].concat();
    assert_nothing_planted("what the station tells", &told);
    for id in ["4711", "0815"] {
        assert!(!booth.log_names(id), "{}", booth.log());
    }
}

#[test]
fn a_kept_order_is_not_heard_again_after_a_restart_and_an_old_one_never() {
    let booth = practice("");
    booth.reconfigure(|text| text + "after = \"keep\"\n");
    let orders = booth.path("orders");
    let old = orders.join("old.gdt");
    fs::write(&old, order(6302, "0815")).unwrap();
    let yesterday = std::time::SystemTime::now() - std::time::Duration::from_secs(24 * 3600);
    fs::File::options().write(true).open(&old).unwrap().set_modified(yesterday).unwrap();
    fs::write(orders.join("new.gdt"), order(6302, "4711")).unwrap();
    let daemon = booth.start();
    booth.wait_for("the patient", || events(&booth, "patient-named") == 1);
    booth.wait_for("the old one", || events(&booth, "order-too-old") == 1);
    assert_eq!(daemon.stop().code(), Some(0));
    let daemon = booth.start();
    booth.wait_for("the start", || events(&booth, "station-ready") == 2);
    put(&booth, "third.gdt", &order(6302, "4712"));
    booth.wait_for("the third", || events(&booth, "patient-named") == 2);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_eq!((events(&booth, "patient-named"), events(&booth, "order-too-old")), (2, 1));
    assert_eq!(visible(&orders).len(), 3);
    assert_nothing_planted("the log", &booth.log());
}

#[test]
fn an_order_is_brought_by_the_program_that_the_practice_software_starts() {
    let booth = practice("");
    let daemon = booth.start();
    booth.wait_for("the start", || events(&booth, "station-ready") == 1);
    let file = booth.path("order.gdt");
    let bring = |bytes: &[u8]| {
        fs::write(&file, bytes).unwrap();
        booth.gaiter(&["gdt-order", file.to_str().unwrap()])
    };
    let good = bring(&order(6302, "4711"));
    assert_eq!(good.status.code(), Some(0), "{}", stderr(&good));
    assert!(stdout(&good).contains("next export belongs to this patient"), "{}", stdout(&good));
    assert_eq!(events(&booth, "patient-named"), 1);
    let long = [order(6302, "4711"), vec![b' '; 13_000]].concat();
    for (bytes, why) in [(order(6301, "4711"), "a message 6301"), (long, "at most 12288")] {
        let refused = bring(&bytes);
        assert_eq!(refused.status.code(), Some(64));
        assert!(stderr(&refused).contains(why), "{}", stderr(&refused));
        assert_nothing_planted("a refusal", &stderr(&refused));
    }
    assert!(file.exists() && events(&booth, "patient-named") == 1);
    let missing = booth.gaiter(&["gdt-order", booth.path("gone.gdt").to_str().unwrap()]);
    assert_eq!(missing.status.code(), Some(66));
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn every_named_record_is_handed_over_once_across_restarts_and_a_lost_journal() {
    let booth = practice("attach = [\"svg/legs.svg\"]\nattach_as = '\\\\srv\\gdt'");
    let daemon = booth.start();
    booth.export("4711_a.obj", &coarse_body(1));
    // Nobody's goes into the folder alone.
    booth.export("unnamed.obj", &coarse_body(2));
    booth.wait_for_records(2);
    let result = fetch(&booth);
    assert_eq!(contents(&result, "8000"), ["6310"]);
    assert_eq!(contents(&result, "3000"), ["4711"]);
    let blocks = contents(&result, "8410");
    for ident in ["LB_L", "LB1_L", "LC_L", "LD_L", "LB_R", "LB1_R", "LC_R", "LD_R", "HB_L", "HC_R"]
    {
        assert!(blocks.iter().any(|its| its == ident), "{ident} is missing: {blocks:?}");
    }
    let attached = contents(&result, "6305").remove(0);
    let name = attached.strip_prefix(r"\\srv\gdt\svg\").unwrap();
    assert!(fs::read(booth.path("results/svg").join(name)).unwrap().starts_with(b"<"));
    // The figures are the record's.
    let record = booth.records().into_iter().find(|(patient, _)| patient == "4711").unwrap();
    let folder = visible(&booth.path("records").join(&record.0)).remove(0);
    let json = fs::read(folder.join("record.json")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let left = &json["legs"].as_array().unwrap().iter().find(|leg| leg["side"] == "left").unwrap();
    let girth_mm = left["landmarks"]["C"]["girth_tape_mm"].as_f64().unwrap();
    let place = blocks.iter().position(|ident| ident == "LC_L").unwrap();
    let told_cm: f64 = contents(&result, "8420")[place].parse().unwrap();
    assert!((told_cm * 10.0 - girth_mm).abs() <= 0.5 + 1e-9, "{told_cm} cm, {girth_mm} mm");
    // The unassigned scan and a restart hand nothing over; neither does a lost journal.
    assert_eq!(daemon.stop().code(), Some(0));
    for file in ["journal.db", "journal.db-wal", "journal.db-shm", "history.head"] {
        let _ = fs::remove_file(booth.path("state").join(file));
    }
    let daemon = booth.start();
    booth.export("4712_b.obj", &coarse_body(3));
    assert_eq!(contents(&fetch(&booth), "3000"), ["4712"]);
    let gdt = "SELECT count(*) FROM deliveries WHERE store = 'gdt' AND state = 'delivered'";
    booth.wait_for_journal(gdt, 2);
    assert_eq!(daemon.stop().code(), Some(0));
    let svg = booth.path("results/svg");
    assert_eq!(visible(&booth.path("results")), [svg], "everything was fetched once");
    assert_eq!(
        booth.journal("SELECT count(*) FROM deliveries WHERE state <> 'delivered'"),
        Some(0)
    );
}

#[test]
fn a_result_that_nobody_fetched_is_no_fault_and_the_next_patients_scan_is_done() {
    let booth = practice("file_name = \"{receiver}{sender}.GDT\"");
    booth.reconfigure(|config| format!("{config}[status]\nlisten = \"127.0.0.1:0\"\n"));
    let daemon = booth.start();
    let site = Site::open(&booth, "local");
    booth.export("4711_a.obj", &body(1));
    let results = booth.path("results");
    booth.wait_for("the first", || !visible(&results).is_empty());
    let state = || site.state_of(&site.operator());
    for (n, id) in [(2, "4712"), (3, "4713")] {
        booth.export(&format!("{id}_b.obj"), &body(n));
        let said = format!("The record of {id} is stored. The patient may get dressed.");
        booth.wait_for("done at the light", || state()["light"]["sentence"] == said);
        let newest = state()["scans"][0].clone();
        assert_eq!(newest["patients"][0], id);
        assert_eq!(newest["word"], "Stored, to be fetched");
    }
    let notice = |state: &Value| state["complaints"][0].clone();
    booth.wait_for("the notice", || notice(&state())["code"] == "result-not-fetched");
    assert_eq!(notice(&state())["severity"], "notice");
    let gdt =
        state()["parts"].as_array().unwrap().iter().find(|of| of["health"] == "wait").cloned();
    assert_eq!(gdt.unwrap()["word"], "waits until the last result is fetched");
    let told = booth.gaiter(&["status"]);
    assert!(code(&told) == Some(0) && stdout(&told).contains("ready\nnote: "), "{}", stdout(&told));
    assert_eq!(site.get("/healthz", &[]).status, 200);
    assert_eq!(contents(&fetch(&booth), "3000"), ["4711"]);
    let others = [fetch(&booth), fetch(&booth)].map(|lines| contents(&lines, "3000"));
    assert_eq!(
        BTreeSet::from(others),
        [["4712".to_owned()], ["4713".to_owned()]].map(Vec::from).into()
    );
    booth.wait_for("the end of the notice", || state()["complaints"] == json!([]));
    booth.wait_for("the last result", || state()["scans"][0]["word"] == "Stored");
    assert_eq!(daemon.stop().code(), Some(0));
    assert!(!booth.log_names("4711") && !booth.log_names("4712"), "{}", booth.log());
}
