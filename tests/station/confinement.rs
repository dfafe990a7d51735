//! The real station on a kernel that lacks guards: it says so, and does not start where they are required.
//! The kernel's answers are those of a filter of system calls that the station's processes inherit.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;
use std::thread;

use rig::Booth;
use rig::verb::{code, stderr, stdout};
use rustix::process::{Pid, Signal, kill_process};
use seccompiler::{BpfProgram, SeccompAction, SeccompFilter, TargetArch};
use support::coarse_body;

/// Answers this thread, and every process that it starts, as a kernel would that does not know these calls.
fn kernel_without(calls: &[(i64, i32)]) {
    for (call, errno) in calls {
        let rules = BTreeMap::from([(*call, Vec::new())]);
        let unknown = SeccompAction::Errno(errno.cast_unsigned());
        let machine = TargetArch::try_from(std::env::consts::ARCH).unwrap();
        let filter = SeccompFilter::new(rules, SeccompAction::Allow, unknown, machine).unwrap();
        let program: BpfProgram = filter.try_into().unwrap();
        seccompiler::apply_filter(&program).unwrap();
    }
}

const NO_LANDLOCK: (i64, i32) = (libc::SYS_landlock_create_ruleset, libc::ENOSYS);
const NO_SECCOMP: (i64, i32) = (libc::SYS_seccomp, libc::EINVAL);

/// Plays on a thread of its own, whose kernel lacks these.
fn played_without(calls: &'static [(i64, i32)], play: impl FnOnce() + Send + 'static) {
    let played = thread::spawn(move || {
        kernel_without(calls);
        play();
    });
    played.join().unwrap();
}

fn required(booth: &Booth) {
    booth.reconfigure(|config| format!("{config}[measure]\nconfine = \"required\"\n"));
}

#[test]
fn a_station_whose_kernel_has_every_guard_says_so() {
    let booth = Booth::new();
    required(&booth);
    let daemon = booth.start_ready();
    assert!(booth.log().contains("event=\"confined\" by=\"landlock"), "{}", booth.log());
    let told = booth.status();
    assert_eq!(told["confinement"]["seccomp"], true);
    assert_ne!(told["confinement"]["landlock"], "not");
    assert!(!stdout(&booth.gaiter(&["status"])).contains("lack"));
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn a_station_without_landlock_measures_and_says_so_in_log_status_and_check() {
    played_without(&[NO_LANDLOCK], || {
        let booth = Booth::new();
        let daemon = booth.start();
        booth.export("4711_a.obj", &coarse_body(1));
        booth.wait_for_records(1);
        assert!(booth.log().contains("event=\"confinement-missing\" missing=\"landlock\""));
        assert_eq!(booth.status()["confinement"]["landlock"], "not");
        let shown = stdout(&booth.gaiter(&["status"]));
        assert!(shown.contains("measuring processes run without landlock, which"), "{shown}");
        let checked = booth.gaiter(&["check"]);
        let row =
            stdout(&checked).lines().find(|line| line.contains("confinement")).map(str::to_owned);
        let row = row.unwrap();
        assert!(row.contains("warn") && row.contains("no landlock"), "{row}");
        assert_eq!(code(&checked), Some(0));
        // Nor is a configuration taken up that requires it.
        required(&booth);
        let pid = Pid::from_raw(daemon.id().cast_signed()).unwrap();
        kill_process(pid, Signal::HUP).unwrap();
        // The log tells of it first.
        let refused = || booth.status()["refused_reload"].to_string();
        booth.wait_for("the refusal", || refused().contains("measure.confine"));
        assert!(booth.log().contains("configuration-refused"), "{}", booth.log());
        assert_eq!(daemon.stop().code(), Some(0));
    });
}

#[test]
fn where_confinement_is_required_a_station_without_either_guard_does_not_start() {
    for (lacking, missing) in [
        (&[NO_LANDLOCK][..], "no landlock"),
        (&[NO_SECCOMP][..], "no seccomp"),
        (&[NO_LANDLOCK, NO_SECCOMP][..], "no landlock and seccomp"),
    ] {
        played_without(lacking, move || {
            let booth = Booth::new();
            required(&booth);
            let ended = booth.gaiter(&["run"]);
            assert_eq!(code(&ended), Some(78), "{}", stderr(&ended));
            assert!(stderr(&ended).contains(missing), "{}", stderr(&ended));
            let checked = booth.gaiter(&["check"]);
            assert_eq!(code(&checked), Some(74));
            assert!(stdout(&checked).contains(missing), "{}", stdout(&checked));
        });
    }
}
