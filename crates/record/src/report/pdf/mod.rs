//! `report.pdf`: the report on A4, with embedded fonts and with tags for screen readers.

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
use super::document::{Block, Document, Origin};
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
    parts::pictures(&mut flow, &content.pictures, &pictures);
    parts::tables(&mut flow, &content.tables);
    parts::section(&mut flow, &content.legend);
    parts::facts(&mut flow, content);
    if print.has_appendix {
        parts::appendix(&mut flow, &content.pictures, &appendix);
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
    write_blocks(&mut flow, of);
    document::bytes(flow.finished(), &of.head, &of.origin)
}

fn write_blocks(flow: &mut Flow<'_>, of: &Document) {
    parts::title(flow, &of.head.title);
    let turn = of.blocks.iter().position(|block| matches!(block, Block::Turn)).unwrap_or(0);
    let (first, others) = of.blocks.split_at(turn);
    parts::first_page(flow, first);
    for block in others {
        match block {
            Block::Verdict(sentences) => parts::sentences(flow, sentences),
            Block::Section(section) => parts::section(flow, section),
            Block::Table(table) => parts::tables(flow, std::slice::from_ref(table)),
            Block::Picture { title, figure, caption } => {
                parts::picture(flow, title, figure, caption);
            }
            Block::View(_) => {}
            Block::Turn => flow.turn(),
        }
    }
}

#[cfg(test)]
mod tests {
    use gaiter_language::Language;

    use super::*;
    use crate::picture::Picture;
    use crate::report::content::Section;

    fn picture(height: f64) -> Block {
        let title = "a picture".to_owned();
        let picture = Picture {
            title: title.clone(),
            size: [720.0, height],
            cuts: Vec::new(),
            marks: Vec::new(),
        };
        let figure = Figure { name: "picture", picture, marks: String::new() };
        Block::Picture { title, figure, caption: "How to read it. ".repeat(12) }
    }

    /// The pages of a report, and how far the last of them is filled, pt.
    fn filled(blocks: Vec<Block>, paper: Paper) -> (usize, f64) {
        let text = "text".to_owned();
        let head = Head {
            language: Language::En,
            title: text.clone(),
            patient: text.clone(),
            taken: text.clone(),
        };
        let origin = Origin { id: text.clone(), author: text.clone(), made_by: text, at: None };
        let of = Document { head: head.clone(), origin, paper: None, blocks };
        let mut flow = Flow::new(&head, paper);
        write_blocks(&mut flow, &of);
        (flow.sheets.pages.len(), flow.y)
    }

    #[test]
    fn what_stands_before_the_turn_is_one_page_however_much_is_to_say() {
        let sentence =
            "Right leg, 12 Jan 2026 to 16 Nov 2026: no change of the volume shown. ".repeat(2);
        for paper in [Paper::A4, Paper::Letter] {
            for count in 0..=8 {
                let said = vec![sentence.clone(); count];
                let section = Section {
                    title: "To consider".to_owned(),
                    entries: said[..count / 2].to_vec(),
                };
                let first =
                    [Block::Verdict(said), Block::Section(section), picture(242.0), picture(290.0)];
                let alone = [first.as_slice(), &[Block::Turn]].concat();
                // The turn itself begins the second page.
                assert_eq!(filled(alone, paper).0, 2, "{count} sentences, {paper:?}");
            }
        }
    }

    #[test]
    fn a_picture_that_goes_to_the_next_page_leaves_less_than_half_of_one_empty() {
        let [_, height] = Paper::A4.size_pt();
        for size in [250.0, 520.0, 1400.0] {
            for before in 0..45 {
                let said = Block::Verdict(vec!["One line.".to_owned(); before]);
                let (_, alone) = filled(vec![said.clone()], Paper::A4);
                let (pages, _) = filled(vec![said, picture(size)], Paper::A4);
                let is_half_full = alone > height / 2.0 + 10.0;
                assert!(pages == 1 || is_half_full, "{size} px below {before} lines");
            }
        }
    }
}
