//! Both legs at a glance for the operator's page: girth and height at B, B1, C and D and where else the garment
//! needs them.

use gaiter_language::Language;
use gaiter_leg::{Level, Side};
use gaiter_sizes::{Garment, Point};
use serde::Serialize;

use super::completeness::Completeness;
use super::measure::amendment::Subject;
use super::measure::{Absent, Length, Measure, why_absent};
use super::report::{Reliability, ReportContent};
use super::rounding;
use super::schema::Record;

/// The levels of a stocking that ends below the knee, highest first as on the measuring sheet.
const LEVELS: [Level; 4] = [Level::D, Level::C, Level::B1, Level::B];

/// The measures of a record, ready to show.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RecordSummary {
    /// D, C, B1, B and what else the garment needs, highest first; then the length of the foot, if it needs that.
    pub levels: Vec<SummaryLevel>,
    /// How many notes of each weight the report has, in its words; empty if it has none.
    pub notes: String,
    /// `complete`, `not-measurable`, `by-hand` or `scan-again`; see [`Kind`](super::completeness::Kind).
    pub verdict: &'static str,
    /// What to do before the patient dresses, in sentences; at least one.
    pub to_do: Vec<String>,
}

/// One level of both legs, or the length of both feet. A leg on which it was not found has no figures.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SummaryLevel {
    /// Its name.
    pub level: &'static str,
    /// Whether it has a girth and a height, or one length alone.
    pub is_level: bool,
    /// On the patient's right leg.
    pub right: Option<SummaryFigures>,
    /// On the patient's left leg.
    pub left: Option<SummaryFigures>,
    /// Why the right leg has none, in a word or two.
    pub right_absent: Option<&'static str>,
    /// Why the left leg has none.
    pub left_absent: Option<&'static str>,
}

/// The figures of one level of one leg, cm with one decimal, as text in the reader's language.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct SummaryFigures {
    /// Tape girth, or length.
    pub girth_cm: String,
    /// Height above the floor.
    pub height_cm: String,
    /// Whether there is a doubt about the girth.
    pub is_girth_doubted: bool,
    /// Whether there is a doubt about the height.
    pub is_height_doubted: bool,
    /// Whether a person set the girth.
    pub is_girth_by_hand: bool,
    /// Whether a person set the height.
    pub is_height_by_hand: bool,
}

impl RecordSummary {
    /// The measures of a record as text in a language, for an order of this garment.
    pub fn from_record(record: &Record, language: Language, garment: &Garment) -> RecordSummary {
        let is_shown = |level: &Level| LEVELS.contains(level) || garment.levels().contains(level);
        let levels = Level::ALL.into_iter().rev().filter(is_shown);
        let foot = garment.needs(Point::Foot).then_some(Subject::FootLength);
        let shown = levels.map(Subject::Level).chain(foot);
        let completeness = Completeness::from_record(record, garment);
        RecordSummary {
            levels: shown.map(|of| SummaryLevel::new(record, of, language)).collect(),
            notes: ReportContent::counted(record, language),
            verdict: completeness.kind().word(),
            to_do: completeness.sentences(language),
        }
    }
}

impl SummaryLevel {
    fn new(record: &Record, subject: Subject, language: Language) -> SummaryLevel {
        let figures = |side: Side| match subject {
            Subject::Level(level) => match Measure::find(record, side, level) {
                Ok(measure) => Ok(SummaryFigures::from_measure(&measure, language)),
                Err(absent) => Err(language.text(why_absent(record, side, level, absent))),
            },
            length => match Length::find(record, side, length) {
                Ok(length) => Ok(SummaryFigures::of_length(length, language)),
                Err(absent) => Err(absent.words(language)),
            },
        };
        let [right, left] = [Side::Right, Side::Left].map(figures);
        SummaryLevel {
            level: subject.name(language),
            is_level: matches!(subject, Subject::Level(_)),
            right: right.clone().ok(),
            left: left.clone().ok(),
            right_absent: right.err(),
            left_absent: left.err(),
        }
    }
}

impl SummaryFigures {
    fn from_measure(measure: &Measure<'_>, language: Language) -> SummaryFigures {
        let is_doubted = |length: Length| measure.mark_of(length) == Reliability::Doubtful;
        let words = |length: Length| rounding::cm_words(length.mm, language);
        SummaryFigures {
            girth_cm: words(measure.girth),
            height_cm: measure.height.map(words).unwrap_or_default(),
            is_girth_doubted: is_doubted(measure.girth),
            is_height_doubted: measure.height.is_some_and(is_doubted),
            is_girth_by_hand: measure.girth.is_by_hand,
            is_height_by_hand: measure.height.is_some_and(|height| height.is_by_hand),
        }
    }

    fn of_length(length: Length, language: Language) -> SummaryFigures {
        SummaryFigures {
            girth_cm: rounding::cm_words(length.mm, language),
            is_girth_by_hand: length.is_by_hand,
            ..SummaryFigures::default()
        }
    }
}

/// Every measure that a person can set, in the order of the measuring sheet.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SheetLine {
    /// The word of the record: a level, or a length.
    pub measure: &'static str,
    /// Its name for people.
    pub name: &'static str,
    /// `level`, `foot` for a level without a height, or `length`.
    pub kind: &'static str,
    /// The values on the right leg; empty on a leg without any.
    pub right: SheetCell,
    /// The values on the left leg.
    pub left: SheetCell,
}

/// The values of a measure of one leg that count now, cm, as text in the reader's language.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct SheetCell {
    /// Girth, or length.
    pub value: String,
    /// Height above the floor.
    pub height: String,
    /// Whether a person set any of it.
    pub is_by_hand: bool,
    /// What of it is to be measured by hand: `girth`, `height` or `length`.
    pub asked: Vec<&'static str>,
}

/// The whole measuring sheet of a record, for an order of this garment.
pub fn sheet(record: &Record, language: Language, garment: &Garment) -> Vec<SheetLine> {
    let Completeness { by_hand, .. } = Completeness::from_record(record, garment);
    let cell = |side: Side, subject: Subject| {
        let items = Side::FROM_FRONT.into_iter().zip(&by_hand).find(|(of, _)| *of == side);
        let items = items.into_iter().flat_map(|(_, items)| items);
        let asked = items.flat_map(|item| item.values_of(subject)).copied().collect();
        SheetCell { asked, ..SheetCell::new(record, side, subject, language) }
    };
    let line = |subject: Subject| SheetLine {
        measure: subject.word(),
        name: subject.name(language),
        kind: match subject {
            Subject::Level(level) if level < Level::B => "foot",
            Subject::Level(_) => "level",
            _ => "length",
        },
        right: cell(Side::Right, subject),
        left: cell(Side::Left, subject),
    };
    Subject::all().map(line).collect()
}

impl SheetCell {
    fn new(record: &Record, side: Side, subject: Subject, language: Language) -> SheetCell {
        let is_by_hand = record.by_hand(side, subject).is_some();
        let words = |length: Length| rounding::cm_words(length.mm, language);
        let found = match subject {
            Subject::Level(level) => Measure::find(record, side, level)
                .map(|of| (words(of.girth), of.height.map(words).unwrap_or_default())),
            length => Length::find(record, side, length).map(|of| (words(of), String::new())),
        };
        let or_why = |absent: Absent| (absent.words(language).to_owned(), String::new());
        let (value, height) = found.unwrap_or_else(or_why);
        SheetCell { value, height, is_by_hand, asked: Vec::new() }
    }
}
