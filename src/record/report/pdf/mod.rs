//! `report.pdf`: the report on A4, with its fonts and with tags for those who have it read to them.

mod document;
mod drawing;
mod flow;
mod letters;
mod packing;
mod parts;
mod sheet;
mod table;
mod tags;
mod wrap;

use thiserror::Error;

use self::flow::Flow;
use super::Content;
use crate::record::picture::figures::Figure;
use crate::record::{Language, Record};

/// Why there is no paper.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum PdfFault {
    /// A font of the program could not be cut down.
    #[error("the fonts of report.pdf could not be cut down: {message}")]
    Font {
        /// The cutter's words.
        message: String,
    },
}

impl PdfFault {
    /// The stable code used in records and the README's table.
    pub fn code(&self) -> &'static str {
        match self {
            PdfFault::Font { .. } => "paper-not-made",
        }
    }
}

/// The paper of a record in a language, with its figures in that language. The same record gives the
/// same bytes.
///
/// # Errors
/// Where a font cannot be cut down, which the tests rule out.
pub fn paper(record: &Record, language: Language, figures: &[Figure]) -> Result<Vec<u8>, PdfFault> {
    let content = Content::of(record, language);
    let mut flow = Flow::new(&content);
    parts::front(&mut flow, &content);
    parts::levels(&mut flow, &content.levels);
    parts::notes(&mut flow, &content);
    parts::tables(&mut flow, &content.tables);
    parts::section(&mut flow, &content.surfaces);
    parts::section(&mut flow, &content.legend);
    parts::pictures(&mut flow, &content.pictures, figures);
    parts::landmarks(&mut flow, &content.landmarks);
    document::bytes(flow.finished(), record, &content)
}
