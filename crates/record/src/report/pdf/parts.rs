//! The parts of a PDF, from the most important figures to every figure of the record.

use gaiter_leg::finding::Severity;
use pdf_writer::types::StructRole;

use super::layout::{BODY_TYPE, BOLD_TYPE, COLUMN, Flow, HEADING_ROOM, HEADING_TYPE, SMALL_TYPE};
use super::table::{Cell, DENSE_PADDING, PADDING, Row, Table};
use super::wrap::Type;
use crate::completeness::Kind;
use crate::picture::figures::DrawnFigure;
use crate::picture::{Anchor, Ink};
use crate::report::content::{self, Fact, Note, Section, Verdict};
use crate::report::document::Room;
use crate::report::{Reliability, ReportFigure};

/// The letters of a table that has many columns.
const DENSE_TYPE: Type = Type { size: 7.0, is_bold: false };

/// Space above a part of a first page, pt.
pub(super) const PART_GAP: f64 = 8.0;

/// Space between a picture and the words above and below it, pt.
pub(super) const DRAWN_GAP: f64 = 4.0;

/// The share of a page that a picture takes with its words if it may take less than half of it.
const PICTURE_SHARE: f64 = 0.48;

/// Space between a table and the words above and below it, pt.
const TABLE_GAP: f64 = 3.0;

/// A table with more rows than this has many.
const ROWS_MANY: usize = 12;

/// With more columns than this the words of a table need smaller letters.
const COLUMNS_PLAIN: usize = 4;

/// A note or paragraph of up to this height stays on one page, pt.
const WHOLE_MAX: f64 = 150.0;

/// What matters most, a sentence a line, below the headings of its parts. What to do stands out between two lines.
pub(super) fn verdict(flow: &mut Flow<'_>, of: &Verdict) {
    let [first, others] =
        if of.kind.is_some() { [HEADING_TYPE, BOLD_TYPE] } else { [BODY_TYPE; 2] };
    if let Some(kind) = of.kind {
        rule(flow, kind);
        flow.space(3.0);
    }
    for (at, part) in of.parts.iter().enumerate() {
        flow.space(if at > 0 { PART_GAP / 2.0 } else { 0.0 });
        if let Some(heading) = &part.heading {
            let below = part.sentences.first().map_or(0.0, |of| Flow::height_of(of, first));
            flow.need(Flow::height_of(heading, BOLD_TYPE) + below);
            flow.text(heading, StructRole::H2, BOLD_TYPE, Ink::Text);
        }
        for (index, sentence) in part.sentences.iter().enumerate() {
            let letters = if index == 0 { first } else { others };
            flow.need(Flow::height_of(sentence, letters));
            flow.text(sentence, StructRole::P, letters, Ink::Text);
            flow.space(3.0);
        }
    }
    if let Some(kind) = of.kind {
        rule(flow, kind);
        flow.space(5.0);
    }
}

/// A line as thick as the action is important.
fn rule(flow: &mut Flow<'_>, kind: Kind) {
    let width = match kind {
        Kind::Complete => 0.7,
        Kind::NotMeasurable | Kind::ByHand | Kind::ScanAgain => 2.0,
    };
    let (y, page) = (flow.y, flow.sheets.current());
    flow.sheets.decorate(page, |pen| pen.rule(COLUMN.map(|x| [x, y]), Ink::Text, width));
}

/// A heading with paragraphs where there is little room.
pub(super) fn small_section(flow: &mut Flow<'_>, section: &Section) {
    flow.space(PART_GAP);
    flow.text(&section.title, StructRole::H2, BOLD_TYPE, Ink::Text);
    for entry in &section.entries {
        flow.text(entry, StructRole::P, SMALL_TYPE, Ink::Text);
        flow.space(2.0);
    }
}

/// Height of a picture below a heading at this place, and of what stands below it, pt.
fn picture_heights(flow: &Flow<'_>, drawn: &DrawnFigure, caption: &str, room: Room) -> [f64; 2] {
    let share = match room {
        Room::HalfPage => PICTURE_SHARE,
        Room::Page => 1.0,
    };
    let below = 2.0 * DRAWN_GAP + Flow::height_of(caption, SMALL_TYPE);
    [flow.share_height(&drawn.picture, HEADING_ROOM + below, share), below]
}

