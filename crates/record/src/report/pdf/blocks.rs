//! The blocks of a report on pages.

use pdf_writer::types::StructRole;

use super::layout::{BOLD_TYPE, Flow, SMALL_TYPE, TITLE_TYPE};
use super::measuring_sheet;
use super::parts::{self, DRAWN_GAP, PART_GAP};
use crate::picture::{Ink, Picture};
use crate::report::document::{Block, Document};

/// The smallest scale at which the letters of a picture can be read, pt per px.
const READABLE: f64 = 0.35;

/// Writes a report. The content before its turn is one page; the appendix begins a page, too.
pub(super) fn write(flow: &mut Flow<'_>, of: &Document, has_appendix: bool) {
    flow.text(&of.head.title, StructRole::H1, TITLE_TYPE, Ink::Text);
    flow.space(6.0);
    let turn = of.blocks.iter().position(|block| matches!(block, Block::Turn)).unwrap_or(0);
    let (first, others) = of.blocks.split_at(turn);
    first_page(flow, first);
    fill(flow, others);
    if let Some(appendix) = of.appendix.as_ref().filter(|_| has_appendix) {
        flow.turn();
        flow.heading(&appendix.title, 0.0);
        fill(flow, &appendix.blocks);
    }
}

/// What matters most on a page of its own: its pictures share the height that its words leave. Only where that is so
/// little that they could not be read, they continue.
fn first_page(flow: &mut Flow<'_>, blocks: &[Block]) {
    let mut pictures: Vec<(&String, &Picture, &String)> = Vec::new();
    for of in blocks {
        match of {
            Block::Section(section) => parts::small_section(flow, section),
            Block::Picture { title, figure, caption, .. } => {
                pictures.push((title, &figure.picture, caption));
            }
            _ => block(flow, of),
        }
    }
    let around = |title: &str, caption: &str| {
        let words = Flow::height_of(title, BOLD_TYPE) + Flow::height_of(caption, SMALL_TYPE);
        PART_GAP + words + 2.0 * DRAWN_GAP
    };
    let words: f64 = pictures.iter().map(|(title, _, caption)| around(title, caption)).sum();
    let heights: f64 = pictures.iter().map(|(_, picture, _)| picture.size[1]).sum();
    let scale = ((flow.room() - words) / heights).max(READABLE);
    for (title, picture, caption) in pictures {
        let height = Flow::drawn_height(picture, scale);
        flow.need(around(title, caption) + height);
        flow.space(PART_GAP);
        flow.text(title, StructRole::H2, BOLD_TYPE, Ink::Text);
        flow.space(DRAWN_GAP);
        flow.drawing(picture, height);
        flow.space(DRAWN_GAP);
        flow.text(caption, StructRole::P, SMALL_TYPE, Ink::Muted);
    }
}

/// Writes blocks on full pages: tables are whole and pictures are not small, so what does not fit below lets what fits
/// go before it.
fn fill(flow: &mut Flow<'_>, blocks: &[Block]) {
    let mut left: Vec<&Block> = blocks.iter().collect();
    while !left.is_empty() {
        let next = next(flow, &left);
        block(flow, left.remove(next));
    }
}

/// The place of the block that is written next: the first that fits below, else the first. Only tables and pictures go
/// before others, and only before such.
fn next(flow: &Flow<'_>, left: &[&Block]) -> usize {
    let is_movable =
        |of: &&&Block| matches!(of, Block::Table(_) | Block::Picture { .. } | Block::View(_));
    let movable = left.iter().take_while(is_movable);
    let goes = |(at, block): (usize, &&Block)| {
        let is_before_like = left[..at].iter().any(|other| is_like(other, block));
        (!is_before_like && fits(flow, block)).then_some(at)
    };
    movable.enumerate().find_map(goes).unwrap_or(0)
}

/// Whether two tables are read one after the other.
fn is_like(one: &Block, other: &Block) -> bool {
    match (one, other) {
        (Block::Table(one), Block::Table(other)) => one.columns == other.columns,
        _ => false,
    }
}

fn fits(flow: &Flow<'_>, block: &Block) -> bool {
    match block {
        Block::Table(table) => parts::table_fits(flow, table),
        Block::Picture { figure, caption, room, .. } => {
            parts::picture_fits(flow, figure, caption, *room)
        }
        _ => true,
    }
}

fn block(flow: &mut Flow<'_>, of: &Block) {
    match of {
        Block::Verdict(sentences) => parts::verdict(flow, sentences),
        Block::Sheet(sheet) => measuring_sheet::write(flow, sheet),
        Block::Notes { notes, summary } => parts::notes(flow, notes, summary),
        Block::Section(section) => parts::section(flow, section),
        Block::Facts(facts) => parts::facts(flow, facts),
        Block::Table(table) => parts::table(flow, table),
        Block::Picture { title, figure, caption, room } => {
            parts::picture(flow, title, figure, caption, *room);
        }
        Block::View(_) => {}
        Block::Turn => flow.turn(),
    }
}

