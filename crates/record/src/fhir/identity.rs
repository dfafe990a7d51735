//! What identifies a resource: always the same for one part of one scan of one patient.

use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::{hex, sha256};

/// Hexadecimal digits of a key: two records share one with a probability of 2⁻¹²⁸.
const DIGITS: usize = 32;

/// Identifies a scan of a patient, and shows neither.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FhirKey(String);

impl FhirKey {
    /// The key of a scan, by the hash of its bytes, and a patient's id.
    pub fn new(scan: &str, patient: &str) -> FhirKey {
        let mut digits = sha256(format!("{scan}\0{patient}").as_bytes());
        digits.truncate(DIGITS);
        FhirKey(digits)
    }

    /// The value that all resources of the record have.
    pub fn record(&self) -> String {
        self.0.clone()
    }

    /// The value that only one part of the record has.
    pub fn part(&self, part: &str) -> String {
        format!("{}/{part}", self.0)
    }

    /// The value that resources have which a station withdrew.
    pub fn withdrawal(&self, station: &str) -> String {
        format!("{}/w/{station}", self.0)
    }

    /// The value that all resources of a revision have.
    pub fn revision(&self, revision: u32) -> String {
        format!("{}/r{revision}", self.0)
    }
}

/// An identifier: a value and the system in which it is unique.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identifier {
    /// The system, a URI.
    pub system: String,
    /// The value.
    pub value: String,
}

impl Identifier {
    /// It as JSON.
    pub fn json(&self) -> Value {
        json!({ "system": self.system, "value": self.value })
    }

    /// It as the value of a search by `identifier`, encoded for a query.
    pub fn query(&self) -> String {
        format!("{}%7C{}", escaped(&self.system), escaped(&self.value))
    }

    /// Whether a resource has it. A server that answers a search with something else is not believed.
    pub fn is_of(&self, resource: &Value) -> bool {
        self.is_among(resource, |one, other| one == other)
    }

    /// Whether a resource has it but for capital and small letters, which a search need not distinguish (R4,
    /// token).
    pub fn is_like(&self, resource: &Value) -> bool {
        self.is_among(resource, |one, other| one.to_lowercase() == other.to_lowercase())
    }

    fn is_among(&self, resource: &Value, is_same: fn(&str, &str) -> bool) -> bool {
        let is = |of: &Value, text: &str| of.as_str().is_some_and(|of| is_same(of, text));
        let mut own = resource["identifier"].as_array().into_iter().flatten();
        own.any(|of| is(&of["system"], &self.system) && is(&of["value"], &self.value))
    }
}

/// A text in which everything but unreserved letters (RFC 3986) is percent-encoded. A comma, dollar or bar of
/// its own would be a sign of the search; it is escaped first, as FHIR asks.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for letter in text.chars() {
        if matches!(letter, ',' | '$' | '|' | '\\') {
            escaped.push_str("%5C");
        }
        let mut bytes = [0; 4];
        for byte in letter.encode_utf8(&mut bytes).bytes() {
            match byte {
                b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' => {
                    escaped.push(char::from(byte));
                }
                byte => escaped.push_str(&format!("%{byte:02X}")),
            }
        }
    }
    escaped
}

/// A UUID that is always the same for one text.
pub fn uuid(text: &str) -> String {
    let digits = hex(&uuid_bytes(text));
    [&digits[..8], &digits[8..12], &digits[12..16], &digits[16..20], &digits[20..]].join("-")
}

/// The bytes of that UUID: version 8 of RFC 9562, from the SHA-256 of the text.
pub fn uuid_bytes(text: &str) -> [u8; 16] {
    let mut bytes = [0; 16];
    bytes.copy_from_slice(&Sha256::digest(text.as_bytes())[..16]);
    bytes[6] = (bytes[6] & 0x0f) | 0x80;
    bytes[8] = (bytes[8] & 0x3f) | 0x80;
    bytes
}
