//! Where a server is, what is trusted on the way to it, and where the station's secrets are.

use std::fmt;
use std::net::IpAddr;
use std::path::{Component, Path, PathBuf};

use http::Uri;

/// A host, its port, and whether it is asked with TLS.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Endpoint {
    /// Name or address of the host; an IPv6 address in brackets.
    pub host: String,
    pub port: u16,
    /// Whether the connection is encrypted.
    pub is_encrypted: bool,
}

/// Why an address is none that the station asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EndpointFault {
    /// It names no host, or more than one: a user, a password.
    #[error("the address is not one of a server")]
    Address,
    /// Without TLS only this machine is asked.
    #[error("a server on another machine is only asked by https")]
    NotEncrypted,
}

/// A proxy that lets connections through (CONNECT).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Proxy {
    /// Where it is. What goes through is encrypted, the way to the proxy itself is not.
    pub endpoint: Endpoint,
    /// User and password, if it asks for them.
    pub user: Option<(String, Secret)>,
}

impl Endpoint {
    /// The endpoint of an address.
    ///
    /// # Errors
    /// If the address names no host, or one of another machine without TLS.
    pub fn from_uri(uri: &Uri) -> Result<Endpoint, EndpointFault> {
        let authority = uri.authority().ok_or(EndpointFault::Address)?;
        let host = authority.host();
        if host.is_empty() || authority.as_str().contains('@') {
            return Err(EndpointFault::Address);
        }
        let is_encrypted = match uri.scheme_str() {
            Some("https") => true,
            Some("http") if is_this_machine(host) => false,
            Some("http") => return Err(EndpointFault::NotEncrypted),
            _ => return Err(EndpointFault::Address),
        };
        let port = authority.port_u16().unwrap_or(if is_encrypted { 443 } else { 80 });
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
        bare(&self.host)
    }
}

/// Whether a host is this machine itself: what is sent there goes through no network.
pub fn is_this_machine(host: &str) -> bool {
    let name = bare(host);
    name == "localhost" || name.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
}

fn bare(host: &str) -> &str {
    host.strip_prefix('[').and_then(|host| host.strip_suffix(']')).unwrap_or(host)
}

/// Which certificates are used.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TlsFiles {
    /// The certificates of authorities (PEM) that are trusted; `None` for those of the system.
    pub authorities: Option<PathBuf>,
    /// The station's certificate (PEM, with those between it and the authority) and its key, where the server
    /// asks for one.
    pub own: Option<(PathBuf, Secret)>,
}

impl TlsFiles {
    /// The station's certificate.
    pub fn certificate(&self) -> Option<&Path> {
        self.own.as_ref().map(|(certificate, _)| certificate.as_path())
    }

    /// The key of the station's certificate.
    pub fn key(&self) -> Option<&Secret> {
        self.own.as_ref().map(|(_, key)| key)
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Secret {
    File(PathBuf),
    /// In a credential of systemd (`LoadCredential=`), by its name.
    Credential(String),
}

impl Secret {
    /// What the name of a credential begins with.
    const CREDENTIAL: &'static str = "credential:";

    /// The place that a text names: a full path, or `credential:NAME`; `None` if it is neither.
    pub fn at(text: &str) -> Option<Secret> {
        if let Some(name) = text.strip_prefix(Secret::CREDENTIAL) {
            let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte);
            let is_bare = !name.is_empty() && !name.starts_with('.') && name.bytes().all(is_plain);
            return is_bare.then(|| Secret::Credential(name.to_owned()));
        }
        let path = Path::new(text);
        let climbs = path.components().any(|part| part == Component::ParentDir);
        let is_full = path.is_absolute() && !climbs && !text.contains(char::is_control);
        is_full.then(|| Secret::File(path.components().collect()))
    }
}

impl fmt::Display for Secret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Secret::File(path) => write!(f, "{}", path.display()),
            Secret::Credential(name) => write!(f, "credential {name}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(address: &str) -> Result<Endpoint, EndpointFault> {
        Endpoint::from_uri(&address.parse().unwrap())
    }

    #[test]
    fn without_tls_only_this_machine_is_asked() {
        for host in ["localhost", "127.0.0.1", "127.8.8.8", "[::1]"] {
            assert!(!parsed(&format!("http://{host}:8080/r4")).unwrap().is_encrypted, "{host}");
        }
        for host in
            ["fhir.clinic.example", "10.0.0.7", "[fe80::1]", "localhost.example", "128.0.0.1"]
        {
            assert_eq!(
                parsed(&format!("http://{host}/r4")),
                Err(EndpointFault::NotEncrypted),
                "{host}"
            );
            assert!(parsed(&format!("https://{host}/r4")).unwrap().is_encrypted, "{host}");
        }
    }

    #[test]
    fn an_address_names_one_host_and_nobody() {
        for address in
            ["/r4", "ftp://fhir.clinic.example", "https://user:secret@fhir.clinic.example/"]
        {
            assert_eq!(parsed(address), Err(EndpointFault::Address), "{address}");
        }
    }

    #[test]
    fn a_usual_port_is_not_written() {
        let written = |address: &str| parsed(address).unwrap().authority();
        assert_eq!(written("https://fhir.clinic.example/r4"), "fhir.clinic.example");
        assert_eq!(written("https://fhir.clinic.example:443/r4"), "fhir.clinic.example");
        assert_eq!(written("https://fhir.clinic.example:8443"), "fhir.clinic.example:8443");
        assert_eq!(written("http://[::1]:80"), "[::1]");
        assert_eq!(parsed("http://[::1]:8080").unwrap().name(), "::1");
    }
}
