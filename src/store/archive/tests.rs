//! The store against a store of objects of prepared answers: what it writes, in which order, and what it makes of each
//! answer.

use std::fs;
use std::sync::LazyLock;
use std::sync::mpsc::Receiver;

use gaiter_record::{RECORD, RecordFile};
use gaiter_scan::Format;
use jiff::{SignedDuration, Timestamp};
use serde_json::json;
use support::coarse_body;
use support::http_server::{answer, serve_answers};
use support::records::without_legs;
use tempfile::TempDir;

use super::*;

const PATIENT: &str = "P-4711";

/// The key of the site.
const SITE: &str = "0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b";

type Crop = fn() -> Result<Cropped, StoreFault>;

/// What a cropper says, whatever it is given.
#[derive(Debug)]
struct Says(Crop);

impl CropScan for Says {
    fn crop(&self, _: &ScanId, _: &Path, _: &str) -> Result<Cropped, StoreFault> {
        (self.0)()
    }

    fn longest(&self) -> Duration {
        Duration::ZERO
    }
}

fn cropped() -> Cropped {
    static CROPPED: LazyLock<Cropped> = LazyLock::new(|| {
        let method = Method::default();
        let measured = gaiter_leg::extract(&coarse_body(1), Format::Obj, &method).unwrap();
        let whole = WholeBody::from_extraction(&measured);
        Cropped { ply: measured.crop().to_ply(), whole }
    });
    CROPPED.clone()
}

/// A station whose archive gives these answers.
struct Station {
    store: ArchiveStore,
    requests: Receiver<String>,
    folder: TempDir,
}

impl Station {
    fn new(answers: &[&str], crop: Crop) -> Station {
        let (port, requests) =
            serve_answers(answers.iter().map(|status| answer(status, "")).collect());
        Station::at(port, requests, crop)
    }

    fn at(port: u16, requests: Receiver<String>, crop: Crop) -> Station {
        let folder = tempfile::tempdir().unwrap();
        let secret = |name: &str, text: &str| {
            let path = folder.path().join(name);
            fs::write(&path, text).unwrap();
            Secret::File(path)
        };
        let bucket = BucketPlace {
            address: format!("http://127.0.0.1:{port}"),
            bucket: "chain".to_owned(),
            region: "us-east-1".to_owned(),
            key_id: "station".to_owned(),
            secret: secret("key", "Quastenflosser"),
        };
        let place = ArchivePlace {
            bucket,
            tls: TlsFiles::default(),
            station: StationId::parse("house-booth-1").unwrap(),
            site_key: secret("site", SITE),
        };
        let crops = Box::new(Says(crop));
        let store = ArchiveStore::new(place, Method::default(), crops, folder.path());
        Station { store, requests, folder }
    }

    fn put(&self) -> Result<Receipt, StoreFault> {
        self.put_for(Some(PATIENT), PATIENT)
    }

    /// Puts a record for a patient that names this one.
    fn put_for(&self, patient: Option<&str>, named: &str) -> Result<Receipt, StoreFault> {
        let scan = ScanId::of_bytes(&coarse_body(1));
        let bytes = without_legs(scan.as_str(), Some(named), 2);
        let files = [RecordFile { name: RECORD.to_owned(), bytes }];
        self.store.put(&Delivery {
            scan: &scan,
            patient,
            person: None,
            first_seen: Timestamp::UNIX_EPOCH,
            revision: 2,
            turn: 0,
            files: &files,
            scan_file: Path::new("/nowhere/scan.obj"),
            ending: "obj",
        })
    }

    /// The first lines of all requests, each up to the end of its path.
    fn asked(&self) -> Vec<String> {
        let line = |request: String| request.split(" HTTP").next().unwrap().to_owned();
        self.requests.try_iter().map(line).collect()
    }
}

/// The body of a request as a document of this key.
fn document<D: Document>(request: &str) -> D {
    let (head, body) = request.split_once("\r\n\r\n").unwrap();
    let key = head.split(' ').nth(1).unwrap().strip_prefix("/chain/").unwrap();
    D::read_at(&key.parse().unwrap(), body.as_bytes()).unwrap()
}

