//! The life of the real program: what the service manager is told, a configuration that changes, a
//! second store.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::io::ErrorKind;
use std::os::unix::net::UnixDatagram;
use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use rig::faults::disk;
use rig::{Booth, PATIENCE, names, sha256};
use rustix::process::{Pid, Signal, kill_process};
use support::coarse_body;

/// A service manager that listens, and a station that tells it.
struct Manager {
    socket: UnixDatagram,
    station: Child,
}

impl Manager {
    fn start(booth: &Booth, more: impl FnOnce(&mut Command)) -> Manager {
        let path = booth.path("notify");
        let socket = UnixDatagram::bind(&path).unwrap();
        socket.set_read_timeout(Some(PATIENCE)).unwrap();
        let mut command = booth.command();
        command.env("NOTIFY_SOCKET", &path);
        more(&mut command);
        Manager { socket, station: command.spawn().unwrap() }
    }

    /// What is told next.
    fn told(&self) -> Vec<String> {
        let mut message = [0; 512];
        let length = loop {
            match self.socket.recv(&mut message) {
                // The machine, or this process, was stopped and goes on.
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                received => break received.unwrap(),
            }
        };
        let message = String::from_utf8_lossy(&message[..length]).into_owned();
        message.lines().map(str::to_owned).collect()
    }

    /// Waits until it is told that.
    fn wait_for(&self, wanted: &str) -> Vec<String> {
        self.wait_until(|line| line == wanted)
    }

    /// Waits until it is told a line like that.
    fn wait_until(&self, is_wanted: impl Fn(&str) -> bool) -> Vec<String> {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let told = self.told();
            if told.iter().any(|line| is_wanted(line)) {
                return told;
            }
            // It is told again and again that the station is alive.
            assert!(Instant::now() < deadline, "the last that it was told is {told:?}");
        }
    }

    /// What it was told by now and has not heard yet.
    fn heard(&self) -> Vec<String> {
        self.socket.set_nonblocking(true).unwrap();
        let mut message = [0; 512];
        let mut heard = Vec::new();
        while let Ok(length) = self.socket.recv(&mut message) {
            heard.push(String::from_utf8_lossy(&message[..length]).into_owned());
        }
        self.socket.set_nonblocking(false).unwrap();
        heard
    }

    fn signal(&self, signal: Signal) {
        kill_process(Pid::from_child(&self.station), signal).unwrap();
    }
}

impl Drop for Manager {
    fn drop(&mut self) {
        let _ = self.station.kill();
        let _ = self.station.wait();
    }
}

/// A second store in this folder.
fn with_copy(booth: &Booth, folder: &Path) {
    let copy = format!("[store.copy]\npath = \"{}\"\n[store.folder]", folder.display());
    booth.reconfigure(|text| text.replace("[store.folder]", &copy));
}

#[test]
fn a_reload_is_told_from_its_beginning_to_its_end_and_takes_up_the_new_configuration() {
    let booth = Booth::new();
    let mut manager = Manager::start(&booth, |_| {});
    manager.wait_for("READY=1");
    let other = booth.path("other");
    fs::create_dir(&other).unwrap();
    with_copy(&booth, &other);
    manager.signal(Signal::HUP);
    let told = manager.wait_for("RELOADING=1");
    assert!(told.iter().any(|line| line.starts_with("MONOTONIC_USEC=")), "{told:?}");
    manager.wait_for("READY=1");
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    booth.wait_for("the copy", || names(&other.join("4711")).len() == 1);
    manager.signal(Signal::TERM);
    manager.wait_for("STOPPING=1");
    assert_eq!(manager.station.wait().unwrap().code(), Some(0));
}

#[test]
fn a_configuration_with_a_fault_is_refused_as_a_whole_and_the_old_one_holds() {
    let booth = Booth::new();
    let mut manager = Manager::start(&booth, |_| {});
    manager.wait_for("READY=1");
    // What is not heard fills the socket, and the station would wait for its manager.
    let hears = || drop(manager.heard());
    let good = fs::read_to_string(booth.path("station.toml")).unwrap();
    let moved = good.replace("/state\"", "/elsewhere\"");
    for bad in [good.replace("quiet = ", "quite = "), moved] {
        fs::write(booth.path("station.toml"), bad).unwrap();
        let refusals = booth.log().matches("configuration-refused").count();
        manager.signal(Signal::HUP);
        booth.wait_for("the refusal", || {
            hears();
            booth.log().matches("configuration-refused").count() > refusals
        });
    }
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for("the record", || {
        hears();
        booth.records().len() == 1
    });
    assert_eq!(booth.log().matches("station-open").count(), 1, "{}", booth.log());
    hears();
    manager.signal(Signal::TERM);
    manager.wait_for("STOPPING=1");
    assert_eq!(manager.station.wait().unwrap().code(), Some(0));
}

