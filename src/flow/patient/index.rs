//! What the index of a patient's records knows, and what of it is to be read again.
//!
//! The folders of a store are named by patient, time and scan, so a listing tells which records a patient
//! has. It does not tell when a scan was taken, by which clock, or whether a person put another patient's
//! record there: that stands in `record.json`, which is long. The index keeps it for each record, with the
//! state in which the file was read. What has another state, another name or no entry is read again, and
//! what is not there any more is dropped, so the index never decides what exists.

use serde::{Deserialize, Serialize};

use crate::record::Acquired;

/// The state of a `record.json`: any write, and any move from elsewhere, changes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileState {
    /// Size, bytes.
    pub size: u64,
    /// When its content was last changed, ns since 1970.
    pub mtime_ns: i128,
    /// When the file system last changed anything about it, ns since 1970.
    pub ctime_ns: i128,
}

/// A record's folder as it lies in the store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sight {
    /// The folder's name.
    pub folder: String,
    /// The state of its `record.json`; `None` if there is no such file.
    pub state: Option<FileState>,
}

/// What `record.json` says, as far as a choice among a patient's records needs it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Told {
    /// The scan, 64 hexadecimal digits.
    pub scan_sha256: String,
    /// When the scan was taken; `None` if the record does not say.
    pub acquired: Option<Acquired>,
    /// The revision.
    pub revision: u32,
    /// Whether it names the patient in whose folder it lies.
    pub is_own: bool,
}

/// What is known about the record in a folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// The folder's name.
    pub folder: String,
    /// The state of `record.json` when it was read.
    pub state: FileState,
    /// What it said; `None` if it could not be understood.
    pub told: Option<Told>,
}

/// What is to be done about a patient's index.
#[derive(Debug, PartialEq, Eq)]
pub struct Plan {
    /// The entries that still hold, in the order of what was seen.
    pub kept: Vec<Entry>,
    /// The records to read.
    pub to_read: Vec<Sight>,
    /// An entry is of no record that was seen, or of another state of it.
    pub has_stale: bool,
}

impl Plan {
    /// Whether the index that was known is not what it must be.
    pub fn is_change(&self) -> bool {
        self.has_stale || !self.to_read.is_empty()
    }
}

/// Compares what the index knows with what lies in the patient's folder.
pub fn plan(known: Vec<Entry>, seen: Vec<Sight>) -> Plan {
    let total = known.len();
    let (mut kept, mut to_read) = (Vec::with_capacity(seen.len()), Vec::new());
    for sight in seen {
        let entry = known
            .iter()
            .find(|entry| entry.folder == sight.folder && Some(entry.state) == sight.state);
        match entry {
            Some(entry) => kept.push(entry.clone()),
            None => to_read.push(sight),
        }
    }
    let has_stale = kept.len() != total;
    Plan { kept, to_read, has_stale }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn state(number: u8) -> FileState {
        FileState { size: u64::from(number), mtime_ns: 1, ctime_ns: 2 }
    }

    fn entry(folder: u8, of: u8) -> Entry {
        Entry { folder: format!("r{folder}"), state: state(of), told: None }
    }

    fn sight(folder: u8, of: u8) -> Sight {
        Sight { folder: format!("r{folder}"), state: Some(state(of)) }
    }

    #[test]
    fn what_is_as_it_was_is_not_read_again() {
        let plan = plan(vec![entry(1, 1), entry(2, 1)], vec![sight(1, 1), sight(2, 1)]);
        assert_eq!(plan.kept, [entry(1, 1), entry(2, 1)]);
        assert!(!plan.is_change());
    }

    #[test]
    fn a_record_added_changed_renamed_or_removed_is_noticed() {
        let known = || vec![entry(1, 1), entry(2, 1)];
        let read = |seen: Vec<Sight>| {
            let plan = plan(known(), seen);
            assert!(plan.is_change());
            plan.to_read.into_iter().map(|sight| sight.folder).collect::<Vec<_>>()
        };
        assert_eq!(read(vec![sight(1, 1), sight(2, 1), sight(3, 1)]), ["r3"]);
        assert_eq!(read(vec![sight(1, 1), sight(2, 9)]), ["r2"]);
        assert_eq!(read(vec![sight(1, 1), sight(4, 1)]), ["r4"]);
        assert_eq!(read(vec![sight(1, 1)]), [""; 0]);
        let without = Sight { folder: "r2".to_owned(), state: None };
        assert_eq!(read(vec![sight(1, 1), without]), ["r2"]);
    }

    proptest! {
        #[test]
        fn every_record_seen_is_kept_or_read_once_and_nothing_else_is(
            known in proptest::collection::btree_map(0_u8..20, 0_u8..3, 0..20),
            seen in proptest::collection::btree_map(0_u8..20, 0_u8..3, 0..20),
        ) {
            let entries = known.iter().map(|(folder, of)| entry(*folder, *of)).collect();
            let sights = seen.iter().map(|(folder, of)| sight(*folder, *of)).collect();
            let plan = plan(entries, sights);
            let kept = plan.kept.iter().map(|entry| entry.folder.clone());
            let mut all: Vec<String> =
                kept.chain(plan.to_read.iter().map(|sight| sight.folder.clone())).collect();
            all.sort();
            let mut wanted: Vec<String> = seen.keys().map(|folder| format!("r{folder}")).collect();
            wanted.sort();
            prop_assert_eq!(all, wanted);
            prop_assert_eq!(plan.is_change(), known != seen);
        }
    }
}
