//! The table of a record for people: both legs side by side, centimetres with one decimal.

use std::fmt::Write;

use crate::leg::{Level, Side};
use crate::record::Record;
use crate::record::schema::LegFigures;

/// The measures of a record as a table, findings below it; ends without a line end.
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
    let legs = sides.map(|side| record.legs.iter().find(|leg| leg.side == side));
    let _ = writeln!(text, "        {:^24}  {:^24}", sides[0], sides[1]);
    let _ = writeln!(text, "        {0:>11}  {1:>11}  {0:>11}  {1:>11}", "height cm", "girth cm");
    for level in Level::ALL.map(Level::name) {
        let [left, right] = legs.map(|leg| cells(leg, level));
        let _ = writeln!(text, "  {level:<4}  {left}  {right}");
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

/// Height and girth of one level of one leg, with what they are worth; a dash where absent, a mark
/// where in doubt.
fn cells(leg: Option<&LegFigures>, level: &str) -> String {
    let Some(landmark) = leg.and_then(|leg| leg.landmarks.get(level)) else {
        return format!("{:>11}  {:>11}", "-", "-");
    };
    let doubt = doubt(&landmark.doubts);
    let height = format!("{}{}", cm(landmark.height_mm), worth(landmark.height_sd_mm));
    let girth = format!("{doubt}{}{}", cm(landmark.girth_tape_mm), worth(landmark.girth_sd_mm));
    format!("{height:>11}  {girth:>11}")
}

/// As [`cells`], of the height in this row of those that were asked for.
fn at_cells(leg: Option<&LegFigures>, row: usize) -> String {
    let at = leg.and_then(|leg| leg.at.get(row));
    let girth = at.and_then(|at| Some((at, at.girth_tape_mm?)));
    let Some((at, girth_mm)) = girth else {
        return format!("{:>11}  {:>11}", "-", "-");
    };
    let girth = format!("{}{}{}", doubt(&at.doubts), cm(girth_mm), worth(at.girth_sd_mm));
    format!("{:>11}  {girth:>11}", cm(at.height_mm))
}

/// A mark where there is a doubt.
fn doubt(doubts: &[String]) -> &'static str {
    if doubts.is_empty() { "" } else { "?" }
}

/// What a figure is worth.
fn worth(sd_mm: Option<f64>) -> String {
    sd_mm.map_or(String::new(), |sd_mm| format!(" ±{:.2}", sd_mm / 10.0))
}

/// Millimetres as the clinic reads them: centimetres with one decimal.
fn cm(mm: f64) -> String {
    format!("{:.1}", mm / 10.0)
}
