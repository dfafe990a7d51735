//! `[store.fhir]`: a FHIR R4 server.

use super::{TlsKeys, address, file_name, line, secret, system, tls};
use crate::config::fault::What;
use crate::config::parse::{self, Bounds, or_none};
use crate::config::reader::{Absent, Found, Reader};
use crate::config::words::Words;
use crate::flow::server::fhir::{Access, FhirServer, Missing, SmartAccess};
use crate::flow::server::{Endpoint, Proxy, Secret};

/// `[store.fhir]`: a FHIR R4 server that gets every named record.
#[derive(Debug, Clone)]
pub struct FhirStoreConfig {
    /// Where it is and how it is asked.
    pub server: FhirServer,
    /// The system of the identifiers of what is sent.
    pub identifiers: String,
    /// The system of gaiter's own codes.
    pub codes: String,
    /// Files of the record that go along.
    pub attach: Vec<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Open,
    Basic,
    Bearer,
    Smart,
}

/// `store.fhir.access`
const KINDS: Words<Kind> = &[
    ("open", Kind::Open),
    ("basic", Kind::Basic),
    ("bearer", Kind::Bearer),
    ("smart", Kind::Smart),
];

/// `store.fhir.missing_patient`
const MISSINGS: Words<Missing> = &[("wait", Missing::Wait), ("create", Missing::Create)];

const TLS: TlsKeys = TlsKeys {
    authorities: "store.fhir.authorities",
    certificate: "store.fhir.certificate",
    key: "store.fhir.certificate_key",
};

/// Reads the keys of `[store.fhir]`. Without an address the section is off.
pub(in crate::config) fn fhir(reader: &mut Reader) -> Option<Option<FhirStoreConfig>> {
    use Absent::Default;
    let base = reader.text("store.fhir.address", Default(""), or_none(address));
    let patients = reader.text("store.fhir.patient_system", Default(""), or_none(system));
    let missing = reader.text("store.fhir.missing_patient", Default("wait"), parse::word(MISSINGS));
    let key = "store.fhir.identifier_system";
    let identifiers = reader.text(key, Default("urn:gaiter:record"), system);
    let codes = reader.text("store.fhir.code_system", Default("urn:gaiter:measure"), system);
    let attach = "report.pdf\", \"record.json";
    let attach = reader.list("store.fhir.attach", Default(attach), file_name);
    let access = access(reader);
    let tls = tls(reader, &TLS);
    let proxy = proxy(reader);
    let bounds = Bounds { least: "1s", most: "50s" };
    let limit = reader.text("store.fhir.timeout", Default("30s"), parse::duration_in(bounds));
    let Found { value: base, at } = base?;
    let Some(base) = base else { return Some(None) };
    let patients = patients?.value;
    if patients.is_none() {
        reader.note(at, "store.fhir.address", What::Without("store.fhir.patient_system"));
    }
    let server = FhirServer {
        base,
        access: access?,
        tls: tls?,
        proxy: proxy?,
        limit: limit?.value,
        patients: patients?,
        missing: missing?.value,
    };
    Some(Some(FhirStoreConfig {
        server,
        identifiers: identifiers?.value,
        codes: codes?.value,
        attach: attach.into_iter().map(|found| found.value).collect(),
    }))
}

/// How the station shows that it may.
fn access(reader: &mut Reader) -> Option<Access> {
    use Absent::Default;
    let kind = reader.text("store.fhir.access", Default("open"), parse::word(KINDS));
    let user = reader.text("store.fhir.user", Default(""), line);
    let secret = reader.text("store.fhir.secret", Default(""), or_none(secret));
    let client = reader.text("store.fhir.client", Default(""), line);
    let key_id = reader.text("store.fhir.key_id", Default(""), line);
    let scope = "system/Patient.rs system/Device.crs system/Observation.crus \
                 system/DiagnosticReport.crus system/DocumentReference.crus";
    let scope = reader.text("store.fhir.scope", Default(scope), line);
    let key = "store.fhir.token_address";
    let token_address = reader.text(key, Default(""), or_none(address));
    let Found { value: kind, at } = kind?;
    let (user, secret, client) = (user?.value, secret?.value, client?.value);
    let (key_id, scope, token_address) = (key_id?.value, scope?.value, token_address?.value);
    let mut needs = |has: bool, key: &'static str| {
        if !has {
            reader.note(at.clone(), "store.fhir.access", What::Without(key));
        }
        has.then_some(())
    };
    if kind == Kind::Open {
        return Some(Access::Open);
    }
    let secret: Option<Secret> = match secret {
        Some(secret) => Some(secret),
        None => {
            needs(false, "store.fhir.secret");
            None
        }
    };
    match kind {
        Kind::Open => Some(Access::Open),
        Kind::Bearer => Some(Access::Bearer { token: secret? }),
        Kind::Basic => {
            needs(!user.is_empty(), "store.fhir.user")?;
            Some(Access::Basic { user, password: secret? })
        }
        Kind::Smart => {
            needs(!client.is_empty(), "store.fhir.client")?;
            let key = secret?;
            Some(Access::Smart(SmartAccess { client, key, key_id, scope, token_address }))
        }
    }
}

/// The proxy between station and server.
fn proxy(reader: &mut Reader) -> Option<Option<Proxy>> {
    use Absent::Default;
    let found = reader.text("store.fhir.proxy", Default(""), or_none(endpoint));
    let user = reader.text("store.fhir.proxy_user", Default(""), line)?;
    let password = reader.text("store.fhir.proxy_secret", Default(""), or_none(secret))?;
    let user = match (user.value.is_empty(), password.value) {
        (true, None) => None,
        (false, Some(password)) => Some((user.value, password)),
        (true, Some(_)) => {
            let missing = What::Without("store.fhir.proxy_user");
            reader.note(password.at, "store.fhir.proxy_secret", missing);
            return None;
        }
        (false, None) => {
            let missing = What::Without("store.fhir.proxy_secret");
            reader.note(user.at, "store.fhir.proxy_user", missing);
            return None;
        }
    };
    Some(found?.value.map(|endpoint| Proxy { endpoint, user }))
}

/// `proxy.clinic.example:3128`
fn endpoint(text: &str) -> Result<Endpoint, What> {
    super::hl7::host_and_port(text).map(|(host, port)| Endpoint { host, port, is_encrypted: false })
}
