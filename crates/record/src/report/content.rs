//! The content of a report as data, for pages and for the PDF: all figures are rounded and in words.
//!
//! The patient's right leg always comes before the left one, as seen from the front. Levels are ordered
//! from the highest to the lowest, as on a standing leg.

mod facts;
mod landmarks;
mod levels;
mod notes;
mod sizes;
mod tables;

use std::fmt::Display;

use gaiter_language::Language;
use gaiter_leg::Side;
use gaiter_leg::finding::Severity;
use gaiter_sizes::Garment;

use super::age::{Age, AgeMax};
use super::{Head, ReportFigure};
use crate::Record;
use crate::completeness::{Completeness, Kind};
use crate::measure::why_no_leg;
use crate::schema::NOT_VOUCHED;
use crate::sizing::{SizeChoice, SizeVerdicts};

/// The whole content of a report.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportContent {
    /// What is on every page.
    pub head: Head,
    /// The origin: patient, time, station, scan, program.
    pub facts: Vec<Fact>,
    /// What to do before the patient dresses.
    pub verdict: Verdict,
    /// The measuring sheet.
    pub levels: Levels,
    /// How old the scan is.
    pub age: Age,
    /// The names of what a person fills in beside it: the fields of an order that a scan cannot give.
    pub open: Section,
    /// The sizes of makers' tables; `None` if there are no tables.
    pub sizes: Option<Sizes>,
    /// The tables that follow: both legs at the same heights, requested heights, volumes.
    pub tables: Vec<Table>,
    /// The volumes of slices; `None` if there are none.
    pub slices: Option<Table>,
    /// How well the surface follows the scan, at least one sentence per leg.
    pub surfaces: Section,
    /// Doubts and findings, most important first.
    pub notes: Section<Note>,
    /// The number of notes of each weight in one line, or that there are none.
    pub summary: String,
    /// How to read the figures.
    pub legend: Section,
    /// Every figure of every level in mm, with the exact digits of `record.json`.
    pub landmarks: Table,
}

/// A heading and the content below it.
#[derive(Debug, Clone, PartialEq)]
pub struct Section<T = String> {
    /// The heading.
    pub title: String,
    /// The content, one paragraph or entry each.
    pub entries: Vec<T>,
}

/// One fact about the record as a whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fact {
    /// Its name.
    pub name: String,
    /// Its value, possibly from outside: it must be escaped and must not change the text direction.
    pub value: String,
}

/// The measuring sheet: the figures that an order needs, in the order of order forms.
#[derive(Debug, Clone, PartialEq)]
pub struct Levels {
    /// The heading.
    pub title: String,
    /// Headings of the columns.
    pub columns: SheetColumns,
    /// The levels, highest first.
    pub rows: Vec<LevelRow>,
    /// Foot and inside leg.
    pub lengths: Vec<SheetRow>,
    /// How to read the signs on the sheet.
    pub key: String,
    /// The doubts about these figures, a line for each leg that has any.
    pub doubts: Vec<String>,
    /// What people set in place of the scan's figures, a line for each measure.
    pub by_hand: Vec<String>,
    /// Where a tape that is not held square reads another girth; `None` where that does not matter.
    pub tilted: Option<String>,
}

/// Headings of the measuring sheet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SheetColumns {
    /// The level.
    pub level: String,
    /// The legs, each over four columns, in the order of [`Side::FROM_FRONT`].
    pub legs: [String; 2],
    /// A girth, with its unit.
    pub girth: String,
    /// A height above the floor, with its unit.
    pub height: String,
    /// The columns that are left open for a girth and a height by hand.
    pub by_hand: [String; 2],
}

/// One level of both legs.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelRow {
    /// Its name, such as `B1`.
    pub level: String,
    /// Where it is on the leg.
    pub place: String,
    /// Whether the garment needs it.
    pub is_needed: bool,
    /// Whether it lies at a height above the floor: not those of the foot.
    pub has_height: bool,
    /// The figures of each leg, in the order of [`Side::FROM_FRONT`].
    pub legs: [LevelFigures; 2],
}

/// One level of one leg.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelFigures {
    /// Girth by tape, cm.
    pub girth: ReportFigure,
    /// Vertical height above the floor, cm; a dash on the foot.
    pub height: ReportFigure,
}

/// A length of both legs.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetRow {
    /// What it is.
    pub head: String,
    /// The length of each leg, cm, in the order of [`Side::FROM_FRONT`].
    pub figures: [ReportFigure; 2],
}

/// What matters most.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verdict {
    /// What to do before the patient dresses; `None` if nothing.
    pub kind: Option<Kind>,
    /// It in words, the most important first.
    pub parts: Vec<VerdictPart>,
}

/// A part of what matters most.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VerdictPart {
    /// What it is about; `None` for the whole report.
    pub heading: Option<String>,
    /// The text, a sentence a line.
    pub sentences: Vec<String>,
}

/// The verdicts of makers' tables, and the boxes of an order form.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes {
    /// The heading.
    pub title: String,
    /// On the sheet: where the sizes are; `None` without tables.
    pub see: Option<String>,
    /// The tables, with what a reader must know before their verdicts, one paragraph each.
    pub about: Vec<String>,
    /// The sizes of all tables, a table for each leg.
    pub tables: Vec<Table>,
    /// The calibre jumps; `None` without tables.
    pub calibre: Option<Section>,
    /// The boxes of the order form, as printed.
    pub form: Table,
}

