//! `[store.fhir]` and `[store.hl7]`: stores that are servers, and what they have in common.

mod fhir;
mod hl7;

use http::Uri;

use super::fault::What;
use super::parse::{self, or_none};
use super::reader::{Absent, Reader};
use crate::flow::server::{Endpoint, EndpointFault, Secret, TlsFiles};
pub use fhir::FhirStoreConfig;
pub(super) use fhir::fhir;
pub use hl7::Hl7StoreConfig;
pub(super) use hl7::hl7;

/// How a credential of systemd is named.
const CREDENTIAL: &str = "credential:";

fn invalid(text: &str, what: &'static str, hint: &'static str) -> What {
    What::Invalid { text: text.into(), what, hint }
}

/// The address of a server, without a slash at its end.
fn address(text: &str) -> Result<String, What> {
    let what = "address of a server";
    let base = text.trim_end_matches('/');
    let uri: Uri = base
        .parse()
        .map_err(|_| invalid(text, what, "write \"https://fhir.clinic.example/r4\""))?;
    if uri.query().is_some() || uri.authority().is_some_and(|of| of.as_str().contains('@')) {
        let hint = "write it without ? and without user and password, which have keys of their own";
        return Err(invalid(text, what, hint));
    }
    match Endpoint::of(&uri) {
        Ok(_) => Ok(base.to_owned()),
        Err(EndpointFault::NotEncrypted) => {
            let hint = "write https: http is for a server on this machine only";
            Err(invalid(text, what, hint))
        }
        Err(_) => Err(invalid(text, what, "write \"https://fhir.clinic.example/r4\"")),
    }
}

/// A URI that names a system of identifiers or codes.
fn system(text: &str) -> Result<String, What> {
    let scheme = text.split_once(':').map(|(scheme, rest)| (scheme, rest.len()));
    let is_plain =
        text.bytes().all(|byte| byte.is_ascii_graphic() && !b"\"<>\\^`{|}".contains(&byte));
    match scheme {
        Some((scheme, 1..))
            if is_plain && scheme.bytes().all(|byte| byte.is_ascii_alphanumeric()) =>
        {
            Ok(text.to_owned())
        }
        _ => Err(invalid(
            text,
            "URI of a system",
            "write a URI: \"urn:oid:1.2.276.0.76.3.1.999\" or \"https://clinic.example/id\"",
        )),
    }
}

/// Where a secret is: a full path, or `credential:NAME`.
fn secret(text: &str) -> Result<Secret, What> {
    let Some(name) = text.strip_prefix(CREDENTIAL) else {
        return parse::full_path(text).map(Secret::File);
    };
    let is_name = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte));
    match is_name && !name.is_empty() && !name.starts_with('.') {
        true => Ok(Secret::Credential(name.to_owned())),
        false => Err(invalid(
            text,
            "place of a secret",
            "write the path of a file, or \"credential:NAME\" with letters, digits, -, _ and .",
        )),
    }
}

/// The bare name of a file of a record.
fn file_name(text: &str) -> Result<String, What> {
    let is_plain = text.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte));
    match is_plain && !text.is_empty() && !text.starts_with('.') {
        true => Ok(text.to_owned()),
        false => {
            Err(invalid(text, "bare name", "letters, digits, -, _ and ., as in \"report.pdf\""))
        }
    }
}

/// A text in a line, which may be empty.
fn line(text: &str) -> Result<String, What> {
    match text.chars().any(char::is_control) || text.chars().count() > 200 {
        true => Err(invalid(text, "text in a line", "write up to 200 characters in a line")),
        false => Ok(text.to_owned()),
    }
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
    let (at, key_at) = (certificate.at, key.at);
    match (certificate.value, key.value) {
        (Some(certificate), Some(key)) => {
            Some(TlsFiles { authorities, own: Some((certificate, key)) })
        }
        (None, None) => Some(TlsFiles { authorities, own: None }),
        (Some(_), None) => {
            reader.note(at, keys.certificate, What::Without(keys.key));
            None
        }
        (None, Some(_)) => {
            reader.note(key_at, keys.key, What::Without(keys.certificate));
            None
        }
    }
}
