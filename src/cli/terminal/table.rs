//! The measures of a record for people, in the order of the measuring sheet: right leg first, from G down
//! to A, girth and vertical height above the floor in centimetres.

use std::fmt::Write;

use super::paint::{self, painted};
use super::screen::indented;
use crate::language::Language;
use crate::leg::{Level, Side};
use crate::record::Record;
use crate::record::chart::AtFigures;
use crate::record::completeness::{Completeness, Kind};
use crate::record::garment::Garment;
use crate::record::measure::{Length, Measure};
use crate::record::report::Mark;
use crate::record::rounding::{cm_margin, cm_words};
use crate::record::schema::{FindingNote, LegFigures};

/// Width of the column of level names, characters.
const NAME: usize = 12;

/// Width of a column of girths or heights: `~120.0 ±12.3` with a gap before it.
const CELL: usize = 14;

/// The marks before figures, as in the report, with what they mean.
const LEGEND: [(Mark, &str); 2] = [
    (Mark::Estimated, "estimated by the body's proportions, not measured"),
    (Mark::Doubtful, "doubtful"),
];

/// Instead of the height of a level on the foot, and of an uncertainty that is unknown.
const NOTHING: &str = "-";

/// The verdict for an order of this garment, the measures and the findings of a record, in lines of at most
/// this many characters; without a line end after the last one.
pub fn of(record: &Record, garment: Garment, columns: usize) -> String {
    let mut text = verdict(record, garment, columns);
    text += &body(record);
    let legs: Vec<&LegFigures> =
        Side::FROM_FRONT.into_iter().filter_map(|side| record.leg(side)).collect();
    text += &measures(&legs);
    text += &feet(&legs);
    for (row, at) in legs.first().map_or(&[][..], |leg| &leg.at).iter().enumerate() {
        let label = format!("at {} cm", at.height_mm / 10.0);
        let cells: String = legs.iter().map(|leg| at_cells(leg.at.get(row))).collect();
        let _ = writeln!(text, "  {label:<NAME$}{cells}");
    }
    for line in findings(&record.findings) {
        text += &indented(&line, "  ", columns);
    }
    text.pop();
    text
}

/// The colour of a verdict, which only repeats what its words say.
pub fn colour(kind: Kind) -> anstyle::Style {
    match kind {
        Kind::Complete => paint::GOOD,
        Kind::ByHand => paint::CARE,
        Kind::ScanAgain => paint::BAD,
    }
}

fn verdict(record: &Record, garment: Garment, columns: usize) -> String {
    let verdict = Completeness::of(record, garment);
    let sentences = verdict.sentences(Language::En).join(" ");
    let lines = indented(&sentences, "  ", columns);
    lines.lines().map(|line| painted(colour(verdict.kind()), line) + "\n").collect()
}

fn body(record: &Record) -> String {
    let height = |mm: Option<f64>| mm.map_or(NOTHING.to_owned(), |mm| format!("{} cm", cm(mm)));
    format!(
        "  stature {}, crotch {}, unit of the scan {}{}\n",
        height(record.body.stature_mm),
        height(record.body.crotch_height_mm),
        record.scan.unit,
        if record.scan.unit_inferred { " (found)" } else { "" },
    )
}

/// The levels of the measured legs, and what their marks mean.
fn measures(legs: &[&LegFigures]) -> String {
    let sides: String =
        legs.iter().map(|leg| format!("{:>1$}", format!("{} leg", leg.side), 2 * CELL)).collect();
    let heads = format!("{:>CELL$}{:>CELL$}", "girth cm", "height cm").repeat(legs.len());
    let mut text = format!("  {:NAME$}{sides}\n  {:NAME$}{heads}\n", "", "");
    let mut marks = Vec::new();
    for level in Level::ALL.into_iter().rev() {
        let measures: Vec<_> = legs.iter().map(|leg| Measure::of(leg, level)).collect();
        marks.extend(measures.iter().flatten().map(Measure::mark));
        let cells: String = measures.iter().map(cells).collect();
        let _ = writeln!(text, "  {:<NAME$}{cells}", level.name());
    }
    let used = LEGEND.into_iter().filter(|(mark, _)| marks.contains(mark));
    let used: Vec<String> =
        used.map(|(mark, meaning)| format!("{} {meaning}", mark.sign())).collect();
    if !used.is_empty() {
        let _ = writeln!(text, "  {}", used.join("; "));
    }
    text
}

