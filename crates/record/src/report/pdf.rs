//! `report.pdf`: the report on A4, with embedded fonts and with tags for screen readers.
//!
//! `layout` has the margins and breaks the text into pages, `sheet` draws on a page, `parts` and `measuring_sheet`
//! define what is on them, `document` writes the objects of the file.

mod blocks;
mod document;
mod drawing;
mod layout;
mod letters;
mod measuring_sheet;
mod parts;
mod sheet;
mod table;
mod tags;
mod wrap;

use thiserror::Error;

use self::layout::Flow;
use super::Print;
use super::document::Document;

/// Why there is no PDF.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum PdfFault {
    /// A font of the program could not be subset.
    #[error("the fonts of report.pdf could not be subset: {message}")]
    Font {
        /// The subsetter's message.
        message: String,
    },
}

impl PdfFault {
    /// The stable code used in records and docs/codes.md.
    pub fn code(&self) -> &'static str {
        match self {
            PdfFault::Font { .. } => "paper-not-made",
        }
    }
}

/// Makes the PDF of a report. The same report gives the same bytes.
///
/// # Errors
/// If a font cannot be subset, which the tests rule out.
pub fn paper(of: &Document, print: Print) -> Result<Vec<u8>, PdfFault> {
    let mut flow = Flow::new(&of.head, print.paper);
    blocks::write(&mut flow, of, print.has_appendix);
    document::bytes(flow.finished(), &of.head, &of.origin)
}
