//! The measures as a table, in the order of the measuring sheet: the verdict, then each leg from G down to A, then
//! the requested heights. RFC 4180: `measurements.csv` for programs with comma and point, and the same table for
//! the spreadsheet of a person with headings and signs as its language has them.

use gaiter_language::Language;
use gaiter_leg::{Level, Side};
use gaiter_sizes::Garment;

use super::{Absent, Length, Measure};
use crate::cells::{Notation, cell, line};
use crate::chart::AtFigures;
use crate::completeness::Completeness;
use crate::measure::amendment::{Amendment, ByHand, Subject};
use crate::rounding::{self, cm_words, shortest};
use crate::schema::{LegFigures, Record};

/// The columns. Those in cm are those of the measuring sheet; those in mm have all digits.
const COLUMNS: [&str; 14] = [
    "leg",
    "level",
    "state",
    "girth_cm",
    "height_cm",
    "doubts",
    "girth_tape_mm",
    "girth_sd_mm",
    "height_mm",
    "height_sd_mm",
    "girth_contour_mm",
    "note",
    "scan_girth_tape_mm",
    "scan_height_mm",
];

/// The texts for the columns.
const HEADINGS: &str = "heading.measurements";

const LINE_END: &str = "\r\n";

/// The state of a level with figures that were measured.
const MEASURED: &str = "measured";

/// The state of a level with figures by a proportion of the body.
const ESTIMATED: &str = "estimated";

/// The state of a level with figures of which a person set at least one.
const BY_HAND: &str = "by hand";

/// The state of a level of which a person noted that it cannot be measured.
const NOT_MEASURABLE: &str = "not measurable";

/// The state of a level or requested height without figures.
const NOT_FOUND: &str = "not found";

/// The verdict for an order of this garment, in words of this language, and all levels of the measured legs.
pub(crate) fn table(
    record: &Record,
    garment: &Garment,
    language: Language,
    notation: Notation,
) -> String {
    let names = COLUMNS.map(|name| notation.heading(HEADINGS, name));
    let mut text = notation.begin.to_owned() + &line(&names, notation.separator, false, LINE_END);
    text += &verdict(record, garment, language).text(notation);
    for side in record.sides() {
        let levels = Level::ALL.into_iter().rev().map(|level| of_level(record, side, level));
        let at = record.leg(side).into_iter().flat_map(|leg| &leg.at);
        let at = at.map(|at| at_height(side, at, notation.language));
        text.extend(levels.chain(at).map(|line| line.text(notation)));
    }
    text
}

/// A line of the table. What it does not have is an empty cell.
#[derive(Default)]
struct Line {
    leg: &'static str,
    level: String,
    state: &'static str,
    girth_mm: Option<f64>,
    girth_sd_mm: Option<f64>,
    height_mm: Option<f64>,
    height_sd_mm: Option<f64>,
    contour_mm: Option<f64>,
    doubts: String,
    note: String,
    /// Whether the note is a sentence, which is always in quotes.
    is_sentence: bool,
    /// The scan's measure of a level that a person set.
    scan_girth_mm: Option<f64>,
    scan_height_mm: Option<f64>,
}

impl Line {
    fn text(&self, notation: Notation) -> String {
        let Notation { separator, language, .. } = notation;
        let cm = |mm: Option<f64>| mm.map_or(String::new(), |mm| cm_words(mm, language));
        let cells = [
            self.leg.to_owned(),
            self.level.clone(),
            self.state.to_owned(),
            cm(self.girth_mm),
            cm(self.height_mm),
            self.doubts.clone(),
            notation.figure(self.girth_mm),
            notation.figure(self.girth_sd_mm),
            notation.figure(self.height_mm),
            notation.figure(self.height_sd_mm),
            notation.figure(self.contour_mm),
            cell(&self.note, separator, self.is_sentence),
            notation.figure(self.scan_girth_mm),
            notation.figure(self.scan_height_mm),
        ];
        cells.join(&separator.to_string()) + LINE_END
    }
}

fn verdict(record: &Record, garment: &Garment, language: Language) -> Line {
    let verdict = Completeness::from_record(record, garment);
    Line {
        level: "verdict".to_owned(),
        state: verdict.kind().word(),
        note: verdict.sentences(language).join(" "),
        is_sentence: true,
        ..Line::default()
    }
}

fn of_level(record: &Record, side: Side, level: Level) -> Line {
    let line = match Measure::find(record, side, level) {
        Ok(measure) => measured(record.leg(side), level, measure),
        Err(Absent::NotFound) => Line { state: NOT_FOUND, ..Line::default() },
        Err(Absent::NotMeasurable) => {
            let hand = record.by_hand(side, Subject::Level(level));
            Line {
                state: NOT_MEASURABLE,
                note: hand.map(|hand| note(&hand)).unwrap_or_default(),
                is_sentence: true,
                ..scanned(record.leg(side), level)
            }
        }
    };
    Line { leg: side.word(), level: level.name().to_owned(), ..line }
}

fn measured(leg: Option<&LegFigures>, level: Level, measure: Measure<'_>) -> Line {
    let Measure { girth, height, is_estimate, doubts, by, by_hand, .. } = measure;
    let landmark = leg.and_then(|leg| leg.landmarks.get(level.name()));
    let line = match by_hand {
        Some(_) => scanned(leg, level),
        None => Line::default(),
    };
    Line {
        state: match (by_hand, is_estimate) {
            (Some(_), _) => BY_HAND,
            (None, true) => ESTIMATED,
            (None, false) => MEASURED,
        },
        girth_mm: Some(girth.mm),
        girth_sd_mm: girth.sd_mm,
        height_mm: height.map(|height| height.mm),
        height_sd_mm: height.and_then(|Length { sd_mm, .. }| sd_mm),
        // The girth along the skin belongs to the scan's own girth.
        contour_mm: landmark.filter(|_| by_hand.is_none()).map(|found| found.girth_contour_mm),
        doubts: doubts.join(" "),
        note: by_hand.map_or_else(|| by.to_owned(), |hand| note(&hand)),
        is_sentence: by_hand.is_some(),
        ..line
    }
}

/// Who set a measure, when and why: `by hand, Anna Berg, 2026-11-25T10:00:00Z: swollen since the scan`.
fn note(hand: &ByHand<'_>) -> String {
    let Amendment { by, at, reason, .. } = hand.last;
    format!("by hand, {by}, {at}: {reason}")
}

/// Only the scan's girth and height of a level that a person set.
fn scanned(leg: Option<&LegFigures>, level: Level) -> Line {
    let scanned = leg.and_then(|leg| Measure::scanned(leg, level));
    Line {
        scan_girth_mm: scanned.as_ref().map(|of| of.girth.mm),
        scan_height_mm: scanned.and_then(|of| of.height).map(|of| of.mm),
        ..Line::default()
    }
}

/// A requested height is exact, so its standard error stays empty.
fn at_height(side: Side, at: &AtFigures, language: Language) -> Line {
    Line {
        leg: side.word(),
        level: format!("at {} cm", shortest(rounding::mm(at.height_mm / 10.0), language)),
        state: if at.girth_tape_mm.is_some() { MEASURED } else { NOT_FOUND },
        girth_mm: at.girth_tape_mm,
        girth_sd_mm: at.girth_sd_mm,
        height_mm: Some(at.height_mm),
        contour_mm: at.girth_contour_mm,
        doubts: at.doubts.join(" "),
        ..Line::default()
    }
}
