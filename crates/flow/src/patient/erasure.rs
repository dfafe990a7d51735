//! The erasure of all that a station holds of one person: what has been done and what is left to do.
//!
//! It is noted before anything is removed, and every step can be repeated. The id is needed until the last
//! store is cleared; then only a keyed hash of it is left, by which the station recognises scans that are
//! still in an export folder.
//!
//! What a server is owed comes first: only the station's own data shows what to take back or correct there.

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

/// What replaces an erased id: in the history, and among those to whom a held scan may belong.
pub const ERASED: &str = "(erased)";

/// A scan of an erased person, of which only the hash is left.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErasedScan {
    /// The hash of its bytes, 64 hexadecimal digits.
    pub sha256: String,
    /// It belonged to no one else: it is never taken in again, no matter who is named.
    pub is_whole: bool,
}

/// A record at a server that is still to be changed there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Owed {
    /// The scan, 64 hexadecimal digits.
    pub sha256: String,
    pub store: String,
    /// What to do there.
    pub step: OwedStep,
    /// The server, as it was configured when it was given the record; `None` if only a journal that was lost knew.
    pub place: Option<String>,
    /// The name by which the record is found there; `None` if no answer came: the server may then have
    /// nothing.
    pub reference: Option<String>,
}

/// What to do with a record at a server.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OwedStep {
    /// It belongs to the wrong patient, and must be taken back.
    TakeBack,
    /// A person set measures since, and the server has the earlier ones.
    Correct,
}

#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Erasure {
    /// When it was asked for.
    pub at: Timestamp,
    /// Which user of the machine asked.
    pub by: String,
    /// The patient's id; `None` once nothing is left to do.
    pub patient: Option<String>,
    /// The scans, in the order of their hashes.
    pub scans: Vec<ErasedScan>,
    /// What servers are owed: nothing is removed before it is done.
    #[serde(default)]
    pub owed: Vec<Owed>,
    /// Whether the person who asked decided that it is not done.
    #[serde(default)]
    pub leaves_owed: bool,
    /// What servers were owed and were left with, by that decision; of earlier erasures, too.
    #[serde(default)]
    pub left: Vec<Owed>,
    /// When the station's own folder was cleared; `None` before. Records of scans that came later stay.
    pub cleared: Option<Timestamp>,
    /// The stores that are still to be cleared, by their names in the journal.
    pub stores: Vec<String>,
    /// When nothing was left to do; `None` before.
    pub ended: Option<Timestamp>,
}

/// What an erasure needs next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next<'a> {
    /// The station's own folder is to be cleared, while nothing else runs on it.
    Own {
        /// The patient's id.
        patient: &'a str,
    },
    /// Stores are to be cleared of records that came before this time.
    Stores {
        /// The patient's id.
        patient: &'a str,
        /// When the station's own folder was cleared.
        before: Timestamp,
    },
    Nothing,
}

impl Erasure {
    /// An erasure that is asked for now. Scans of an earlier one stay known, and so does what servers were left with.
    pub fn asked(
        earlier: Option<Erasure>,
        patient: &str,
        at: Timestamp,
        by: String,
        stores: Vec<String>,
    ) -> Erasure {
        let (scans, left) =
            earlier.map(|earlier| (earlier.scans, earlier.left)).unwrap_or_default();
        let patient = Some(patient.to_owned());
        Erasure { at, by, patient, scans, left, stores, ..Erasure::default() }
    }

    /// Notes what servers are owed now. Returns whether that is news.
    pub fn owes(&mut self, mut owed: Vec<Owed>) -> bool {
        if self.leaves_owed {
            owed.retain(|owed| !self.left.contains(owed));
            let is_news = !owed.is_empty();
            self.left.extend(owed);
            return is_news;
        }
        let is_news = self.owed != owed;
        self.owed = owed;
        is_news
    }

    /// What to do next.
    pub fn next(&self) -> Next<'_> {
        match (&self.patient, self.cleared) {
            (Some(patient), None) => Next::Own { patient },
            (Some(patient), Some(before)) => Next::Stores { patient, before },
            (None, _) => Next::Nothing,
        }
    }

    /// Adds scans that are about to be removed. One that is known as whole stays so.
    pub fn add(&mut self, scans: impl IntoIterator<Item = ErasedScan>) {
        for scan in scans {
            match self.scans.iter_mut().find(|known| known.sha256 == scan.sha256) {
                Some(known) => known.is_whole |= scan.is_whole,
                None => self.scans.push(scan),
            }
        }
        self.scans.sort();
    }

    /// The station's own folder is cleared; `stores` are those that it still has.
    pub fn own_cleared(&mut self, now: Timestamp, stores: &[&str]) {
        self.cleared = Some(now);
        self.stores.retain(|store| stores.contains(&store.as_str()));
        self.end_if_done(now);
    }

    pub fn store_cleared(&mut self, store: &str, now: Timestamp) {
        self.stores.retain(|known| known != store);
        self.end_if_done(now);
    }

    fn end_if_done(&mut self, now: Timestamp) {
        if self.cleared.is_some() && self.stores.is_empty() {
            (self.patient, self.ended) = (None, Some(now));
        }
    }

    /// Whether a scan must not be taken in for a patient; `is_theirs`: whether that is this patient.
    pub fn refuses(&self, sha256: &str, is_theirs: bool) -> bool {
        let known = self.scans.iter().find(|known| known.sha256 == sha256);
        known.is_some_and(|known| known.is_whole || is_theirs)
    }
}

