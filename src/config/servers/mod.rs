//! `[store.fhir]` and `[store.hl7]`: stores that are servers, and what they have in common.

mod fhir;
mod hl7;

use std::net::Ipv6Addr;

use http::Uri;

use super::fault::What;
use super::parse::{self, invalid, or_none};
use super::reader::{Absent, Reader};
use crate::store::endpoint::{Endpoint, EndpointFault, Secret, TlsFiles};
pub use fhir::FhirStoreConfig;
pub(super) use fhir::fhir;
pub use hl7::Hl7StoreConfig;
pub(super) use hl7::hl7;

/// How a credential of systemd is named.
const CREDENTIAL: &str = "credential:";

/// The longest text in a message or header, characters.
const LINE_MOST: usize = 200;

/// The address of a server, without a slash at its end.
fn address(text: &str) -> Result<String, What> {
    let no_address = |hint| invalid(text, "address of a server", hint);
    let base = text.trim_end_matches('/');
    let example = "write \"https://fhir.clinic.example/r4\"";
    let uri: Uri = base.parse().map_err(|_| no_address(example))?;
    // What follows # is never sent: without it the address would be another one.
    let is_more = uri.query().is_some() || text.contains('#');
    if is_more || uri.authority().is_some_and(|of| of.as_str().contains('@')) {
        let hint =
            "write it without ? and #, and without user and password, which have keys of their own";
        return Err(no_address(hint));
    }
    match Endpoint::of(&uri) {
        Ok(_) => Ok(base.to_owned()),
        Err(EndpointFault::NotEncrypted) => {
            Err(no_address("write https: http is for a server on this machine only"))
        }
        Err(_) => Err(no_address(example)),
    }
}

/// `kis.clinic.example:2575`
fn host_and_port(text: &str) -> Result<(String, u16), What> {
    let found = text.rsplit_once(':').and_then(|(host, port)| {
        let port: u16 = port.parse().ok().filter(|port| *port > 0)?;
        is_host(host).then(|| (host.to_owned(), port))
    });
    let hint = "write host and port: \"kis.clinic.example:2575\"";
    found.ok_or_else(|| invalid(text, "host and port", hint))
}

/// A name, an address of IPv4, or one of IPv6 in brackets.
fn is_host(host: &str) -> bool {
    match host.strip_prefix('[').and_then(|host| host.strip_suffix(']')) {
        Some(address) => address.parse::<Ipv6Addr>().is_ok(),
        None => {
            let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._".contains(&byte);
            !host.is_empty() && host.bytes().all(is_plain)
        }
    }
}

/// A URI that names a system of identifiers.
fn system(text: &str) -> Result<String, What> {
    let is_plain = |byte: u8| byte.is_ascii_graphic() && !b"\"<>\\^`{|}".contains(&byte);
    let is_uri = text.split_once(':').is_some_and(|(scheme, rest)| {
        !scheme.is_empty()
            && scheme.bytes().all(|of| of.is_ascii_alphanumeric())
            && !rest.is_empty()
    });
    if is_uri && text.bytes().all(is_plain) {
        return Ok(text.to_owned());
    }
    let hint = "write a URI: \"urn:oid:1.2.276.0.76.3.1.999\" or \"https://clinic.example/id\"";
    Err(invalid(text, "URI of a system", hint))
}

/// Where a secret is: a full path, or `credential:NAME`.
fn secret(text: &str) -> Result<Secret, What> {
    let place = match text.strip_prefix(CREDENTIAL) {
        Some(name) => is_bare(name).then(|| Secret::Credential(name.to_owned())),
        None => parse::full_path(text).ok().map(Secret::File),
    };
    let hint =
        "write the full path of a file, or \"credential:NAME\" with letters, digits, -, _ and .";
    place.ok_or_else(|| invalid(text, "place of a secret", hint))
}

