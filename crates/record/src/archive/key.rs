//! The keys of objects: what a store of objects calls a path.

use std::fmt;
use std::str::FromStr;

use super::words::{MethodId, StationId, WordFault};
use crate::scan_id::ScanId;

/// How many digits of a hash are a folder of their own, so that none holds millions.
const FOLDER_DIGITS: usize = 2;

/// The key of an object.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum ObjectKey {
    /// The crop of a scan.
    Scan(ScanId),
    /// A station's record of it.
    Record {
        /// The station.
        station: StationId,
        /// The scan.
        scan: ScanId,
        /// The revision of the record.
        revision: u32,
    },
    /// That both are there.
    Announcement {
        /// The station.
        station: StationId,
        /// The scan.
        scan: ScanId,
        /// The revision of the record.
        revision: u32,
    },
    /// What a method says of a scan.
    Result {
        /// The method.
        method: MethodId,
        /// The scan.
        scan: ScanId,
    },
    /// A station's heartbeat.
    Heartbeat(StationId),
}

/// A text that is no key of an archive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum KeyFault {
    /// It has not the shape of any.
    #[error("it is no key of an archive's object")]
    Shape,
    /// One of its words is wrong.
    #[error(transparent)]
    Word(#[from] WordFault),
    /// Its hash is none.
    #[error("it has no hash of 64 lower-case hexadecimal digits")]
    Scan,
}

impl ObjectKey {
    /// What the keys of all announcements begin with.
    pub const INBOX: &'static str = "inbox/";

    /// What the keys of announcements begin with that are indexed: they are moved there, so that the inbox stays short.
    pub const ANNOUNCED: &'static str = "announced/";

    /// What the keys of all results begin with.
    pub const RESULTS: &'static str = "result/";

    /// What the keys of all heartbeats begin with.
    pub const FLEET: &'static str = "fleet/";
}

impl fmt::Display for ObjectKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ObjectKey::Scan(scan) => write!(f, "scan/{}/{scan}.ply.zst", folder(scan)),
            ObjectKey::Record { station, scan, revision } => {
                write!(f, "record/{station}/{scan}/r{revision}.json.zst")
            }
            ObjectKey::Announcement { station, scan, revision } => {
                write!(f, "inbox/{station}/{scan}-r{revision}.json")
            }
            ObjectKey::Result { method, scan } => {
                write!(f, "result/{method}/{}/{scan}.json.zst", folder(scan))
            }
            ObjectKey::Heartbeat(station) => write!(f, "fleet/{station}.json"),
        }
    }
}

impl FromStr for ObjectKey {
    type Err = KeyFault;

    fn from_str(text: &str) -> Result<ObjectKey, KeyFault> {
        let key = parsed(text)?;
        // A hash in another hash's folder, or a number with zeros before it.
        if key.to_string() == text { Ok(key) } else { Err(KeyFault::Shape) }
    }
}

fn parsed(text: &str) -> Result<ObjectKey, KeyFault> {
    let words: Vec<&str> = text.split('/').collect();
    Ok(match words.as_slice() {
        ["scan", _, scan] => ObjectKey::Scan(scan_id(without(scan, ".ply.zst")?)?),
        ["record", station, scan, revision] => {
            let revision = without(revision, ".json.zst")?;
            ObjectKey::Record {
                station: StationId::parse(station)?,
                scan: scan_id(scan)?,
                revision: number(revision.strip_prefix('r').ok_or(KeyFault::Shape)?)?,
            }
        }
        ["inbox", station, name] => {
            let name = without(name, ".json")?;
            let (scan, revision) = name.split_once("-r").ok_or(KeyFault::Shape)?;
            ObjectKey::Announcement {
                station: StationId::parse(station)?,
                scan: scan_id(scan)?,
                revision: number(revision)?,
            }
        }
        ["result", method, _, scan] => ObjectKey::Result {
            method: MethodId::parse(method)?,
            scan: scan_id(without(scan, ".json.zst")?)?,
        },
        ["fleet", station] => ObjectKey::Heartbeat(StationId::parse(without(station, ".json")?)?),
        _ => return Err(KeyFault::Shape),
    })
}

fn folder(scan: &ScanId) -> &str {
    &scan.as_str()[..FOLDER_DIGITS]
}

fn without<'a>(name: &'a str, ending: &str) -> Result<&'a str, KeyFault> {
    name.strip_suffix(ending).ok_or(KeyFault::Shape)
}

fn scan_id(text: &str) -> Result<ScanId, KeyFault> {
    ScanId::parse(text).ok_or(KeyFault::Scan)
}

fn number(text: &str) -> Result<u32, KeyFault> {
    text.parse().map_err(|_| KeyFault::Shape)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys() -> [ObjectKey; 5] {
        let (station, scan) = (StationId::parse("booth-1").unwrap(), ScanId::of_bytes(b"crop"));
        [
            ObjectKey::Scan(scan.clone()),
            ObjectKey::Record { station: station.clone(), scan: scan.clone(), revision: 1 },
            ObjectKey::Announcement { station: station.clone(), scan: scan.clone(), revision: 12 },
            ObjectKey::Result { method: MethodId::parse("0.1.0+0a1b2c3d").unwrap(), scan },
            ObjectKey::Heartbeat(station),
        ]
    }

    #[test]
    fn a_key_reads_back() {
        for key in keys() {
            assert_eq!(key.to_string().parse(), Ok(key));
        }
    }

    #[test]
    fn a_key_that_is_not_written_so_is_none() {
        let hash = "ab".repeat(32);
        for text in [
            "",
            "scan",
            "fleet/.json",
            "fleet/../x.json",
            "fleet/a/b.json",
            &format!("scan/ac/{hash}.ply.zst"),
            &format!("scan/ab/{hash}.obj.zst"),
            &format!("/scan/ab/{hash}.ply.zst"),
            &format!("scan/ab/{}.ply.zst", hash.to_uppercase()),
            &format!("inbox/booth-1/{hash}-r01.json"),
            &format!("inbox/booth-1/{hash}-r-1.json"),
            &format!("inbox/../{hash}-r1.json"),
            &format!("record/booth-1/{hash}/1.json.zst"),
            &format!("result/0.1.0/ab/{hash}.json.zst"),
        ] {
            assert!(text.parse::<ObjectKey>().is_err(), "{text}");
        }
    }
}
