//! A station whose scans go to an archive: a bucket of moto, a store of objects by S3's protocol.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use gaiter_https::{Bucket, BucketPlace, HttpsClient, Secret, TlsFiles};
use gaiter_leg::{Method, extract_crop};
use gaiter_record::archive::{
    Announcement, Document, Heartbeat, ObjectKey, Pseudonym, RecordHash, SiteKey, Withdrawal,
    unpacked,
};
use gaiter_record::{Record, ScanId, sha256};
use rig::Booth;
use rig::verb::{code, gaiter_told, stderr};
use support::coarse_body;

use crate::server::python;

const PATIENT: &str = "4711";

/// More than a crop or a record has, bytes.
const MOST: u64 = 1 << 26;

/// A booth beside a store of objects, which ends with its input.
struct ArchivingBooth {
    booth: Booth,
    bucket: Bucket,
    site: SiteKey,
    _store: Child,
}

impl ArchivingBooth {
    fn new() -> ArchivingBooth {
        let booth = Booth::new();
        let (store, port) = started();
        let site = "0b".repeat(32);
        let address = format!("http://127.0.0.1:{port}");
        booth.send_to_archive(&address, "archive-0", "house-booth-1", &site, "");
        let place = BucketPlace {
            address,
            bucket: "archive-0".to_owned(),
            region: "us-east-1".to_owned(),
            key_id: "key".to_owned(),
            secret: Secret::File(booth.path("archive.key")),
        };
        let client = HttpsClient::new(TlsFiles::default(), None, Duration::from_secs(30));
        let (bucket, site) = (Bucket::new(place, client), SiteKey::parse(&site).unwrap());
        // What is put under no key is the bucket itself.
        booth.wait_for("the store of objects", || bucket.put("", Vec::new()).is_ok());
        ArchivingBooth { booth, bucket, site, _store: store }
    }

    fn keys(&self, prefix: &str) -> Vec<String> {
        let page = self.bucket.list(prefix, "").unwrap();
        page.objects.into_iter().map(|listed| listed.key).collect()
    }

    fn unpacked(&self, key: &ObjectKey) -> Vec<u8> {
        unpacked(&self.bucket.get(&key.to_string()).unwrap().unwrap(), MOST).unwrap()
    }

    /// What was announced, oldest first.
    fn announced(&self) -> Vec<Announcement> {
        let mut all: Vec<Announcement> = self.said();
        all.sort_by_key(|of| of.at);
        all
    }

    /// The documents of a kind in the inbox.
    fn said<D: Document>(&self) -> Vec<D> {
        let read = |key: String| {
            let bytes = self.bucket.get(&key).unwrap().unwrap();
            D::read_at(&key.parse().unwrap(), &bytes).ok()
        };
        self.keys(ObjectKey::INBOX).into_iter().filter_map(read).collect()
    }

    #[track_caller]
    fn verb(&self, args: &[&str], line: &str) {
        let output = gaiter_told(&self.booth.path("station.toml"), args, &format!("{line}\n"));
        assert_eq!(code(&output), Some(0), "{args:?}: {}", stderr(&output));
    }
}

/// The store of objects of the archive's own tests, and its port.
fn started() -> (Child, u16) {
    let script =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/archive/tests/archive/store.py");
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let mut command = Command::new(python());
    command.arg(script).arg(port.to_string()).stdin(Stdio::piped());
    (command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap(), port)
}

#[test]
#[ignore = "needs Python with moto, run by .ci/run"]
fn a_scan_is_in_the_archive_as_legs_with_a_pseudonym_and_measures_there_as_here() {
    let place = ArchivingBooth::new();
    let daemon = place.booth.start();
    let scan = coarse_body(1);
    place.booth.export(&format!("{PATIENT}_a.obj"), &scan);
    place.booth.wait_for("the announcement", || !place.announced().is_empty());
    let [announced] = &place.announced()[..] else { panic!("announced twice") };
    assert_eq!(announced.export, ScanId::of_bytes(&scan));
    assert_eq!(announced.patient, Some(Pseudonym::of(&place.site, PATIENT)));
    let ply = place.unpacked(&ObjectKey::Scan(announced.scan.clone()));
    assert_eq!(
        (ScanId::of_bytes(&ply), ply.len() as u64),
        (announced.scan.clone(), announced.bytes)
    );
    let (station, scan_id) = (announced.station.clone(), announced.scan.clone());
    let (record, hash) = (announced.record.clone(), &announced.record);
    let key = ObjectKey::Record { station, scan: scan_id, record };
    let json = place.unpacked(&key);
    assert_eq!(RecordHash::of_bytes(&json), *hash);
    let record: Record = serde_json::from_slice(&json).unwrap();
    assert_eq!(record.patient.unwrap().id, announced.patient.as_ref().unwrap().as_str());
    let measured = extract_crop(&ply, &announced.whole, &Method::default()).unwrap();
    assert_eq!(record.legs.len(), measured.legs.len());
    let highest_mm = measured.body.mesh.points().iter().map(|point| point.z).fold(0.0, f64::max);
    let crotch_mm = record.body.crotch_height_mm.unwrap();
    assert!(highest_mm < crotch_mm + 101.0, "{highest_mm} mm, the crotch at {crotch_mm} mm");
    for key in place.keys("") {
        let bytes = place.bucket.get(&key).unwrap().unwrap();
        let text = String::from_utf8_lossy(&unpacked(&bytes, MOST).unwrap_or(bytes)).into_owned();
        assert!(!text.contains("\"4711\"") && !key.contains("4711_"), "{key}");
    }
    place.booth.wait_for("the heartbeat", || !place.keys(ObjectKey::FLEET).is_empty());
    let key = &place.keys(ObjectKey::FLEET)[0];
    let bytes = place.bucket.get(key).unwrap().unwrap();
    let heartbeat = Heartbeat::read_at(&key.parse().unwrap(), &bytes).unwrap();
    assert_eq!(heartbeat.station.as_str(), "house-booth-1");
    assert_eq!(daemon.stop().code(), Some(0));
    assert!(!place.booth.log_names(PATIENT), "{}", place.booth.log());
}

#[test]
#[ignore = "needs Python with moto, run by .ci/run"]
fn a_scan_that_is_given_to_another_patient_is_taken_back_and_announced_anew() {
    let place = ArchivingBooth::new();
    let daemon = place.booth.start();
    let scan = coarse_body(1);
    place.booth.export(&format!("{PATIENT}_a.obj"), &scan);
    place.booth.wait_for("the announcement", || place.announced().len() == 1);
    let id = sha256(&scan)[..12].to_owned();
    place.verb(&["unassign", &id], "");
    place.verb(&["assign", &id], "4712");
    let own = |patient: &str| Some(Pseudonym::of(&place.site, patient));
    let is_own = |of: &Announcement, patient: &str| of.patient == own(patient);
    let is_announced = || place.announced().last().is_some_and(|last| is_own(last, "4712"));
    place.booth.wait_for("the other patient's", is_announced);
    let withdrawn = || -> Vec<_> {
        place.said::<Withdrawal>().into_iter().filter(|of| of.patient == own(PATIENT)).collect()
    };
    place.booth.wait_for("the withdrawal", || !withdrawn().is_empty());
    let (announced, withdrawn) = (place.announced(), withdrawn());
    assert_eq!(withdrawn[0].export, ScanId::of_bytes(&scan));
    assert!(withdrawn[0].at > announced[0].at);
    // One crop for both.
    assert!(announced.iter().all(|of| of.scan == announced[0].scan));
    assert_eq!(daemon.stop().code(), Some(0));
}
