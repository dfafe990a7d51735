//! What each code of a finding or doubt means for people, and what to do about it.

use super::{level_findings, scan_findings};
use crate::record::Language;

/// A finding in plain words in one language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::record::report) struct Plain {
    /// A short name.
    pub title: &'static str,
    /// What it means.
    pub meaning: &'static str,
    /// What to do.
    pub action: &'static str,
}

/// What a code means; `None` for an unknown code, such as one of a later version.
pub(in crate::record::report) fn plain(code: &str, language: Language) -> Option<Plain> {
    let mut all = level_findings::TOLD.iter().chain(&scan_findings::TOLD);
    let told = all.find(|told| told.code == code)?;
    let pick = |[english, german]: [&'static str; 2]| language.pick(english, german);
    Some(Plain { title: pick(told.title), meaning: pick(told.meaning), action: pick(told.action) })
}

/// The short name of a code, or the code itself if it is unknown.
pub(in crate::record::report) fn short(code: &str, language: Language) -> String {
    plain(code, language).map_or_else(|| code.to_owned(), |plain| plain.title.to_owned())
}
