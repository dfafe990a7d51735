//! How record folders are named. A name depends only on patient, time and bytes, so that a delivery made
//! twice goes to the same folder.

use gaiter_record::FIRST_REVISION;
use jiff::Timestamp;

use crate::ScanId;

/// The folder of scans without a named patient.
pub const UNASSIGNED: &str = "_unassigned";

/// The folder of a patient. Different ids give different names, and no id gives [`UNASSIGNED`], a hidden
/// name or a way out of the folder: every byte that is not `A-Z a-z 0-9 - _` becomes `%` and two
/// hexadecimal digits, and so does a leading `_`.
pub fn patient_folder(id: Option<&str>) -> String {
    let Some(id) = id else { return UNASSIGNED.to_owned() };
    let mut name = String::with_capacity(id.len());
    for (at, byte) in id.bytes().enumerate() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' => name.push(char::from(byte)),
            b'_' if at > 0 => name.push('_'),
            other => name.push_str(&format!("%{other:02X}")),
        }
    }
    name
}

/// The patient of a folder with this name: `Some(None)` for [`UNASSIGNED`], `None` for a name that
/// [`patient_folder`] never gives.
pub fn patient_of_folder(name: &str) -> Option<Option<String>> {
    if name == UNASSIGNED {
        return Some(None);
    }
    let mut parts = name.split('%');
    let mut id = parts.next()?.as_bytes().to_vec();
    for part in parts {
        let (digits, rest) = part.split_at_checked(2)?;
        id.push(u8::from_str_radix(digits, 16).ok()?);
        id.extend_from_slice(rest.as_bytes());
    }
    let id = String::from_utf8(id).ok()?;
    (!id.is_empty() && patient_folder(Some(&id)) == name).then_some(Some(id))
}

/// The parts of a record folder's name.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct RecordName {
    /// When the scan was first seen.
    pub first_seen: Timestamp,
    /// The beginning of its id.
    pub scan: String,
    /// 1, or more if the scan was measured again later; each result has a folder of its own.
    pub revision: u32,
}

impl RecordName {
    /// Parses a name; `None` for one that [`record_folder`] and [`RecordName::folder`] never give.
    pub fn read(name: &str) -> Option<RecordName> {
        let (time, rest) = name.split_once('_')?;
        let time = jiff::civil::DateTime::strptime("%Y%m%dT%H%M%SZ", time).ok()?;
        let first_seen = time.to_zoned(jiff::tz::TimeZone::UTC).ok()?.timestamp();
        let (scan, revision) = match rest.split_once("_r") {
            None => (rest.to_owned(), FIRST_REVISION),
            Some((scan, number)) => (scan.to_owned(), number.parse().ok()?),
        };
        let read = RecordName { first_seen, scan, revision };
        (read.folder() == name).then_some(read)
    }

    /// The folder of this name: that of the first result has no number.
    pub fn folder(&self) -> String {
        let RecordName { first_seen, scan, revision } = self;
        let first = format!("{}_{scan}", first_seen.strftime("%Y%m%dT%H%M%SZ"));
        if *revision == FIRST_REVISION { first } else { format!("{first}_r{revision}") }
    }
}

/// The folder of a scan's first record: when the scan was first seen, UTC, and the beginning of its id.
pub fn record_folder(first_seen: Timestamp, scan: &ScanId) -> String {
    let scan = scan.short().to_owned();
    RecordName { first_seen, scan, revision: FIRST_REVISION }.folder()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_record_folder_is_named_by_time_and_scan() {
        let first_seen = "2026-11-21T09:15:00Z".parse().unwrap();
        let scan = ScanId::parse(&"0123456789abcdef".repeat(4)).unwrap();
        assert_eq!(record_folder(first_seen, &scan), "20261121T091500Z_01234567");
        let read = RecordName::read("20261121T091500Z_01234567");
        let first = RecordName { first_seen, scan: "01234567".to_owned(), revision: 1 };
        assert_eq!(read, Some(first));
        for name in ["20261121T091500Z", "notes_2026", ".staging.booth-1.20261121T091500Z_0"] {
            assert_eq!(RecordName::read(name), None, "{name}");
        }
    }

    #[test]
    fn a_revision_bears_its_number_in_one_way_only() {
        let first = RecordName::read("20261121T091500Z_01234567").unwrap();
        let third = RecordName { revision: 3, ..first.clone() };
        assert_eq!(third.folder(), "20261121T091500Z_01234567_r3");
        assert_eq!(RecordName::read(&third.folder()), Some(third.clone()));
        assert!(first < third && third < RecordName { revision: 10, ..first });
        for end in ["_r1", "_r03", "_r+3", "_r", "_r3_r4", "_rx", "_r99999999999"] {
            assert_eq!(RecordName::read(&format!("20261121T091500Z_01234567{end}")), None, "{end}");
        }
    }

    #[test]
    fn ordinary_ids_stand_as_they_are() {
        assert_eq!(patient_folder(Some("P0815")), "P0815");
        assert_eq!(patient_folder(Some("a-b_c")), "a-b_c");
        assert_eq!(patient_folder(None), "_unassigned");
    }

    #[test]
    fn no_id_leaves_the_folder_or_poses_as_unassigned() {
        let names = BTreeMap::from([
            ("_unassigned", "%5Funassigned"),
            (".staging.x", "%2Estaging%2Ex"),
            ("..", "%2E%2E"),
            ("a/b", "a%2Fb"),
            ("%5Funassigned", "%255Funassigned"),
        ]);
        for (id, name) in names {
            assert_eq!(patient_folder(Some(id)), name);
        }
    }

    proptest! {
        #[test]
        fn a_folder_says_whose_it_is(id in ".{1,8}") {
            let folder = patient_folder(Some(&id));
            prop_assert_eq!(patient_of_folder(&folder), Some(Some(id)));
        }

        #[test]
        fn a_name_that_is_nobody_s_folder_says_nothing(name in "[.%_a ]{1,5}") {
            if let Some(id) = patient_of_folder(&name) {
                prop_assert_eq!(patient_folder(id.as_deref()), name);
            }
        }

        #[test]
        fn different_ids_have_different_folders(a in ".{1,6}", b in ".{1,6}") {
            prop_assert_eq!(a == b, patient_folder(Some(&a)) == patient_folder(Some(&b)));
        }
    }
}
