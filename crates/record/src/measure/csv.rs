//! `measurements.csv` for spreadsheets, in the order of the measuring sheet: the verdict, then each leg
//! from G down to A, then the requested heights. RFC 4180, comma, point.

use gaiter_language::Language;
use gaiter_leg::{Level, Side};
use gaiter_sizes::Garment;

use super::{Absent, Length, Measure};
use crate::chart::AtFigures;
use crate::completeness::Completeness;
use crate::measure::amendment::{Amendment, ByHand, Subject};
use crate::rounding::{self, cm_words};
use crate::schema::{LegFigures, Record};

const HEADER: &str = "leg,level,state,girth_cm,height_cm,doubts,girth_tape_mm,girth_sd_mm,\
                      height_mm,height_sd_mm,girth_contour_mm,note,scan_girth_tape_mm,\
                      scan_height_mm\r\n";

/// The columns between `doubts` and `note`, all empty.
const NO_EXACT: &str = ",,,,";

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

/// The columns after `note`: what the scan says of a level that a person set, both empty.
const NOT_SET: &str = ",,";

/// The verdict for an order of this garment, in words of this language, and all levels of the measured
/// legs. The columns in cm are those of the measuring sheet; the columns in mm have all digits.
pub fn measurements(record: &Record, garment: &Garment, language: Language) -> String {
    let verdict = Completeness::of(record, garment);
    let to_do = quoted(&verdict.sentences(language).join(" "));
    let kind = verdict.kind().word();
    let mut text = format!("{HEADER},verdict,{kind},,,,{NO_EXACT},{to_do}{NOT_SET}\r\n");
    for side in record.sides() {
        let leg = record.leg(side);
        for level in Level::ALL.into_iter().rev() {
            let cells = match Measure::of(record, side, level) {
                Ok(measure) => of_level(leg, level, &measure),
                Err(Absent::NotFound) => without_figures(NOT_FOUND, "") + NOT_SET,
                Err(Absent::NotMeasurable) => not_measurable(record, side, level),
            };
            text.push_str(&format!("{},{},{cells}\r\n", side.word(), level.name()));
        }
        for at in leg.iter().flat_map(|leg| &leg.at) {
            let level = format!("at {} cm", rounding::mm(at.height_mm / 10.0));
            text.push_str(&format!("{},{level},{}{NOT_SET}\r\n", side.word(), at_height(at)));
        }
    }
    text
}

/// A text as one cell.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// A figure, or nothing if it is unknown.
fn judged(figure: Option<f64>) -> String {
    figure.map_or(String::new(), |figure| figure.to_string())
}

/// A length in cm, rounded as on the measuring sheet, or nothing.
fn cm(mm: Option<f64>) -> String {
    mm.map_or(String::new(), |mm| cm_words(mm, Language::En))
}

fn without_figures(state: &str, note: &str) -> String {
    format!("{state},,,,{NO_EXACT},{note}")
}

fn not_measurable(record: &Record, side: Side, level: Level) -> String {
    let hand = record.by_hand(side, Subject::Level(level));
    let note = hand.map_or(String::new(), |hand| note(&hand));
    without_figures(NOT_MEASURABLE, &note) + &scanned(record.leg(side), level)
}

fn of_level(leg: Option<&LegFigures>, level: Level, measure: &Measure<'_>) -> String {
    let Measure { girth, height, is_estimate, doubts, by, by_hand, .. } = measure;
    let height_mm = height.map(|height| height.mm);
    let landmark = leg.and_then(|leg| leg.landmarks.get(level.name()));
    // The girth along the skin belongs to the scan's own girth.
    let contour_mm = landmark.filter(|_| by_hand.is_none()).map(|found| found.girth_contour_mm);
    let state = match (by_hand, is_estimate) {
        (Some(_), _) => BY_HAND,
        (None, true) => ESTIMATED,
        (None, false) => MEASURED,
    };
    format!(
        "{state},{},{},{},{},{},{},{},{},{}{}",
        cm(Some(girth.mm)),
        cm(height_mm),
        doubts.join(" "),
        girth.mm,
        judged(girth.sd_mm),
        judged(height_mm),
        judged(height.and_then(|Length { sd_mm, .. }| sd_mm)),
        judged(contour_mm),
        by_hand.as_ref().map_or_else(|| (*by).to_owned(), note),
        by_hand.map_or_else(|| NOT_SET.to_owned(), |_| scanned(leg, level)),
    )
}

/// Who set a measure, when and why: `by hand, Anna Berg, 2026-11-25T10:00:00Z: swollen since the scan`.
fn note(hand: &ByHand<'_>) -> String {
    let Amendment { by, at, reason, .. } = hand.last;
    quoted(&format!("by hand, {by}, {at}: {reason}"))
}

/// The columns after `note`: the scan's girth and height of a level that a person set.
fn scanned(leg: Option<&LegFigures>, level: Level) -> String {
    let scanned = leg.and_then(|leg| Measure::scanned(leg, level));
    let girth_mm = scanned.as_ref().map(|of| of.girth.mm);
    let height_mm = scanned.and_then(|of| of.height).map(|of| of.mm);
    format!(",{},{}", judged(girth_mm), judged(height_mm))
}

/// A requested height is exact, so its standard error stays empty.
fn at_height(at: &AtFigures) -> String {
    format!(
        "{},{},{},{},{},{},{},,{},",
        if at.girth_tape_mm.is_some() { MEASURED } else { NOT_FOUND },
        cm(at.girth_tape_mm),
        cm(Some(at.height_mm)),
        at.doubts.join(" "),
        judged(at.girth_tape_mm),
        judged(at.girth_sd_mm),
        at.height_mm,
        judged(at.girth_contour_mm),
    )
}