/// The bare name of a file of a record.
fn file_name(text: &str) -> Result<String, What> {
    if is_bare(text) {
        return Ok(text.to_owned());
    }
    Err(invalid(text, "bare name", "letters, digits, -, _ and ., as in \"report.pdf\""))
}

fn is_bare(name: &str) -> bool {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte);
    !name.is_empty() && !name.starts_with('.') && name.bytes().all(is_plain)
}

/// A text in a line, which may be empty.
fn line(text: &str) -> Result<String, What> {
    if text.chars().any(char::is_control) || text.chars().count() > LINE_MOST {
        return Err(invalid(text, "text in a line", "write up to 200 characters in a line"));
    }
    Ok(text.to_owned())
}

/// A user whose password is sent with the name: a colon ends the name (RFC 7617).
fn user(text: &str) -> Result<String, What> {
    if text.contains(':') {
        let hint = "write a name without a colon, which the password follows";
        return Err(invalid(text, "user", hint));
    }
    line(text)
}

/// The keys of the certificates of a store, in their order.
struct TlsKeys {
    authorities: &'static str,
    certificate: &'static str,
    key: &'static str,
}

/// Reads which certificates a store uses.
fn tls(reader: &mut Reader, keys: &TlsKeys) -> Option<TlsFiles> {
    let mut path = |key| reader.text(key, Absent::Default(""), or_none(parse::full_path));
    let (authorities, certificate) = (path(keys.authorities), path(keys.certificate));
    let key = reader.text(keys.key, Absent::Default(""), or_none(secret));
    let (authorities, certificate, key) = (authorities?.value, certificate?, key?);
    match (certificate.value, key.value) {
        (Some(certificate), Some(key)) => {
            Some(TlsFiles { authorities, own: Some((certificate, key)) })
        }
        (None, None) => Some(TlsFiles { authorities, own: None }),
        (Some(_), None) => {
            reader.note(certificate.at, keys.certificate, What::Without(keys.key));
            None
        }
        (None, Some(_)) => {
            reader.note(key.at, keys.key, What::Without(keys.certificate));
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_server_is_asked_by_https_and_only_this_machine_without() {
        for text in ["https://fhir.clinic.example/r4", "http://localhost:8103/r4", "http://[::1]/"]
        {
            assert_eq!(address(text).as_deref(), Ok(text.trim_end_matches('/')));
        }
        for text in [
            "fhir.clinic.example/r4",
            "http://fhir.clinic.example/r4",
            "https://user:word@fhir.clinic.example",
            "https://fhir.clinic.example/r4?x=1",
            "https://fhir.clinic.example/r4#x",
            "ftp://fhir.clinic.example",
            "https:///r4",
        ] {
            assert!(address(text).is_err(), "{text}");
        }
    }

    #[test]
    fn host_and_port_are_both_written_and_ipv6_in_brackets() {
        for (text, host) in
            [("kis.clinic.example:2575", "kis.clinic.example"), ("[fd00::7]:2575", "[fd00::7]")]
        {
            assert_eq!(host_and_port(text), Ok((host.to_owned(), 2575)));
        }
        for text in ["kis", "kis:", ":2575", "kis:0", "kis:65536", "fd00::7:2575", "mllp://kis:1"] {
            assert!(host_and_port(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_secret_is_a_place_and_never_the_secret_itself() {
        assert_eq!(secret("/etc/gaiter/token"), Ok(Secret::File("/etc/gaiter/token".into())));
        assert_eq!(secret("credential:fhir"), Ok(Secret::Credential("fhir".to_owned())));
        for text in ["Quastenflosser", "credential:", "credential:../x", "credential:.x", "token"] {
            assert!(secret(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_system_is_a_uri() {
        for text in ["urn:oid:1.2.276.0.76.3.1.999", "https://clinic.example/id"] {
            assert_eq!(system(text).as_deref(), Ok(text));
        }
        for text in ["clinic", "urn:", ":x", "urn:a b", "urn:a|b", "urn:ä"] {
            assert!(system(text).is_err(), "{text}");
        }
    }
}
