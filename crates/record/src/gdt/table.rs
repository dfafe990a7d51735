//! The table of measures for people, in columns of fixed width, in German like the format.

use gaiter_language::Language;
use gaiter_leg::{Level, Side};

use super::words;
use crate::measure::{Absent, Length, Measure};
use crate::report::Reliability;
use crate::rounding::cm_words;
use crate::schema::Record;

/// Width of the column of level names, characters.
const NAME: usize = 4;

/// Width of a column of girths or heights, characters.
const CELL: usize = 10;

/// The marks before figures, as in the report, with what they mean.
const LEGEND: [(Reliability, &str); 3] = [
    (Reliability::ByHand, words::BY_HAND),
    (Reliability::Estimated, "geschätzt, nicht gemessen"),
    (Reliability::Doubtful, "zweifelhaft, bitte nachmessen"),
];

/// Instead of the height of a level on the foot.
const NO_HEIGHT: &str = "-";

/// The table, and what its marks mean if it has any. Empty without a leg.
pub(super) fn lines(record: &Record) -> Vec<String> {
    let sides: Vec<Side> = record.sides().collect();
    if sides.is_empty() {
        return Vec::new();
    }
    let row = |name: &str, cells: Vec<String>| format!("{name:<NAME$}{}", cells.concat());
    let heads = sides.iter().map(|side| format!("{:>1$}", words::side(*side), 2 * CELL));
    let columns = sides.iter().map(|_| format!("{:>CELL$}{:>CELL$}", "Umfang", "Höhe"));
    let mut lines = vec![row("[cm]", heads.collect()), row("", columns.collect())];
    let mut marks = Vec::new();
    for level in Level::ALL.into_iter().rev() {
        let measures: Vec<_> =
            sides.iter().map(|side| Measure::find(record, *side, level)).collect();
        marks.extend(measures.iter().flatten().flat_map(Measure::marks));
        lines.push(row(level.name(), measures.iter().map(cells).collect()));
    }
    let used = LEGEND.into_iter().filter(|(mark, _)| marks.contains(mark));
    lines.extend(used.map(|(mark, meaning)| format!("{} {meaning}", mark.sign())));
    lines
}

/// Girth and height of a level of one leg.
fn cells(measure: &Result<Measure<'_>, Absent>) -> String {
    let measure = match measure {
        Ok(measure) => measure,
        Err(absent) => return format!("{:>1$}", absent.words(Language::De), 2 * CELL),
    };
    let figure = |length: Length| {
        format!("{}{}", measure.mark_of(length).sign(), cm_words(length.mm, Language::De))
    };
    let height = measure.height.map_or(NO_HEIGHT.to_owned(), figure);
    format!("{:>CELL$}{height:>CELL$}", figure(measure.girth))
}
