//! `[store.fhir]`, `[store.hl7]`, `[store.dicom]`, `[store.archive]` and `[patient.worklist]`: servers, and what they have
//! in common.

mod archive;
#[cfg(feature = "dicom")]
mod dicom;
mod fhir;
mod hl7;
#[cfg(feature = "dicom")]
mod worklist;

use std::net::Ipv6Addr;
use std::ops::Range;

use gaiter_https::{Endpoint, EndpointFault, Secret, TlsFiles};
use http::Uri;

use super::parse::{self, Absent, Found, Reader, What, is_bare, or_none};
use super::words::Words;
pub use archive::ArchiveStoreConfig;
pub(super) use archive::archive;
#[cfg(feature = "dicom")]
pub use dicom::DicomStoreConfig;
#[cfg(feature = "dicom")]
pub(super) use dicom::dicom;
pub use fhir::FhirStoreConfig;
pub(super) use fhir::fhir;
pub use hl7::Hl7StoreConfig;
pub(super) use hl7::hl7;
#[cfg(feature = "dicom")]
pub use worklist::WorklistConfig;
#[cfg(feature = "dicom")]
pub(super) use worklist::worklist;

/// Whether a line that is not HTTP is encrypted: `store.hl7.encryption`, `store.dicom.encryption`,
/// `patient.worklist.encryption`.
const ENCRYPTIONS: Words<bool> = &[("tls", true), ("none", false)];

/// How the station calls itself to servers that know their peers by name, if nothing else is set.
const APPLICATION: &str = "GAITER";

/// The longest text in a message or header, characters.
const LINE_MOST: usize = 200;

/// The address of a server, without a slash at its end.
fn address(text: &str) -> Result<String, What> {
    let no_address = |hint| What::not_a(text, "a valid address of a server", hint);
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
    match Endpoint::from_uri(&uri) {
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
    found.ok_or_else(|| What::not_a(text, "a valid host and port", hint))
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
    Err(What::not_a(text, "a valid URI of a system", hint))
}

/// Where a secret is: a full path, or `credential:NAME`.
fn secret(text: &str) -> Result<Secret, What> {
    let hint =
        "write the full path of a file, or \"credential:NAME\" with letters, digits, -, _ and .";
    Secret::at(text).ok_or_else(|| What::not_a(text, "a valid place of a secret", hint))
}

/// The bare name of a file of a record.
fn file_name(text: &str) -> Result<String, What> {
    if is_bare(text) {
        return Ok(text.to_owned());
    }
    Err(What::not_a(text, "a valid bare name", "letters, digits, -, _ and ., as in \"report.pdf\""))
}

/// A text in a line, which may be empty.
fn line(text: &str) -> Result<String, What> {
    if text.chars().any(char::is_control) || text.chars().count() > LINE_MOST {
        return Err(What::not_a(
            text,
            "a valid text in a line",
            "write up to 200 characters in a line",
        ));
    }
    Ok(text.to_owned())
}

/// A user whose password is sent with the name: a colon ends the name (RFC 7617).
fn user(text: &str) -> Result<String, What> {
    if text.contains(':') {
        let hint = "write a name without a colon, which the password follows";
        return Err(What::not_a(text, "a valid user", hint));
    }
    line(text)
}

/// The keys of the certificates of a server: of the authorities that are trusted, the station's own, and its key.
type TlsKeys = [&'static str; 3];

/// Reads which certificates a store uses.
fn tls(reader: &mut Reader, [authorities, own, own_key]: TlsKeys) -> Option<TlsFiles> {
    let mut path = |key| reader.text(key, Absent::Default(""), or_none(parse::full_path));
    let (authorities, certificate) = (path(authorities), path(own));
    let key = reader.text(own_key, Absent::Default(""), or_none(secret));
    let (authorities, certificate, key) = (authorities?.value, certificate?, key?);
    let own = both(reader, (own, certificate), (own_key, key))?;
    Some(TlsFiles { authorities, own })
}

/// These certificates for a line that is not HTTP; `None` without encryption, where their keys have no effect.
fn tls_of_line(
    reader: &mut Reader,
    keys: TlsKeys,
    tls: TlsFiles,
    is_encrypted: bool,
) -> Option<TlsFiles> {
    if is_encrypted {
        return Some(tls);
    }
    reader.note_unread(&keys, || no_effect("with encryption = \"none\""));
    None
}

/// Notes all keys that are missing for an access, at its own key, or have no effect with it; each comes with whether it
/// is set and whether it is needed.
fn keys_of_access(
    reader: &mut Reader,
    at: Range<usize>,
    access: &str,
    keys: &[(&'static str, bool, bool)],
) {
    for &(key, is_set, is_needed) in keys {
        match (is_set, is_needed) {
            (false, true) => reader.note(at.clone(), access, set_without(key)),
            (true, false) => reader.note_unread(&[key], || no_effect("with this access")),
            _ => {}
        }
    }
}

/// The values of two keys that need each other, each with its key; `Some(None)` if neither is set.
fn both<A, B>(
    reader: &mut Reader,
    (key_a, a): (&'static str, Found<Option<A>>),
    (key_b, b): (&'static str, Found<Option<B>>),
) -> Option<Option<(A, B)>> {
    let (at, key, without) = match (a.value, b.value) {
        (Some(a), Some(b)) => return Some(Some((a, b))),
        (None, None) => return Some(None),
        (Some(_), None) => (a.at, key_a, key_b),
        (None, Some(_)) => (b.at, key_b, key_a),
    };
    reader.note(at, key, set_without(without));
    None
}

/// The fault of a key that needs another one.
fn set_without(key: &str) -> What {
    What::own(format!("is set without {key}"), format!("set {key} too"))
}

/// The fault of a key that nothing reads as the others are set.
fn no_effect(why: &str) -> What {
    What::own(format!("has no effect {why}"), "remove it")
}
