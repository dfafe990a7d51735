//! Tables in a PDF: columns as wide as their text needs, unbroken rows, headings on every page.

use pdf_writer::types::StructRole;

use super::layout::{COLUMN, Flow, WIDTH};
use super::tags::{ElementIndex, ROOT};
use super::wrap::{Type, lines};
use crate::picture::font::writable;
use crate::picture::{Anchor, Ink};

/// Space between the text of two columns, pt.
const GAP: f64 = 9.0;

/// Space above and below a row, and where a table has many rows, pt.
pub(super) const PADDING: f64 = 2.2;
pub(super) const DENSE_PADDING: f64 = 1.6;

/// The largest width that a column gets for a single word, pt. A longer word is broken.
const WORD_MAX: f64 = 110.0;

/// The width of a box for a figure by hand, pt.
const BOX_WIDTH: f64 = 36.0;

/// The smallest letters of a table, pt.
const SIZE_MIN: f64 = 5.5;

#[derive(Debug, Clone)]
pub(super) struct Cell {
    /// Writable text.
    words: String,
    letters: Type,
    ink: Ink,
    anchor: Anchor,
    span: usize,
    /// Whether its text stays on one line, as for a figure with its uncertainty.
    is_whole: bool,
    /// Whether it is a box for a figure by hand.
    is_box: bool,
}

impl Cell {
    pub(super) fn new(words: &str, letters: Type, anchor: Anchor) -> Cell {
        let words = writable(words);
        Cell { words, letters, ink: Ink::Text, anchor, span: 1, is_whole: false, is_box: false }
    }

    /// A box for a figure by hand.
    pub(super) fn to_fill_in() -> Cell {
        let is_box = true;
        Cell { is_box, ..Cell::new("", Type { size: SIZE_MIN, is_bold: false }, Anchor::Start) }
    }

    pub(super) fn inked(self, ink: Ink) -> Cell {
        Cell { ink, ..self }
    }

    pub(super) fn whole(self) -> Cell {
        // An excessively wide figure is broken so that it does not leave the page.
        Cell { is_whole: self.letters.width(&self.words) <= WORD_MAX, ..self }
    }

    pub(super) fn anchored(self, anchor: Anchor) -> Cell {
        Cell { anchor, ..self }
    }

    pub(super) fn over(self, span: usize) -> Cell {
        Cell { span, ..self }
    }
}

/// A row. The spans of its cells add up to the number of columns.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub cells: Vec<Cell>,
    /// Whether it belongs to the row above and stays on its page.
    pub is_joined: bool,
}

#[derive(Debug, Clone)]
pub(super) struct Table {
    pub heads: Vec<Row>,
    pub rows: Vec<Row>,
    /// Whether there are lines between its rows.
    pub is_ruled: bool,
    /// Space above and below a row, pt.
    pub padding: f64,
    /// Height of what stands below it, on the page of its last row, pt.
    pub follows: f64,
}

/// A table with the computed widths of its columns.
struct Laid<'t> {
    table: &'t Table,
    widths: Vec<f64>,
    /// Factor for smaller letters if the words are too wide for the page.
    shrink: f64,
}

impl Table {
    /// Height of its headings and of what stays with them, which must be on the page of the table's heading, pt.
    pub(super) fn first_height(&self) -> f64 {
        let laid = Laid::new(self);
        let heads: f64 = self.heads.iter().map(|row| laid.height(row)).sum();
        heads + self.together_height(&laid, &self.rows)
    }

    /// Height of all of it, pt.
    pub(super) fn height(&self) -> f64 {
        let laid = Laid::new(self);
        self.heads.iter().chain(&self.rows).map(|row| laid.height(row)).sum()
    }

    /// Height of those of these last rows of it that stay on one page, and of what stands below them, pt.
    fn together_height(&self, laid: &Laid<'_>, rows: &[Row]) -> f64 {
        let count = together(rows);
        let height: f64 = rows[..count].iter().map(|row| laid.height(row)).sum();
        if count == rows.len() { height + self.follows } else { height }
    }

