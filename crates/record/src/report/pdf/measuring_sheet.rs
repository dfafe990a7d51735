//! The measuring sheet: the figures of an order, both legs with their girths, and what a person fills in.

use pdf_writer::types::StructRole;

use super::layout::{BODY_TYPE, BOLD_TYPE, COLUMN, Flow, SMALL_TYPE, WIDTH};
use super::parts::{facts_table, figure};
use super::table::{Cell, PADDING, Row, Table};
use super::wrap::Type;
use crate::picture::{Anchor, Ink};
use crate::report::content::{LevelFigures, LevelRow, Section, SheetRow};
use crate::report::document::Sheet;

/// Height of a field to fill in, pt: room for handwriting.
const FIELD_HEIGHT: f64 = 19.0;

/// Fields to fill in beside each other.
const FIELDS_ABREAST: usize = 3;

/// Space between them, pt.
const FIELD_GAP: f64 = 14.0;

/// The smallest height at which the legs are worth drawing, pt.
const DRAWING_MIN: f64 = 120.0;

/// Writes the sheet. With many doubts it continues to a second page.
pub(super) fn write(flow: &mut Flow<'_>, of: &Sheet) {
    facts_table(&of.facts).write(flow);
    flow.space(4.0);
    levels(flow, of);
    if let Some(legs) = &of.legs {
        let room = flow.room() - fields_height(&of.open);
        if room >= DRAWING_MIN {
            flow.drawing(&legs.picture, room);
        }
    }
    fields(flow, &of.open);
}

/// Girths and heights at the levels of both legs, with room for corrections.
fn levels(flow: &mut Flow<'_>, of: &Sheet) {
    let levels = &of.levels;
    let columns = &levels.columns;
    let head = |words: &str, anchor: Anchor| {
        Cell::new(words, Type { is_bold: true, ..SMALL_TYPE }, anchor).inked(Ink::Muted)
    };
    let [right, left] = &columns.legs;
    let leg = |words: &str, ink: Ink| Cell::new(words, BOLD_TYPE, Anchor::Start).inked(ink).over(4);
    let first = vec![head("", Anchor::Start).over(2), leg(right, Ink::Right), leg(left, Ink::Left)];
    let mut second = vec![head(&columns.level, Anchor::Start).over(2)];
    for _ in 0..2 {
        second.push(head(&columns.girth, Anchor::End));
        second.push(head(&columns.height, Anchor::End));
        second.extend(columns.by_hand.iter().map(|words| head(words, Anchor::Middle)));
    }
    let heads = [first, second].map(|cells| Row { cells, is_joined: false }).into();
    let rows = levels.rows.iter().map(level).chain(levels.lengths.iter().map(length)).collect();
    let table = Table { heads, rows, is_ruled: true, padding: PADDING, follows: 0.0 };
    flow.heading(&levels.title, table.first_height());
    table.write(flow);
    let key = [&levels.key, &of.age.until].into_iter();
    let below =
        key.chain(&levels.by_hand).chain(&levels.doubts).chain(&levels.tilted).chain(&of.see_sizes);
    for below in below {
        flow.space(2.0);
        flow.text(below, StructRole::P, SMALL_TYPE, Ink::Text);
    }
}

/// A level; what is needed for the garment stands out.
fn level(row: &LevelRow) -> Row {
    let name = Type { is_bold: row.is_needed, ..BODY_TYPE };
    let mut cells = vec![
        Cell::new(&row.level, name, Anchor::Start).whole(),
        Cell::new(&row.place, SMALL_TYPE, Anchor::Start).inked(Ink::Muted).whole(),
    ];
    for LevelFigures { girth, height } in &row.legs {
        if girth.is_missing() {
            // One reason for both columns.
            cells.push(figure(girth, SMALL_TYPE).over(2));
        } else {
            cells.push(figure(girth, name));
            cells.push(figure(height, BODY_TYPE));
        }
        match row.has_height {
            true => cells.extend([Cell::to_fill_in(), Cell::to_fill_in()]),
            false => cells.push(Cell::to_fill_in().over(2)),
        }
    }
    Row { cells, is_joined: false }
}

/// A length, which has one figure a leg.
fn length(row: &SheetRow) -> Row {
    let mut cells = vec![Cell::new(&row.head, BODY_TYPE, Anchor::Start).over(2).whole()];
    for of in &row.figures {
        cells.push(figure(of, if of.is_missing() { SMALL_TYPE } else { BODY_TYPE }).over(2));
        cells.push(Cell::to_fill_in().over(2));
    }
    Row { cells, is_joined: false }
}

fn fields_height(open: &Section) -> f64 {
    let rows = open.entries.len().div_ceil(FIELDS_ABREAST) as f64;
    Flow::height_of(&open.title, BOLD_TYPE) + rows * FIELD_HEIGHT + 8.0
}

/// Names of fields, each on a line to write on.
fn fields(flow: &mut Flow<'_>, open: &Section) {
    flow.need(fields_height(open));
    flow.space(4.0);
    flow.text(&open.title, StructRole::P, BOLD_TYPE, Ink::Text);
    let width = (WIDTH + FIELD_GAP) / FIELDS_ABREAST as f64;
    for names in open.entries.chunks(FIELDS_ABREAST) {
        flow.space(FIELD_HEIGHT);
        for (index, name) in names.iter().enumerate() {
            let left = COLUMN[0] + index as f64 * width;
            flow.field(name, [left, left + width - FIELD_GAP]);
        }
    }
    flow.space(4.0);
}
