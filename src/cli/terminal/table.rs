//! The measures of a record for people, in the order of the measuring sheet: right leg first, from G down
//! to A, girth and vertical height above the floor in centimetres.

use std::fmt::Write;

use gaiter_language::Language;
use gaiter_leg::{Level, Side};
use gaiter_record::Record;
use gaiter_record::chart::AtFigures;
use gaiter_record::completeness::{Completeness, Kind};
use gaiter_record::measure::amendment::Subject;
use gaiter_record::measure::{Absent, Length, Measure};
use gaiter_record::report::{Reliability, ReportContent};
use gaiter_record::rounding::{cm_margin, cm_words};
use gaiter_record::schema::{FindingNote, LegFigures};
use gaiter_sizes::Garment;

use super::screen::indented;
use super::{BAD, CARE, GOOD, painted};

/// Width of the column of level names, characters.
const NAME: usize = 12;

/// Width of a column of girths or heights: `~120.0 ±12.3` with a gap before it.
const CELL: usize = 14;

/// The marks before figures, as in the report, with what they mean.
const LEGEND: [(Reliability, &str); 3] = [
    (Reliability::ByHand, "set by hand"),
    (Reliability::Estimated, "estimated by the body's proportions, not measured"),
    (Reliability::Doubtful, "doubtful"),
];

/// Instead of the height of a level on the foot, and of an uncertainty that is unknown.
const NOTHING: &str = "-";

/// The verdict for an order of this garment, the measures and the findings of a record, in lines of at most
/// this many characters; without a line end after the last one.
pub fn render(record: &Record, garment: &Garment, columns: usize) -> String {
    let mut text = verdict(record, garment, columns);
    text += &body(record);
    let sides: Vec<Side> = record.sides().collect();
    text += &measures(record, &sides);
    text += &feet(record, &sides);
    text += &by_hand(record, columns);
    let legs: Vec<Option<&LegFigures>> = sides.iter().map(|side| record.leg(*side)).collect();
    let asked = legs.iter().flatten().map(|leg| &leg.at).find(|at| !at.is_empty());
    for (row, at) in asked.into_iter().flatten().enumerate() {
        let label = format!("at {} cm", at.height_mm / 10.0);
        let cells: String =
            legs.iter().map(|leg| at_cells(leg.and_then(|leg| leg.at.get(row)))).collect();
        let _ = writeln!(text, "  {label:<NAME$}{cells}");
    }
    for line in findings(&record.findings) {
        text += &indented(&line, "  ", columns);
    }
    text.pop();
    text
}

/// The colour of a verdict, which only repeats its words.
pub fn colour(kind: Kind) -> anstyle::Style {
    match kind {
        Kind::Complete => GOOD,
        Kind::NotMeasurable | Kind::ByHand => CARE,
        Kind::ScanAgain => BAD,
    }
}

fn verdict(record: &Record, garment: &Garment, columns: usize) -> String {
    let verdict = Completeness::from_record(record, garment);
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

/// The levels of these legs, and what their marks mean.
fn measures(record: &Record, sides: &[Side]) -> String {
    let leg = |side: &Side| format!("{:>1$}", format!("{} leg", side.word()), 2 * CELL);
    let legs: String = sides.iter().map(leg).collect();
    let heads = format!("{:>CELL$}{:>CELL$}", "girth cm", "height cm").repeat(sides.len());
    let mut text = format!("  {:NAME$}{legs}\n  {:NAME$}{heads}\n", "", "");
    let mut marks = Vec::new();
    for level in Level::ALL.into_iter().rev() {
        let measures: Vec<_> =
            sides.iter().map(|side| Measure::find(record, *side, level)).collect();
        marks.extend(measures.iter().flatten().flat_map(Measure::marks));
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

/// Length and breadth of the feet, if one is known.
fn feet(record: &Record, sides: &[Side]) -> String {
    const LENGTHS: [Subject; 2] = [Subject::FootLength, Subject::FootBreadth];
    let of_leg = |side: &Side| LENGTHS.map(|subject| Length::find(record, *side, subject));
    let feet: Vec<_> = sides.iter().map(of_leg).collect();
    if feet.iter().flatten().all(|length| *length == Err(Absent::NotFound)) {
        return String::new();
    }
    let cell = |length: &Result<Length, Absent>| match length {
        Ok(Length { mm, is_by_hand: true, .. }) => {
            format!("{}{}", Reliability::ByHand.sign(), cm(*mm))
        }
        Ok(length) => cm(length.mm),
        Err(_) => NOTHING.to_owned(),
    };
    let cells: String =
        feet.iter().flatten().map(|length| format!("{:>CELL$}", cell(length))).collect();
    let heads = format!("{:>CELL$}{:>CELL$}", "length cm", "breadth cm").repeat(sides.len());
    format!("  {:NAME$}{heads}\n  {:<NAME$}{cells}\n", "", "foot")
}

/// What people set in place of the scan's figures, a line for each measure.
fn by_hand(record: &Record, columns: usize) -> String {
    let lines = ReportContent::by_hand(record, Language::En);
    lines.iter().map(|line| indented(line, "  ", columns)).collect()
}

/// Girth and height of one level of one leg, with their uncertainties.
fn cells(measure: &Result<Measure<'_>, Absent>) -> String {
    let measure = match measure {
        Ok(measure) => measure,
        Err(absent) => return format!("{:>1$}", absent.words(Language::En), 2 * CELL),
    };
    let figure =
        |length: Length| format!("{}{}", measure.mark_of(length).sign(), with_margin(length));
    let height = measure.height.map_or(NOTHING.to_owned(), figure);
    format!("{:>CELL$}{height:>CELL$}", figure(measure.girth))
}

/// The same as [`cells`], for a requested height, which is exact.
fn at_cells(at: Option<&AtFigures>) -> String {
    let Some((at, girth_mm)) = at.and_then(|at| Some((at, at.girth_tape_mm?))) else {
        return format!("{:>1$}", Language::En.text("report.missing.level_absent"), 2 * CELL);
    };
    let mark = if at.doubts.is_empty() { Reliability::Sure } else { Reliability::Doubtful };
    let girth = with_margin(Length::scanned(girth_mm, at.girth_sd_mm));
    format!("{:>CELL$}{:>CELL$}", format!("{}{girth}", mark.sign()), cm(at.height_mm))
}

/// The findings in plain words: those of one code in a line, with the places that they are about.
fn findings(findings: &[FindingNote]) -> Vec<String> {
    let mut groups: Vec<Vec<&FindingNote>> = Vec::new();
    for finding in findings {
        let is_same =
            |of: &&FindingNote| of.code == finding.code && of.severity == finding.severity;
        match groups.iter_mut().find(|group| group.iter().any(is_same)) {
            Some(group) => group.push(finding),
            None => groups.push(vec![finding]),
        }
    }
    groups.iter().filter_map(|group| finding_text(group)).collect()
}

/// Findings of one code: `warning: Skin partly not seen, right C, B · left C [gap]`.
fn finding_text(group: &[&FindingNote]) -> Option<String> {
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
fn with_margin(Length { mm, sd_mm, .. }: Length) -> String {
    let margin = sd_mm.map_or(String::new(), |sd_mm| format!(" ±{:.1}", cm_margin(sd_mm)));
    format!("{}{margin}", cm(mm))
}

/// Millimetres in the clinic's unit: centimetres with one decimal.
fn cm(mm: f64) -> String {
    cm_words(mm, Language::En)
}
