//! The station killed before every call of a run that changes a file: nothing is lost, nothing is
//! delivered twice, nothing partial lies under a final name, and no scan under another's name.

#![cfg(all(target_os = "linux", target_arch = "x86_64"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use std::fs;

use rig::Booth;
use rig::day::Day;
use rig::faults::matrix::{
    DAY_HANDS, POINTS_MIN, Struck, Tally, booth, day_step, found_at_once, renew, restarted,
    strike_everywhere, struck_at, struck_at_until, thinned,
};
use rig::faults::tracer::{Call, CallFate, can_trace};

/// Runs at a time: one waits while the other works.
const HANDS: usize = 3;

/// With a button so many times fewer calls are struck: each run waits until the station is sure that it
/// hears every press.
const FEWER_WITH_BUTTON: usize = 2;

fn killed(booth: &mut Booth, nth: usize) -> Struck {
    renew(booth);
    let (at, run) = struck_at(booth, nth, CallFate::Kill, |_| CallFate::Do);
    let at = at?;
    let mut found = found_at_once(booth, &run);
    found.extend(restarted(booth));
    Some((at, found))
}

#[test]
#[ignore = "needs ptrace and minutes, run by .ci/run"]
fn a_station_killed_before_any_call_loses_nothing_and_delivers_nothing_twice() {
    assert!(can_trace());
    let tally = strike_everywhere("kill -9", HANDS, 1, booth, killed);
    assert_clean(&tally);
    assert!(tally.points * thinned() >= POINTS_MIN, "{} points", tally.points);
}

fn assert_clean(tally: &Tally) {
    for (kind, times) in &tally.kinds {
        println!("  {times:4} {kind}");
    }
    assert!(tally.violations.is_empty(), "{:#?}", tally.violations);
}

/// A day with names that is cut off once, and goes on.
fn killed_on_a_day(day: &mut Day, nth: usize) -> Struck {
    day.renew();
    let usual = |_: &Call| CallFate::Do;
    let (at, run) = struck_at_until(&day.booth, || day.goes_on(), nth, CallFate::Kill, usual);
    let Some(at) = at else {
        assert!(day.is_all_delivered(), "without a fault; log:\n{}", day.booth.log());
        return None;
    };
    let mut found = day.found_at_once(&run);
    found.extend(day.goes_on_restarted());
    Some((at, found))
}

#[test]
#[ignore = "needs ptrace and minutes, run by .ci/run"]
fn a_station_killed_on_a_day_with_names_gives_nobody_the_scan_of_another() {
    assert!(can_trace());
    let name = "kill -9 on a day with names";
    assert_clean(&strike_everywhere(
        name,
        DAY_HANDS,
        day_step(),
        Day::without_button,
        killed_on_a_day,
    ));
}

#[test]
#[ignore = "needs ptrace and minutes, run by .ci/run"]
fn a_station_with_a_button_killed_on_a_day_with_names_gives_nobody_the_scan_of_another() {
    assert!(can_trace());
    let name = "kill -9 on a day with names and a button";
    let step = day_step() * FEWER_WITH_BUTTON;
    assert_clean(&strike_everywhere(name, DAY_HANDS, step, Day::with_button, killed_on_a_day));
}

#[test]
fn a_day_without_a_fault_is_in_order_and_a_record_under_another_name_is_found() {
    let day = Day::without_button();
    assert_eq!(day.goes_on_restarted(), Vec::<String>::new());
    assert!(day.is_all_delivered());
    let records = day.booth.path("records");
    fs::rename(records.join("1002"), records.join("1001")).unwrap();
    assert_eq!(day.wrong_names(), ["second.obj of 1002 lies under 1001"]);
}
