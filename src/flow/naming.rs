//! What record folders are called. Names depend on nothing but patient, time and bytes, so that a
//! delivery made twice lands in the same folder.

use jiff::Timestamp;

use super::ScanId;

/// The folder of scans whose patient nobody named.
pub const UNASSIGNED: &str = "_unassigned";

/// The folder of a patient. Different ids give different names, and none gives [`UNASSIGNED`], a
/// hidden name or a way out of the folder: whatever is not `A-Z a-z 0-9 - _` becomes `%` and two
/// hexadecimal digits a byte, and so does a leading `_`.
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

/// The folder of one record: when the scan was first seen, UTC, and the beginning of its id.
pub fn record_folder(first_seen: Timestamp, scan: &ScanId) -> String {
    format!("{}_{}", first_seen.strftime("%Y%m%dT%H%M%SZ"), scan.short())
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
        fn different_ids_have_different_folders(a in ".{1,6}", b in ".{1,6}") {
            prop_assert_eq!(a == b, patient_folder(Some(&a)) == patient_folder(Some(&b)));
        }
    }
}
