//! Both legs at a glance for the operator's page: girth and height at B, B1, C and D.

use serde::Serialize;

use super::rounding;
use super::schema::{LandmarkFigures, Record};
use crate::language::Language;
use crate::leg::Side;

/// The levels of a stocking that ends below the knee, from the foot up.
const LEVELS: [&str; 4] = ["B", "B1", "C", "D"];

/// The measures of a record, ready to show.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RecordSummary {
    /// B, B1, C and D, from the foot up.
    pub levels: Vec<SummaryLevel>,
    /// Number of findings, without those that are only information.
    pub findings: usize,
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
    /// The measures of a record as text in a language.
    pub fn of(record: &Record, language: Language) -> RecordSummary {
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
        RecordSummary { levels: levels.into(), findings }
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