/// A table. Each row has a head and one figure for every column after the first.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The heading, with the unit.
    pub title: String,
    /// How to read it; `None` if it needs no explanation.
    pub explanation: Option<String>,
    /// Headings of all columns, beginning with that of the rows' heads.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<TableRow>,
    /// What is to be known of its figures, below them; `None` if nothing is.
    pub below: Option<String>,
}

impl Table {
    /// Whether its letters are smaller, because it has many columns.
    pub(super) fn is_dense(&self) -> bool {
        self.columns.len() > COLUMNS_MANY
    }
}

/// A table with more columns than this has many: the columns of one with fewer fit on a page in plain letters.
const COLUMNS_MANY: usize = 10;

/// A row of a [`Table`].
#[derive(Debug, Clone, PartialEq)]
pub struct TableRow {
    /// The subject of the row.
    pub head: String,
    /// Its figures.
    pub figures: Vec<ReportFigure>,
}

/// A doubt or finding in plain words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// Its stable code.
    pub code: String,
    /// How much it matters.
    pub weight: Severity,
    /// The weight in words.
    pub weight_words: String,
    /// The leg and level; empty for the whole scan.
    pub place: String,
    /// A short name, or the code if it is unknown here.
    pub title: String,
    /// The finding, with its figures.
    pub message: String,
    /// Whether the message is only available in English, the language of the record.
    pub is_message_english: bool,
    /// What it means; `None` for an unknown code.
    pub meaning: Option<String>,
    /// What to do; `None` for an unknown code.
    pub action: Option<String>,
}

impl ReportContent {
    /// The content of a report of this record in this language, for an order of this garment, without sizes.
    pub fn from_record(record: &Record, language: Language, garment: &Garment) -> ReportContent {
        let none = SizeVerdicts::new(record, garment, &SizeChoice::default());
        ReportContent::with_sizes(record, language, garment, &none, AgeMax::default())
    }

    /// The content of a report with the size tables' verdicts on the record, and how old its scan may be.
    pub fn with_sizes(
        record: &Record,
        language: Language,
        garment: &Garment,
        verdicts: &SizeVerdicts,
        age_max: AgeMax,
    ) -> ReportContent {
        let completeness = Completeness::from_record(record, garment);
        let report = Report { record, language, garment };
        let notes = report.notes();
        let is_vouched = !record.has_finding(NOT_VOUCHED);
        let title = if is_vouched { "report.title" } else { "report.title_not_vouched" };
        ReportContent {
            head: Head {
                language,
                title: report.text(title),
                is_vouched,
                patient: report.patient(),
                taken: report.taken(),
            },
            facts: report.facts(),
            verdict: Verdict {
                kind: Some(completeness.kind()),
                parts: vec![VerdictPart {
                    heading: None,
                    sentences: completeness.sentences(language),
                }],
            },
            levels: report.levels(),
            age: Age::new(record, age_max, language),
            open: report.open_fields(),
            sizes: report.sizes(verdicts),
            tables: report.tables(),
            slices: report.slices(),
            surfaces: report.surfaces(),
            summary: report.summary(&notes.entries),
            notes,
            legend: report.legend(),
            landmarks: report.landmarks(),
        }
    }

    /// What people set in place of the scan's figures, a line for each measure.
    pub fn by_hand(record: &Record, language: Language) -> Vec<String> {
        Report { record, language, garment: &Garment::default() }.by_hand()
    }

    /// How many notes of each weight a report has, in a line; empty if it has none.
    pub fn counted(record: &Record, language: Language) -> String {
        let garment = Garment::default();
        let report = Report { record, language, garment: &garment };
        let notes = report.notes().entries;
        if notes.is_empty() { String::new() } else { report.summary(&notes) }
    }
}

/// What a person fills in on the measuring sheet, in this order.
const OPEN_FIELDS: [&str; 12] = [
    "patient",
    "class",
    "knit",
    "product",
    "colour",
    "toe",
    "band",
    "quantity",
    "remark",
    "measured_by",
    "date",
    "signature",
];

/// A record with the language of its report.
struct Report<'a> {
    record: &'a Record,
    language: Language,
    garment: &'a Garment,
}

impl Report<'_> {
    fn text(&self, key: &'static str) -> String {
        self.language.text(key).to_owned()
    }

    fn filled(&self, key: &'static str, words: &[(&str, &dyn Display)]) -> String {
        self.language.filled(key, words)
    }

    fn open_fields(&self) -> Section {
        let name = |field| self.language.word("report.open.field", field).to_owned();
        Section { title: self.text("report.open.title"), entries: OPEN_FIELDS.map(name).into() }
    }

    /// The name of a leg.
    fn leg(&self, side: Side) -> &'static str {
        self.language.word("leg", side.word())
    }

    /// The name of a leg as a heading.
    fn leg_heading(&self, side: Side) -> String {
        self.language.word("leg.heading", side.word()).to_owned()
    }

    /// Why a leg is not in the record.
    fn no_leg(&self, side: Side) -> &'static str {
        self.language.text(why_no_leg(self.record, side))
    }
}
