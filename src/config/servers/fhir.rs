//! `[store.fhir]`: a FHIR R4 server.

use gaiter_https::{Endpoint, Proxy};

use super::{
    TlsKeys, address, both, file_name, host_and_port, keys_of_access, line, no_effect, secret,
    set_without, system, tls, user,
};
use crate::config::parse::{self, Absent, Found, Reader, What, or_none};
use crate::config::words::Words;
use crate::store::HttpAccess;
use crate::store::fhir::{FhirAccess, FhirServer, SmartAccess};

/// `[store.fhir]`: a FHIR R4 server that gets every named record.
#[derive(Debug, Clone)]
pub struct FhirStoreConfig {
    /// Where it is and how it is asked.
    pub server: FhirServer,
    /// The system of the identifiers of what is sent.
    pub identifiers: String,
    /// Files of the record that are sent with it.
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

const TLS: TlsKeys =
    ["store.fhir.authorities", "store.fhir.certificate", "store.fhir.certificate_key"];

/// Reads the keys of `[store.fhir]`. Without an address the section is off.
pub(in crate::config) fn fhir(reader: &mut Reader) -> Option<FhirStoreConfig> {
    use Absent::Default;
    let base = reader.text("store.fhir.address", Default(""), or_none(address));
    let patients = reader.text("store.fhir.patient_system", Default(""), or_none(system));
    let key = "store.fhir.identifier_system";
    let identifiers = reader.value(key, "urn:gaiter:record", system)?;
    let attach = "report.pdf\", \"record.json\", \"left.step\", \"right.step";
    let attach = reader.list("store.fhir.attach", Default(attach), file_name);
    let access = access(reader);
    let tls = tls(reader, TLS);
    let proxy = proxy(reader);
    let limit = reader.value("store.fhir.timeout", "30s", parse::duration_in("1s"..="50s"))?;
    let Found { value: base, at } = base.and_then(parse::if_set)?;
    let patients = patients?.value;
    if patients.is_none() {
        reader.note(at, "store.fhir.address", set_without("store.fhir.patient_system"));
    }
    let (access, tls, proxy, patients) = (access?, tls?, proxy?, patients?);
    let server = FhirServer { base, access, tls, proxy, limit, patients };
    let attach = attach.into_iter().map(|found| found.value).collect();
    Some(FhirStoreConfig { server, identifiers, attach })
}

/// Further keys that have an effect with SMART only.
const FOR_SMART: [&str; 3] = ["store.fhir.key_id", "store.fhir.scope", "store.fhir.token_address"];

/// How the station authenticates.
fn access(reader: &mut Reader) -> Option<FhirAccess> {
    use Absent::Default;
    let kind = reader.text("store.fhir.access", Default("open"), parse::word(KINDS));
    let user = reader.text("store.fhir.user", Default(""), or_none(user));
    let secret = reader.text("store.fhir.secret", Default(""), or_none(secret));
    let client = reader.text("store.fhir.client", Default(""), or_none(line));
    let key_id = reader.value("store.fhir.key_id", "", line)?;
    let scope = "system/Patient.rs system/Device.crs system/Observation.crus \
                 system/DiagnosticReport.crus system/DocumentReference.crus";
    let scope = reader.value("store.fhir.scope", scope, line)?;
    let token_address = reader.value("store.fhir.token_address", "", or_none(address))?;
    let Found { value: kind, at } = kind?;
    let (user, secret, client) = (user?.value, secret?.value, client?.value);
    let keys = [
        ("store.fhir.user", user.is_some(), kind == Kind::Basic),
        ("store.fhir.secret", secret.is_some(), kind != Kind::Open),
        ("store.fhir.client", client.is_some(), kind == Kind::Smart),
    ];
    keys_of_access(reader, at, "store.fhir.access", &keys);
    if kind != Kind::Smart {
        reader.note_unread(&FOR_SMART, || no_effect("with this access"));
    }
    Some(match kind {
        Kind::Open => FhirAccess::Http(HttpAccess::Open),
        Kind::Basic => FhirAccess::Http(HttpAccess::Basic { user: user?, password: secret? }),
        Kind::Bearer => FhirAccess::Http(HttpAccess::Bearer { token: secret? }),
        Kind::Smart => FhirAccess::Smart(SmartAccess {
            client: client?,
            key: secret?,
            key_id,
            scope,
            token_address,
        }),
    })
}

/// The proxy between station and server.
fn proxy(reader: &mut Reader) -> Option<Option<Proxy>> {
    use Absent::Default;
    const USER: &str = "store.fhir.proxy_user";
    const SECRET: &str = "store.fhir.proxy_secret";
    let found = reader.text("store.fhir.proxy", Default(""), or_none(endpoint));
    let user = reader.text(USER, Default(""), or_none(user));
    let password = reader.text(SECRET, Default(""), or_none(secret));
    let user = both(reader, (USER, user?), (SECRET, password?))?;
    Some(found?.value.map(|endpoint| Proxy { endpoint, user }))
}

/// `proxy.clinic.example:3128`
fn endpoint(text: &str) -> Result<Endpoint, What> {
    host_and_port(text).map(|(host, port)| Endpoint { host, port, is_encrypted: false })
}
