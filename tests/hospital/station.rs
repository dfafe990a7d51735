//! A station that delivers to a FHIR server, a receiver of HL7 v2 and an archive of images beside its folder, as the
//! real program.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};

use rig::Booth;
use rig::faults::matrix::{booth, empty_folders, restarted};
use rig::sha256;
use rig::verb::{code, gaiter_told, stderr};
use support::coarse_body;

use crate::dicom_house::{Way, dimse_section};
use crate::fhir_house::{ONE, PATIENTS};
use crate::hl7_house::segments_named;
use crate::orthanc::Orthanc;
use crate::records::PATIENT;
use crate::server::{House, dicom, fhir, hl7};

/// How many objects an archive of images has of one record: the figures and the report.
const OBJECTS: usize = 2;

/// A station that delivers to servers.
pub trait Delivering: Sync {
    /// How many stores a record goes to.
    const STORES: usize;

    fn booth(&self) -> &Booth;

    /// Empties all folders, and takes servers that have nothing of the record; then a scan is exported.
    fn renew(&mut self);

    /// What may be at no moment: something twice.
    fn twice(&self) -> Vec<String>;

    /// What does not hold at rest.
    fn wrong(&self) -> Vec<String>;

    /// Whether every store has the record.
    fn is_delivered(&self) -> bool {
        self.booth().log().matches("scan-delivered").count() >= Self::STORES
    }

    #[track_caller]
    fn verb(&self, args: &[&str], line: &str) {
        let config = self.booth().path("station.toml");
        let output = gaiter_told(&config, args, &format!("{line}\n"));
        assert_eq!(code(&output), Some(0), "{args:?}: {}", stderr(&output));
    }
}

/// A station with a server of each kind, of which that of FHIR knows the patient.
pub struct HospitalStation {
    pub booth: Booth,
    pub fhir: House,
    pub hl7: House,
    pub dicom: House,
    /// The configuration without the servers.
    alone: String,
}

impl HospitalStation {
    pub fn new() -> HospitalStation {
        let booth = booth();
        let alone = fs::read_to_string(booth.path("station.toml")).unwrap();
        let (fhir, hl7, dicom) = (House::new(fhir()), House::new(hl7()), House::new(dicom()));
        let place = HospitalStation { booth, fhir, hl7, dicom, alone };
        place.configure();
        place
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
        let images = dimse_section(self.dicom.server.port("dimse"), &self.dicom.name);
        self.booth.reconfigure(|_| format!("{}{stores}{images}", self.alone));
    }
}

impl Delivering for HospitalStation {
    const STORES: usize = 4;

    fn booth(&self) -> &Booth {
        &self.booth
    }

    fn renew(&mut self) {
        empty_folders(&self.booth);
        (self.fhir, self.hl7) = (House::with_patient(), House::new(hl7()));
        self.dicom = House::new(dicom());
        self.configure();
        self.booth.export(&format!("{PATIENT}_a.obj"), &coarse_body(1));
    }

    fn twice(&self) -> Vec<String> {
        let (counts, controls) = (self.fhir.counts(), self.hl7.controls());
        let mut found = Vec::new();
        if counts.iter().zip(ONE).any(|(found, most)| *found > most) {
            found.push(format!("the FHIR server has {counts:?}"));
        }
        if controls.len() > 1 {
            found.push(format!("the receiver has messages of {controls:?}"));
        }
        found.extend(more_than_once(self.dicom.image_count()));
        found
    }

    fn wrong(&self) -> Vec<String> {
        let mut found = self.twice();
        if self.fhir.counts() != ONE {
            found.push(format!("the FHIR server has {:?}", self.fhir.counts()));
        }
        if self.hl7.messages().is_empty() {
            found.push("the receiver has no message".to_owned());
        }
        found.extend(other_than_once(self.dicom.image_count()));
        found
    }
}

/// A station that delivers to Orthanc beside its folder. Each scan is of another patient, so that there is nothing of
/// it before.
pub struct ArchiveStation<'a> {
    pub booth: Booth,
    orthanc: &'a Orthanc,
    patient: String,
}

impl ArchiveStation<'_> {
    pub fn new(orthanc: &Orthanc, way: Way) -> ArchiveStation<'_> {
        let booth = booth();
        booth.reconfigure(|alone| alone + &orthanc.section(way));
        ArchiveStation { booth, orthanc, patient: String::new() }
    }

    fn object_count(&self) -> usize {
        self.orthanc.count_of(&self.patient)
    }
}