/// Whether a picture fits below what is on the page.
pub(super) fn picture_fits(
    flow: &Flow<'_>,
    drawn: &DrawnFigure,
    caption: &str,
    room: Room,
) -> bool {
    let [height, below] = picture_heights(flow, drawn, caption, room);
    flow.has_room(HEADING_ROOM + height + below)
}

/// A picture below a heading.
pub(super) fn picture(
    flow: &mut Flow<'_>,
    title: &str,
    drawn: &DrawnFigure,
    caption: &str,
    room: Room,
) {
    let [height, below] = picture_heights(flow, drawn, caption, room);
    flow.heading(title, height + below);
    flow.drawing(&drawn.picture, height);
    flow.space(DRAWN_GAP);
    flow.text(caption, StructRole::P, SMALL_TYPE, Ink::Muted);
    flow.space(DRAWN_GAP);
}

/// A heading with facts.
pub(super) fn facts(flow: &mut Flow<'_>, of: &Section<Fact>) {
    let table = facts_table(&of.entries);
    flow.heading(&of.title, table.first_height());
    table.write(flow);
}

/// Facts, each with its name before it.
pub(super) fn facts_table(facts: &[Fact]) -> Table {
    let row = |fact: &Fact| Row {
        cells: vec![
            Cell::new(&fact.name, SMALL_TYPE, Anchor::Start).inked(Ink::Muted),
            Cell::new(&fact.value, SMALL_TYPE, Anchor::Start),
        ],
        is_joined: true,
    };
    let rows = facts.iter().map(row).collect();
    Table { heads: Vec::new(), rows, is_ruled: false, padding: PADDING, follows: 0.0 }
}

/// A figure with its uncertainty and the mark that shows how to read it.
pub(super) fn figure(figure: &ReportFigure, letters: Type) -> Cell {
    let margin = figure.margin.as_ref().map(|margin| format!(" ± {margin}")).unwrap_or_default();
    let [before, behind] = match figure.mark {
        Reliability::Estimated => ["~", ""],
        Reliability::Doubtful => ["", " ?"],
        Reliability::ByHand => ["", " *"],
        Reliability::Sure | Reliability::Missing | Reliability::Real => ["", ""],
    };
    let words = format!("{before}{}{margin}{behind}", figure.value);
    match figure.mark {
        Reliability::Missing => {
            let size = letters.size.min(SMALL_TYPE.size);
            Cell::new(&words, Type { size, ..letters }, Anchor::End).inked(Ink::Muted)
        }
        Reliability::Real => {
            Cell::new(&words, Type { is_bold: true, ..letters }, Anchor::End).whole()
        }
        _ if has_figure(&figure.value) => Cell::new(&words, letters, Anchor::End).whole(),
        _ => Cell::new(&words, letters, Anchor::End),
    }
}

/// Doubts and findings.
pub(super) fn notes(flow: &mut Flow<'_>, notes: &Section<Note>, summary: &str) {
    flow.heading(&notes.title, 3.0 * BODY_TYPE.leading());
    flow.text(summary, StructRole::P, BODY_TYPE, Ink::Text);
    for entry in &notes.entries {
        flow.space(5.0);
        note(flow, entry);
    }
}

fn note(flow: &mut Flow<'_>, note: &Note) {
    let place = if note.place.is_empty() { String::new() } else { format!("{}: ", note.place) };
    let heading = format!("{} · {place}{}", note.weight_words, note.title);
    let ink = match note.weight {
        Severity::Error => Ink::Right,
        Severity::Warning | Severity::Info => Ink::Text,
    };
    let sentences = [Some(&note.message), note.meaning.as_ref(), note.action.as_ref()];
    let sentences: Vec<&str> = sentences.into_iter().flatten().map(String::as_str).collect();
    let sentences = sentences.join(" ");
    let height = Flow::height_of(&heading, BOLD_TYPE) + Flow::height_of(&sentences, BODY_TYPE);
    flow.need(height.min(WHOLE_MAX));
    flow.text(&heading, StructRole::H3, BOLD_TYPE, ink);
    if !sentences.trim().is_empty() {
        flow.text(&sentences, StructRole::P, BODY_TYPE, Ink::Text);
    }
}

