//! Size tables and order files of a running station: what its reports show, a table that becomes bad or new, and
//! where the files of an order go.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::PathBuf;

use rig::verb::{code, stderr};
use rig::{Booth, names, sha256};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use support::coarse_body;
use support::gdt_check::contents;

use crate::gdt::{fetch, practice, visible};

const EXAMPLE: &str = include_str!("../../config/sizes/invented-example.toml");

/// The report of the only record of a patient.
fn report(booth: &Booth, patient: &str) -> String {
    let folder: PathBuf = booth.path("records").join(patient);
    let [name] = names(&folder).try_into().unwrap();
    fs::read_to_string(folder.join(name).join("report.html")).unwrap()
}

/// The first digits of a table's hash, as reports print them.
fn hash(table: &str) -> String {
    sha256(table.as_bytes())[..12].to_owned()
}

#[test]
fn a_table_that_becomes_bad_is_refused_with_its_place_and_the_old_one_holds_until_it_is_mended() {
    let booth = Booth::new();
    let table = booth.path("maker.toml");
    fs::write(&table, EXAMPLE.replace("2027-01-31", "2026-01-31")).unwrap();
    let at = table.display().to_string();
    booth.reconfigure(|text| format!("{text}[sizes]\ntables = [\"{at}\"]\n"));
    let daemon = booth.start_ready();
    let expired = "event=\"size-table-expired\" table=\"example-invented\"";
    assert!(booth.log().contains(expired), "{}", booth.log());
    let pid = Pid::from_raw(daemon.id().cast_signed()).unwrap();
    let reload = |told: &str| {
        let before = booth.log().matches(told).count();
        kill_process(pid, Signal::HUP).unwrap();
        booth.wait_for(told, || booth.log().matches(told).count() > before);
    };

    fs::write(&table, EXAMPLE.replace("[18, 20]", "[20, 18]")).unwrap();
    reload("configuration-refused");
    // The log tells of it first.
    let refused = || booth.status()["refused_reload"].to_string();
    let fault = format!("{at}:38:6: size.I.cB");
    booth.wait_for("the place of the fault", || refused().contains(&fault));
    booth.export("1_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    let old = hash(&EXAMPLE.replace("2027-01-31", "2026-01-31"));
    let page = report(&booth, "1");
    assert!(page.contains(&old) && page.contains("EXPIRED"), "the table of the start counts");

    fs::write(&table, EXAMPLE).unwrap();
    // Until it is ready again, the one with the old table may take an export.
    reload("station-ready");
    booth.export("2_a.obj", &coarse_body(2));
    booth.wait_for_records(2);
    let page = report(&booth, "2");
    assert!(page.contains(&hash(EXAMPLE)) && !page.contains("EXPIRED"), "the new one counts");
    assert!(booth.status()["refused_reload"].is_null());
    assert_eq!(daemon.stop().code(), Some(0));
}

/// A practice with a second folder of records, which gets a mapping's file as an attachment.
fn practice_with_orders() -> Booth {
    let booth = practice("attach = [\"files/order-example-points.csv\"]\nattach_as = \"name\"");
    let mapping = booth.path("mapping.toml");
    fs::write(&mapping, include_str!("../../config/orders/example-points.toml")).unwrap();
    fs::create_dir(booth.path("copy")).unwrap();
    let (copy, mapping) = (booth.path("copy"), mapping.display().to_string());
    booth.reconfigure(|text| {
        format!(
            "{text}[store.copy]\npath = \"{}\"\n[orders]\nmappings = [\"{mapping}\"]\n",
            copy.display()
        )
    });
    booth
}

#[test]
fn the_files_of_an_order_go_to_every_store_and_a_correction_makes_them_anew() {
    const FILES: [&str; 4] =
        ["order.csv", "order.json", "order-example-points.csv", "order-spreadsheet.csv"];
    let booth = practice_with_orders();
    let daemon = booth.start();
    let bytes = coarse_body(1);
    booth.export("4711_a.obj", &bytes);
    let result = fetch(&booth);
    let attached = contents(&result, "6305").remove(0);
    let stored = |store: &str| visible(&booth.path(store).join("4711")).pop().unwrap();
    let delivered = "SELECT count(*) FROM deliveries WHERE state = 'delivered'";
    booth.wait_for_journal(delivered, 3);
    let sums = fs::read_to_string(stored("records").join("SHA256SUMS")).unwrap();
    for name in FILES {
        let file = fs::read(stored("records").join(name)).unwrap();
        assert_eq!(file, fs::read(stored("copy").join(name)).unwrap(), "{name}");
        assert!(sums.contains(&format!("{}  {name}\n", sha256(&file))), "{name}");
        assert!(!String::from_utf8(file).unwrap().contains("4711"), "{name}");
    }
    let of_practice = fs::read(booth.path("results/files").join(attached)).unwrap();
    assert_eq!(of_practice, fs::read(stored("records").join(FILES[2])).unwrap());

    let what = ["--leg", "right", "--level", "C", "--girth-cm", "40.1", "--sure"];
    let said = ["--reason", "swollen", "--by", "Anna Berg"];
    let set = booth.gaiter(&[&["amend", &sha256(&bytes)[..8]][..], &what, &said].concat());
    assert_eq!(code(&set), Some(0), "{}", stderr(&set));
    fetch(&booth);
    booth.wait_for("the revision", || visible(&booth.path("copy").join("4711")).len() == 2);
    for store in ["records", "copy"] {
        let order: Value =
            serde_json::from_slice(&fs::read(stored(store).join("order.json")).unwrap()).unwrap();
        assert_eq!(order["record"]["revision"], 2);
        let rows = order["rows"].as_array().unwrap().iter();
        let c: Vec<f64> = rows
            .filter(|row| row["side"] == "right" && row["point"] == "C")
            .map(|row| row["girth"]["mm"].as_f64().unwrap())
            .collect();
        assert!(c.len() == 2 && (c[0] - 401.0).abs() > 1.0 && c[1] == 401.0, "{c:?}");
    }
    assert_eq!(daemon.stop().code(), Some(0));
}
