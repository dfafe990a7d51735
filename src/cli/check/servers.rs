//! Tries the servers that records go to, in the way the station asks them, and looks at its secrets.

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use super::environment::writable;
use super::row::{Row, Verdict};
use crate::config::{Config, FhirStoreConfig, Hl7StoreConfig};
use crate::station::stores::Stores;
use crate::store::access::OTHERS;
use crate::store::endpoint::{Secret, is_this_machine};
use crate::store::hl7::Hl7Way;
use crate::store::secret::{self, SecretFault};
use crate::store::{FhirStore, Hl7Store, RecordStore};

/// A row for each server and each secret.
pub(super) fn rows(config: &Config) -> Vec<Row> {
    let stores = Stores::of(config);
    let fhir = config.store.fhir.as_ref().zip(stores.named(FhirStore::NAME));
    let hl7 = config.store.hl7.as_ref().zip(stores.named(Hl7Store::NAME));
    let fhir = fhir.map(|(fhir, store)| fhir_rows(fhir, store)).unwrap_or_default();
    let hl7 = hl7.map(|(hl7, store)| hl7_rows(hl7, store)).unwrap_or_default();
    fhir.into_iter().chain(hl7).collect()
}

fn fhir_rows(config: &FhirStoreConfig, store: &dyn RecordStore) -> Vec<Row> {
    let secrets = config.server.secrets();
    let mut rows: Vec<Row> = secrets.iter().map(|secret| of_secret(secret)).collect();
    let detail = "speaks R4, and lets the station look for patients";
    rows.push(tried("FHIR server", store, &secrets, detail));
    rows
}

fn hl7_rows(config: &Hl7StoreConfig, store: &dyn RecordStore) -> Vec<Row> {
    let (host, tls) = match &config.way {
        Hl7Way::Files(folder) => return vec![Row::of("message folder", folder, writable(folder))],
        Hl7Way::Mllp { host, tls, .. } => (host, tls),
    };
    let own = config.way.secret();
    let mut rows: Vec<Row> = own.map(of_secret).into_iter().collect();
    rows.push(tried("HL7 receiver", store, own.as_slice(), "takes a connection"));
    if tls.is_none() && !is_this_machine(host) {
        let detail = "not encrypted: anyone in the network can read the results; \
                      encryption = \"tls\" if the receiver can";
        rows.push(Row::at("encryption", store.place(), Verdict::Warn, detail));
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
    let is_not_given =
        |secret: &&Secret| matches!(secret::path(secret), Err(SecretFault::NoCredentials(_)));
    if secrets.iter().any(is_not_given) {
        let detail = "not tried, because only the service has the credential: systemd-run --pipe \
                      --uid=gaiter --property=LoadCredential=NAME:FILE gaiter check";
        return Row::at(check, place, Verdict::Warn, detail);
    }
    match store.try_out() {
        Ok(()) => Row::at(check, place, Verdict::Ok, found),
        Err(fault) => Row::at(check, place, Verdict::Fail, fault.cause().to_string()),
    }
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
