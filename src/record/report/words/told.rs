//! The meaning of a code in every language.

/// A finding in plain words, English and German.
pub(super) struct Told {
    pub code: &'static str,
    pub title: [&'static str; 2],
    pub meaning: [&'static str; 2],
    pub action: [&'static str; 2],
}
