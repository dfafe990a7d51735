//! A figure as the report tells it: rounded, in words, with what it is worth.

use crate::record::Language;
use crate::record::rounding::{
    cm, cm_margin, cm_words, ml_margin, number, signed, tenths_words, whole_ml,
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
    /// A difference larger than its own uncertainty, as both are told.
    Real,
}

impl Figure {
    /// A length or girth, cm.
    pub(super) fn cm(value_mm: f64, sd_mm: Option<f64>, mark: Mark, language: Language) -> Figure {
        let margin = sd_mm.map_or_else(unknown, |sd_mm| number(cm_margin(sd_mm), 1, language));
        Figure { value: cm_words(value_mm, language), margin: Some(margin), mark }
    }

    /// A volume, mL.
    pub(super) fn ml(value_ml: f64, sd_ml: Option<f64>, language: Language) -> Figure {
        let margin = sd_ml.map_or_else(unknown, |sd_ml| number(ml_margin(sd_ml), 0, language));
        Figure {
            value: number(whole_ml(value_ml), 0, language),
            margin: Some(margin),
            mark: Mark::Sure,
        }
    }

    /// A difference of lengths, cm, left minus right.
    pub(super) fn cm_difference(value_mm: f64, sd_mm: Option<f64>, language: Language) -> Figure {
        let mark = reality(cm(value_mm), sd_mm.map(cm_margin));
        let figure = Figure::cm(value_mm, sd_mm, mark, language);
        Figure { value: signed(value_mm, &figure.value), ..figure }
    }

    /// A difference of volumes, mL, left minus right, with its share of the smaller leg.
    pub(super) fn ml_difference(
        [value_ml, percent]: [f64; 2],
        sd_ml: Option<f64>,
        language: Language,
    ) -> [Figure; 2] {
        let mark = reality(whole_ml(value_ml), sd_ml.map(ml_margin));
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

/// How a difference is to be taken, of itself and its uncertainty as they are told.
fn reality(told: f64, margin: Option<f64>) -> Mark {
    if margin.is_some_and(|margin| told.abs() > margin) { Mark::Real } else { Mark::Sure }
}