#[cfg(test)]
mod tests {
    use gaiter_language::Language;

    use super::*;
    use crate::picture::figures::DrawnFigure;
    use crate::report::content::{Section, Table, TableRow, Verdict, VerdictPart};
    use crate::report::document::{Origin, Room};
    use crate::report::{self, Head, Paper, Reliability};

    fn picture(height: f64) -> Block {
        let title = "a picture".to_owned();
        let picture = Picture {
            title: title.clone(),
            size: [720.0, height],
            cuts: Vec::new(),
            marks: Vec::new(),
        };
        let figure = DrawnFigure { name: "picture", picture, marks: String::new() };
        let caption = "How to read it. ".repeat(12);
        Block::Picture { title, figure, caption, room: Room::HalfPage }
    }

    fn verdict(sentences: Vec<String>) -> Block {
        Block::Verdict(Verdict {
            kind: None,
            parts: vec![VerdictPart { heading: None, sentences }],
        })
    }

    /// A table that no other one is like but those of as many rows.
    fn table(rows: usize) -> Block {
        table_of(rows, format!("{rows} rows"))
    }

    fn table_of(rows: usize, column: String) -> Block {
        let figure = || report::ReportFigure {
            value: "1".to_owned(),
            margin: None,
            mark: Reliability::Sure,
        };
        let row = |at: usize| TableRow { head: format!("row {at}"), figures: vec![figure()] };
        Block::Table(Table {
            title: "a table".to_owned(),
            explanation: Some("How to read it.".to_owned()),
            columns: vec!["place".to_owned(), column],
            rows: (0..rows).map(row).collect(),
            below: Some("What is to be known of it.".to_owned()),
        })
    }

    fn lines(count: usize) -> Block {
        verdict(vec!["One line.".to_owned(); count])
    }

    /// The pages of a report, and how far the last of them is filled, pt.
    fn filled(blocks: Vec<Block>, paper: Paper) -> (usize, f64) {
        let text = "text".to_owned();
        let head = Head {
            language: Language::En,
            title: text.clone(),
            is_vouched: true,
            patient: text.clone(),
            taken: text.clone(),
        };
        let origin = Origin { id: text.clone(), author: text.clone(), made_by: text, at: None };
        let of = Document { head: head.clone(), origin, paper: None, blocks, appendix: None };
        let mut flow = Flow::new(&head, paper);
        write(&mut flow, &of, false);
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
                    [verdict(said), Block::Section(section), picture(242.0), picture(290.0)];
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
                let (_, alone) = filled(vec![lines(before)], Paper::A4);
                let (pages, _) = filled(vec![lines(before), picture(size)], Paper::A4);
                let is_half_full = alone > height / 2.0 + 10.0;
                assert!(pages == 1 || is_half_full, "{size} px below {before} lines");
            }
        }
    }

    /// How far a page is filled by these blocks alone, pt.
    fn alone(block: Block, paper: Paper) -> f64 {
        filled(vec![Block::Turn, block], paper).1
    }

    #[test]
    fn a_table_that_fits_on_a_page_is_never_broken() {
        for paper in [Paper::A4, Paper::Letter] {
            for rows in [3, 12, 13, 30] {
                let whole = alone(table(rows), paper);
                for before in 0..40 {
                    let (pages, y) = filled(vec![lines(before), table(rows)], paper);
                    let is_whole = pages == 1 || (y - whole).abs() < 1e-6;
                    assert!(is_whole, "{rows} rows below {before} lines, {paper:?}: {y}, {whole}");
                }
            }
        }
    }

    #[test]
    fn of_a_table_over_pages_no_row_is_alone_on_one() {
        let top = filled(vec![Block::Turn], Paper::A4).1;
        let mut broken = 0;
        for rows in 45..110 {
            let (pages, y) = filled(vec![Block::Turn, table(rows)], Paper::A4);
            // Heads and rows are 13.8 pt high, the words below 13.6.
            let is_alone = y - top < 13.8 + 1.5 * 13.8 + 13.6;
            assert!(!is_alone, "{rows} rows on {pages} pages: {y}");
            broken += usize::from(pages > 2);
        }
        assert!(broken > 40, "{broken}");
    }

    #[test]
    fn what_does_not_fit_below_lets_what_fits_go_before_it() {
        let long = alone(table(30), Paper::A4);
        let (pages, y) = filled(vec![lines(25), table(30), table(4)], Paper::A4);
        assert_eq!(pages, 2);
        assert!((y - long).abs() < 1e-6, "the short table is on the first page: {y}, {long}");
        // Like tables stay in their order: those of the right leg and of the left one.
        let like = table_of(4, "30 rows".to_owned());
        let (pages, y) = filled(vec![lines(25), table(30), like], Paper::A4);
        assert!(pages == 2 && y > long + 10.0, "{pages}, {y}");
    }
}
