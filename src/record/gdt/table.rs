//! The table of measures for people, in columns of fixed width, in German like the format.

use super::words;
use crate::language::Language;
use crate::leg::{Level, Side};
use crate::record::measure::Measure;
use crate::record::report::Mark;
use crate::record::rounding::cm_words;
use crate::record::schema::{LegFigures, Record};

/// Width of the column of level names, characters.
const NAME: usize = 4;

/// Width of a column of girths or heights, characters.
const CELL: usize = 10;

/// The marks before figures, as in the report, with what they mean.
const LEGEND: [(Mark, &str); 2] = [
    (Mark::Estimated, "geschätzt, nicht gemessen"),
    (Mark::Doubtful, "zweifelhaft, bitte nachmessen"),
];

/// Instead of the height of a level on the foot.
const NO_HEIGHT: &str = "-";

/// The measured legs, each with its side, in the order of the measuring sheet.
pub(super) fn legs(record: &Record) -> impl Iterator<Item = (&LegFigures, Side)> {
    Side::FROM_FRONT.into_iter().filter_map(|side| Some((record.leg(side)?, side)))
}

/// The table, and what its marks mean if it has any. Empty without a leg.
pub(super) fn lines(record: &Record) -> Vec<String> {
    let legs: Vec<(&LegFigures, Side)> = legs(record).collect();
    if legs.is_empty() {
        return Vec::new();
    }
    let row = |name: &str, cells: Vec<String>| format!("{name:<NAME$}{}", cells.concat());
    let sides = legs.iter().map(|(_, side)| format!("{:>1$}", words::side(*side), 2 * CELL));
    let columns = legs.iter().map(|_| format!("{:>CELL$}{:>CELL$}", "Umfang", "Höhe"));
    let mut lines = vec![row("[cm]", sides.collect()), row("", columns.collect())];
    let mut marks = Vec::new();
    for level in Level::ALL.into_iter().rev() {
        let measures: Vec<_> = legs.iter().map(|(leg, _)| Measure::of(leg, level)).collect();
        marks.extend(measures.iter().flatten().map(Measure::mark));
        lines.push(row(level.name(), measures.iter().map(cells).collect()));
    }
    let used = LEGEND.into_iter().filter(|(mark, _)| marks.contains(mark));
    lines.extend(used.map(|(mark, meaning)| format!("{} {meaning}", mark.sign())));
    lines
}

/// Girth and height of a level of one leg.
fn cells(measure: &Option<Measure<'_>>) -> String {
    let Some(measure) = measure else {
        return format!("{:>1$}", Language::De.text("report.missing.level_absent"), 2 * CELL);
    };
    let figure = |mm: f64| format!("{}{}", measure.mark().sign(), cm_words(mm, Language::De));
    let height = measure.height.map_or(NO_HEIGHT.to_owned(), |height| figure(height.mm));
    format!("{:>CELL$}{height:>CELL$}", figure(measure.girth.mm))
}
