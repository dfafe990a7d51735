//! A report of blocks on pages.

use super::flow::Flow;
use super::parts;
use crate::report::document::{Block, Document};

/// Writes a report. What stands before its turn is one page. Behind it, tables are whole and pictures are not small, so
/// what does not fit below lets what fits go before it: a page is full, and a table is not broken.
pub(super) fn write(flow: &mut Flow<'_>, of: &Document) {
    parts::title(flow, &of.head.title);
    let turn = of.blocks.iter().position(|block| matches!(block, Block::Turn)).unwrap_or(0);
    let (first, others) = of.blocks.split_at(turn);
    parts::first_page(flow, first);
    let mut left: Vec<&Block> = others.iter().collect();
    while !left.is_empty() {
        let next = next(flow, &left);
        block(flow, left.remove(next));
    }
}

/// The place of the block that is written next: the first that fits below, else the first. Only tables and pictures go
/// before others, and only before such.
fn next(flow: &Flow<'_>, left: &[&Block]) -> usize {
    let movable = left.iter().take_while(|block| is_movable(block));
    let goes = |(at, block): (usize, &&Block)| {
        let is_before_like = left[..at].iter().any(|other| is_like(other, block));
        (!is_before_like && fits(flow, block)).then_some(at)
    };
    movable.enumerate().find_map(goes).unwrap_or(0)
}

fn is_movable(block: &Block) -> bool {
    match block {
        Block::Table(_) | Block::Picture { .. } | Block::View(_) => true,
        Block::Verdict(_) | Block::Section(_) | Block::Turn => false,
    }
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
        Block::Picture { figure, caption, .. } => parts::picture_fits(flow, figure, caption),
        Block::View(_) | Block::Verdict(_) | Block::Section(_) | Block::Turn => true,
    }
}

fn block(flow: &mut Flow<'_>, of: &Block) {
    match of {
        Block::Verdict(said) => parts::verdict(flow, said),
        Block::Section(section) => parts::section(flow, section),
        Block::Table(table) => parts::whole_table(flow, table),
        Block::Picture { title, figure, caption } => parts::picture(flow, title, figure, caption),
        Block::View(_) => {}
        Block::Turn => flow.turn(),
    }
}

#[cfg(test)]
mod tests {
    use gaiter_language::Language;

    use super::*;
    use crate::picture::Picture;
    use crate::picture::figures::Figure;
    use crate::report::content::{Section, Table, TableRow};
    use crate::report::document::{Origin, VerdictPart};
    use crate::report::{self, Head, Mark, Paper};

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

    fn verdict(sentences: Vec<String>) -> Block {
        Block::Verdict(vec![VerdictPart { heading: None, sentences }])
    }

    /// A table that no other one is like but those of as many rows.
    fn table(rows: usize) -> Block {
        table_of(rows, format!("{rows} rows"))
    }

    fn table_of(rows: usize, column: String) -> Block {
        let figure = || report::Figure { value: "1".to_owned(), margin: None, mark: Mark::Sure };
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
            patient: text.clone(),
            taken: text.clone(),
        };
        let origin = Origin { id: text.clone(), author: text.clone(), made_by: text, at: None };
        let of = Document { head: head.clone(), origin, paper: None, blocks };
        let mut flow = Flow::new(&head, paper);
        write(&mut flow, &of);
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
