//! What an export folder holds besides scans: why it is passed over, and whether it may hold an export.

use std::time::Duration;

use gaiter_language::Language;
use gaiter_scan::Format;
use serde::{Deserialize, Serialize};

/// Endings that scanners and copy programs use for unfinished files.
const UNFINISHED: [&str; 2] = [".part", ".tmp"];

/// Endings of packed files.
const PACKED: [&str; 7] = [".gz", ".zip", ".7z", ".rar", ".bz2", ".xz", ".zst"];

/// How long something lies in an export folder before it counts as an export that is not read: a packed
/// copy may come beside the export itself.
const STAYS: Duration = Duration::from_secs(5);

gaiter_record::word_enum! {
    /// Why something in an export folder is passed over.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
    pub enum PassedOver as serde {
        /// A folder, where sub-folders are not searched.
        SubFolder => "sub_folder",
        /// A folder that is nested too deep.
        TooDeep => "too_deep",
        /// A folder that the station may not read.
        NoAccess => "no_access",
        Link => "link",
        /// A packed scan.
        Packed => "packed",
        /// A hidden file.
        Hidden => "hidden",
        /// A file with the name of an unfinished one.
        Unfinished => "unfinished",
        /// A file without the ending of a scan.
        NoScan => "no_scan",
        Pipe => "pipe",
        Socket => "socket",
        /// Whatever else is no regular file.
        Device => "device",
    }
}

/// Something in an export folder that is passed over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ignored {
    pub why: PassedOver,
    /// When it changed last, by the clock of its file system, nanoseconds since 1970; 0 where that does
    /// not matter.
    pub changed_ns: i128,
    /// When it came or changed, on the station's clock; zero for what was there at its start.
    pub since: Duration,
}

impl PassedOver {
    /// Why a file of this name is passed over whatever it contains.
    pub fn by_name(name: &str) -> Option<PassedOver> {
        if name.starts_with('.') {
            return Some(PassedOver::Hidden);
        }
        let lower = name.to_ascii_lowercase();
        let is_unfinished = UNFINISHED.iter().any(|end| lower.ends_with(end));
        is_unfinished.then_some(PassedOver::Unfinished)
    }

    /// The same, if the name is that of a scan before it is finished.
    pub fn of_scan_to_come(name: &str) -> Option<PassedOver> {
        let why = PassedOver::by_name(name)?;
        // What a Mac writes beside each file that it copies.
        if name.starts_with("._") {
            return None;
        }
        let lower = name.trim_start_matches('.').to_ascii_lowercase();
        let mut rest = lower.as_str();
        while let Some(shorter) = UNFINISHED.iter().find_map(|end| rest.strip_suffix(end)) {
            rest = shorter;
        }
        Format::of_file_name(rest).is_ok().then_some(why)
    }

    /// Why a file is passed over whose name is not a scan's.
    pub fn of_no_scan(name: &str) -> PassedOver {
        let lower = name.to_ascii_lowercase();
        let inner = PACKED.iter().find_map(|end| lower.strip_suffix(end));
        match inner.is_some_and(|inner| Format::of_file_name(inner).is_ok()) {
            true => PassedOver::Packed,
            false => PassedOver::NoScan,
        }
    }

    /// Whether it may be an export or hold one.
    pub fn is_unread(self) -> bool {
        !matches!(
            self,
            PassedOver::NoScan | PassedOver::Pipe | PassedOver::Socket | PassedOver::Device
        )
    }

    /// Whether its name alone shows that it is passed over.
    pub fn is_of_name(self) -> bool {
        matches!(self, PassedOver::Hidden | PassedOver::Unfinished)
    }

    /// Why, in words that follow the file.
    pub fn words(self, language: Language) -> &'static str {
        language.word("explain.passed_over", self.word())
    }

    /// Why a file within it is not read, in words that follow that file.
    pub fn words_within(self, language: Language) -> &'static str {
        let own = language.find(&format!("explain.within.{}", self.word()));
        own.unwrap_or_else(|| language.text("explain.within.other"))
    }
}

impl Ignored {
    /// Whether it may be an export, came after this time, and has stayed.
    pub(crate) fn may_be_export_since(&self, opened: Duration, now: Duration) -> bool {
        self.why.is_unread() && self.since > opened && now >= self.since + STAYS
    }
}

/// How much is passed over, by the words of its reasons: "sub-folders 1, packed files 2".
pub fn listed<'a>(counts: impl Iterator<Item = (&'a str, usize)>, language: Language) -> String {
    let word = |why: &'a str| language.word("page.part.passed_over", why);
    let counts = counts.map(|(why, count)| format!("{} {count}", word(why)));
    counts.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_tells_why_a_file_is_passed_over_and_whether_it_may_be_an_export() {
        for (name, by_name, to_come) in [
            ("a.obj", None, None),
            (".a.obj", Some(PassedOver::Hidden), Some(PassedOver::Hidden)),
            (".a.obj.tmp", Some(PassedOver::Hidden), Some(PassedOver::Hidden)),
            ("a.OBJ.Part", Some(PassedOver::Unfinished), Some(PassedOver::Unfinished)),
            ("a.tmp", Some(PassedOver::Unfinished), None),
            (".DS_Store", Some(PassedOver::Hidden), None),
            ("._a.obj", Some(PassedOver::Hidden), None),
        ] {
            assert_eq!(PassedOver::by_name(name), by_name, "{name}");
            assert_eq!(PassedOver::of_scan_to_come(name), to_come, "{name}");
        }
        for (name, why) in [
            ("a.obj.gz", PassedOver::Packed),
            ("A.STL.ZIP", PassedOver::Packed),
            ("a.zip", PassedOver::NoScan),
            ("notes.pdf", PassedOver::NoScan),
        ] {
            assert_eq!(PassedOver::of_no_scan(name), why, "{name}");
        }
    }

    #[test]
    fn what_may_be_an_export_is_counted_by_its_reason() {
        let counts = || [(PassedOver::SubFolder.word(), 1), ("packed", 2)].into_iter();
        assert_eq!(listed(counts(), Language::En), "sub-folders 1, packed files 2");
        assert_eq!(listed(counts(), Language::De), "Unterordner 1, gepackte Dateien 2");
    }

    #[test]
    fn what_came_before_the_capture_or_just_now_is_not_taken_for_its_export() {
        let second = Duration::from_secs;
        let at = |why, since| Ignored { why, changed_ns: 0, since: second(since) };
        for (ignored, is_it) in [
            (at(PassedOver::SubFolder, 20), true),
            (at(PassedOver::SubFolder, 10), false),
            (at(PassedOver::SubFolder, 96), false),
            (at(PassedOver::NoScan, 20), false),
        ] {
            assert_eq!(ignored.may_be_export_since(second(10), second(100)), is_it, "{ignored:?}");
        }
    }
}
