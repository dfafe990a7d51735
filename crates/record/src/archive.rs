//! What stations write into an archive of many of them, as bytes: the names of objects, announcements, heartbeats and
//! results. Objects are the truth of an archive; whatever indexes them can be made again from these.
//!
//! | object | key | content |
//! |---|---|---|
//! | crop of a scan | `scan/<ab>/<sha256>.ply.zst` | [`Extraction::crop`](gaiter_leg::Extraction::crop) as PLY, [`packed`] |
//! | the station's record | `record/<station>/<sha256>/<record>.json.zst` | [`pseudonymous()`] [`Record`](crate::Record), packed |
//! | announcement, written last | `inbox/<station>/<sha256>-r<revision>-<at>.json` | [`Announcement`] |
//! | withdrawal | `inbox/<station>/<export>-withdrawn-<at>.json` | [`Withdrawal`] |
//! | both, once indexed | the same below `announced/` | the same |
//! | result of a method | `result/<method>/<ab>/<sha256>.json.zst` | [`ScanResult`], packed |
//! | heartbeat, overwritten | `fleet/<station>.json` | [`Heartbeat`] |
//!
//! `<sha256>` is that of the crop's PLY, before it is packed; `<ab>` are its first two digits. `<record>` is the SHA-256
//! of the record's JSON, `<export>` that of the scanner's file, `<at>` the time at which the station says so, milliseconds
//! since 1970. So nothing but the heartbeat has a key under which other content lay before.
//!
//! What a station says of a scan is ordered by `at` alone. That is the time of its clock, or a millisecond after what it
//! said before if its clock was set back since: what is said later is later.

mod announcement;
mod heartbeat;
mod key;
mod packing;
mod pseudonymous;
mod result;
mod words;

pub use announcement::{Announcement, Withdrawal};
pub use heartbeat::Heartbeat;
pub use key::{KeyFault, ObjectKey};
pub use packing::{PackingFault, packed, unpacked};
pub use pseudonymous::pseudonymous;
pub use result::{Outcome, ScanResult};
pub use words::{MethodId, Pseudonym, RecordHash, SiteKey, StationId, WordFault};

/// Why the bytes of an object are no document of an archive.
#[derive(Debug, thiserror::Error)]
pub enum DocumentFault {
    /// It is no JSON, or lacks fields.
    #[error("it is no {schema}: {source}")]
    NotReadable {
        /// What was expected.
        schema: &'static str,
        /// Why it is none.
        source: serde_json::Error,
    },
    /// It is of another schema.
    #[error("its schema is {found:?}, not {schema}")]
    OtherSchema {
        /// What was expected.
        schema: &'static str,
        /// Its text.
        found: String,
    },
    /// It lies under a key that is not its own.
    #[error("it says of itself that it is {own}")]
    Elsewhere {
        /// The key by its content.
        own: Box<ObjectKey>,
    },
}

/// A document that says of itself what it is and where it lies.
pub trait Document: serde::Serialize + serde::de::DeserializeOwned {
    /// Name and number of its schema.
    const SCHEMA: &'static str;

    /// The schema that it names.
    fn schema(&self) -> &str;

    /// The key of its object, by its content.
    fn key(&self) -> ObjectKey;

    /// Its bytes, not packed.
    ///
    /// # Errors
    /// If a figure cannot be written as JSON.
    fn json(&self) -> Result<Vec<u8>, serde_json::Error> {
        serde_json::to_vec(self)
    }

    /// Reads the bytes of the object at this key.
    ///
    /// # Errors
    /// See [`DocumentFault`].
    fn read_at(key: &ObjectKey, bytes: &[u8]) -> Result<Self, DocumentFault> {
        let schema = Self::SCHEMA;
        let read: Self = serde_json::from_slice(bytes)
            .map_err(|source| DocumentFault::NotReadable { schema, source })?;
        if read.schema() != schema {
            return Err(DocumentFault::OtherSchema { schema, found: read.schema().to_owned() });
        }
        match read.key() {
            own if own == *key => Ok(read),
            own => Err(DocumentFault::Elsewhere { own: Box::new(own) }),
        }
    }
}

#[cfg(test)]
mod tests {
    use jiff::Timestamp;

    use super::*;

    /// As version 0.1.0 wrote it. It is never written anew: archives keep announcements for as long as they last, and
    /// measure by them again. A field that comes later has a default; none is renamed.
    const FIRST: &str = include_str!("../tests/record/announcement_1.json");

    fn announcement() -> Announcement {
        serde_json::from_str(FIRST).unwrap()
    }

    #[test]
    fn an_announcement_of_the_first_version_is_read() {
        let first: serde_json::Value = serde_json::from_str(FIRST).unwrap();
        assert_eq!(serde_json::to_value(announcement()).unwrap(), first);
    }

    #[test]
    fn an_announcement_reads_back_under_its_own_key_only() {
        let announcement = announcement();
        let bytes = announcement.json().unwrap();
        let key = announcement.key();
        assert_eq!(Announcement::read_at(&key, &bytes).unwrap().json().unwrap(), bytes);
        let other = Announcement { revision: 3, ..announcement }.key();
        let elsewhere = Announcement::read_at(&other, &bytes).unwrap_err();
        assert!(matches!(elsewhere, DocumentFault::Elsewhere { own } if *own == key));
    }

    #[test]
    fn a_scan_that_comes_back_to_a_patient_is_announced_beside_what_was_withdrawn() {
        let (first, at) = (announcement(), Timestamp::from_millisecond(1500).unwrap());
        let withdrawal = Withdrawal {
            schema: Withdrawal::SCHEMA.to_owned(),
            station: first.station.clone(),
            export: first.export.clone(),
            patient: None,
            at,
        };
        let key = withdrawal.key();
        assert_eq!(key.to_string().parse(), Ok(key.clone()));
        let bytes = withdrawal.json().unwrap();
        assert_eq!(Withdrawal::read_at(&key, &bytes).unwrap(), withdrawal);
        assert!(Announcement::read_at(&key, &bytes).is_err());
        let again = Announcement { at, ..first.clone() };
        assert_ne!(again.key(), first.key());
    }

    #[test]
    fn what_is_no_announcement_is_told_so() {
        let key = announcement().key();
        let read = |text: &str| Announcement::read_at(&key, text.as_bytes()).unwrap_err();
        assert!(matches!(read("{}"), DocumentFault::NotReadable { .. }));
        let text = String::from_utf8(announcement().json().unwrap()).unwrap();
        let older = text.replace("announcement/1", "announcement/0");
        assert!(matches!(read(&older), DocumentFault::OtherSchema { .. }));
        let outside = text.replace("booth-1", "../booth");
        assert!(matches!(read(&outside), DocumentFault::NotReadable { .. }));
    }
}