/// Length and breadth of the feet, if one was seen.
fn feet(legs: &[&LegFigures]) -> String {
    if legs.iter().all(|leg| leg.foot.is_none()) {
        return String::new();
    }
    let pair = |[length, breadth]: [String; 2]| format!("{length:>CELL$}{breadth:>CELL$}");
    let cells = |leg: &&LegFigures| match &leg.foot {
        Some(foot) => pair([foot.length_mm, foot.breadth_mm].map(cm)),
        None => pair([NOTHING, NOTHING].map(str::to_owned)),
    };
    let cells: String = legs.iter().map(cells).collect();
    let heads = pair(["length cm", "breadth cm"].map(str::to_owned)).repeat(legs.len());
    format!("  {:NAME$}{heads}\n  {:<NAME$}{cells}\n", "", "foot")
}

/// Girth and height of one level of one leg, with their uncertainties.
fn cells(measure: &Option<Measure<'_>>) -> String {
    let Some(measure) = measure else {
        return format!("{:>1$}", Language::En.text("report.missing.level_absent"), 2 * CELL);
    };
    let figure = |length: Length| format!("{}{}", measure.mark().sign(), with_margin(length));
    let height = measure.height.map_or(NOTHING.to_owned(), figure);
    format!("{:>CELL$}{height:>CELL$}", figure(measure.girth))
}

/// The same as [`cells`], for a requested height, which is exact.
fn at_cells(at: Option<&AtFigures>) -> String {
    let Some((at, girth_mm)) = at.and_then(|at| Some((at, at.girth_tape_mm?))) else {
        return format!("{:>1$}", Language::En.text("report.missing.level_absent"), 2 * CELL);
    };
    let mark = if at.doubts.is_empty() { Mark::Sure } else { Mark::Doubtful };
    let girth = with_margin(Length { mm: girth_mm, sd_mm: at.girth_sd_mm });
    format!("{:>CELL$}{:>CELL$}", format!("{}{girth}", mark.sign()), cm(at.height_mm))
}

/// The findings in plain words: those of one code in a line, with the places that they are about.
fn findings(findings: &[FindingNote]) -> Vec<String> {
    let mut groups: Vec<Vec<&FindingNote>> = Vec::new();
    for finding in findings {
        let is_same = |group: &&mut Vec<&FindingNote>| {
            let its = |of: &FindingNote| (of.code.clone(), of.severity.clone());
            group.iter().any(|of| its(of) == its(finding))
        };
        match groups.iter_mut().find(is_same) {
            Some(group) => group.push(finding),
            None => groups.push(vec![finding]),
        }
    }
    groups.iter().filter_map(|group| told(group)).collect()
}

/// Findings of one code: `warning: Skin partly not seen, right C, B · left C [gap]`.
fn told(group: &[&FindingNote]) -> Option<String> {
    let FindingNote { severity, code, message, .. } = group.first()?;
    let title = Language::En.find(&format!("finding.{code}.title")).unwrap_or(message);
    let of_leg = |side: Option<&str>| {
        let of_leg: Vec<_> = group.iter().filter(|of| of.leg.as_deref() == side).collect();
        let has = |level: &Level| of_leg.iter().any(|of| of.level.as_deref() == Some(level.name()));
        let levels: Vec<&str> =
            Level::ALL.iter().rev().filter(|level| has(level)).map(|level| level.name()).collect();
        let place = format!("{} {}", side.unwrap_or_default(), levels.join(", "));
        (!of_leg.is_empty() && !place.trim().is_empty()).then(|| place.trim().to_owned())
    };
    let sides = Side::FROM_FRONT.map(|side| Some(side.word())).into_iter().chain([None]);
    let places: Vec<String> = sides.filter_map(of_leg).collect();
    let comma = if places.is_empty() { "" } else { ", " };
    Some(format!("{severity}: {title}{comma}{} [{code}]", places.join(" · ")))
}

/// A length in cm with its uncertainty, as in the report.
fn with_margin(Length { mm, sd_mm }: Length) -> String {
    let margin = sd_mm.map_or(String::new(), |sd_mm| format!(" ±{:.1}", cm_margin(sd_mm)));
    format!("{}{margin}", cm(mm))
}

/// Millimetres in the clinic's unit: centimetres with one decimal.
fn cm(mm: f64) -> String {
    cm_words(mm, Language::En)
}
