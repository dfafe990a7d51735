//! A report that is not of a single record: a head and blocks in reading order, as data for a page and a PDF.

use jiff::Timestamp;

use super::content::{Section, Table};
use super::head::Head;
use crate::Record;
use crate::picture::figures::Figure;

/// Where a report comes from, for the properties of its PDF.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// What tells it from all others, such as the hashes of its scans.
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
    /// What stands on every page.
    pub head: Head,
    /// Where it comes from.
    pub origin: Origin,
    /// The same report as a PDF; `None` if a reader of the page cannot open it from there.
    pub paper: Option<PaperLink>,
    /// Its content, in reading order. What stands before the first [`Block::Turn`] is one page of paper.
    pub blocks: Vec<Block>,
}

/// A link from a page to the same report as a PDF.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PaperLink {
    /// Where it is, from the page.
    pub address: String,
    /// What the link says.
    pub words: String,
}

/// A part of a report.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// What matters most.
    Verdict(Vec<VerdictPart>),
    /// A heading with paragraphs.
    Section(Section),
    /// A table.
    Table(Table),
    /// A picture below a heading, and how to read it.
    Picture {
        /// The heading.
        title: String,
        /// What is drawn.
        figure: Figure,
        /// How to read it.
        caption: String,
    },
    /// Legs in the interactive 3D view of a page; nothing on paper.
    View(Box<View>),
    /// What follows begins on a new page of paper.
    Turn,
}

/// A part of what matters most.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VerdictPart {
    /// What it is about; `None` for the whole report.
    pub heading: Option<String>,
    /// What is said, a sentence a line.
    pub sentences: Vec<String>,
}

/// Legs in the interactive 3D view.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// The heading.
    pub title: String,
    /// How to read it.
    pub text: String,
    /// The legs as those of a record.
    pub record: Record,
    /// Words of the view, by their keys in the table `viewer`, that are others than for a record.
    pub words: Vec<(&'static str, String)>,
}
