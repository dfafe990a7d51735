//! An order as a table: one row per side and point. UTF-8, lines end with CR LF. For programs with semicolons and
//! decimal points, for the spreadsheet of a person with headings, signs and texts as its language has them.

use gaiter_language::Language;

use super::{LastFigure, Order, OrderFigure, Row, SCAN_AGE, State};
use crate::cells::{Notation, line};

/// The columns of every order.
const COLUMNS: [&str; 17] = [
    "format",
    "order_ref",
    "scan_ref",
    "side",
    "point",
    "girth_mm",
    "girth_u95_mm",
    "length_mm",
    "length_u95_mm",
    "length_from",
    "basis",
    "method",
    "flag",
    "printed_girth_cm",
    "printed_length_cm",
    "edited_by",
    "reason",
];

/// The further columns of an order that repeats another.
const OF_A_REORDER: [&str; 10] = [
    "reorder",
    "last_order_ref",
    "last_scan_ref",
    "last_scan_at",
    "last_girth_mm",
    "girth_change_mm",
    "girth_change_u95_mm",
    "last_length_mm",
    "length_change_mm",
    "length_change_u95_mm",
];

/// The texts for the columns.
const HEADINGS: &str = "heading.order";

const LINE_END: &str = "\r\n";

/// The order as the exact table for programs: the same in every language.
pub fn csv(order: &Order) -> String {
    table(order, Notation::exact(';'))
}

/// The same table for a spreadsheet that is set to this language, with its headings.
pub fn spreadsheet(order: &Order, language: Language) -> String {
    table(order, Notation::spreadsheet(language))
}

fn table(order: &Order, notation: Notation) -> String {
    let Notation { begin, separator, .. } = notation;
    let further: &[&str] = if order.reorder.is_some() { &OF_A_REORDER } else { &[] };
    let names = COLUMNS.iter().chain(further).map(|name| notation.heading(HEADINGS, name));
    let names = names.collect::<Vec<_>>();
    let mut text = begin.to_owned() + &line(&names, separator, false, LINE_END);
    for row in &order.rows {
        let mut cells = own(order, row, notation);
        cells.extend(of_a_reorder(order, row, notation));
        text += &line(&cells, separator, false, LINE_END);
    }
    text
}

fn own(order: &Order, row: &Row, notation: Notation) -> Vec<String> {
    let number = |figure| notation.figure(figure);
    let words = |text: Option<&str>| text.map(|text| notation.words(text)).unwrap_or_default();
    let [girth, length] = [&row.girth, &row.length].map(Option::as_ref);
    vec![
        order.schema.clone(),
        words(order.order_ref.as_deref()),
        notation.words(&order.scan.reference),
        row.side.word().to_owned(),
        row.point.clone(),
        number(girth.and_then(|of| of.mm)),
        number(girth.and_then(|of| of.u95_mm)),
        number(length.and_then(|of| of.mm)),
        number(length.and_then(|of| of.u95_mm)),
        row.length_from.clone().unwrap_or_default(),
        order.basis.clone(),
        method(row),
        flag(order, row),
        number(girth.and_then(|of| of.printed_cm)),
        number(length.and_then(|of| of.printed_cm)),
        words(row.edited_by.as_deref()),
        words(row.reason.as_deref()),
    ]
}

fn of_a_reorder(order: &Order, row: &Row, notation: Notation) -> Vec<String> {
    let Some(reorder) = &order.reorder else { return Vec::new() };
    let at = reorder.last_scan.acquired.as_ref().map(|acquired| acquired.at.to_string());
    let last = |of: Option<LastFigure>| {
        let figures = [of.map(|of| of.mm), of.and_then(|of| of.change_mm)];
        let figures = figures.into_iter().chain([of.and_then(|of| of.change_u95_mm)]);
        figures.map(|figure| notation.figure(figure)).collect::<Vec<_>>()
    };
    let last_row = row.last.clone().unwrap_or_default();
    let mut cells = vec![
        reorder.is.word().to_owned(),
        reorder.last_ref.as_deref().map(|text| notation.words(text)).unwrap_or_default(),
        notation.words(&reorder.last_scan.reference),
        at.unwrap_or_default(),
    ];
    cells.extend(last(last_row.girth));
    cells.extend(last(last_row.length));
    cells
}

/// How girth and length were taken: one word if both were alike, else that of the girth, `/`, that of the
/// length.
fn method(row: &Row) -> String {
    let mut words: Vec<&str> =
        row.figures().filter_map(|figure| figure.method).map(|way| way.word()).collect();
    words.dedup();
    words.join("/")
}

/// What is to be known of a row, separated by blanks.
fn flag(order: &Order, row: &Row) -> String {
    let mut flags: Vec<String> = Vec::new();
    if !row.counts {
        flags.push("replaced".to_owned());
    }
    match [&row.girth, &row.length] {
        [Some(girth), Some(length)] if girth.is != length.is => {
            flags.extend(state(girth).map(|word| format!("girth-{word}")));
            flags.extend(state(length).map(|word| format!("length-{word}")));
        }
        _ => flags.extend(row.figures().next().and_then(state).map(str::to_owned)),
    }
    // A doubt that does not matter for a tape leaves a figure measured.
    let sure = row.figures().filter(|figure| figure.is == State::Measured);
    for doubt in sure.flat_map(|figure| &figure.doubts) {
        if !flags.contains(doubt) {
            flags.push(doubt.clone());
        }
    }
    if order.is_of_an_old_scan() && row.figures().any(|figure| figure.mm.is_some()) {
        flags.push(SCAN_AGE.to_owned());
    }
    flags.join(" ")
}

fn state(figure: &OrderFigure) -> Option<&'static str> {
    (figure.is != State::Measured).then(|| figure.is.word())
}
