//! Tries the servers that records go to and the one of the worklist, in the way the station asks them, and looks at its
//! secrets.

#[cfg(feature = "dicom")]
mod dicom;
#[cfg(feature = "dicom")]
mod worklist;

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use gaiter_flow::health::CERTIFICATE_ENDS_SOON;
use gaiter_https::{Secret, SecretFault, is_this_machine, secret, tls};
use jiff::Timestamp;

use super::environment::writable;
use super::row::{Row, Verdict};
use crate::config::{ArchiveStoreConfig, Config, Hl7StoreConfig};
use crate::station::stores::Stores;
use crate::store::archive::CropChoice;
use crate::store::hl7::Hl7Way;
use crate::store::{ArchiveStore, FhirStore, Hl7Store, OTHERS, Peer, RecordStore};

/// A row for each server, each secret and each certificate of the station.
pub(super) fn rows(config: &Config) -> Vec<Row> {
    let stores = Stores::from_config(config);
    let fhir = config.store.fhir.as_ref().zip(stores.named(FhirStore::NAME));
    let hl7 = config.store.hl7.as_ref().zip(stores.named(Hl7Store::NAME));
    let archive = config.store.archive.as_ref().zip(stores.named(ArchiveStore::NAME));
    let rows = [
        fhir.map(|(fhir, store)| {
            let detail = "speaks R4, and lets the station look for patients";
            of_store("FHIR server", store, &fhir.server.secrets(), detail)
        }),
        hl7.map(|(hl7, store)| hl7_rows(hl7, store)),
        archive.map(|(archive, store)| archive_rows(archive, store)),
    ];
    let rows = rows.into_iter().flatten().flatten();
    #[cfg(feature = "dicom")]
    let rows = rows.chain(dicom::rows(config, &stores)).chain(worklist::rows(config));
    rows.collect()
}

fn hl7_rows(config: &Hl7StoreConfig, store: &dyn RecordStore) -> Vec<Row> {
    let receiver = match &config.way {
        Hl7Way::Files(folder) => {
            return vec![Row::from_attempt("message folder", folder, writable(folder))];
        }
        Hl7Way::Mllp(receiver) => receiver,
    };
    let secrets = receiver.secret();
    let mut rows = of_store("HL7 receiver", store, secrets.as_slice(), "takes a connection");
    rows.extend(not_encrypted(receiver, store.place(), "the results", "receiver"));
    rows
}

/// The rows of a server: the secrets and the certificate of the station, and whether it answers.
fn of_store(
    check: &'static str,
    store: &dyn RecordStore,
    secrets: &[&Secret],
    found: &'static str,
) -> Vec<Row> {
    let mut rows = of_station(secrets, store.own_certificate());
    rows.push(tried(check, store, secrets, found));
    rows
}

/// The rows of what the station shows a server.
fn of_station(secrets: &[&Secret], certificate: Option<&Path>) -> Vec<Row> {
    let of_secrets = secrets.iter().map(|secret| of_secret(secret));
    of_secrets.chain(of_certificate(certificate, Timestamp::now())).collect()
}

/// A warning that what goes to a server on another machine or comes from it can be read on the way.
fn not_encrypted(peer: &Peer, place: String, what: &str, server: &str) -> Option<Row> {
    if peer.tls.is_some() || is_this_machine(&peer.host) {
        return None;
    }
    let detail = format!(
        "not encrypted: anyone in the network can read {what}; encryption = \"tls\" if the {server} can"
    );
    Some(Row::at("encryption", place, Verdict::Warn, detail))
}

fn archive_rows(config: &ArchiveStoreConfig, store: &dyn RecordStore) -> Vec<Row> {
    let detail = "takes what the station writes";
    let mut rows = of_store("archive", store, &config.place.secrets(), detail);
    if config.crop == CropChoice::Whole {
        let detail =
            "whole bodies with their faces leave the house; crop = \"legs\" sends legs only";
        rows.push(Row::at("crop", store.place(), Verdict::Warn, detail));
    }
    rows
}

/// Tries a server, unless it needs a credential that systemd gives to the service only.
fn tried(
    check: &'static str,
    store: &dyn RecordStore,
    secrets: &[&Secret],
    found: &'static str,
) -> Row {
    let place = store.place();
    not_given(secrets, check, &place).unwrap_or_else(|| match store.try_out() {
        Ok(()) => Row::at(check, place, Verdict::Ok, found),
        Err(fault) => Row::at(check, place, Verdict::Fail, fault.cause().to_string()),
    })
}

/// That a server is not tried, because a secret is missing that only the service has.
fn not_given(secrets: &[&Secret], check: &'static str, place: &str) -> Option<Row> {
    let is_not_given =
        |secret: &&Secret| matches!(secret::path(secret), Err(SecretFault::NoCredentials(_)));
    let detail = "not tried, because only the service has the credential: systemd-run --pipe \
                  --uid=gaiter --property=LoadCredential=NAME:FILE gaiter check";
    let is_any = secrets.iter().any(is_not_given);
    is_any.then(|| Row::at(check, place, Verdict::Warn, detail))
}

/// Whether a secret can be read, and only by whom it is for.
fn of_secret(secret: &Secret) -> Row {
    let check = "secret";
    match secret::read(secret) {
        Err(SecretFault::NoCredentials(_)) => {
            Row::at(check, secret, Verdict::Warn, "given by systemd to the service only")
        }
        Err(fault) => Row::at(check, secret, Verdict::Fail, fault.to_string()),
        Ok(_) => match secret {
            Secret::Credential(_) => Row::at(check, secret, Verdict::Ok, "can be read"),
            Secret::File(path) => kept(check, path),
        },
    }
}

/// How long the station's own certificate still holds, if it has one. One that cannot be read is reported where the server
/// is tried.
fn of_certificate(certificate: Option<&Path>, now: Timestamp) -> Option<Row> {
    let path = certificate?;
    let left = tls::holds_until(path).ok()??.duration_since(now);
    let days = left.as_hours() / 24;
    let (verdict, detail) = match left {
        left if left.is_negative() => {
            (Verdict::Fail, "has ended: have a new one signed".to_owned())
        }
        left if left < CERTIFICATE_ENDS_SOON => {
            (Verdict::Warn, format!("ends in {days} days: have a new one signed"))
        }
        _ => (Verdict::Ok, format!("holds for {days} days")),
    };
    Some(Row::at("certificate", path.display(), verdict, detail))
}

fn kept(check: &'static str, path: &Path) -> Row {
    match fs::metadata(path).map(|found| found.mode() & OTHERS) {
        Ok(0) => Row::ok(check, path, "can be read, by its owner only"),
        Ok(_) => {
            let detail = "others can read it too: chmod 600, for the user of the station";
            Row::at(check, path.display(), Verdict::Warn, detail)
        }
        Err(error) => Row::at(check, path.display(), Verdict::Fail, error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_certificate_of_the_station_is_told_before_it_ends() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/tls/localhost.pem");
        for (now, verdict, detail) in [
            ("2119-01-01T00:00:00Z", Verdict::Ok, "holds for 365 days"),
            ("2119-12-03T00:00:00Z", Verdict::Warn, "ends in 29 days: have a new one signed"),
            ("2120-01-02T00:00:00Z", Verdict::Fail, "has ended: have a new one signed"),
        ] {
            let row = of_certificate(Some(&path), now.parse().unwrap()).unwrap();
            assert_eq!((row.verdict, row.detail.as_str()), (verdict, detail));
        }
        assert!(of_certificate(None, Timestamp::now()).is_none());
    }
}
