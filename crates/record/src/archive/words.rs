//! The words that keys of objects are made of. None of them can leave its place in a key.

use std::fmt;

use gaiter_leg::Method;
use gaiter_leg::method::{FacingChoice, Scope, UnitChoice, Up, Winding};
use hmac::{Hmac, Mac};
use serde::{Deserialize, Serialize};
use sha2::Sha256;

use crate::files::{hex, sha256};

/// The longest id of a station, characters.
const STATION_MOST: usize = 32;

/// How many digits of a method's hash are in its id.
const METHOD_DIGITS: usize = 8;

/// The digits of a SHA-256.
const SHA256_DIGITS: usize = 64;

/// A text that is not the word that it should be. The text itself may be anything, and is not told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum WordFault {
    /// No id of a station.
    #[error("a station's id has 1 to 32 letters, digits, - and _; this text ({len} bytes) is none")]
    Station {
        /// Its length, bytes.
        len: usize,
    },
    /// No id of a method.
    #[error("a method's id is a version, + and 8 digits; this text ({len} bytes) is none")]
    Method {
        /// Its length, bytes.
        len: usize,
    },
    /// No hash of a record.
    #[error(
        "a record's hash has 64 lower-case hexadecimal digits; this text ({len} bytes) is none"
    )]
    RecordHash {
        /// Its length, bytes.
        len: usize,
    },
    /// No key of a site.
    #[error("a site's key has 64 hexadecimal digits; this text is none")]
    SiteKey,
    /// No pseudonym.
    #[error("a pseudonym has 64 lower-case hexadecimal digits; this text ({len} bytes) is none")]
    Pseudonym {
        /// Its length, bytes.
        len: usize,
    },
}

/// A word that is written as text and checked when it is read.
macro_rules! word {
    ($(#[$of_word:meta])* $name:ident, $fault:ident, $is_one:expr) => {
        $(#[$of_word])*
        #[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(try_from = "String")]
        pub struct $name(String);

        impl $name {
            /// Parses it.
            ///
            /// # Errors
            /// The [`WordFault`] of its kind.
            pub fn parse(text: &str) -> Result<$name, WordFault> {
                let is_one: fn(&str) -> bool = $is_one;
                match is_one(text) {
                    true => Ok($name(text.to_owned())),
                    false => Err(WordFault::$fault { len: text.len() }),
                }
            }

            /// The text.
            pub fn as_str(&self) -> &str {
                &self.0
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&self.0)
            }
        }

        impl TryFrom<String> for $name {
            type Error = WordFault;

            fn try_from(text: String) -> Result<$name, WordFault> {
                $name::parse(&text)
            }
        }
    };
}

word! {
    /// The id of a station, as its configuration allows it.
    StationId, Station, |text| {
        let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_".contains(&byte);
        (1..=STATION_MOST).contains(&text.len()) && text.bytes().all(is_plain)
    }
}

word! {
    /// Program and method: gaiter's version, `+`, and the first digits of the SHA-256 of the method as JSON.
    MethodId, Method, |text| {
        let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b".-".contains(&byte);
        text.split_once('+').is_some_and(|(version, digits)| {
            version.starts_with(|first: char| first.is_ascii_digit())
                && version.bytes().all(is_plain)
                && digits.len() == METHOD_DIGITS
                && is_hexadecimal(digits)
        })
    }
}

word! {
    /// What stands for a patient outside of the house.
    Pseudonym, Pseudonym, |text| text.len() == SHA256_DIGITS && is_hexadecimal(text)
}

word! {
    /// The SHA-256 of a record's JSON, before it is packed.
    RecordHash, RecordHash, |text| text.len() == SHA256_DIGITS && is_hexadecimal(text)
}

impl RecordHash {
    /// The hash of a record's JSON.
    pub fn of_bytes(json: &[u8]) -> RecordHash {
        RecordHash(sha256(json))
    }
}

fn is_hexadecimal(text: &str) -> bool {
    text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

impl MethodId {
    /// The id of a method in this version. What does not count for a crop is not in it: unit, up, facing, winding
    /// and scope.
    ///
    /// # Errors
    /// If a figure of the method cannot be written as JSON.
    pub fn of(method: &Method) -> Result<MethodId, serde_json::Error> {
        let of_crop = Method {
            scope: Scope::default(),
            unit: UnitChoice::default(),
            up: Up::default(),
            facing: FacingChoice::default(),
            winding: Winding::default(),
            ..method.clone()
        };
        let hash = sha256(&serde_json::to_vec(&of_crop)?);
        Ok(MethodId(format!("{}+{}", env!("CARGO_PKG_VERSION"), &hash[..METHOD_DIGITS])))
    }
}

/// The key of a site, from which the pseudonyms of its patients are made. It never leaves the site.
pub struct SiteKey([u8; 32]);

impl SiteKey {
    /// Parses 64 hexadecimal digits.
    ///
    /// # Errors
    /// [`WordFault::SiteKey`] for anything else.
    pub fn parse(text: &str) -> Result<SiteKey, WordFault> {
        let digits: Option<Vec<u8>> =
            text.chars().map(|c| c.to_digit(16).and_then(|digit| digit.try_into().ok())).collect();
        let digits = digits.filter(|digits| digits.len() == SHA256_DIGITS);
        let digits = digits.ok_or(WordFault::SiteKey)?;
        Ok(SiteKey(std::array::from_fn(|at| (digits[2 * at] << 4) | digits[2 * at + 1])))
    }
}

impl fmt::Debug for SiteKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SiteKey")
    }
}