fn pseudonym() -> Pseudonym {
    Pseudonym::of(&SiteKey::parse(SITE).unwrap(), PATIENT)
}

#[test]
fn a_record_is_announced_after_scan_and_record_and_only_with_a_pseudonym() {
    let station = Station::new(&["200 OK"; 3], || Ok(cropped()));
    let receipt = station.put().unwrap();
    let requests: Vec<String> = station.requests.try_iter().collect();
    let [scan, record, announced] = &requests[..] else { panic!("{}", requests.len()) };
    let announcement: Announcement = document(announced);
    let id = ScanId::of_bytes(&cropped().ply);
    assert_eq!(announcement.scan, id);
    assert_eq!(announcement.export, ScanId::of_bytes(&coarse_body(1)));
    assert_eq!((announcement.revision, announcement.first_seen), (2, Timestamp::UNIX_EPOCH));
    let (whole, patient) = (announcement.whole, announcement.patient);
    let told = |of: &WholeBody| serde_json::to_value(of).unwrap();
    assert_eq!((told(&whole), patient), (told(&cropped().whole), Some(pseudonym())));
    let key = ObjectKey::Scan(id.clone()).to_string();
    assert_eq!(receipt.folder, Path::new(&key));
    assert!(scan.starts_with(&format!("PUT /chain/{key} HTTP/1.1\r\n")), "{scan}");
    let (station_id, hash) = (announcement.station, announcement.record);
    let key = ObjectKey::Record { station: station_id, scan: id, record: hash };
    assert!(record.starts_with(&format!("PUT /chain/{key} HTTP/1.1\r\n")), "{record}");
    for request in &requests {
        assert!(request.to_ascii_lowercase().contains("\r\nif-none-match: *\r\n"));
        assert!(!request.contains(PATIENT) && !request.contains("Quastenflosser"));
    }
}

#[test]
fn a_record_of_another_patient_or_of_nobody_is_not_sent() {
    let station = Station::new(&[], || Ok(cropped()));
    for (patient, rejection) in
        [(None, Rejection::Unassigned), (Some("P-4712"), Rejection::OtherPatient)]
    {
        let fault = station.put_for(patient, PATIENT).unwrap_err();
        assert!(matches!(fault, StoreFault::Permanent(found) if found == rejection));
    }
    assert_eq!(station.asked(), Vec::<String>::new());
}

#[test]
fn a_scan_that_is_there_is_a_receipt_if_its_length_is_right_or_nobody_may_ask() {
    let own = packed(&cropped().ply).len();
    let length = |bytes: usize| {
        format!("HTTP/1.1 200 OK\r\nContent-Length: {bytes}\r\nConnection: close\r\n\r\n")
    };
    let there = answer("412 Precondition Failed", "");
    let done = || answer("200 OK", "");
    for head in [length(own), answer("403 Forbidden", "")] {
        let (port, requests) = serve_answers(vec![there.clone(), head, done(), there.clone()]);
        let station = Station::at(port, requests, || Ok(cropped()));
        let put = station.put();
        // The last answer is about the announcement, which is told again.
        let Err(StoreFault::Server(fault)) = put else { panic!("{put:?}") };
        assert!(fault.is_of_a_record(), "{fault}");
        let asked = station.asked();
        assert_eq!(asked.len(), 4, "{asked:?}");
        assert!(asked[1].starts_with("HEAD /chain/scan/"), "{asked:?}");
    }
    let (port, requests) = serve_answers(vec![there, length(own + 1)]);
    let station = Station::at(port, requests, || Ok(cropped()));
    let fault = station.put().unwrap_err();
    assert_eq!(fault.code(), "store-place-occupied");
    assert_eq!(station.asked().len(), 2, "nothing is announced");
}