    /// Writes the table. The last row is never alone on a page.
    pub(super) fn write(&self, flow: &mut Flow<'_>) {
        let laid = Laid::new(self);
        let table = flow.sheets.tags.add(ROOT, StructRole::Table);
        flow.need(self.first_height());
        self.heads.iter().for_each(|row| laid.write(flow, row, Some((table, StructRole::TH))));
        laid.rule(flow, Ink::Muted);
        let mut rest = self.rows.as_slice();
        while let Some((first, others)) = rest.split_first() {
            let joined = joined(others);
            if flow.need(self.together_height(&laid, rest)) {
                self.heads.iter().for_each(|row| laid.write(flow, row, None));
                laid.rule(flow, Ink::Muted);
            }
            laid.write(flow, first, Some((table, StructRole::TD)));
            for row in &others[..joined] {
                laid.write(flow, row, Some((table, StructRole::TD)));
            }
            if self.is_ruled {
                laid.rule(flow, Ink::Grid);
            }
            rest = &others[joined..];
        }
    }

    fn columns(&self) -> usize {
        let rows = self.heads.iter().chain(&self.rows);
        rows.map(|row| row.cells.iter().map(|cell| cell.span).sum()).max().unwrap_or(0)
    }

    /// The cells of one column that span no other.
    fn cells_of(&self, column: usize) -> impl Iterator<Item = &Cell> {
        let in_row = move |row: &'_ Row| {
            let mut first = 0;
            row.cells.iter().position(|cell| {
                first += cell.span;
                first - cell.span == column && cell.span == 1
            })
        };
        let rows = self.heads.iter().chain(&self.rows);
        rows.filter_map(move |row| in_row(row).map(|index| &row.cells[index]))
    }
}

/// How many of these rows belong to the row before them.
fn joined(rows: &[Row]) -> usize {
    rows.iter().take_while(|row| row.is_joined).count()
}

/// How many of these rows stay on one page: the first with those that belong to it, and all where only one other would
/// be left for the next page.
fn together(rows: &[Row]) -> usize {
    let Some((_, others)) = rows.split_first() else { return 0 };
    let joined = joined(others);
    let is_one_behind = others[joined..].iter().filter(|row| !row.is_joined).count() == 1;
    if is_one_behind { rows.len() } else { joined + 1 }
}

