//! The parts of a PDF, from the most important figures to every figure of the record.

use pdf_writer::types::StructRole;

use super::flow::{BODY_TYPE, BOLD_TYPE, Flow, HEADING_ROOM, SMALL_TYPE, TITLE_TYPE};
use super::table::{Cell, DENSE_PADDING, PADDING, Row, Table};
use super::wrap::Type;
use crate::picture::figures::Figure as Drawn;
use crate::picture::{Anchor, Ink, Picture};
use crate::report::content::{self, Content, Note, PictureWords, Section, Sizes, Weight};
use crate::report::document::{Block, VerdictPart};
use crate::report::{Figure, Mark};

/// Letter size of the table of all figures, which has many columns, pt.
const DENSE: f64 = 7.0;

/// Space above a part of a first page, pt.
const PART_GAP: f64 = 8.0;

/// Space between a picture and the words above and below it, pt.
const DRAWN_GAP: f64 = 4.0;

/// The smallest scale at which the letters of a picture can be read, pt per px.
const READABLE: f64 = 0.35;

/// With its words a picture takes at most this share of a page: where it does not fit below what is before it, more
/// than half of that page is filled.
const PICTURE_SHARE: f64 = 0.48;

/// Space between a table and the words above and below it, pt.
const TABLE_GAP: f64 = 3.0;

/// A table with more rows than this has many.
const ROWS_MANY: usize = 12;

/// A note or paragraph of up to this height stays on one page, pt.
const WHOLE_MAX: f64 = 150.0;

/// The title of a report.
pub(super) fn title(flow: &mut Flow<'_>, title: &str) {
    flow.text(title, StructRole::H1, TITLE_TYPE, Ink::Text);
    flow.space(6.0);
}

/// What matters most, a sentence a line, below the headings of its parts.
pub(super) fn verdict(flow: &mut Flow<'_>, parts: &[VerdictPart]) {
    for (at, part) in parts.iter().enumerate() {
        flow.space(if at > 0 { PART_GAP / 2.0 } else { 0.0 });
        if let Some(heading) = &part.heading {
            let first = part.sentences.first().map_or(0.0, |of| Flow::height_of(of, BODY_TYPE));
            flow.need(Flow::height_of(heading, BOLD_TYPE) + first);
            flow.text(heading, StructRole::H2, BOLD_TYPE, Ink::Text);
        }
        for sentence in &part.sentences {
            flow.need(Flow::height_of(sentence, BODY_TYPE));
            flow.text(sentence, StructRole::P, BODY_TYPE, Ink::Text);
            flow.space(3.0);
        }
    }
}

