//! A station that delivers to hospitals' servers, killed before every call that changes a file: each server has the
//! record once.

#![cfg(all(target_os = "linux", target_arch = "x86_64"))]
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

use rig::faults::matrix::{
    Struck, Tally, faults, restarted, strike_everywhere, struck_at_until, thinned,
};
use rig::faults::tracer::{CallFate, can_trace};
use rig::invariants::Moment;

use crate::dicom_house::Way;
use crate::orthanc::Orthanc;
use crate::server::{dicom, fhir, hl7};
use crate::station::{ArchiveStation, Delivering, HospitalStation};

/// Runs at a time: one waits while the other works.
const HANDS: usize = 3;

/// Fewer points than this and a matrix has not seen the delivery to three servers, or to one.
const POINTS_LEAST: [usize; 2] = [60, 30];

fn killed(place: &mut impl Delivering, nth: usize) -> Struck {
    place.renew();
    let finished = || place.is_delivered();
    let (at, run) = struck_at_until(place.booth(), finished, nth, CallFate::Kill, |_| CallFate::Do);
    let at = at?;
    let mut found = faults(place.booth(), Moment::Any);
    found.extend(run.hung.then(|| "it did not end".to_owned()));
    found.extend(place.twice());
    found.extend(restarted(place.booth()));
    found.extend(place.wrong());
    Some((at, found))
}

#[test]
#[ignore = "needs ptrace, Medplum's FHIR router and Python with hl7apy and pynetdicom, run by .ci/run"]
fn a_station_killed_before_any_call_delivers_to_every_server_once() {
    assert!(can_trace());
    // Here, because a hand that traces waits for all that it started itself.
    fhir();
    hl7();
    dicom();
    let tally = strike_everywhere("kill -9 with servers", HANDS, 1, HospitalStation::new, killed);
    holds(&tally, POINTS_LEAST[0]);
}

#[test]
#[ignore = "needs ptrace and Orthanc in a network of its own, run by .ci/run"]
fn orthanc_has_the_record_of_a_station_killed_before_any_call_once() {
    assert!(can_trace());
    let orthanc = Orthanc::new();
    for way in Way::ALL {
        let name = format!("kill -9 with Orthanc, {way:?}");
        let make = || ArchiveStation::new(&orthanc, way);
        let tally = strike_everywhere(&name, HANDS, 1, make, killed);
        holds(&tally, POINTS_LEAST[1]);
    }
}

fn holds(tally: &Tally, least: usize) {
    for (kind, times) in &tally.kinds {
        println!("  {times:4} {kind}");
    }
    assert!(tally.violations.is_empty(), "{:#?}", tally.violations);
    assert!(tally.points * thinned() >= least, "{} points", tally.points);
}