impl Pseudonym {
    /// HMAC-SHA-256 of a patient's id with the key of the site: without the key nobody can try ids out, and two sites
    /// have two pseudonyms for one person.
    pub fn of(site: &SiteKey, patient: &str) -> Pseudonym {
        // A key that is shorter than a block of the hash is filled up with zeros (RFC 2104).
        let mut block = [0; 64];
        block[..site.0.len()].copy_from_slice(&site.0);
        let mut mac = Hmac::<Sha256>::new(&block.into());
        mac.update(patient.as_bytes());
        Pseudonym(hex(&mac.finalize().into_bytes()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_that_could_leave_its_place_is_none() {
        for text in ["", "..", "a/b", "a.json", "a b", "ä", "a\n", "%2e", &"a".repeat(33)] {
            assert!(StationId::parse(text).is_err(), "{text:?}");
        }
        for text in ["", "0.1.0", "0.1.0+1234567", "+12345678", "../x+12345678", "0.1.0+1234567G"] {
            assert!(MethodId::parse(text).is_err(), "{text:?}");
        }
        assert!(StationId::parse("booth_1-b").is_ok());
        assert!(MethodId::parse("0.1.0-rc.1+0a1b2c3d").is_ok());
    }

    #[test]
    fn a_method_is_known_by_what_counts_for_a_crop() {
        let of = |method: &Method| MethodId::of(method).unwrap();
        let usual = Method::default();
        assert!(MethodId::parse(of(&usual).as_str()).is_ok());
        assert_eq!(of(&Method { up: Up::Z, ..usual.clone() }), of(&usual));
        assert_ne!(of(&Method { at_heights_mm: vec![150.0], ..usual.clone() }), of(&usual));
    }

    /// RFC 4231, test case 1 has a key of 20 bytes; filled up to 32 with zeros it is the same key.
    #[test]
    fn a_pseudonym_is_the_hmac_of_the_standard() {
        let key = format!("{}{}", "0b".repeat(20), "00".repeat(12));
        assert_eq!(
            Pseudonym::of(&SiteKey::parse(&key).unwrap(), "Hi There").as_str(),
            "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7"
        );
        for text in ["", &key[1..], &format!("{key}0"), &key.replace('b', "g")] {
            assert_eq!(SiteKey::parse(text).unwrap_err(), WordFault::SiteKey);
        }
    }
}
