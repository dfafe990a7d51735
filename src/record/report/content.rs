//! What a report says, as data: rounded by the one rule and in words, for pages and for paper.
//!
//! Of two legs the patient's right one comes first everywhere, as it is seen from the front. Levels
//! come from the highest to the lowest, as a leg stands.

mod facts;
mod landmarks;
mod levels;
mod notes;
mod pictures;
mod surfaces;
mod tables;

use super::Figure;
use crate::leg::Side;
use crate::record::schema::LegFigures;
use crate::record::{Language, Record};

/// Everything that a report says.
#[derive(Debug, Clone, PartialEq)]
pub struct Content {
    /// The language it is said in.
    pub language: Language,
    /// What this is.
    pub title: String,
    /// The patient's id with nothing hidden in it, or that there is none.
    pub patient: String,
    /// When and where, in one line, for the head of a page.
    pub taken: String,
    /// Where it comes from: patient, time, station, scan, program.
    pub facts: Vec<Fact>,
    /// The heading of these facts.
    pub origin: String,
    /// The heading of the girths that matter most, with their unit.
    pub key: String,
    /// The girths and lengths at the levels.
    pub levels: Levels,
    /// Tables that follow: volumes, slices, the foot, heights that were asked for.
    pub tables: Vec<Table>,
    /// How well the surface follows the scan, a sentence or more a leg.
    pub surfaces: Section,
    /// Doubts and findings, what matters most first.
    pub notes: Section<Note>,
    /// How many notes there are of each weight, in one line, or that there is none.
    pub summary: String,
    /// How the figures are to be read.
    pub legend: Section,
    /// Every figure of every level in mm, digit by digit as in `record.json`.
    pub landmarks: Table,
    /// Headings of the pictures, and what is said where the record holds none.
    pub pictures: PictureWords,
}

/// A heading and what stands below it.
#[derive(Debug, Clone, PartialEq)]
pub struct Section<T = String> {
    /// The heading.
    pub title: String,
    /// What stands below it, one paragraph or entry each.
    pub entries: Vec<T>,
}

/// One thing about the record as a whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fact {
    /// What it is.
    pub name: String,
    /// Text that may come from outside: to be escaped, and kept from turning the text around it.
    pub value: String,
}

/// The table of levels.
#[derive(Debug, Clone, PartialEq)]
pub struct Levels {
    /// The heading.
    pub title: String,
    /// Heads: level; girth and length of the right leg; of the left leg; difference.
    pub columns: LevelColumns,
    /// The levels, highest first.
    pub rows: Vec<LevelRow>,
    /// Levels without a row, and why; none where all have one.
    pub left_out: Option<String>,
}

/// Heads of the table of levels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LevelColumns {
    /// Of the level.
    pub level: String,
    /// Of the legs, each over two columns, in the order of [`Side::FROM_FRONT`].
    pub legs: [String; 2],
    /// Of a girth, with its unit.
    pub girth: String,
    /// Of a length, with its unit.
    pub length: String,
    /// Of the difference of the girths, with its unit.
    pub difference: String,
}

/// One level of both legs.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelRow {
    /// Its name: `B1`.
    pub level: String,
    /// Where it is on the leg.
    pub place: String,
    /// Whether it is one of B, B1, C and D, for which every leg is searched.
    pub is_sought: bool,
    /// Of each leg, in the order of [`Side::FROM_FRONT`].
    pub legs: [LevelFigures; 2],
    /// Girth of the left leg minus that of the right, cm.
    pub difference: Figure,
}

/// One level of one leg.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelFigures {
    /// What a tape reads, cm.
    pub girth: Figure,
    /// From the floor along the skin, cm; of an estimated level the height above the floor, which
    /// its words say.
    pub length: Figure,
    /// Its doubts, in few words each.
    pub doubts: Vec<String>,
}

/// A table: each row has a head and as many figures as there are columns behind the first.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The heading, with the unit.
    pub title: String,
    /// How to read it; none where it needs no words.
    pub explanation: Option<String>,
    /// Heads of all columns, that of the rows' heads first.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<TableRow>,
}

/// A row of a [`Table`].
#[derive(Debug, Clone, PartialEq)]
pub struct TableRow {
    /// What the row is about.
    pub head: String,
    /// Its figures.
    pub figures: Vec<Figure>,
}

/// A doubt or finding in plain words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// Its stable code.
    pub code: String,
    /// How much it matters.
    pub weight: Weight,
    /// That in words.
    pub weight_words: String,
    /// Which leg and level, empty for the whole scan.
    pub place: String,
    /// What it is, in few words; the code where it is unknown here.
    pub title: String,
    /// What was found, with its figures.
    pub message: String,
    /// Whether the message could only be given in English, the record's own language.
    pub is_message_english: bool,
    /// What it means; none for an unknown code.
    pub meaning: Option<String>,
    /// What to do; none for an unknown code.
    pub action: Option<String>,
}

/// How much a note matters, the heaviest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Weight {
    /// Something was not measured.
    Error,
    /// Look before you use the record.
    Warning,
    /// Worth knowing.
    Info,
}

/// What is said around the pictures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PictureWords {
    /// The heading.
    pub title: String,
    /// What each figure of [`crate::record::picture::figures`] shows.
    pub captions: Vec<Caption>,
    /// Said where a leg of the record holds no shapes; none where all do.
    pub missing: Option<String>,
    /// The heading of the view that can be turned.
    pub view: String,
    /// Said where a page's script does not run.
    pub no_script: String,
}

/// What a figure shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Caption {
    /// The figure's name.
    pub name: &'static str,
    /// What it shows, in few words.
    pub title: String,
    /// How to read it.
    pub text: String,
}

impl Content {
    /// What a report of this record says in this language.
    pub fn of(record: &Record, language: Language) -> Content {
        let report = Report { record, language };
        let notes = report.notes();
        Content {
            language,
            title: report.say("Leg measurement", "Beinvermessung"),
            patient: report.patient(),
            taken: report.taken(),
            facts: report.facts(),
            origin: report.say("Where this comes from", "Woher dies stammt"),
            key: report.say("Girths at D, C, B1 and B (cm)", "Umfänge bei D, C, B1 und B (cm)"),
            levels: report.levels(),
            tables: report.tables(),
            surfaces: report.surfaces(),
            summary: report.summary(&notes.entries),
            notes,
            legend: report.legend(),
            landmarks: report.landmarks(),
            pictures: report.picture_words(),
        }
    }
}

/// A record that is told in a language.
struct Report<'a> {
    record: &'a Record,
    language: Language,
}

impl Report<'_> {
    fn say(&self, english: &str, german: &str) -> String {
        self.language.pick(english, german).to_owned()
    }

    /// The figures of both legs in the order of [`Side::FROM_FRONT`].
    fn legs(&self) -> [Option<&LegFigures>; 2] {
        Side::FROM_FRONT.map(|side| self.record.leg(side))
    }

    /// Whether somebody found something of this code about a leg, or about a level of it.
    fn is_found(&self, code: &str, side: Side, level: Option<&str>) -> bool {
        self.record.findings.iter().any(|finding| {
            let is_there = finding.leg.as_deref() == Some(side.word());
            finding.code == code && is_there && finding.level.as_deref() == level
        })
    }

    /// Why a leg is not in the record.
    fn no_leg(&self, side: Side) -> &'static str {
        if self.is_found("leg-not-measured", side, None) {
            self.language.pick("leg not measured", "Bein nicht vermessen")
        } else {
            self.language.pick("leg not in the scan", "Bein nicht im Scan")
        }
    }
}