#[test]
fn the_watchdog_is_fed_at_half_its_time() {
    let booth = Booth::new();
    // Before the station: what it told while this test was kept waiting is heard in one go.
    let began = Instant::now();
    let manager = Manager::start(&booth, |command| {
        command.env("WATCHDOG_USEC", "400000");
    });
    for _ in 0..10 {
        manager.wait_for("WATCHDOG=1");
    }
    // Between ten beats are nine pauses of 200 ms; a machine that is busy only makes them longer.
    assert!(began.elapsed() >= Duration::from_millis(1800), "{:?}", began.elapsed());
}

#[test]
#[ignore = "needs root and a loop device, run by .ci/run"]
fn the_watchdog_starves_while_a_worker_hangs_and_is_fed_again_when_it_turns() {
    assert!(disk::can_be_cut());
    let booth = Booth::new();
    fs::create_dir(booth.path("state")).unwrap();
    let state = disk::Disk::new(booth.path("state"));
    booth.reconfigure(|config| config.replace("[station]", "[station]\ndisk_floor = \"0B\""));
    let manager = Manager::start(&booth, |command| {
        command.env("WATCHDOG_USEC", "400000");
    });
    manager.wait_for("WATCHDOG=1");
    let frozen = state.freeze();
    booth.export("4711_a.obj", &coarse_body(1));
    let hangs = || booth.log().matches("worker-hangs").count();
    // What is not heard fills the socket, and the station would wait for its manager.
    booth.wait_for("the hanging worker", || {
        manager.heard();
        hangs() > 0
    });
    // It may have been fed between the last hearing and the first hang.
    manager.heard();
    let (then, mut heard) = (hangs(), Vec::new());
    booth.wait_for("ten more beats", || {
        heard.extend(manager.heard());
        hangs() >= then + 10
    });
    assert!(!heard.iter().any(|told| told.contains("WATCHDOG=1")), "{heard:?}");
    drop(frozen);
    manager.wait_for("WATCHDOG=1");
    booth.wait_for_records(1);
    drop(manager);
}

#[test]
fn the_service_manager_is_told_in_one_line_how_the_station_is() {
    let booth = Booth::new();
    let manager = Manager::start(&booth, |_| {});
    booth.export("4711_0.obj", &coarse_body(0));
    booth.wait_for_records(1);
    manager.wait_for("STATUS=ready; 0 records to be delivered");
    booth.take_records_away();
    fs::create_dir(booth.path("records")).unwrap();
    booth.export("4711_a.obj", &coarse_body(1));
    let told = manager.wait_until(|line| line.starts_with("STATUS=not ready"));
    assert_eq!(
        told,
        ["STATUS=not ready: store-fault; 1 records to be delivered; see gaiter status"]
    );
}

#[test]
fn a_store_that_is_away_does_not_keep_the_other_from_its_records_and_gets_its_own_later() {
    let booth = Booth::new();
    let other = booth.path("mnt");
    with_copy(&booth, &other);
    let daemon = booth.start();
    booth.wait_until_begun("copy");
    fs::rename(&other, booth.path("unmounted")).unwrap();
    fs::create_dir(&other).unwrap();
    let scans: Vec<Vec<u8>> = (0..3).map(coarse_body).collect();
    for (n, bytes) in scans.iter().enumerate() {
        booth.export(&format!("4711_{n}.obj"), bytes);
    }
    booth.wait_for_records(3);
    booth.wait_for("the outage", || booth.log().contains("store-unavailable"));
    assert_eq!(names(&other), [""; 0], "nothing is written into the empty place");
    fs::remove_dir(&other).unwrap();
    fs::rename(booth.path("unmounted"), &other).unwrap();
    booth.wait_for_journal("SELECT count(*) FROM deliveries WHERE state = 'delivered'", 6);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_eq!(names(&other.join("4711")).len(), 3);
    assert_eq!(names(&booth.path("state/spool")), [""; 0]);
    assert!(booth.log().contains(&sha256(&scans[0])[..8]));
}
