//! A figure as shown in the report: rounded, in words, with its uncertainty.

use gaiter_language::Language;

use crate::rounding::{
    cm, cm_margin, cm_words, exceeds, ml_margin, number, signed, tenths_words, whole_ml,
};

/// A figure in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReportFigure {
    /// The figure in the unit of its table, or the reason why it is missing.
    pub value: String,
    /// Its uncertainty without `±`; `?` if it is unknown. `None` for a figure without an uncertainty to
    /// show.
    pub margin: Option<String>,
    /// How to read it.
    pub mark: Reliability,
}

/// How to read a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reliability {
    /// At face value.
    Sure,
    /// There is a doubt, which a note explains.
    Doubtful,
    /// Estimated by a proportion of the body, not seen.
    Estimated,
    /// A person set it.
    ByHand,
    /// There is no figure; the words give the reason.
    Missing,
    /// A difference larger than its own uncertainty, both as shown.
    Real,
}

impl Reliability {
    /// The sign for it in tables of plain text.
    pub fn sign(self) -> &'static str {
        match self {
            Reliability::Estimated => "~",
            Reliability::Doubtful => "?",
            Reliability::ByHand => "*",
            Reliability::Sure | Reliability::Missing | Reliability::Real => "",
        }
    }

    /// The sign behind a girth in a picture if a person set it.
    pub(crate) fn by_hand_sign(self) -> &'static str {
        if self == Reliability::ByHand { " *" } else { "" }
    }
}

impl ReportFigure {
    /// A length or girth, cm.
    pub(super) fn cm(
        value_mm: f64,
        sd_mm: Option<f64>,
        mark: Reliability,
        language: Language,
    ) -> ReportFigure {
        let margin = sd_mm.map_or_else(unknown, |sd_mm| number(cm_margin(sd_mm), 1, language));
        ReportFigure { value: cm_words(value_mm, language), margin: Some(margin), mark }
    }

    /// A volume, mL.
    pub fn ml(value_ml: f64, sd_ml: Option<f64>, language: Language) -> ReportFigure {
        let margin = sd_ml.map_or_else(unknown, |sd_ml| number(ml_margin(sd_ml), 0, language));
        ReportFigure {
            value: number(whole_ml(value_ml), 0, language),
            margin: Some(margin),
            mark: Reliability::Sure,
        }
    }

    /// A difference of lengths, cm, left minus right.
    pub(super) fn cm_difference(
        value_mm: f64,
        sd_mm: Option<f64>,
        language: Language,
    ) -> ReportFigure {
        let mark = reality(cm(value_mm), sd_mm.map(cm_margin));
        let figure = ReportFigure::cm(value_mm, sd_mm, mark, language);
        ReportFigure { value: signed(value_mm, &figure.value), ..figure }
    }

    /// A difference of volumes, mL, left minus right, with its share of the smaller leg.
    pub(super) fn ml_difference(
        [value_ml, percent]: [f64; 2],
        sd_ml: Option<f64>,
        language: Language,
    ) -> [ReportFigure; 2] {
        let mark = reality(whole_ml(value_ml), sd_ml.map(ml_margin));
        let figure = ReportFigure::ml(value_ml, sd_ml, language);
        let share = signed(percent, &tenths_words(percent, language));
        [
            ReportFigure { value: signed(value_ml, &figure.value), mark, ..figure },
            ReportFigure { value: share, margin: None, mark },
        ]
    }

    /// A missing figure, with the reason.
    pub fn missing(why: &str) -> ReportFigure {
        ReportFigure::marked(why, Reliability::Missing)
    }

    /// A figure or other text without changes.
    pub fn plain(value: impl Into<String>) -> ReportFigure {
        ReportFigure::marked(value, Reliability::Sure)
    }

    /// A figure without an uncertainty to show, and how to read it.
    pub fn marked(value: impl Into<String>, mark: Reliability) -> ReportFigure {
        ReportFigure { value: value.into(), margin: None, mark }
    }

    /// Whether there is a reason instead of a figure.
    pub fn is_missing(&self) -> bool {
        self.mark == Reliability::Missing
    }
}

/// The text for an unknown uncertainty.
fn unknown() -> String {
    "?".to_owned()
}

/// The mark of a difference, from the rounded values that are shown.
fn reality(printed: f64, margin: Option<f64>) -> Reliability {
    if exceeds(printed, margin) { Reliability::Real } else { Reliability::Sure }
}
