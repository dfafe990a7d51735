//! The station killed before every call of a run that changes a file: nothing is lost, nothing is
//! delivered twice, nothing partial lies under a final name.

#![cfg(all(target_os = "linux", target_arch = "x86_64"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

#[path = "support/matrix.rs"]
mod matrix;

use matrix::station::Booth;
use matrix::station::invariants::Moment;
use matrix::tracer::{Answer, Kind};
use matrix::{
    Struck, acknowledged, booth, faults, renew, restarted, strike_everywhere, struck, what,
};

/// Runs at a time: one waits while the other works.
const HANDS: usize = 2;

/// Fewer points than this and the matrix has not seen the run.
const POINTS_MIN: usize = 150;

fn killed(booth: &mut Booth, nth: usize) -> Struck {
    renew(booth);
    let mut at = None;
    let mut count = 0;
    let run = struck(booth, |call| {
        // A changed mode is nothing that a crash could leave half done.
        if call.kind == Kind::Mode {
            return Answer::Do;
        }
        count += 1;
        if count == nth {
            at = Some(what(booth, call));
            return Answer::Kill;
        }
        Answer::Do
    });
    let mut found = acknowledged(booth);
    found.extend(faults(booth, Moment::Any));
    if run.hung {
        found.push("it did not end".to_owned());
    }
    found.extend(restarted(booth));
    at.map(|at| (at, found))
}

#[test]
#[ignore = "needs ptrace and minutes, run by .ci/run"]
fn a_station_killed_before_any_call_loses_nothing_and_delivers_nothing_twice() {
    let tally = strike_everywhere("kill -9", HANDS, 1, booth, killed);
    for (kind, times) in &tally.kinds {
        println!("  {times:4} {kind}");
    }
    assert!(tally.violations.is_empty(), "{:#?}", tally.violations);
    assert!(tally.points >= POINTS_MIN, "{} points", tally.points);
}
