//! Both legs at a glance for the operator's page: girth and height at B, B1, C and D.

use serde::Serialize;

use super::completeness::Completeness;
use super::garment::Garment;
use super::rounding;
use super::schema::{LandmarkFigures, Record};
use crate::language::Language;
use crate::leg::Side;

/// The levels of a stocking that ends below the knee, highest first as on the measuring sheet.
const LEVELS: [&str; 4] = ["D", "C", "B1", "B"];

/// The measures of a record, ready to show.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RecordSummary {
    /// D, C, B1 and B.
    pub levels: Vec<SummaryLevel>,
    /// Number of findings, without those that are only information.
    pub findings: usize,
    /// `complete`, `by-hand` or `scan-again`; see [`Kind`](super::completeness::Kind).
    pub verdict: &'static str,
    /// What is to be done before the patient dresses, in sentences; at least one.
    pub to_do: Vec<String>,
}

/// One level of both legs. A leg on which it was not found has no figures.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SummaryLevel {
    /// Its name.
    pub level: &'static str,
    /// On the patient's right leg.
    pub right: Option<SummaryFigures>,
    /// On the patient's left leg.
    pub left: Option<SummaryFigures>,
}

/// The figures of one level of one leg, cm with one decimal, as text in the reader's language.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SummaryFigures {
    /// Tape girth.
    pub girth_cm: String,
    /// Height above the floor.
    pub height_cm: String,
    /// Whether there is a doubt about it.
    pub is_doubted: bool,
}

impl RecordSummary {
    /// The measures of a record as text in a language, for an order of this garment.
    pub fn of(record: &Record, language: Language, garment: Garment) -> RecordSummary {
        let figures = |side: Side, level: &str| {
            let leg = record.leg(side)?;
            leg.landmarks.get(level).map(|landmark| SummaryFigures::of(landmark, language))
        };
        let levels = LEVELS.map(|level| SummaryLevel {
            level,
            right: figures(Side::Right, level),
            left: figures(Side::Left, level),
        });
        let findings = record.findings.iter().filter(|finding| finding.severity != "info").count();
        let completeness = Completeness::of(record, garment);
        RecordSummary {
            levels: levels.into(),
            findings,
            verdict: completeness.kind().word(),
            to_do: completeness.sentences(language),
        }
    }
}

impl SummaryFigures {
    fn of(landmark: &LandmarkFigures, language: Language) -> SummaryFigures {
        SummaryFigures {
            girth_cm: rounding::cm_words(landmark.girth_tape_mm, language),
            height_cm: rounding::cm_words(landmark.height_mm, language),
            is_doubted: !landmark.doubts.is_empty(),
        }
    }
}
