//! The station killed before every call of a run that changes a file: nothing is lost, nothing is
//! delivered twice, nothing partial lies under a final name.

#![cfg(all(target_os = "linux", target_arch = "x86_64"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

#[path = "support/matrix.rs"]
mod matrix;

use matrix::station::Booth;
use matrix::tracer::{Answer, can_trace};
use matrix::{
    POINTS_MIN, Struck, booth, found_at_once, renew, restarted, strike_everywhere, struck_at,
};

/// Runs at a time: one waits while the other works.
const HANDS: usize = 3;

fn killed(booth: &mut Booth, nth: usize) -> Struck {
    renew(booth);
    let (at, run) = struck_at(booth, nth, Answer::Kill, |_| Answer::Do);
    let at = at?;
    let mut found = found_at_once(booth, &run);
    found.extend(restarted(booth));
    Some((at, found))
}

#[test]
#[ignore = "needs ptrace and minutes, run by .ci/run"]
fn a_station_killed_before_any_call_loses_nothing_and_delivers_nothing_twice() {
    if !can_trace() {
        return;
    }
    let tally = strike_everywhere("kill -9", HANDS, 1, booth, killed);
    for (kind, times) in &tally.kinds {
        println!("  {times:4} {kind}");
    }
    assert!(tally.violations.is_empty(), "{:#?}", tally.violations);
    assert!(tally.points >= POINTS_MIN, "{} points", tally.points);
}
