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
use gaiter_https::{Secret, SecretFault, TlsFiles, is_this_machine, secret, tls};
use jiff::Timestamp;

use super::environment::writable;
use super::row::{Row, Verdict};
use crate::config::{ArchiveStoreConfig, Config, FhirStoreConfig, Hl7StoreConfig};
use crate::station::stores::Stores;
use crate::store::archive::CropChoice;
use crate::store::hl7::Hl7Way;
use crate::store::{ArchiveStore, FhirStore, Hl7Store, OTHERS, RecordStore};

/// A row for each server, each secret and each certificate of the station.
pub(super) fn rows(config: &Config) -> Vec<Row> {
    let stores = Stores::from_config(config);
    let fhir = config.store.fhir.as_ref().zip(stores.named(FhirStore::NAME));
    let hl7 = config.store.hl7.as_ref().zip(stores.named(Hl7Store::NAME));
    let fhir = fhir.map(|(fhir, store)| fhir_rows(fhir, store)).unwrap_or_default();
    let hl7 = hl7.map(|(hl7, store)| hl7_rows(hl7, store)).unwrap_or_default();
    let archive = config.store.archive.as_ref().zip(stores.named(ArchiveStore::NAME));
    let archive = archive.map(|(archive, store)| archive_rows(archive, store));
    let rows = fhir.into_iter().chain(hl7).chain(archive.unwrap_or_default());
    #[cfg(feature = "dicom")]
    let rows = rows.chain(dicom::rows(config, &stores)).chain(worklist::rows(config));
    rows.collect()
}

fn fhir_rows(config: &FhirStoreConfig, store: &dyn RecordStore) -> Vec<Row> {
    let secrets = config.server.secrets();
    let mut rows: Vec<Row> = secrets.iter().map(|secret| of_secret(secret)).collect();
    rows.extend(of_certificate(&config.server.tls, Timestamp::now()));
    let detail = "speaks R4, and lets the station look for patients";
    rows.push(tried("FHIR server", store, &secrets, detail));
    rows
}

fn hl7_rows(config: &Hl7StoreConfig, store: &dyn RecordStore) -> Vec<Row> {
    let (host, tls) = match &config.way {
        Hl7Way::Files(folder) => {
            return vec![Row::from_attempt("message folder", folder, writable(folder))];
        }
        Hl7Way::Mllp { host, tls, .. } => (host, tls),
    };
    let own = config.way.secret();
    let mut rows: Vec<Row> = own.map(of_secret).into_iter().collect();
    rows.extend(tls.as_ref().and_then(|tls| of_certificate(tls, Timestamp::now())));
    rows.push(tried("HL7 receiver", store, own.as_slice(), "takes a connection"));
    if tls.is_none() && !is_this_machine(host) {
        rows.push(not_encrypted(store.place(), "the results", "receiver"));
    }
    rows
}

/// A warning that what goes to a server or comes from it can be read on the way.
fn not_encrypted(place: String, what: &str, server: &str) -> Row {
    let detail = format!(
        "not encrypted: anyone in the network can read {what}; encryption = \"tls\" if the {server} can"
    );
    Row::at("encryption", place, Verdict::Warn, detail)
}

fn archive_rows(config: &ArchiveStoreConfig, store: &dyn RecordStore) -> Vec<Row> {
    let secrets = config.place.secrets();
    let mut rows: Vec<Row> = secrets.iter().map(|secret| of_secret(secret)).collect();
    rows.push(tried("archive", store, &secrets, "takes what the station writes"));
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
fn of_certificate(tls: &TlsFiles, now: Timestamp) -> Option<Row> {
    let (path, _) = tls.own.as_ref()?;
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
    Some(Row::new("certificate", path, verdict, detail))
}

fn kept(check: &'static str, path: &Path) -> Row {
    match fs::metadata(path).map(|found| found.mode() & OTHERS) {
        Ok(0) => Row::ok(check, path, "can be read, by its owner only"),
        Ok(_) => {
            let detail = "others can read it too: chmod 600, for the user of the station";
            Row::new(check, path, Verdict::Warn, detail)
        }
        Err(error) => Row::new(check, path, Verdict::Fail, error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_certificate_of_the_station_is_told_before_it_ends() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/tls/localhost.pem");
        let key = Secret::Credential("key".to_owned());
        let tls = TlsFiles { authorities: None, own: Some((path, key)) };
        for (now, verdict, detail) in [
            ("2119-01-01T00:00:00Z", Verdict::Ok, "holds for 365 days"),
            ("2119-12-03T00:00:00Z", Verdict::Warn, "ends in 29 days: have a new one signed"),
            ("2120-01-02T00:00:00Z", Verdict::Fail, "has ended: have a new one signed"),
        ] {
            let row = of_certificate(&tls, now.parse().unwrap()).unwrap();
            assert_eq!((row.verdict, row.detail.as_str()), (verdict, detail));
        }
        assert!(of_certificate(&TlsFiles::default(), Timestamp::now()).is_none());
    }
}
