//! A FHIR server: where it is, and how the station authenticates.

use std::time::Duration;

use gaiter_https::{Proxy, Secret, TlsFiles};

use crate::store::HttpAccess;

/// Where a server is and how it is asked.
#[derive(Debug, Clone)]
pub struct FhirServer {
    /// The base address, without a slash at its end.
    pub base: String,
    /// How the station authenticates.
    pub access: FhirAccess,
    /// What connections trust.
    pub tls: TlsFiles,
    /// The proxy between station and server, if there is one.
    pub proxy: Option<Proxy>,
    /// For a whole exchange.
    pub limit: Duration,
    /// The system of patients' ids on the server.
    pub patients: String,
}

/// How the station authenticates.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FhirAccess {
    /// As with any server.
    Http(HttpAccess),
    /// By SMART Backend Services: a signed statement gives a token for some minutes.
    Smart(SmartAccess),
}

/// What SMART Backend Services needs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SmartAccess {
    /// The client, as the server knows it.
    pub client: String,
    /// The private key (PKCS#8 as PEM): P-384 signs as ES384, RSA as RS384.
    pub key: Secret,
    /// The name of the key at the server; empty for none.
    pub key_id: String,
    /// What the station asks to be allowed.
    pub scope: String,
    /// Where tokens are given; `None` to ask the server.
    pub token_address: Option<String>,
}

impl FhirServer {
    /// Every secret that connections with it need.
    pub fn secrets(&self) -> Vec<&Secret> {
        let of_access = match &self.access {
            FhirAccess::Http(access) => access.secret(),
            FhirAccess::Smart(smart) => Some(&smart.key),
        };
        let of_proxy = self.proxy.as_ref().and_then(|proxy| proxy.user.as_ref());
        let of_proxy = of_proxy.map(|(_, password)| password);
        [of_access, of_proxy, self.tls.key()].into_iter().flatten().collect()
    }
}
