//! The table of a record for people: both legs side by side, in centimetres with one decimal.

use std::fmt::Write;

use crate::language::Language;
use crate::leg::{Level, Side};
use crate::record::Record;
use crate::record::rounding::{cm_margin, cm_words};
use crate::record::schema::LegFigures;

/// The measures of a record as a table, with the findings below it and no line end after the last line.
pub fn of(record: &Record) -> String {
    let height = |mm: Option<f64>| mm.map_or("-".to_owned(), |mm| format!("{} cm", cm(mm)));
    let mut text = format!(
        "stature {}, crotch {}, unit {}{}\n",
        height(record.body.stature_mm),
        height(record.body.crotch_height_mm),
        record.scan.unit,
        if record.scan.unit_inferred { " (found)" } else { "" },
    );
    let sides = Side::BOTH.map(Side::word);
    let legs = Side::BOTH.map(|side| record.leg(side));
    let _ = writeln!(text, "        {:^24}  {:^24}", sides[0], sides[1]);
    let _ = writeln!(text, "        {0:>11}  {1:>11}  {0:>11}  {1:>11}", "height cm", "girth cm");
    for level in Level::ALL.into_iter().filter(|level| record.has_row(*level)) {
        let level = level.name();
        let [left, right] = legs.map(|leg| cells(leg, level));
        let _ = writeln!(text, "  {level:<4}  {left}  {right}");
    }
    text += &feet(legs);
    let missing: Vec<&str> =
        Level::ALL.into_iter().filter(|level| !record.has_row(*level)).map(Level::name).collect();
    if !missing.is_empty() {
        let _ = writeln!(text, "  not measured on either leg: {}", missing.join(", "));
    }
    let asked = record.legs.first().map_or(&[][..], |leg| &leg.at);
    for (row, at) in asked.iter().enumerate() {
        let [left, right] = legs.map(|leg| at_cells(leg, row));
        let label = format!("@{}", at.height_mm / 10.0);
        let _ = writeln!(text, "  {label:<6}{left}  {right}");
    }
    for finding in &record.findings {
        let place = [finding.leg.as_deref(), finding.level.as_deref()].into_iter().flatten();
        let place: String = place.flat_map(|word| [word, " "]).collect();
        let (severity, code) = (&finding.severity, &finding.code);
        let _ = writeln!(text, "  {severity}: {place}[{code}] {}", finding.message);
    }
    text.pop();
    text
}

/// The lengths of the feet, if at least one is known.
fn feet(legs: [Option<&LegFigures>; 2]) -> String {
    let lengths = legs.map(|leg| leg.and_then(|leg| leg.foot.as_ref()).map(|foot| foot.length_mm));
    if lengths == [None, None] {
        return String::new();
    }
    let [left, right] = lengths.map(|mm| mm.map_or("-".to_owned(), cm));
    format!("  foot  {left:>11}  {:>11}  {right:>11}\n", "")
}

/// Height and girth of one level of one leg, with their uncertainties. A dash means absent, one mark a
/// doubt, another an estimate by proportion.
fn cells(leg: Option<&LegFigures>, level: &str) -> String {
    let landmark = leg.and_then(|leg| leg.landmarks.get(level)).map(|found| {
        let doubt = doubt(&found.doubts);
        let heights = (found.height_mm, found.height_sd_mm);
        pair(["", doubt], heights, (found.girth_tape_mm, found.girth_sd_mm))
    });
    let estimate = || {
        let estimate = leg.and_then(|leg| leg.estimates.get(level))?;
        let heights = (estimate.height_mm, estimate.height_sd_mm);
        Some(pair(["~", "~"], heights, (estimate.girth_tape_mm, estimate.girth_sd_mm)))
    };
    landmark.or_else(estimate).unwrap_or_else(|| format!("{:>11}  {:>11}", "-", "-"))
}

/// Height and girth in cm with their marks and uncertainties.
fn pair(marks: [&str; 2], height: (f64, Option<f64>), girth: (f64, Option<f64>)) -> String {
    let cell = |mark: &str, (mm, sd)| format!("{mark}{}{}", cm(mm), worth(sd));
    format!("{:>11}  {:>11}", cell(marks[0], height), cell(marks[1], girth))
}

/// The same as [`cells`], for the requested height in this row.
fn at_cells(leg: Option<&LegFigures>, row: usize) -> String {
    let at = leg.and_then(|leg| leg.at.get(row));
    let girth = at.and_then(|at| Some((at, at.girth_tape_mm?)));
    let Some((at, girth_mm)) = girth else {
        return format!("{:>11}  {:>11}", "-", "-");
    };
    let girth = format!("{}{}{}", doubt(&at.doubts), cm(girth_mm), worth(at.girth_sd_mm));
    format!("{:>11}  {girth:>11}", cm(at.height_mm))
}

/// The mark for a doubt, if there is one.
fn doubt(doubts: &[String]) -> &'static str {
    if doubts.is_empty() { "" } else { "?" }
}

/// The uncertainty of a figure, as in the report.
fn worth(sd_mm: Option<f64>) -> String {
    sd_mm.map_or(String::new(), |sd_mm| format!(" ±{:.1}", cm_margin(sd_mm)))
}

/// Millimetres in the clinic's unit: centimetres with one decimal.
fn cm(mm: f64) -> String {
    cm_words(mm, Language::En)
}
