//! A station that delivers to a FHIR server and a receiver of HL7 v2 beside its folder, as the real program.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;

use rig::Booth;
use rig::faults::matrix::{booth, empty_folders, restarted};
use rig::sha256;
use rig::verb::{code, gaiter_told, stderr};
use support::coarse_body;

use crate::fhir_house::{ONE, PATIENTS};
use crate::hl7_house::segments_named;
use crate::records::PATIENT;
use crate::server::{House, fhir, hl7};

/// How many stores a record goes to.
const STORES: usize = 3;

/// A station with its servers.
pub struct HospitalStation {
    pub booth: Booth,
    pub fhir: House,
    pub hl7: House,
    /// The configuration without the servers.
    alone: String,
}

impl HospitalStation {
    pub fn new() -> HospitalStation {
        let booth = booth();
        let alone = fs::read_to_string(booth.path("station.toml")).unwrap();
        let place =
            HospitalStation { booth, fhir: House::new(fhir()), hl7: House::new(hl7()), alone };
        place.configure();
        place
    }

    /// Empties all folders, and takes other servers, of which that of FHIR knows the patient; then a scan of the
    /// patient is exported.
    pub fn renew(&mut self) {
        empty_folders(&self.booth);
        (self.fhir, self.hl7) = (House::with_patient(), House::new(hl7()));
        self.configure();
        self.booth.export(&format!("{PATIENT}_a.obj"), &coarse_body(1));
    }

    fn configure(&self) {
        let (base, port) = (self.fhir.base(), self.hl7.server.port("plain"));
        let stores = format!(
            "[store.fhir]\naddress = \"{base}\"\npatient_system = \"{PATIENTS}\"\n\
             attach = [\"record.json\"]\n\
             [store.hl7]\naddress = \"127.0.0.1:{port}\"\nencryption = \"none\"\n\
             receiving_application = \"{}\"\n",
            self.hl7.name
        );
        self.booth.reconfigure(|_| format!("{}{stores}", self.alone));
    }

    /// Whether every store has the record.
    pub fn is_delivered(&self) -> bool {
        self.booth.log().matches("scan-delivered").count() >= STORES
    }

    /// What may be at no moment: something twice.
    pub fn twice(&self) -> Vec<String> {
        let (counts, controls) = (self.fhir.counts(), self.hl7.controls());
        let mut found = Vec::new();
        if counts.iter().zip(ONE).any(|(found, most)| *found > most) {
            found.push(format!("the FHIR server has {counts:?}"));
        }
        if controls.len() > 1 {
            found.push(format!("the receiver has messages of {controls:?}"));
        }
        found
    }

    /// What does not hold at rest.
    pub fn wrong(&self) -> Vec<String> {
        let mut found = self.twice();
        if self.fhir.counts() != ONE {
            found.push(format!("the FHIR server has {:?}", self.fhir.counts()));
        }
        if self.hl7.messages().is_empty() {
            found.push("the receiver has no message".to_owned());
        }
        found
    }

    #[track_caller]
    fn verb(&self, args: &[&str], line: &str) {
        let config = self.booth.path("station.toml");
        let output = gaiter_told(&config, args, &format!("{line}\n"));
        assert_eq!(code(&output), Some(0), "{args:?}: {}", stderr(&output));
    }
}

/// A server of a station.
type HouseOf = fn(&HospitalStation) -> &House;

const FHIR: HouseOf = |place| &place.fhir;
const HL7: HouseOf = |place| &place.hl7;

#[test]
#[ignore = "needs Medplum's FHIR router and Python with hl7apy, run by .ci/run"]
fn a_station_killed_while_a_server_owes_an_answer_delivers_once() {
    let mut place = HospitalStation::new();
    let gates = [
        (FHIR, "hang-after"),
        (FHIR, "hang-before POST"),
        (HL7, "hang-before"),
        (HL7, "hang-after"),
    ];
    for (house, gate) in gates {
        // Each request in turn, until there is none left to be killed at.
        for nth in 1.. {
            place.renew();
            house(&place).becomes(&format!("{gate} {nth}"));
            let daemon = place.booth.start();
            let is_over = || house(&place).strikes() > 0 || place.is_delivered();
            place.booth.wait_for("a request or the end", is_over);
            let strikes = house(&place).strikes();
            daemon.kill();
            house(&place).becomes("");
            let mut found = place.twice();
            found.extend(restarted(&place.booth));
            found.extend(place.wrong());
            assert!(found.is_empty(), "{gate} {nth}: {found:#?}\n{}", place.booth.log());
            if strikes == 0 {
                assert!(nth > 1, "{gate} has never struck");
                break;
            }
        }
    }
}