impl<'t> Laid<'t> {
    /// Each column gets the width of its longest word, and a share of the rest in proportion to what its
    /// longest cell would need. Letters shrink if even the words do not fit.
    fn new(table: &'t Table) -> Laid<'t> {
        let columns = table.columns();
        // No gap is needed after the last column.
        let room = WIDTH + GAP;
        let widest = |column: usize, width: fn(&Cell) -> f64| {
            table.cells_of(column).map(width).fold(0.0, f64::max) + GAP
        };
        let needed: Vec<f64> = (0..columns).map(|column| widest(column, longest_word)).collect();
        let liked: Vec<f64> = (0..columns)
            .map(|column| widest(column, |cell| cell.letters.width(&cell.words)))
            .collect();
        let total = |widths: &[f64]| widths.iter().sum::<f64>();
        let shrink = (room / total(&needed)).min(1.0);
        let needed: Vec<f64> = needed.iter().map(|width| width * shrink).collect();
        let wanted: Vec<f64> = liked
            .iter()
            .zip(&needed)
            .map(|(liked, needed)| (liked * shrink - needed).max(0.0))
            .collect();
        let (free, total_wanted) = (room - total(&needed), total(&wanted));
        let share = if total_wanted > 0.0 { (free / total_wanted).min(1.0) } else { 0.0 };
        let mut widths: Vec<f64> =
            needed.iter().zip(&wanted).map(|(needed, wanted)| needed + share * wanted).collect();
        // A ruled table fills the whole column. Other tables stay together on its left.
        let spare = (room - total(&widths)) / columns.max(1) as f64;
        if table.is_ruled {
            widths.iter_mut().for_each(|width| *width += spare);
        }
        Laid { table, widths, shrink }
    }

    fn letters(&self, cell: &Cell) -> Type {
        Type { size: (cell.letters.size * self.shrink).max(SIZE_MIN), ..cell.letters }
    }

    /// Every cell with its left edge and width, pt.
    fn places<'r>(&self, row: &'r Row) -> Vec<(&'r Cell, f64, f64)> {
        let mut column = 0;
        let place = |cell: &'r Cell| {
            let left = COLUMN[0] + self.widths[..column].iter().sum::<f64>();
            let width = self.widths[column..column + cell.span].iter().sum::<f64>();
            column += cell.span;
            (cell, left, width)
        };
        row.cells.iter().map(place).collect()
    }

    fn lines(&self, cell: &Cell, width: f64) -> Vec<String> {
        if cell.is_whole {
            return vec![cell.words.clone()];
        }
        lines(&cell.words, width - GAP, self.letters(cell))
    }

    fn height(&self, row: &Row) -> f64 {
        let heights = self.places(row).into_iter().map(|(cell, _, width)| {
            self.lines(cell, width).len() as f64 * self.letters(cell).leading()
        });
        let padding = self.table.padding * if row.is_joined { 1.0 } else { 2.0 };
        heights.fold(0.0, f64::max) + padding
    }

    /// Writes a row as part of a table, or as a decoration if it only repeats one.
    fn write(&self, flow: &mut Flow<'_>, row: &Row, part: Option<(ElementIndex, StructRole)>) {
        let row_element = part.map(|(table, _)| flow.sheets.tags.add(table, StructRole::TR));
        let top = flow.y + if row.is_joined { 0.0 } else { self.table.padding };
        // Cells of different sizes share one baseline.
        let first_line =
            self.places(row).iter().map(|(cell, ..)| self.letters(cell).size).fold(0.0, f64::max);
        for (cell, left, width) in self.places(row) {
            if cell.is_box {
                self.draw_box(flow, row, [left, left + width - GAP]);
            }
            let letters = self.letters(cell);
            let x = left + cell.anchor.share() * (width - GAP);
            let written: Vec<(String, f64)> = self
                .lines(cell, width)
                .into_iter()
                .enumerate()
                .map(|(index, line)| (line, top + first_line + index as f64 * letters.leading()))
                .collect();
            let draw = |pen: &mut super::sheet::Pen<'_>| {
                for (line, y) in &written {
                    pen.words(line, [x, *y], cell.anchor, letters, cell.ink);
                }
            };
            if let (Some(row), Some((_, role))) = (row_element, part) {
                let cell = flow.sheets.tags.add_cell(row, role, cell.span);
                flow.sheets.draw(cell, draw);
            } else {
                let page = flow.sheets.current();
                flow.sheets.decorate(page, draw);
            }
        }
        flow.y += self.height(row);
    }

    /// Draws the sides of a box that is as high as its row; the lines between rows close it.
    fn draw_box(&self, flow: &mut Flow<'_>, row: &Row, sides: [f64; 2]) {
        let (top, bottom) = (flow.y, flow.y + self.height(row));
        let page = flow.sheets.current();
        flow.sheets.decorate(page, |pen| {
            sides.into_iter().for_each(|x| pen.rule([[x, top], [x, bottom]], Ink::Muted, 0.5));
        });
    }

    fn rule(&self, flow: &mut Flow<'_>, ink: Ink) {
        let right = COLUMN[0] + self.widths.iter().sum::<f64>() - GAP;
        if self.table.is_ruled {
            let (y, page) = (flow.y, flow.sheets.current());
            flow.sheets.decorate(page, |pen| pen.rule([[COLUMN[0], y], [right, y]], ink, 0.5));
        }
    }
}

/// Width of the longest word of a cell, with an upper limit.
fn longest_word(cell: &Cell) -> f64 {
    if cell.is_box {
        return BOX_WIDTH;
    }
    if cell.is_whole {
        return cell.letters.width(&cell.words);
    }
    let words = cell.words.split(' ').map(|word| cell.letters.width(word));
    words.fold(0.0, f64::max).min(WORD_MAX)
}
