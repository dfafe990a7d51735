//! The station and an archive: a store of objects of these tests' own, which takes whatever it is given.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::io::Write;
use std::sync::{Arc, Mutex};

use gaiter_record::ScanId;
use gaiter_record::archive::{Announcement, Document, Heartbeat, Pseudonym, SiteKey};
use rig::Booth;
use support::coarse_body;
use support::http_server::{answer, request_of, serve};

const PATIENT: &str = "4711";

/// The key of the site.
const SITE: &str = "0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b0b";

/// A booth whose scans go to an archive, cropped so, and what the archive was sent.
fn booth(crop: &str) -> (Booth, Arc<Mutex<Vec<String>>>) {
    let requests: Arc<Mutex<Vec<String>>> = Arc::default();
    let kept = Arc::clone(&requests);
    let port = serve(move |mut stream| {
        let Ok(request) = request_of(&mut stream) else { return };
        kept.lock().unwrap().push(request);
        let _ = stream.write_all(answer("200 OK", "").as_bytes());
    });
    let booth = Booth::new();
    let (key, site_key) = (booth.path("archive.key"), booth.path("site.key"));
    fs::write(&key, "Quastenflosser\n").unwrap();
    fs::write(&site_key, SITE).unwrap();
    booth.reconfigure(|text| {
        format!(
            "{text}[store.archive]\naddress = \"http://127.0.0.1:{port}\"\nbucket = \"chain\"\n\
             station = \"house-1\"\nkey_id = \"station\"\nkey = \"{}\"\nsite_key = \"{}\"\n\
             crop = \"{crop}\"\n",
            key.display(),
            site_key.display()
        )
    });
    (booth, requests)
}

/// The first document of a kind that was put under a key that begins so.
fn sent<D: Document>(requests: &Mutex<Vec<String>>, begin: &str) -> Option<D> {
    let requests = requests.lock().unwrap();
    let line = format!("PUT /chain/{begin}");
    let request = requests.iter().find(|request| request.starts_with(&line))?;
    let (head, body) = request.split_once("\r\n\r\n").unwrap();
    let key = head.split(' ').nth(1).unwrap().strip_prefix("/chain/").unwrap();
    Some(D::read_at(&key.parse().unwrap(), body.as_bytes()).unwrap())
}

#[test]
fn a_scan_leaves_the_house_as_legs_or_whole_and_its_patient_as_a_pseudonym() {
    let scan = coarse_body(1);
    let announced = ["legs", "whole"].map(|crop| {
        let (booth, requests) = booth(crop);
        let daemon = booth.start();
        booth.export(&format!("{PATIENT}_a.obj"), &scan);
        let announced = || sent::<Announcement>(&requests, "inbox/house-1/");
        booth.wait_for("the announcement", || announced().is_some());
        booth.wait_for_records(1);
        booth.wait_for_journal("SELECT count(*) FROM scans WHERE state = 'delivered'", 1);
        let heartbeat = || sent::<Heartbeat>(&requests, "fleet/house-1.json");
        booth.wait_for("the heartbeat", || heartbeat().is_some());
        assert_eq!(daemon.stop().code(), Some(0));
        assert!(!booth.log_names(PATIENT), "{}", booth.log());
        for request in requests.lock().unwrap().iter() {
            assert!(!request.contains("\"4711\"") && !request.contains("Quastenflosser"));
        }
        announced().unwrap()
    });
    let site = SiteKey::parse(SITE).unwrap();
    for announcement in &announced {
        assert_eq!(announcement.export, ScanId::of_bytes(&scan));
        assert_eq!(announcement.patient, Some(Pseudonym::of(&site, PATIENT)));
    }
    let [legs, whole] = announced;
    assert!(legs.bytes < whole.bytes, "{} of {} bytes", legs.bytes, whole.bytes);
}