#[test]
#[ignore = "needs Medplum's FHIR router and Python with hl7apy, run by .ci/run"]
fn a_server_that_is_away_keeps_no_other_store_waiting_and_gets_the_record_later() {
    let mut place = HospitalStation::new();
    place.renew();
    place.fhir.becomes("503");
    let daemon = place.booth.start();
    place.booth.wait_for_records(1);
    place.booth.wait_for("the message", || !place.hl7.messages().is_empty());
    place.booth.wait_for("the outage", || place.booth.log().contains("store-unavailable"));
    place.fhir.becomes("");
    place.booth.wait_for("the delivery", || place.is_delivered());
    assert_eq!(daemon.stop().code(), Some(0));
    assert_eq!(place.wrong(), Vec::<String>::new());
    assert!(!place.booth.log_names(PATIENT), "{}", place.booth.log());
}

#[test]
#[ignore = "needs Medplum's FHIR router and Python with hl7apy, run by .ci/run"]
fn a_take_back_reaches_a_receiver_that_has_the_result_and_whose_answer_was_lost() {
    let mut place = HospitalStation::new();
    place.renew();
    place.hl7.becomes("cut-after");
    let daemon = place.booth.start();
    place.booth.wait_for_records(1);
    place.booth.wait_for("the message", || !place.hl7.messages().is_empty());
    place.verb(&["unassign", &sha256(&coarse_body(1))[..12]], "");
    place.hl7.becomes("");
    let is_withdrawn = || {
        let messages = place.hl7.messages();
        let last =
            messages.last().map(|message| segments_named(message, "OBX")).unwrap_or_default();
        !last.is_empty() && last.iter().all(|obx| obx[11] == "W")
    };
    place.booth.wait_for("the withdrawal", is_withdrawn);
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
#[ignore = "needs Medplum's FHIR router and Python with hl7apy, run by .ci/run"]
fn a_record_of_a_patient_whom_the_server_does_not_know_waits_for_a_person() {
    let mut place = HospitalStation::new();
    place.renew();
    place.fhir = House::new(fhir());
    place.configure();
    let daemon = place.booth.start();
    let said = "SELECT count(*) FROM scans WHERE code = 'patient-not-registered'";
    place.booth.wait_for_journal(said, 1);
    place.booth.wait_for_records(1);
    place.booth.wait_for("the message", || !place.hl7.messages().is_empty());
    place.fhir.register(PATIENT);
    place.verb(&["retry", &sha256(&coarse_body(1))[..12]], "");
    place.booth.wait_for("the delivery", || place.fhir.counts() == ONE);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_eq!(place.wrong(), Vec::<String>::new());
    assert_eq!(place.fhir.resources("Patient").len(), 1, "the station has created none");
}

#[test]
#[ignore = "needs Medplum's FHIR router and Python with hl7apy, run by .ci/run"]
fn a_take_back_at_the_station_is_entered_in_error_there() {
    let mut place = HospitalStation::new();
    place.renew();
    place.fhir.register("4712");
    let daemon = place.booth.start();
    place.booth.wait_for("the delivery", || place.is_delivered());
    let scan = sha256(&coarse_body(1))[..12].to_owned();
    place.verb(&["unassign", &scan], "");
    place.verb(&["assign", &scan], "4712");
    let statuses = |patient| place.fhir.statuses("Observation", patient);
    place.booth.wait_for("the right patient's", || statuses("4712") == ["final", "final"]);
    let wrong = ["entered-in-error", "entered-in-error"];
    place.booth.wait_for("the wrong patient's", || statuses(PATIENT) == wrong);
    let is_withdrawn = || {
        let messages = place.hl7.messages();
        let mut withdrawn = messages.iter().filter(|message| {
            let all = segments_named(message, "OBX");
            !all.is_empty() && all.iter().all(|obx| obx[11] == "W")
        });
        withdrawn
            .any(|message| segments_named(message, "PID")[0][3].starts_with(&format!("{PATIENT}^")))
    };
    place.booth.wait_for("the withdrawal", is_withdrawn);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_eq!(place.hl7.controls().len(), 3);
}

#[test]
#[ignore = "needs Medplum's FHIR router and Python with hl7apy, run by .ci/run"]
fn an_erasure_comes_after_the_take_back_at_a_server_that_was_away() {
    let mut place = HospitalStation::new();
    place.renew();
    let daemon = place.booth.start();
    place.booth.wait_for("the delivery", || place.is_delivered());
    place.fhir.becomes("503");
    place.verb(&["unassign", &sha256(&coarse_body(1))[..12]], "");
    let twice = format!("{PATIENT}\n{PATIENT}\n");
    let config = place.booth.path("station.toml");
    let erased = gaiter_told(&config, &["patient", "erase"], &twice);
    assert_eq!(code(&erased), Some(74), "{}", stderr(&erased));
    place.fhir.becomes("");
    let ended = "SELECT count(*) FROM history WHERE event = 'erasure-ended'";
    place.booth.wait_for_journal(ended, 1);
    let statuses = place.fhir.statuses("Observation", PATIENT);
    assert_eq!(statuses, ["entered-in-error", "entered-in-error"]);
    assert_eq!(daemon.stop().code(), Some(0));
}
