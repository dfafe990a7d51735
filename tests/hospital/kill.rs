//! A station that delivers to hospitals' servers, killed before every call that changes a file: each server has the
//! record once.

#![cfg(all(target_os = "linux", target_arch = "x86_64"))]
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

use rig::faults::matrix::{Struck, faults, restarted, strike_everywhere, struck_at_until, thinned};
use rig::faults::tracer::{CallFate, can_trace};
use rig::invariants::Moment;

use crate::server::{fhir, hl7};
use crate::station::HospitalStation;

/// Runs at a time: one waits while the other works.
const HANDS: usize = 3;

/// Fewer points than this and the matrix has not seen the delivery.
const POINTS_LEAST: usize = 60;

fn killed(place: &mut HospitalStation, nth: usize) -> Struck {
    place.renew();
    let finished = || place.is_delivered();
    let (at, run) = struck_at_until(&place.booth, finished, nth, CallFate::Kill, |_| CallFate::Do);
    let at = at?;
    let mut found = faults(&place.booth, Moment::Any);
    found.extend(run.hung.then(|| "it did not end".to_owned()));
    found.extend(place.twice());
    found.extend(restarted(&place.booth));
    found.extend(place.wrong());
    Some((at, found))
}

#[test]
#[ignore = "needs ptrace, Medplum's FHIR router and Python with hl7apy, run by .ci/run"]
fn a_station_killed_before_any_call_delivers_to_every_server_once() {
    assert!(can_trace());
    // Here, because a hand that traces waits for all that it started itself.
    fhir();
    hl7();
    let tally = strike_everywhere("kill -9 with servers", HANDS, 1, HospitalStation::new, killed);
    for (kind, times) in &tally.kinds {
        println!("  {times:4} {kind}");
    }
    assert!(tally.violations.is_empty(), "{:#?}", tally.violations);
    assert!(tally.points * thinned() >= POINTS_LEAST, "{} points", tally.points);
}
