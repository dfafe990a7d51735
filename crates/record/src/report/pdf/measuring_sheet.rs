//! The first page: what is to be done before the patient dresses, the figures of an order, both legs with
//! their girths, and what a person fills in.

use pdf_writer::types::StructRole;

use super::flow::{
    BODY_TYPE, BOLD_TYPE, COLUMN, Flow, HEADING_TYPE, SMALL_TYPE, TITLE_TYPE, WIDTH,
};
use super::parts::{fact, figure};
use super::table::{Cell, PADDING, Row, Table};
use super::wrap::Type;
use crate::completeness::Kind;
use crate::picture::figures::{Figure as Drawn, SHEET};
use crate::picture::{Anchor, Ink};
use crate::report::Content;
use crate::report::content::{LevelFigures, LevelRow, Levels, OpenFields, SheetRow, Verdict};

/// How many facts about the record stand on the first page: patient, record, order, and who named the patient.
const FACTS: usize = 4;

/// Height of a field to fill in, pt: room for handwriting.
const FIELD_HEIGHT: f64 = 19.0;

/// Fields to fill in beside each other.
const FIELDS_ABREAST: usize = 3;

/// Space between them, pt.
const FIELD_GAP: f64 = 14.0;

/// The smallest height at which the legs are worth drawing, pt.
const DRAWING_MIN: f64 = 120.0;

/// Writes the page. A record with many doubts goes on to a second one.
pub(super) fn write(flow: &mut Flow<'_>, content: &Content, figures: &[Drawn]) {
    flow.text(&content.title, StructRole::H1, TITLE_TYPE, Ink::Text);
    flow.space(2.0);
    verdict(flow, &content.verdict);
    let rows = content.facts.iter().take(FACTS).map(fact).collect();
    Table { heads: Vec::new(), rows, is_ruled: false, padding: PADDING, follows: 0.0 }.write(flow);
    flow.space(4.0);
    let see = content.sizes.as_ref().and_then(|of| of.see.as_ref());
    levels(flow, &content.levels, &content.age.until, see);
    if let Some(legs) = figures.iter().find(|drawn| drawn.name == SHEET) {
        let room = flow.room() - fields_height(&content.open);
        if room >= DRAWING_MIN {
            flow.drawing(&legs.picture, room);
        }
    }
    fields(flow, &content.open);
}

/// What is to be done, between two lines that are as thick as it matters.
fn verdict(flow: &mut Flow<'_>, verdict: &Verdict) {
    let width = match verdict.kind {
        Kind::Complete => 0.7,
        Kind::NotMeasurable | Kind::ByHand | Kind::ScanAgain => 2.0,
    };
    rule(flow, width);
    flow.space(3.0);
    for (index, sentence) in verdict.sentences.iter().enumerate() {
        let letters = if index == 0 { HEADING_TYPE } else { BOLD_TYPE };
        flow.text(sentence, StructRole::P, letters, Ink::Text);
    }
    flow.space(3.0);
    rule(flow, width);
    flow.space(5.0);
}

fn rule(flow: &mut Flow<'_>, width: f64) {
    let (y, page) = (flow.y, flow.sheets.current());
    flow.sheets.decorate(page, |pen| pen.rule(COLUMN.map(|x| [x, y]), Ink::Text, width));
}

/// Girths and heights at the levels of both legs, with room for corrections.
fn levels(flow: &mut Flow<'_>, levels: &Levels, age: &String, see_sizes: Option<&String>) {
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
    let key = [&levels.key, age].into_iter();
    for below in
        key.chain(&levels.by_hand).chain(&levels.doubts).chain(&levels.tilted).chain(see_sizes)
    {
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

fn fields_height(open: &OpenFields) -> f64 {
    let rows = open.names.len().div_ceil(FIELDS_ABREAST) as f64;
    Flow::height_of(&open.title, BOLD_TYPE) + rows * FIELD_HEIGHT + 8.0
}

/// Names of fields, each on a line to write on.
fn fields(flow: &mut Flow<'_>, open: &OpenFields) {
    flow.need(fields_height(open));
    flow.space(4.0);
    flow.text(&open.title, StructRole::P, BOLD_TYPE, Ink::Text);
    let width = (WIDTH + FIELD_GAP) / FIELDS_ABREAST as f64;
    for names in open.names.chunks(FIELDS_ABREAST) {
        flow.space(FIELD_HEIGHT);
        for (index, name) in names.iter().enumerate() {
            let left = COLUMN[0] + index as f64 * width;
            flow.field(name, [left, left + width - FIELD_GAP]);
        }
    }
    flow.space(4.0);
}
