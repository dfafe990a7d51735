//! Tries the servers that records go to, in the way the station asks them, and looks at its secrets.

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use super::environment::writable;
use super::row::{Row, Verdict};
use crate::config::{Config, FhirStoreConfig, Hl7StoreConfig};
use crate::flow::server::hl7::Way;
use crate::flow::server::{Secret, is_this_machine};
use crate::station::stores::Stores;
use crate::store::secret::{self, SecretFault};
use crate::store::{FhirStore, Hl7Store, RecordStore};

/// Permission bits of all but the owner.
const OTHERS: u32 = 0o077;

/// A row for each server and each secret.
pub(super) fn rows(config: &Config) -> Vec<Row> {
    let stores = Stores::of(config);
    let tried = stores.iter().flat_map(|store| match store {
        RecordStore::Fhir(store) => {
            config.store.fhir.as_ref().map(|fhir| fhir_rows(fhir, store)).unwrap_or_default()
        }
        RecordStore::Hl7(store) => {
            config.store.hl7.as_ref().map(|hl7| hl7_rows(hl7, store)).unwrap_or_default()
        }
        _ => Vec::new(),
    });
    tried.collect()
}

fn fhir_rows(config: &FhirStoreConfig, store: &FhirStore) -> Vec<Row> {
    let server = &config.server;
    let secrets = server.secrets();
    let mut rows: Vec<Row> = secrets.iter().map(|secret| of_secret(secret)).collect();
    let (check, place) = ("FHIR server", &server.base);
    rows.push(match is_for_the_service(&secrets) {
        true => not_tried(check, place),
        false => match store.try_out() {
            Ok(()) => {
                Row::at(check, place, Verdict::Ok, "speaks R4, and finds patients by their id")
            }
            Err(fault) => Row::at(check, place, Verdict::Fail, fault.to_string()),
        },
    });
    rows
}

fn hl7_rows(config: &Hl7StoreConfig, store: &Hl7Store) -> Vec<Row> {
    let (host, tls) = match &config.way {
        Way::Files(folder) => return vec![Row::of("message folder", folder, writable(folder))],
        Way::Mllp { host, tls, .. } => (host, tls),
    };
    let own = config.way.secret();
    let mut rows: Vec<Row> = own.map(of_secret).into_iter().collect();
    let (check, place) = ("HL7 receiver", store.place());
    rows.push(match is_for_the_service(own.as_slice()) {
        true => not_tried(check, &place),
        false => match store.reach() {
            Ok(()) => Row::at(check, &place, Verdict::Ok, "takes a connection"),
            Err(fault) => Row::at(check, &place, Verdict::Fail, fault.to_string()),
        },
    });
    if tls.is_none() && !is_this_machine(host) {
        let detail = "not encrypted: anyone in the network can read the results; \
                      encryption = \"tls\" if the receiver can";
        rows.push(Row::at("encryption", place, Verdict::Warn, detail));
    }
    rows
}

/// Whether a secret is a credential that systemd gives to the service only.
fn is_for_the_service(secrets: &[&Secret]) -> bool {
    secrets.iter().any(|secret| matches!(secret::path(secret), Err(SecretFault::NoCredentials(_))))
}

fn not_tried(check: &'static str, place: &str) -> Row {
    let detail = "not tried, because only the service has the credential: systemd-run --pipe \
                  --uid=gaiter --property=LoadCredential=NAME:FILE gaiter check";
    Row::at(check, place, Verdict::Warn, detail)
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
            Secret::File(path) => kept(path),
        },
    }
}

fn kept(path: &Path) -> Row {
    match fs::metadata(path).map(|found| found.mode() & OTHERS) {
        Ok(0) => Row::ok("secret", path, "can be read, by its owner only"),
        Ok(_) => {
            let detail = "others can read it too: chmod 600, for the user of the station";
            Row::new("secret", path, Verdict::Warn, detail)
        }
        Err(error) => Row::new("secret", path, Verdict::Fail, error.to_string()),
    }
}
