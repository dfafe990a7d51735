//! Size tables of a running station: what its reports show, and a table that becomes bad or new.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::PathBuf;

use rustix::process::{Pid, Signal, kill_process};
use support::{Booth, coarse_body, names, sha256};

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
    let refused = booth.status()["refused_reload"].to_string();
    assert!(refused.contains(&format!("{at}:38:6: size.I.cB")), "{refused}");
    booth.export("1_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    let old = hash(&EXAMPLE.replace("2027-01-31", "2026-01-31"));
    let page = report(&booth, "1");
    assert!(page.contains(&old) && page.contains("EXPIRED"), "the table of the start counts");

    fs::write(&table, EXAMPLE).unwrap();
    reload("configuration-reloaded");
    booth.export("2_a.obj", &coarse_body(2));
    booth.wait_for_records(2);
    let page = report(&booth, "2");
    assert!(page.contains(&hash(EXAMPLE)) && !page.contains("EXPIRED"), "the new one counts");
    assert!(booth.status()["refused_reload"].is_null());
    assert_eq!(daemon.stop().code(), Some(0));
}
