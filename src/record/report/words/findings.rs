//! What every code of a finding or doubt means for people, and what they do about it.

mod levels;
mod scans;

use crate::record::Language;

/// A finding in plain words of one language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::record::report) struct Plain {
    /// What it is, in few words.
    pub title: &'static str,
    /// What it means.
    pub meaning: &'static str,
    /// What to do.
    pub action: &'static str,
}

/// A finding in plain words, English and German.
struct Told {
    code: &'static str,
    title: [&'static str; 2],
    meaning: [&'static str; 2],
    action: [&'static str; 2],
}

/// What a code means; none for one that is not known here, as of a later version.
pub(in crate::record::report) fn plain(code: &str, language: Language) -> Option<Plain> {
    let mut all = levels::TOLD.iter().chain(&scans::TOLD);
    let told = all.find(|told| told.code == code)?;
    let pick = |[english, german]: [&'static str; 2]| language.pick(english, german);
    Some(Plain { title: pick(told.title), meaning: pick(told.meaning), action: pick(told.action) })
}

/// A code in few words; the code itself where it is not known here.
pub(in crate::record::report) fn short(code: &str, language: Language) -> String {
    plain(code, language).map_or_else(|| code.to_owned(), |plain| plain.title.to_owned())
}
