//! Why a measure is not set, in words.

use std::fmt::Display;

use gaiter_language::Language;
use gaiter_leg::Side;

use super::{Subject, WORDS_MOST};
use crate::rounding::cm_words;

/// Why an amendment is not accepted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", self.in_words(Language::En))]
pub enum AmendFault {
    /// No such leg.
    Leg(String),
    /// No such measure.
    Measure(String),
    /// Reason (`reason`) or name (`by`) is missing.
    NoWords(&'static str),
    /// Reason or name is too long, or not in one line.
    Words(&'static str),
    /// It does not fit the measure of a leg.
    At {
        /// The leg.
        side: Side,
        /// The measure.
        subject: Subject,
        /// Why.
        what: What,
    },
}

/// Why an amendment does not fit a measure. `value` is `girth`, `height` or `length`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum What {
    /// Nothing is set.
    Nothing,
    /// A value that this measure does not have.
    NoSuch {
        /// Which.
        value: &'static str,
    },
    /// A value that no leg has.
    Range {
        /// Which.
        value: &'static str,
        /// The value found, mm.
        found_mm: f64,
        /// The smallest and the largest possible value, mm.
        range_mm: [f64; 2],
    },
    /// The scan did not find the level, and only part of it is set.
    Half {
        /// What is missing.
        value: &'static str,
    },
    /// A height that is not between those of the levels below and above.
    Order {
        /// The height, mm.
        height_mm: f64,
        /// Whether it must be above the other level.
        is_above: bool,
        /// The other level.
        other: &'static str,
        /// The height of the other level, mm.
        other_mm: f64,
    },
    /// A value that is far off the scan's, from a person who did not confirm it.
    FarOff {
        /// Which.
        value: &'static str,
        /// The value found, mm.
        found_mm: f64,
        /// The scan's at that height, mm.
        scanned_mm: f64,
    },
    /// Nothing was set before that could be taken back.
    NothingToTakeBack,
}

impl AmendFault {
    /// Whether a person who is sure may set it all the same.
    pub fn is_far_off(&self) -> bool {
        matches!(self, AmendFault::At { what: What::FarOff { .. }, .. })
    }

    pub(super) fn at(side: Side, subject: Subject, what: What) -> AmendFault {
        AmendFault::At { side, subject, what }
    }

    /// The fault in a sentence.
    pub fn in_words(&self, language: Language) -> String {
        match self {
            AmendFault::Leg(leg) => language.filled("amend.leg", &[("leg", leg)]),
            AmendFault::Measure(of) => language.filled("amend.measure", &[("measure", of)]),
            AmendFault::NoWords(which) => {
                let which = language.word("amend.words", which);
                language.filled("amend.words_missing", &[("which", &which)])
            }
            AmendFault::Words(which) => {
                let which = language.word("amend.words", which);
                language.filled("amend.no_words", &[("which", &which), ("most", &WORDS_MOST)])
            }
            AmendFault::At { side, subject, what } => {
                let leg = language.word("leg", side.word());
                let why = what.in_words(language);
                let measure = subject.name(language);
                language.filled("amend.at", &[("leg", &leg), ("measure", &measure), ("why", &why)])
            }
        }
    }
}

impl What {
    fn in_words(self, language: Language) -> String {
        let value = |value| language.word("amend.value", value);
        let cm = |mm| cm_words(mm, language);
        match self {
            What::Nothing => language.text("amend.nothing").to_owned(),
            What::NoSuch { value: of } => {
                language.filled("amend.no_such", &[("value", &value(of))])
            }
            What::Range { value: of, found_mm, range_mm: [low, high] } => {
                let words: [(&str, &dyn Display); 4] = [
                    ("value", &value(of)),
                    ("found", &cm(found_mm)),
                    ("low", &cm(low)),
                    ("high", &cm(high)),
                ];
                language.filled("amend.range", &words)
            }
            What::Half { value: of } => language.filled("amend.half", &[("value", &value(of))]),
            What::Order { height_mm, is_above, other, other_mm } => {
                let key = if is_above { "amend.not_above" } else { "amend.not_below" };
                let words: [(&str, &dyn Display); 3] = [
                    ("height", &cm(height_mm)),
                    ("other", &other),
                    ("other_height", &cm(other_mm)),
                ];
                language.filled(key, &words)
            }
            What::FarOff { value: of, found_mm, scanned_mm } => language.filled(
                "amend.far_off",
                &[("value", &value(of)), ("found", &cm(found_mm)), ("scan", &cm(scanned_mm))],
            ),
            What::NothingToTakeBack => language.text("amend.nothing_to_take_back").to_owned(),
        }
    }
}
