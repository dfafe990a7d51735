//! The station's own memory, limited as its unit does it, under floods: files, companions and orders by
//! the ten thousand. A station that went over the limit would abort.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use std::fs;
use std::time::Instant;

use gaiter_record::gdt::{Charset, message};
use rig::invariants::PutKind;
use rig::{Booth, Daemon};
use support::coarse_body;

/// Of each kind.
const FLOOD: usize = 20_000;

const UNIT: &str = include_str!("../../systemd/gaiter.service");

/// The value of a setting of the unit.
fn unit(setting: &str) -> &'static str {
    let line = UNIT.lines().find_map(|line| line.strip_prefix(setting)).unwrap();
    line.trim_start_matches('=')
}

/// The station as the unit starts it, as far as memory goes.
fn start(booth: &Booth) -> Daemon {
    let soft = unit("LimitDATA").split(':').next().unwrap();
    let bytes: u64 = soft.strip_suffix('G').unwrap().parse::<u64>().unwrap() << 30;
    let limit = format!("--data={bytes}:");
    let mut command = booth.command_behind(&["prlimit", &limit]);
    let (name, value) = unit("Environment").split_once('=').unwrap();
    let daemon = Daemon::start({
        command.env(name, value);
        command
    });
    booth.wait_for("the station", || booth.log().contains("station-ready"));
    daemon
}

/// The most memory that the station's own process has had, kB.
fn most_kb(daemon: &Daemon) -> u64 {
    let status = fs::read_to_string(format!("/proc/{}/status", daemon.id())).unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    line.trim().trim_end_matches(" kB").parse().unwrap()
}

/// It goes on, tells how it is, and ends as it was asked to.
fn is_well(booth: &Booth, daemon: Daemon, what: &str, began: Instant) {
    println!("{what}: at most {} MB, {:.0?}", most_kb(&daemon) / 1000, began.elapsed());
    assert!(!booth.gaiter(&["status", "--json"]).stdout.is_empty(), "{}", booth.log());
    assert!(!booth.log().contains("worker-hangs"), "{}", booth.log());
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
#[ignore = "takes minutes, run by .ci/run"]
fn files_and_companions_by_the_ten_thousand() {
    let (booth, began) = (Booth::new(), Instant::now());
    let daemon = start(&booth);
    for n in 0..FLOOD {
        let name = format!("{}.c{n:05}", n % 5);
        booth.export(&name, b"beside\n");
        booth.has_put(&name, b"beside\n", PutKind::Beside);
        fs::write(booth.path("export").join(format!("junk_{n}.obj")), format!("{n}\n")).unwrap();
    }
    for n in 0..5 {
        booth.export(&format!("{n}.obj"), &coarse_body(n));
    }
    booth.wait_for_records(5);
    is_well(&booth, daemon, "files and companions", began);
}

#[test]
#[ignore = "takes minutes, run by .ci/run"]
fn orders_by_the_ten_thousand() {
    let (booth, began) = (Booth::new(), Instant::now());
    let orders = booth.path("orders");
    fs::create_dir(&orders).unwrap();
    let folder = orders.display();
    let lines = format!("[patient.orders]\npath = \"{folder}\"\nquiet = \"1s\"\n");
    booth.reconfigure(|config| config + &lines);
    for n in 0..FLOOD {
        let fields = [
            (8315, "LEGSCAN1".to_owned()),
            (8316, "PRAX_EDV".to_owned()),
            (9206, "3".to_owned()),
            (9218, "02.10".to_owned()),
            (3000, (100_000 + n).to_string()),
        ];
        let bytes = message(6302, Charset::Cp1252, &fields).unwrap();
        fs::write(orders.join(format!("{n}.gdt")), bytes).unwrap();
    }
    let daemon = start(&booth);
    booth.wait_for("a crowd", || booth.log().contains("names-too-many"));
    // While the orders are read the station takes scans in, and gives none of them to anybody.
    booth.export("scan.obj", &coarse_body(1));
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'held'", 1);
    is_well(&booth, daemon, "orders", began);
}
