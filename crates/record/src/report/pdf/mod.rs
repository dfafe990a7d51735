//! `report.pdf`: the report on A4, with embedded fonts and with tags for screen readers.

mod blocks;
mod document;
mod drawing;
mod flow;
mod letters;
mod measuring_sheet;
mod packing;
mod parts;
mod sheet;
mod table;
mod tags;
mod wrap;

use thiserror::Error;

use self::flow::Flow;
use super::document::{Document, Origin};
use super::print::parted;
use super::{Content, Head, Paper, Print};
use crate::Record;
use crate::picture::figures::Figure;

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

/// Makes the PDF of a record with its content and with figures in the same language. The same record gives
/// the same bytes.
///
/// # Errors
/// If a font cannot be subset, which the tests rule out.
pub fn paper(
    record: &Record,
    content: &Content,
    figures: &[Figure],
    print: Print,
) -> Result<Vec<u8>, PdfFault> {
    let head = Head::of(content);
    let mut flow = Flow::new(&head, print.paper);
    let (pictures, appendix) = parted(figures);
    measuring_sheet::write(&mut flow, content, figures);
    parts::sizes(&mut flow, content.sizes.as_ref());
    parts::notes(&mut flow, content);
    let words = &content.pictures;
    parts::pictures(&mut flow, &words.title, words, &pictures);
    parts::tables(&mut flow, &content.tables);
    parts::section(&mut flow, &content.legend);
    parts::facts(&mut flow, content);
    if print.has_appendix {
        parts::pictures(&mut flow, &words.appendix, words, &appendix);
        parts::tables(&mut flow, content.slices.as_slice());
        parts::section(&mut flow, &content.surfaces);
        parts::landmarks(&mut flow, &content.landmarks);
    }
    let origin = Origin {
        id: format!("{} {}", record.scan.sha256, record.revision),
        author: record.station.clone().unwrap_or_else(|| "gaiter".to_owned()),
        made_by: format!("gaiter {}", record.made_by.gaiter),
        at: record.acquired.as_ref().map(|acquired| acquired.at),
    };
    document::bytes(flow.finished(), &head, &origin)
}

/// Makes the PDF of a report of blocks.
///
/// # Errors
/// If a font cannot be subset, which the tests rule out.
pub fn document_paper(of: &Document, paper: Paper) -> Result<Vec<u8>, PdfFault> {
    let mut flow = Flow::new(&of.head, paper);
    blocks::write(&mut flow, of);
    document::bytes(flow.finished(), &of.head, &of.origin)
}