/// What matters most on a page of its own: its pictures share the height that its words leave. Only where that is so
/// little that they could not be read, they go on.
pub(super) fn first_page(flow: &mut Flow<'_>, blocks: &[Block]) {
    let mut pictures: Vec<(&String, &Picture, &String)> = Vec::new();
    for block in blocks {
        match block {
            Block::Verdict(said) => verdict(flow, said),
            Block::Section(section) => small_section(flow, section),
            Block::Table(table) => tables(flow, std::slice::from_ref(table)),
            Block::Picture { title, figure, caption } => {
                pictures.push((title, &figure.picture, caption));
            }
            Block::View(_) | Block::Turn => {}
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

/// A heading with paragraphs where there is little room.
fn small_section(flow: &mut Flow<'_>, section: &Section) {
    flow.space(PART_GAP);
    flow.text(&section.title, StructRole::H2, BOLD_TYPE, Ink::Text);
    for entry in &section.entries {
        flow.text(entry, StructRole::P, SMALL_TYPE, Ink::Text);
        flow.space(2.0);
    }
}

/// Height of a picture below a heading at this place, and of what stands below it, pt.
fn picture_heights(flow: &Flow<'_>, drawn: &Drawn, caption: &str) -> [f64; 2] {
    let below = 2.0 * DRAWN_GAP + Flow::height_of(caption, SMALL_TYPE);
    [flow.share_height(&drawn.picture, HEADING_ROOM + below, PICTURE_SHARE), below]
}

/// Whether a picture fits below what is on the page.
pub(super) fn picture_fits(flow: &Flow<'_>, drawn: &Drawn, caption: &str) -> bool {
    let [height, below] = picture_heights(flow, drawn, caption);
    flow.has_room(HEADING_ROOM + height + below)
}

/// A picture below a heading.
pub(super) fn picture(flow: &mut Flow<'_>, title: &str, drawn: &Drawn, caption: &str) {
    let [height, below] = picture_heights(flow, drawn, caption);
    flow.heading(title, height + below);
    flow.drawing(&drawn.picture, height);
    flow.space(DRAWN_GAP);
    flow.text(caption, StructRole::P, SMALL_TYPE, Ink::Muted);
    flow.space(DRAWN_GAP);
}

/// Where the record comes from.
pub(super) fn facts(flow: &mut Flow<'_>, content: &Content) {
    let table = Table {
        heads: Vec::new(),
        rows: content.facts.iter().map(fact).collect(),
        is_ruled: false,
        padding: PADDING,
        follows: 0.0,
    };
    flow.heading(&content.origin, table.first_height());
    table.write(flow);
}

/// A fact, with its name before it.
pub(super) fn fact(fact: &content::Fact) -> Row {
    Row {
        cells: vec![
            Cell::new(&fact.name, SMALL_TYPE, Anchor::Start).inked(Ink::Muted),
            Cell::new(&fact.value, SMALL_TYPE, Anchor::Start),
        ],
        is_joined: true,
    }
}

/// A figure with its uncertainty and the mark that shows how to read it.
pub(super) fn figure(figure: &Figure, letters: Type) -> Cell {
    let margin = figure.margin.as_ref().map(|margin| format!(" ± {margin}")).unwrap_or_default();
    let [before, behind] = match figure.mark {
        Mark::Estimated => ["~", ""],
        Mark::Doubtful => ["", " ?"],
        Mark::ByHand => ["", " *"],
        Mark::Sure | Mark::Missing | Mark::Real => ["", ""],
    };
    let words = format!("{before}{}{margin}{behind}", figure.value);
    match figure.mark {
        Mark::Missing => {
            let size = letters.size.min(SMALL_TYPE.size);
            Cell::new(&words, Type { size, ..letters }, Anchor::End).inked(Ink::Muted)
        }
        Mark::Real => Cell::new(&words, Type { is_bold: true, ..letters }, Anchor::End).whole(),
        _ if has_figure(&figure.value) => Cell::new(&words, letters, Anchor::End).whole(),
        _ => Cell::new(&words, letters, Anchor::End),
    }
}

/// Doubts and findings.
pub(super) fn notes(flow: &mut Flow<'_>, content: &Content) {
    flow.heading(&content.notes.title, 3.0 * BODY_TYPE.leading());
    flow.text(&content.summary, StructRole::P, BODY_TYPE, Ink::Text);
    for entry in &content.notes.entries {
        flow.space(5.0);
        note(flow, entry);
    }
}

fn note(flow: &mut Flow<'_>, note: &Note) {
    let place = if note.place.is_empty() { String::new() } else { format!("{}: ", note.place) };
    let heading = format!("{} · {place}{}", note.weight_words, note.title);
    let ink = match note.weight {
        Weight::Error => Ink::Right,
        Weight::Warning | Weight::Info => Ink::Text,
    };
    let said = [Some(&note.message), note.meaning.as_ref(), note.action.as_ref()];
    let said: Vec<&str> = said.into_iter().flatten().map(String::as_str).collect();
    let said = said.join(" ");
    let height = Flow::height_of(&heading, BOLD_TYPE) + Flow::height_of(&said, BODY_TYPE);
    flow.need(height.min(WHOLE_MAX));
    flow.text(&heading, StructRole::H3, BOLD_TYPE, ink);
    if !said.trim().is_empty() {
        flow.text(&said, StructRole::P, BODY_TYPE, Ink::Text);
    }
}

/// Both legs at the same heights, requested heights, volumes; slices.
pub(super) fn tables(flow: &mut Flow<'_>, tables: &[content::Table]) {
    for table in tables {
        figures(flow, table, BODY_TYPE, Anchor::End);
    }
}

/// The sizes of makers' tables, on a page of their own behind the sheet.
pub(super) fn sizes(flow: &mut Flow<'_>, sizes: Option<&Sizes>) {
    let Some(sizes) = sizes else { return };
    flow.turn();
    // Without tables there is only the form.
    if !sizes.about.is_empty() {
        flow.heading(&sizes.title, 3.0 * SMALL_TYPE.leading());
    }
    for said in &sizes.about {
        flow.text(said, StructRole::P, SMALL_TYPE, Ink::Text);
        flow.space(2.0);
    }
    for table in &sizes.tables {
        figures(flow, table, SMALL_TYPE, Anchor::Start);
    }
    if let Some(calibre) = &sizes.calibre {
        section(flow, calibre);
    }
    figures(flow, &sizes.form, BODY_TYPE, Anchor::End);
}

/// Every figure of the levels in mm, on a page of its own.
pub(super) fn landmarks(flow: &mut Flow<'_>, table: &content::Table) {
    flow.turn();
    figures(flow, table, Type { size: DENSE, is_bold: false }, Anchor::Start);
}

/// A table. Cells with text are aligned as `words` says.
fn figures(flow: &mut Flow<'_>, table: &content::Table, letters: Type, words: Anchor) {
    let laid = laid(table, letters, words);
    let explanation = table.explanation.as_ref().map_or(0.0, |_| 3.0 * SMALL_TYPE.leading());
    flow.heading(&table.title, explanation + laid.first_height());
    below_heading(flow, table, &laid);
}

/// A table of a report of blocks: whole on its page, if a page is high enough for it.
pub(super) fn whole_table(flow: &mut Flow<'_>, table: &content::Table) {
    let laid = laid_dense(table);
    flow.heading(&table.title, unbroken_height(flow, table, &laid));
    below_heading(flow, table, &laid);
}

/// Whether a table of a report of blocks fits below what is on the page; of one that is longer than a page, its
/// beginning.
pub(super) fn table_fits(flow: &Flow<'_>, table: &content::Table) -> bool {
    let heading = flow.heading_gap() + Flow::heading_height(&table.title);
    flow.has_room(heading + unbroken_height(flow, table, &laid_dense(table)))
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

/// What stands below the heading of a table.
fn below_heading(flow: &mut Flow<'_>, table: &content::Table, laid: &Table) {
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

/// A table as it is laid out in a report of blocks: closer where it has many rows, so that two such tables are on a
/// page.
fn laid_dense(table: &content::Table) -> Table {
    match table.rows.len() > ROWS_MANY {
        true => Table { padding: DENSE_PADDING, ..laid(table, SMALL_TYPE, Anchor::End) },
        false => laid(table, BODY_TYPE, Anchor::End),
    }
}

/// A table as it is laid out. Cells with text are aligned as `words` says.
fn laid(table: &content::Table, letters: Type, words: Anchor) -> Table {
    let is_words = |column: usize| {
        let mut figures = table.rows.iter().filter_map(|row| row.figures.get(column));
        figures.any(|figure| !figure.is_missing() && !has_figure(&figure.value))
    };
    let anchors: Vec<Anchor> = (0..table.columns.len())
        .map(|column| match column.checked_sub(1) {
            None => Anchor::Start,
            Some(column) if is_words(column) => words,
            Some(_) => Anchor::End,
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
    let follows = words_height(table.below.as_ref());
    Table { heads: vec![head], rows, is_ruled: true, padding: PADDING, follows }
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

/// Pictures below a heading.
pub(super) fn pictures(flow: &mut Flow<'_>, title: &str, words: &PictureWords, drawn: &[&Drawn]) {
    let height = |of: &&Drawn| flow.picture_height(&of.picture, captions(words, of), HEADING_ROOM);
    let first = drawn.first().map_or(0.0, height);
    flow.heading(title, first);
    for drawn in drawn {
        let [title, text] = captions(words, drawn);
        flow.picture(&drawn.picture, title, text);
    }
}

/// The two texts below a picture: what it shows, and how to read it.
fn captions<'a>(words: &'a PictureWords, drawn: &'a Drawn) -> [&'a str; 2] {
    match words.captions.iter().find(|caption| caption.name == drawn.name) {
        Some(of) => [&of.title, &of.text],
        None => [&drawn.picture.title, ""],
    }
}
