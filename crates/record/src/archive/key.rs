//! The keys of objects: what a store of objects calls a path.

use std::fmt;
use std::str::FromStr;

use super::words::{MethodId, RecordHash, StationId, WordFault};
use crate::scan_id::ScanId;

/// How many digits of a hash are a folder of their own, so that none holds millions.
const FOLDER_DIGITS: usize = 2;

/// What stands in the key of a withdrawal where an announcement has its revision.
const WITHDRAWN: &str = "withdrawn";

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
        /// The record.
        record: RecordHash,
    },
    /// That both are there.
    Announcement {
        /// The station.
        station: StationId,
        /// The scan.
        scan: ScanId,
        /// The revision of the record.
        revision: u32,
        /// When it was announced, milliseconds since 1970.
        at_ms: i64,
    },
    /// That a station has taken a scan back from a patient.
    Withdrawal {
        /// The station.
        station: StationId,
        /// The scanner's export.
        export: ScanId,
        /// When it was taken back, milliseconds since 1970.
        at_ms: i64,
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
            ObjectKey::Record { station, scan, record } => {
                write!(f, "record/{station}/{scan}/{record}.json.zst")
            }
            ObjectKey::Announcement { station, scan, revision, at_ms } => {
                write!(f, "inbox/{station}/{scan}-r{revision}-{at_ms}.json")
            }
            ObjectKey::Withdrawal { station, export, at_ms } => {
                write!(f, "inbox/{station}/{export}-{WITHDRAWN}-{at_ms}.json")
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
        ["record", station, scan, record] => ObjectKey::Record {
            station: StationId::parse(station)?,
            scan: scan_id(scan)?,
            record: RecordHash::parse(without(record, ".json.zst")?)?,
        },
        ["inbox", station, name] => said(StationId::parse(station)?, without(name, ".json")?)?,
        ["result", method, _, scan] => ObjectKey::Result {
            method: MethodId::parse(method)?,
            scan: scan_id(without(scan, ".json.zst")?)?,
        },
        ["fleet", station] => ObjectKey::Heartbeat(StationId::parse(without(station, ".json")?)?),
        _ => return Err(KeyFault::Shape),
    })
}

/// What a station says, by the name of its object.
fn said(station: StationId, name: &str) -> Result<ObjectKey, KeyFault> {
    let words: Vec<&str> = name.splitn(3, '-').collect();
    let [hash, kind, at_ms] = words[..] else { return Err(KeyFault::Shape) };
    let (hash, at_ms) = (scan_id(hash)?, number(at_ms)?);
    if kind == WITHDRAWN {
        return Ok(ObjectKey::Withdrawal { station, export: hash, at_ms });
    }
    let revision = number(kind.strip_prefix('r').ok_or(KeyFault::Shape)?)?;
    Ok(ObjectKey::Announcement { station, scan: hash, revision, at_ms })
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

fn number<N: FromStr>(text: &str) -> Result<N, KeyFault> {
    text.parse().map_err(|_| KeyFault::Shape)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys() -> [ObjectKey; 6] {
        let (scan, at_ms) = (ScanId::of_bytes(b"crop"), 1_795_000_000_123);
        let station = || StationId::parse("booth-1").unwrap();
        let record = RecordHash::of_bytes(b"record");
        [
            ObjectKey::Scan(scan.clone()),
            ObjectKey::Record { station: station(), scan: scan.clone(), record },
            ObjectKey::Announcement { station: station(), scan: scan.clone(), revision: 12, at_ms },
            ObjectKey::Withdrawal { station: station(), export: scan.clone(), at_ms },
            ObjectKey::Result { method: MethodId::parse("0.1.0+0a1b2c3d").unwrap(), scan },
            ObjectKey::Heartbeat(station()),
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
            &format!("inbox/booth-1/{hash}-r1.json"),
            &format!("inbox/booth-1/{hash}-r01-5.json"),
            &format!("inbox/booth-1/{hash}-r-1-5.json"),
            &format!("inbox/booth-1/{hash}-r1-05.json"),
            &format!("inbox/booth-1/{hash}-removed-5.json"),
            &format!("inbox/../{hash}-r1-5.json"),
            &format!("record/booth-1/{hash}/r1.json.zst"),
            &format!("result/0.1.0/ab/{hash}.json.zst"),
        ] {
            assert!(text.parse::<ObjectKey>().is_err(), "{text}");
        }
    }
}
