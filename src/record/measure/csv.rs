//! `measurements.csv` for spreadsheets, in the order of the measuring sheet: the verdict, then each leg
//! from G down to A, then the requested heights. RFC 4180, comma, point.

use super::{Length, Measure};
use crate::language::Language;
use crate::leg::{Level, Side};
use crate::record::chart::AtFigures;
use crate::record::completeness::Completeness;
use crate::record::garment::Garment;
use crate::record::rounding::{self, cm_words};
use crate::record::schema::{LegFigures, Record};

const HEADER: &str = "leg,level,state,girth_cm,height_cm,doubts,girth_tape_mm,girth_sd_mm,\
                      height_mm,height_sd_mm,girth_contour_mm,note\r\n";

/// The columns between `doubts` and `note`, all empty.
const NO_EXACT: &str = ",,,,";

/// The state of a level with figures that were measured.
const MEASURED: &str = "measured";

/// The state of a level with figures by a proportion of the body.
const ESTIMATED: &str = "estimated";

/// The state of a level or requested height without figures.
const NOT_FOUND: &str = "not found";

/// The verdict for an order of this garment, in words of this language, and all levels of the measured
/// legs. The columns in cm are those of the measuring sheet; the columns in mm have all digits.
pub fn measurements(record: &Record, garment: Garment, language: Language) -> String {
    let verdict = Completeness::of(record, garment);
    let to_do = quoted(&verdict.sentences(language).join(" "));
    let mut text = format!("{HEADER},verdict,{},,,,{NO_EXACT},{to_do}\r\n", verdict.kind().word());
    for leg in Side::FROM_FRONT.into_iter().filter_map(|side| record.leg(side)) {
        for level in Level::ALL.into_iter().rev() {
            let cells = Measure::of(leg, level)
                .map_or_else(not_found, |measure| of_level(leg, level, &measure));
            text.push_str(&format!("{},{},{cells}\r\n", leg.side, level.name()));
        }
        for at in &leg.at {
            let level = format!("at {} cm", rounding::mm(at.height_mm / 10.0));
            text.push_str(&format!("{},{level},{}\r\n", leg.side, at_height(at)));
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

fn not_found() -> String {
    format!("{NOT_FOUND},,,,{NO_EXACT},")
}

fn of_level(leg: &LegFigures, level: Level, measure: &Measure<'_>) -> String {
    let Measure { girth, height, is_estimate, doubts, by } = measure;
    let height_mm = height.map(|height| height.mm);
    let contour_mm = leg.landmarks.get(level.name()).map(|found| found.girth_contour_mm);
    format!(
        "{},{},{},{},{},{},{},{},{},{}",
        if *is_estimate { ESTIMATED } else { MEASURED },
        cm(Some(girth.mm)),
        cm(height_mm),
        doubts.join(" "),
        girth.mm,
        judged(girth.sd_mm),
        judged(height_mm),
        judged(height.and_then(|Length { sd_mm, .. }| sd_mm)),
        judged(contour_mm),
        by
    )
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