/// Whether bytes, such as a path, hold an id that no further letter or digit belongs to.
pub fn names(bytes: &[u8], id: &str) -> bool {
    let (id, is_part) =
        (id.as_bytes(), |byte: Option<&u8>| byte.is_some_and(u8::is_ascii_alphanumeric));
    if id.is_empty() {
        return false;
    }
    let mut places = bytes.windows(id.len()).enumerate().filter(|(_, window)| *window == id);
    places.any(|(at, _)| {
        let before = at.checked_sub(1).and_then(|before| bytes.get(before));
        !is_part(before) && !is_part(bytes.get(at + id.len()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: i64) -> Timestamp {
        Timestamp::from_second(1_800_000_000 + seconds).unwrap()
    }

    fn asked() -> Erasure {
        let stores = vec!["folder".to_owned(), "copy".to_owned()];
        Erasure::asked(None, "4711", at(0), "uid 0".to_owned(), stores)
    }

    fn scan(sha256: &str, is_whole: bool) -> ErasedScan {
        ErasedScan { sha256: sha256.to_owned(), is_whole }
    }

    #[test]
    fn the_id_is_kept_until_the_last_store_is_cleared_and_no_longer() {
        let mut erasure = asked();
        assert_eq!(erasure.next(), Next::Own { patient: "4711" });
        erasure.own_cleared(at(1), &["folder", "copy", "gdt"]);
        assert_eq!(erasure.next(), Next::Stores { patient: "4711", before: at(1) });
        erasure.store_cleared("copy", at(2));
        assert_eq!((erasure.patient.as_deref(), erasure.ended), (Some("4711"), None));
        erasure.store_cleared("folder", at(3));
        assert_eq!((erasure.next(), erasure.ended), (Next::Nothing, Some(at(3))));
        assert_eq!(erasure.patient, None);
    }

    #[test]
    fn a_store_that_the_station_has_no_more_is_not_waited_for() {
        let mut erasure = asked();
        erasure.own_cleared(at(1), &["folder"]);
        assert_eq!(erasure.stores, ["folder"]);
        let mut erasure = asked();
        erasure.own_cleared(at(1), &[]);
        assert_eq!(erasure.ended, Some(at(1)));
    }

    #[test]
    fn what_servers_are_owed_is_waited_for_or_left_by_decision_and_then_stays_written_down() {
        let owed = |reference: &str| Owed {
            sha256: "a".to_owned(),
            store: "hl7".to_owned(),
            step: OwedStep::TakeBack,
            place: Some("mllp://hl7.clinic.example:2575".to_owned()),
            reference: Some(reference.to_owned()),
        };
        let mut erasure = asked();
        assert!(erasure.owes(vec![owed("1"), owed("2")]));
        assert!(!erasure.owes(vec![owed("1"), owed("2")]), "it is known");
        assert!(erasure.owes(vec![owed("2")]));
        assert_eq!((erasure.owed.len(), erasure.left.len()), (1, 0));
        // The server no longer exists: the person who asks decides again.
        let mut again = Erasure::asked(Some(erasure), "4711", at(1), String::new(), vec![]);
        again.leaves_owed = true;
        assert!(again.owes(vec![owed("2")]));
        assert!(!again.owes(vec![owed("2")]), "a start after a crash says the same");
        assert!(again.owed.is_empty());
        again.own_cleared(at(2), &[]);
        assert_eq!(again.ended, Some(at(2)));
        let later = Erasure::asked(Some(again), "4711", at(3), String::new(), vec![]);
        assert_eq!(later.left, [owed("2")]);
    }

    #[test]
    fn a_scan_of_one_person_is_refused_for_all_and_a_shared_one_for_this_person_only() {
        let mut erasure = asked();
        erasure.add([scan("b", false), scan("a", true)]);
        erasure.add([scan("a", false)]);
        let refused = |sha256| [false, true].map(|is_theirs| erasure.refuses(sha256, is_theirs));
        assert_eq!(refused("a"), [true, true]);
        assert_eq!(refused("b"), [false, true]);
        assert_eq!(refused("c"), [false, false]);
        let again = Erasure::asked(Some(erasure.clone()), "4711", at(9), String::new(), vec![]);
        assert!(again.refuses("a", false), "an earlier erasure stays known");
    }

    #[test]
    fn an_id_within_a_longer_one_is_not_named() {
        for text in ["4711", "4711_a.obj", "/srv/export/4711/a.obj", "a-4711-b", "x 4711"] {
            assert!(names(text.as_bytes(), "4711"), "{text}");
        }
        for text in ["", "47110_a.obj", "P4711_a.obj", "471", "14711"] {
            assert!(!names(text.as_bytes(), "4711"), "{text}");
        }
        assert!(!names(b"anything", ""));
    }
}