#[test]
fn a_scan_whose_crop_measures_otherwise_stays_in_the_house_and_waits_for_a_person() {
    let station = Station::new(&[], || {
        let why = ".legs[0].at[1].girth_mm: 367.1 → 366.9".to_owned();
        Err(StoreFault::Permanent(Rejection::CropDiffers { why }))
    });
    let fault = station.put().unwrap_err();
    assert_eq!(fault.code(), "crop-differs");
    assert!(matches!(fault, StoreFault::Permanent(_)), "{fault}");
    let later = Station::new(&[], || Err(StoreFault::NoCrop("killed".to_owned())));
    assert!(matches!(later.put(), Err(StoreFault::NoCrop(_))));
    assert_eq!((station.asked(), later.asked()), (vec![], vec![]));
}

#[test]
fn a_store_of_objects_that_does_not_take_it_is_asked_again_whatever_it_says() {
    for status in ["503 Slow Down", "404 Not Found", "400 Bad Request", "403 Forbidden"] {
        let station = Station::new(&[status], || Ok(cropped()));
        let fault = station.put().unwrap_err();
        assert_eq!(fault.code(), "store-unavailable", "{status}");
        let StoreFault::Server(fault) = fault else { panic!("{status}") };
        assert!(!fault.is_of_a_record(), "{status}");
    }
}

#[test]
fn a_scan_that_is_taken_back_is_said_to_be_this_patients_no_longer() {
    let station = Station::new(&["200 OK"], || Ok(cropped()));
    let scan = ScanId::of_bytes(b"scan");
    station.store.withdraw(&TakeBack::new(&scan, Some(PATIENT))).unwrap();
    let withdrawal: Withdrawal = document(&station.requests.try_iter().next().unwrap());
    assert_eq!((withdrawal.export, withdrawal.patient), (scan, Some(pseudonym())));
}

#[test]
fn what_is_said_later_is_later_also_after_the_clock_was_set_back() {
    let station = Station::new(&["200 OK"; 8], || Ok(cropped()));
    let withdraw = || {
        let scan = ScanId::of_bytes(b"scan");
        station.store.withdraw(&TakeBack::new(&scan, Some(PATIENT))).unwrap();
    };
    let before = Timestamp::now();
    withdraw();
    // As a station notes it whose clock was ahead when it said something last.
    let ahead = before + SignedDuration::from_hours(24);
    let note = json!({ "schema": "gaiter.archive-clock/1", "last_ms": ahead.as_millisecond() });
    fs::write(station.folder.path().join("archive-clock.json"), note.to_string()).unwrap();
    station.put().unwrap();
    withdraw();
    station.put().unwrap();
    let requests: Vec<String> = station.requests.try_iter().collect();
    let announced = |at: usize| document::<Announcement>(&requests[at]).at;
    let withdrawn = |at: usize| document::<Withdrawal>(&requests[at]).at;
    let said =
        [withdrawn(0), announced(3), withdrawn(4), announced(7)].map(|at| at.as_millisecond());
    let [before_ms, ahead_ms] = [before, ahead].map(Timestamp::as_millisecond);
    assert!((before_ms..ahead_ms).contains(&said[0]), "{said:?}");
    assert_eq!(said[1..], [1, 2, 3].map(|later_ms| ahead_ms + later_ms));
}

#[test]
fn nothing_is_announced_that_cannot_be_ordered() {
    let station = Station::new(&["200 OK"; 3], || Ok(cropped()));
    fs::write(station.folder.path().join("archive-clock.json"), "{}").unwrap();
    let fault = station.put().unwrap_err();
    assert!(matches!(fault, StoreFault::Transient { .. }), "{fault}");
    assert_eq!(station.asked().len(), 2, "the scan and its record alone");
}

#[test]
fn a_store_is_in_reach_if_it_takes_the_empty_scan_and_pseudonyms_can_be_made() {
    let station = Station::new(&["200 OK"], || Ok(cropped()));
    station.store.reach().unwrap();
    let empty = ScanId::of_bytes(b"");
    assert_eq!(station.asked(), [format!("PUT /chain/{}", ObjectKey::Scan(empty))]);
    fs::write(station.folder.path().join("site"), "secret").unwrap();
    let fault = station.store.reach().unwrap_err();
    assert!(matches!(fault, StoreFault::Server(ServerFault::SiteKey(_))), "{fault}");
}