/// A table: whole on its page, if a page is high enough for it.
pub(super) fn table(flow: &mut Flow<'_>, table: &content::Table) {
    let laid = laid(table);
    flow.heading(&table.title, unbroken_height(flow, table, &laid));
    if let Some(explanation) = &table.explanation {
        flow.text(explanation, StructRole::P, SMALL_TYPE, Ink::Muted);
        flow.space(TABLE_GAP);
    }
    laid.write(flow);
    if let Some(below) = &table.below {
        flow.space(TABLE_GAP);
        flow.text(below, StructRole::P, SMALL_TYPE, Ink::Muted);
    }
}

/// Whether a table fits below what is on the page; of one that is longer than a page, its beginning.
pub(super) fn table_fits(flow: &Flow<'_>, table: &content::Table) -> bool {
    let heading = flow.heading_gap() + Flow::heading_height(&table.title);
    flow.has_room(heading + unbroken_height(flow, table, &laid(table)))
}

/// Height of what of a table is not parted from its heading, pt.
fn unbroken_height(flow: &Flow<'_>, table: &content::Table, laid: &Table) -> f64 {
    let explanation = words_height(table.explanation.as_ref());
    let whole = explanation + laid.height() + laid.follows;
    let is_whole = Flow::heading_height(&table.title) + whole <= flow.page_height();
    if is_whole { whole } else { explanation + laid.first_height() }
}

/// Height of words above or below a table, pt.
fn words_height(words: Option<&String>) -> f64 {
    words.map_or(0.0, |words| Flow::height_of(words, SMALL_TYPE) + TABLE_GAP)
}

/// A table as it is laid out: closer where it has many rows, so that two such tables are on a page, and smaller where it
/// has many columns. Numbers end below each other, and words begin so.
fn laid(table: &content::Table) -> Table {
    let has_many_rows = table.rows.len() > ROWS_MANY;
    let letters = if table.is_dense() {
        DENSE_TYPE
    } else if has_many_rows || table.columns.len() > COLUMNS_PLAIN {
        SMALL_TYPE
    } else {
        BODY_TYPE
    };
    let has_words = |column: usize| {
        let mut figures = table.rows.iter().filter_map(|row| row.figures.get(column));
        figures.any(|figure| !figure.is_missing() && figure.value.contains(char::is_alphabetic))
    };
    let anchors: Vec<Anchor> = (0..table.columns.len())
        .map(|column| match column.checked_sub(1) {
            Some(column) if !has_words(column) => Anchor::End,
            _ => Anchor::Start,
        })
        .collect();
    let small = Type { size: letters.size.min(SMALL_TYPE.size), is_bold: true };
    let heads = table.columns.iter().zip(&anchors);
    let heads = heads.map(|(head, anchor)| Cell::new(head, small, *anchor).inked(Ink::Muted));
    let head = Row { cells: heads.collect(), is_joined: false };
    let row = |row: &content::TableRow| {
        let mut cells = vec![Cell::new(&row.head, letters, Anchor::Start)];
        let figures = row.figures.iter().zip(&anchors[1..]);
        cells.extend(figures.map(|(of, anchor)| figure(of, letters).anchored(*anchor)));
        Row { cells, is_joined: false }
    };
    let rows = table.rows.iter().map(row).collect();
    let padding = if has_many_rows { DENSE_PADDING } else { PADDING };
    let follows = words_height(table.below.as_ref());
    Table { heads: vec![head], rows, is_ruled: true, padding, follows }
}

/// Whether a text is a number: `12.3`, `+4`.
fn has_figure(words: &str) -> bool {
    words.trim_start_matches(['+', '−']).chars().all(|of| of.is_ascii_digit() || ".,".contains(of))
}

/// A heading with paragraphs.
pub(super) fn section(flow: &mut Flow<'_>, section: &Section) {
    let height = |entry: &String| (Flow::height_of(entry, BODY_TYPE) + 3.0).min(WHOLE_MAX);
    let all: f64 = section.entries.iter().map(height).sum();
    flow.heading(&section.title, all.min(WHOLE_MAX));
    for entry in &section.entries {
        flow.need(height(entry));
        flow.text(entry, StructRole::P, BODY_TYPE, Ink::Text);
        flow.space(3.0);
    }
}