impl Delivering for ArchiveStation<'_> {
    const STORES: usize = 2;

    fn booth(&self) -> &Booth {
        &self.booth
    }

    fn renew(&mut self) {
        static COUNT: AtomicUsize = AtomicUsize::new(471_100);
        self.patient = COUNT.fetch_add(1, Ordering::Relaxed).to_string();
        empty_folders(&self.booth);
        self.booth.export(&format!("{}_a.obj", self.patient), &coarse_body(1));
    }

    fn twice(&self) -> Vec<String> {
        more_than_once(self.object_count()).into_iter().collect()
    }

    fn wrong(&self) -> Vec<String> {
        other_than_once(self.object_count()).into_iter().collect()
    }
}

fn more_than_once(objects: usize) -> Option<String> {
    (objects > OBJECTS).then(|| format!("the archive of images has {objects} objects"))
}

fn other_than_once(objects: usize) -> Option<String> {
    (objects != OBJECTS)
        .then(|| format!("the archive of images has {objects} objects, not {OBJECTS}"))
}

/// A server of a station.
type HouseOf = fn(&HospitalStation) -> &House;

const FHIR: HouseOf = |place| &place.fhir;
const HL7: HouseOf = |place| &place.hl7;
const DICOM: HouseOf = |place| &place.dicom;

#[test]
#[ignore = "needs Medplum's FHIR router and Python with hl7apy and pynetdicom, run by .ci/run"]
fn a_station_killed_while_a_server_owes_an_answer_delivers_once() {
    is_killed_at_each(&[
        (FHIR, "hang-after"),
        (FHIR, "hang-before POST"),
        (HL7, "hang-before"),
        (HL7, "hang-after"),
    ]);
}

#[test]
#[ignore = "needs Medplum's FHIR router and Python with hl7apy and pynetdicom, run by .ci/run"]
fn a_station_killed_while_an_archive_of_images_owes_an_answer_delivers_once() {
    is_killed_at_each(&[(DICOM, "hang-before"), (DICOM, "hang-after STORE")]);
}

/// Kills a station while a server of it hangs so, at each request in turn.
fn is_killed_at_each(gates: &[(HouseOf, &str)]) {
    let mut place = HospitalStation::new();
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
#[ignore = "needs Medplum's FHIR router and Python with hl7apy and pynetdicom, run by .ci/run"]
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
#[ignore = "needs Medplum's FHIR router and Python with hl7apy and pynetdicom, run by .ci/run"]
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
#[ignore = "needs Medplum's FHIR router and Python with hl7apy and pynetdicom, run by .ci/run"]
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
#[ignore = "needs Medplum's FHIR router and Python with hl7apy and pynetdicom, run by .ci/run"]
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
    // The wrong patient's with their mark, and the right patient's.
    place.booth.wait_for("the mark", || place.dicom.image_count() == 2 * OBJECTS + 1);
    assert_eq!(daemon.stop().code(), Some(0));
    assert_eq!(place.hl7.controls().len(), 3);
}

#[test]
#[ignore = "needs Medplum's FHIR router and Python with hl7apy and pynetdicom, run by .ci/run"]
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

#[test]
#[ignore = "needs Orthanc in a network of its own, run by .ci/run"]
fn orthanc_that_was_away_has_the_record_once_and_its_take_back() {
    for way in Way::ALL {
        let orthanc = Orthanc::new();
        let mut place = ArchiveStation::new(&orthanc, way);
        orthanc.is_killed();
        place.renew();
        let daemon = place.booth.start();
        place.booth.wait_for_records(1);
        place.booth.wait_for("the outage", || place.booth.log().contains("store-unavailable"));
        orthanc.starts_again();
        place.booth.wait_for("the delivery", || place.is_delivered());
        assert_eq!(place.wrong(), Vec::<String>::new(), "{way:?}");
        place.verb(&["unassign", &sha256(&coarse_body(1))[..12]], "");
        place.booth.wait_for("the mark", || place.object_count() == OBJECTS + 1);
        assert_eq!(daemon.stop().code(), Some(0));
        assert!(!place.booth.log_names(&place.patient), "{}", place.booth.log());
    }
}
