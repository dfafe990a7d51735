//! A figure as the report tells it: rounded, in words, with what it is worth.

use crate::record::Language;
use crate::record::rounding::{
    cm_margin_words, cm_words, ml_margin_words, ml_words, signed, tenths_words,
};

/// A figure in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// The figure in the unit that its table names; of a missing one, why it is missing.
    pub value: String,
    /// What it is uncertain by, without `±`: `?` where that cannot be judged; none where the figure
    /// has no uncertainty to tell.
    pub margin: Option<String>,
    /// How it is to be taken.
    pub mark: Mark,
}

/// How a figure is to be taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// As it stands.
    Sure,
    /// There is a doubt; a note tells which.
    Doubtful,
    /// Given by a proportion of the body, not seen.
    Estimated,
    /// There is none; the words say why.
    Missing,
    /// A difference larger than its own uncertainty.
    Real,
}

impl Figure {
    /// A length or girth, cm.
    pub(super) fn cm(value_mm: f64, sd_mm: Option<f64>, mark: Mark, language: Language) -> Figure {
        let margin = sd_mm.map_or_else(unknown, |sd_mm| cm_margin_words(sd_mm, language));
        Figure { value: cm_words(value_mm, language), margin: Some(margin), mark }
    }

    /// A volume, mL.
    pub(super) fn ml(value_ml: f64, sd_ml: Option<f64>, language: Language) -> Figure {
        let margin = sd_ml.map_or_else(unknown, |sd_ml| ml_margin_words(sd_ml, language));
        Figure { value: ml_words(value_ml, language), margin: Some(margin), mark: Mark::Sure }
    }

    /// A difference of lengths, cm, left minus right.
    pub(super) fn cm_difference(value_mm: f64, sd_mm: Option<f64>, language: Language) -> Figure {
        let figure = Figure::cm(value_mm, sd_mm, reality(value_mm, sd_mm), language);
        Figure { value: signed(value_mm, &figure.value), ..figure }
    }

    /// A difference of volumes, mL, left minus right, with its share of the smaller leg.
    pub(super) fn ml_difference(
        [value_ml, percent]: [f64; 2],
        sd_ml: Option<f64>,
        language: Language,
    ) -> [Figure; 2] {
        let mark = reality(value_ml, sd_ml);
        let figure = Figure::ml(value_ml, sd_ml, language);
        let share = signed(percent, &tenths_words(percent, language));
        [
            Figure { value: signed(value_ml, &figure.value), mark, ..figure },
            Figure { value: share, margin: None, mark },
        ]
    }

    /// No figure, and why.
    pub(super) fn missing(why: &str) -> Figure {
        Figure { value: why.to_owned(), margin: None, mark: Mark::Missing }
    }

    /// A figure or other words as they are.
    pub(super) fn plain(value: impl Into<String>) -> Figure {
        Figure { value: value.into(), margin: None, mark: Mark::Sure }
    }

    /// Whether it is told in words instead of digits.
    pub fn is_missing(&self) -> bool {
        self.mark == Mark::Missing
    }
}

/// An uncertainty that cannot be judged.
fn unknown() -> String {
    "?".to_owned()
}

/// Whether a difference is larger than two standard errors, as the findings judge it.
fn reality(value: f64, sd: Option<f64>) -> Mark {
    let is_real = sd.is_some_and(|sd| value.abs() > crate::record::rounding::MARGIN_SDS * sd);
    if is_real { Mark::Real } else { Mark::Sure }
}
