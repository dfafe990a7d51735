//! A report as data for a page and a PDF: a head and blocks in reading order.

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use super::Head;
use super::age::Age;
use super::content::{Fact, Levels, Note, Section, Table, Verdict};
use crate::Record;
use crate::picture::figures::DrawnFigure;

/// Where a report comes from, for the properties of its PDF.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// What identifies it, such as the hashes of its scans.
    pub id: String,
    /// Who made it.
    pub author: String,
    /// The program and its version.
    pub made_by: String,
    /// When its scan was taken; `None` if that is not known.
    pub at: Option<Timestamp>,
}

/// A report of blocks.
#[derive(Debug, Clone, PartialEq)]
pub struct Document {
    /// What is on every page.
    pub head: Head,
    /// Where it comes from.
    pub origin: Origin,
    /// The same report as a PDF; `None` if a reader of the page cannot open it from there.
    pub paper: Option<PaperLink>,
    /// Its content, in reading order. The content before the first [`Block::Turn`] is one page of paper.
    pub blocks: Vec<Block>,
    /// What few readers need; `None` if there is nothing of that kind.
    pub appendix: Option<Appendix>,
}

/// What few readers need: closed on a page, and on paper only if it is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Appendix {
    /// The heading.
    pub title: String,
    /// Its content, in reading order.
    pub blocks: Vec<Block>,
}

/// A link from a page to the same report as a PDF.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PaperLink {
    /// Where it is, from the page.
    pub address: String,
    /// The text of the link.
    pub words: String,
}

/// How the report is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Print {
    /// The paper.
    pub paper: Paper,
    /// Whether the engineering figures follow: the fit of the surface and every figure in mm.
    pub has_appendix: bool,
}

/// The format of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Paper {
    /// ISO 216 A4: 210 mm × 297 mm.
    #[default]
    A4,
    /// ANSI letter: 8.5 in × 11 in.
    Letter,
}

impl Paper {
    /// The name in the configuration and in style sheets.
    pub const fn name(self) -> &'static str {
        match self {
            Paper::A4 => "A4",
            Paper::Letter => "letter",
        }
    }

    /// Width and height, pt.
    pub const fn size_pt(self) -> [f64; 2] {
        match self {
            Paper::A4 => [595.28, 841.89],
            Paper::Letter => [612.0, 792.0],
        }
    }
}

/// A part of a report.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// What matters most.
    Verdict(Verdict),
    /// The measuring sheet.
    Sheet(Box<Sheet>),
    /// Doubts and findings.
    Notes {
        /// The notes below their heading, most important first.
        notes: Section<Note>,
        /// The number of notes of each weight in one line, or that there are none.
        summary: String,
    },
    /// A heading with paragraphs.
    Section(Section),
    /// A heading with facts.
    Facts(Section<Fact>),
    /// A table.
    Table(Table),
    /// A picture below a heading, and how to read it.
    Picture {
        /// The heading.
        title: String,
        /// What is drawn.
        figure: DrawnFigure,
        /// How to read it.
        caption: String,
        /// How much of a page of paper it may take.
        room: Room,
    },
    /// Legs in the interactive 3D view of a page; nothing on paper.
    View(Box<View>),
    /// What follows begins on a new page of paper.
    Turn,
}

/// How much of a page of paper a picture takes at most, with its words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Room {
    /// Less than half: where it does not fit below what is before it, more than half of that page is filled.
    HalfPage,
    /// All of it, for pictures with much to read in them.
    Page,
}

/// The measuring sheet, with both legs and with what a person fills in.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// What identifies it: for paper, where the other facts are on another page.
    pub facts: Vec<Fact>,
    /// The figures of an order.
    pub levels: Levels,
    /// How old the scan is.
    pub age: Age,
    /// Where the sizes are; `None` without tables of sizes.
    pub see_sizes: Option<String>,
    /// Both legs with their girths; `None` for a record without shapes.
    pub legs: Option<DrawnFigure>,
    /// The names of what a person fills in.
    pub open: Section,
}

/// Legs in the interactive 3D view.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// The heading.
    pub title: String,
    /// Whose legs they are, behind the heading; `None` where that is plain.
    pub whose: Option<String>,
    /// How to read it; `None` if it needs no explanation.
    pub text: Option<String>,
    /// The legs as those of a record.
    pub record: Record,
    /// Words of the view, by their keys in the table `viewer`, that are others than for a record.
    pub words: Vec<(&'static str, String)>,
}
