//! Servers that take records: where they are, what is trusted, and where the station's secrets are.

pub mod fhir;
pub mod hl7;

/// The stores that are servers, by their names in the journal.
pub const SERVERS: [&str; 2] = [fhir::NAME, hl7::NAME];

use core::net::IpAddr;
use std::fmt;
use std::path::PathBuf;

use http::Uri;

/// A host, its port, and whether it is asked with TLS.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Endpoint {
    /// Name or address of the host.
    pub host: String,
    /// The port.
    pub port: u16,
    /// Whether the connection is encrypted.
    pub is_encrypted: bool,
}

/// Why an address is none that the station asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EndpointFault {
    /// The address is none, or names no host.
    #[error("the address is not one of a server")]
    Address,
    /// Without TLS only this machine is asked.
    #[error("a server on another machine is only asked by https")]
    NotEncrypted,
}

/// A proxy that lets connections through (CONNECT).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Proxy {
    /// Where it is.
    pub endpoint: Endpoint,
    /// User and password, if it asks for them.
    pub user: Option<(String, Secret)>,
}

impl Endpoint {
    /// The endpoint of an address.
    ///
    /// # Errors
    /// If the address names no host, or one of another machine without TLS.
    pub fn of(uri: &Uri) -> Result<Endpoint, EndpointFault> {
        let host = uri.host().filter(|host| !host.is_empty()).ok_or(EndpointFault::Address)?;
        let is_encrypted = match uri.scheme_str() {
            Some("https") => true,
            Some("http") if is_this_machine(host) => false,
            Some("http") => return Err(EndpointFault::NotEncrypted),
            _ => return Err(EndpointFault::Address),
        };
        let port = uri.port_u16().unwrap_or(if is_encrypted { 443 } else { 80 });
        Ok(Endpoint { host: host.to_owned(), port, is_encrypted })
    }

    /// Host and port, the port only if it is not the usual one.
    pub fn authority(&self) -> String {
        let usual = if self.is_encrypted { 443 } else { 80 };
        match self.port == usual {
            true => self.host.clone(),
            false => format!("{}:{}", self.host, self.port),
        }
    }

    /// The host without the brackets of an IPv6 address.
    pub fn name(&self) -> &str {
        self.host.trim_start_matches('[').trim_end_matches(']')
    }
}

/// Whether a host is this machine itself: what is sent there leaves it for no network.
pub fn is_this_machine(host: &str) -> bool {
    let name = host.trim_start_matches('[').trim_end_matches(']');
    name == "localhost" || name.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
}

/// Which certificates are used.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TlsFiles {
    /// The certificates of authorities (PEM) that are trusted; `None` for those of the system.
    pub authorities: Option<PathBuf>,
    /// The station's certificate and its key (PEM), where the server asks for one.
    pub own: Option<(PathBuf, Secret)>,
}

/// Where a secret is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Secret {
    /// In a file.
    File(PathBuf),
    /// In a credential of systemd (`LoadCredential=`), by its name.
    Credential(String),
}

impl fmt::Display for Secret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Secret::File(path) => write!(f, "{}", path.display()),
            Secret::Credential(name) => write!(f, "credential {name}"),
        }
    }
}
