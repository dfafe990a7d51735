//! The tables of a report of visits.

use std::collections::BTreeSet;
use std::fmt::Display;

use gaiter_leg::levels::at_height::PROFILE_STEP_MM;
use gaiter_leg::{Level, Side};
use gaiter_record::report::content::{Table, TableRow};
use gaiter_record::report::{Reliability, ReportFigure};
use gaiter_record::rounding::{cm_words, number, signed, tenths_words};

use super::summary::{between, cancelling};
use super::words::Words;
use crate::comparison::{Comparison, PlaceChange};
use crate::course::{Affected, Group};
use crate::place::{Step, along_mm};
use crate::quantity::{Change, Quantity, Shown};

/// Behind the time of a visit at another time of day than the last one.
const OTHER_TIME: &str = " †";

/// Behind a change beside a girth in doubt.
const DOUBT: &str = " ?";

/// All visits, newest first: conditions, volumes, excess or difference.
pub(super) fn visits(words: &Words) -> Table {
    let legs = Side::FROM_FRONT
        .map(|side| words.filled("visits.column.volume", &[("leg", &words.leg_in_sentence(side))]));
    let [right, left] = legs;
    let columns = ["visits.column.visit", "visits.column.posture", "visits.column.phantom"];
    let columns = columns.map(|key| words.text(key)).into_iter();
    let rows: Vec<TableRow> =
        (0..words.course.visits.len()).rev().map(|visit| visit_row(words, visit)).collect();
    Table {
        title: words.text("visits.all"),
        explanation: Some(all_explained(words, &rows)),
        columns: columns.chain([right, left, words.text(apart_column(words))]).collect(),
        rows,
        below: Some(words.text("visits.rounded")),
    }
}

/// The conditions and volumes of a visit.
fn visit_row(words: &Words, visit: usize) -> TableRow {
    let course = words.course;
    let of = &course.visits[visit];
    let group = course.groups.iter().find(|group| group.visits.contains(&visit));
    let phantom = of.phantom_mm.map_or_else(
        || ReportFigure::missing(words.language.text("visits.no_phantom")),
        |mm| ReportFigure::plain(signed(mm, &tenths_words(mm, words.language))),
    );
    let volume = |side: Side| match group.and_then(|of| course.volume(of, visit, side)) {
        Some(volume) => ml(words, &volume),
        None => missing(words),
    };
    let [right, left] = Side::FROM_FRONT.map(volume);
    let apart = group.and_then(|group| apart(words, group, visit));
    let apart = apart.unwrap_or_else(|| missing(words));
    let figures = vec![ReportFigure::plain(words.posture(of)), phantom, right, left, apart];
    let other_time = group.and_then(|group| course.other_time_of_day(group, visit));
    let sign = if other_time.is_some() { OTHER_TIME } else { "" };
    TableRow { head: words.time(of) + sign, figures }
}

/// How to read the table of all visits: what occurs in it.
fn all_explained(words: &Words, rows: &[TableRow]) -> String {
    let visits = &words.course.visits;
    let is_checked = visits.iter().any(|visit| visit.phantom_mm.is_some());
    let is_excess = matches!(words.course.choice.affected, Some(Affected::One(_)));
    let is_other_time = rows.iter().any(|row| row.head.ends_with(OTHER_TIME));
    words.joined(&[
        (is_checked, "visits.all_phantom"),
        (true, "visits.all_volumes"),
        (is_excess, "visits.all_excess"),
        (is_other_time, "visits.other_time"),
    ])
}

/// The heading of what the legs differ by.
fn apart_column(words: &Words) -> &'static str {
    match words.course.choice.affected {
        Some(Affected::One(_)) => "visits.column.excess",
        Some(Affected::Both | Affected::Neither) | None => "visits.column.difference",
    }
}

/// The excess of the affected leg at a visit; without one, the difference of the legs.
fn apart(words: &Words, group: &Group, visit: usize) -> Option<ReportFigure> {
    let course = words.course;
    let Some(Affected::One(_)) = course.choice.affected else {
        return Some(ml_apart(words, &course.left_minus_right(group, visit)?));
    };
    let excess = course.excess(group, visit)?;
    let percent = words.percent_change(excess.percent);
    Some(ReportFigure::plain(format!("{} ({percent} %)", words.ml_change(excess.ml.value))))
}

/// Volumes and excess at the two visits of a comparison.
pub(super) fn volumes(words: &Words, group: &Group, of: &Comparison) -> Table {
    let columns = ["subject", "earlier", "later", "change", "percent", "detectable", "shown"];
    let mut columns: Vec<String> =
        columns.iter().map(|key| words.language.word("visits.column", key).to_owned()).collect();
    [columns[1], columns[2]] = words.days(of);
    let leg = |side: Side| {
        let change = of.volume(side)?;
        let at = |visit: usize| words.course.volume(group, visit, side);
        let ends = [at(of.earlier)?, at(of.later)?].map(|of| ml(words, &of));
        let [percent, percent_detectable] = words.printed_percent(&change);
        let percent = ReportFigure::marked(percent, mark(change.shown()));
        let beside = format!(" ({percent_detectable} %)");
        let head = words.leg(side).to_owned();
        Some(TableRow { head, figures: changed(words, ends, &change, percent, &beside) })
    };
    let apart = volumes_apart(words, group, of);
    let rows: Vec<TableRow> = Side::FROM_FRONT.into_iter().filter_map(leg).chain(apart).collect();
    let below = [Some(words.text("visits.rounded")), cancelling(words, of)];
    Table {
        title: words.filled("visits.volumes", &[("between", &between(words, of))]),
        explanation: None,
        columns,
        rows,
        below: Some(below.into_iter().flatten().collect::<Vec<_>>().join(" ")),
    }
}

/// The legs' difference at the two visits of a comparison. Its percent change is not reported: that of an excess has
/// a name of its own, and a difference may be zero.
fn volumes_apart(words: &Words, group: &Group, of: &Comparison) -> Option<TableRow> {
    let (head, ends, change) = match &of.excess {
        Some(excess) => {
            let side = words.language.word("leg.only", excess.later.affected.word());
            let head = words.filled("visits.excess_of", &[("side", &side)]);
            (head, [excess.earlier.ml, excess.later.ml], excess.change)
        }
        None => {
            let at = |visit: usize| words.course.left_minus_right(group, visit);
            let ends = [at(of.earlier)?, at(of.later)?];
            (words.text("visits.difference_of"), ends, of.left_minus_right?)
        }
    };
    let ends = ends.map(|of| ml_apart(words, &of));
    Some(TableRow { head, figures: changed(words, ends, &change, missing(words), "") })
}

/// The figures of a change: before, after, the change, its percentage, and from where on it can be shown with what
/// stands behind that.
fn changed(
    words: &Words,
    [before, after]: [ReportFigure; 2],
    change: &Change,
    percent: ReportFigure,
    beside: &str,
) -> Vec<ReportFigure> {
    let [printed, detectable] = words.printed(change);
    vec![
        before,
        after,
        ReportFigure::marked(printed, mark(change.shown())),
        percent,
        ReportFigure::plain(detectable + beside),
        ReportFigure::plain(words.language.word("visits.shown", change.shown().word()).to_owned()),
    ]
}

/// Girths of a leg at fixed places, highest first, at the visits beside each other; and their changes.
pub(super) fn girths(
    words: &Words,
    side: Side,
    shown: &[usize],
    compared: &[Comparison],
) -> Option<Table> {
    let cell = |visit: usize, step: Step| {
        let leg = words.course.visits[visit].legs.get(side).as_ref()?;
        let place = leg.places.get(&step)?;
        let mark = if place.is_doubtful { Reliability::Doubtful } else { Reliability::Sure };
        Some(ReportFigure::marked(cm_words(place.girth_mm, words.language), mark))
    };
    let change = |change: &Change| {
        let value = signed(change.by, &cm_words(change.by, words.language));
        ReportFigure::marked(value, mark(change.shown()))
    };
    let place = |step: Step| number(along_mm(step) / 10.0, 0, words.language);
    let changes: Vec<&[PlaceChange]> = compared.iter().map(|of| of.girths(side)).collect();
    let steps: BTreeSet<Step> = changes.iter().copied().flatten().map(|of| of.step).collect();
    let rows = places(words, &steps, shown, &changes, (&cell, &change, &place));
    let title = words.filled("visits.girths", &[("leg", &words.leg(side))]);
    (!steps.is_empty()).then(|| table_of_places(words, title, shown, compared, rows))
}

/// The volumes of the pieces of a leg that count for its volume, highest first, and their sums: the volume and its
/// changes.
pub(super) fn slices(
    words: &Words,
    group: &Group,
    side: Side,
    shown: &[usize],
    compared: &[Comparison],
) -> Option<Table> {
    let cell = |visit: usize, step: Step| {
        let leg = words.course.visits[visit].legs.get(side).as_ref()?;
        let piece = *leg.pieces(group.volume).get(&step)?;
        let mut ends = [step, step + 1].into_iter().filter_map(|end| leg.places.get(&end));
        let is_doubtful = ends.any(|place| place.is_doubtful);
        let mark = if is_doubtful { Reliability::Doubtful } else { Reliability::Sure };
        Some(ReportFigure::marked(number(piece.ml, 0, words.language), mark))
    };
    let change =
        |change: &Change| ReportFigure::marked(words.ml_change(change.by), mark(change.shown()));
    let place = |step: Step| {
        let cm = |mm: f64| number(mm / 10.0, 0, words.language);
        format!("{}–{}", cm(along_mm(step)), cm(along_mm(step) + PROFILE_STEP_MM))
    };
    let changes: Vec<&[PlaceChange]> = compared.iter().map(|of| of.pieces(side)).collect();
    let steps = group.pieces.get(side);
    let mut rows = places(words, steps, shown, &changes, (&cell, &change, &place));
    rows.push(sums(words, group, side, shown, compared));
    let title = words.filled("visits.slices", &[("leg", &words.leg(side))]);
    let is_compared = changes.iter().any(|of| !of.is_empty());
    is_compared.then(|| table_of_places(words, title, shown, compared, rows))
}

/// The sums of the slices of a leg, as in the tables of volumes. Slices that are not compared count.
fn sums(
    words: &Words,
    group: &Group,
    side: Side,
    shown: &[usize],
    compared: &[Comparison],
) -> TableRow {
    let of_visit = |visit: &usize| match words.course.volume(group, *visit, side) {
        Some(volume) => ReportFigure::plain(number(volume.value, 0, words.language)),
        None => missing(words),
    };
    let of_change = |of: &Comparison| match of.volume(side) {
        Some(change) => {
            let [printed, _] = words.printed(&change);
            ReportFigure::marked(printed, mark(change.shown()))
        }
        None => missing(words),
    };
    let figures = shown.iter().map(of_visit).chain(compared.iter().map(of_change)).collect();
    TableRow { head: words.text("visits.sum"), figures }
}

/// What a table of places shows: a figure of a visit, a change, the name of a place.
type Cells<'a> = (
    &'a dyn Fn(usize, Step) -> Option<ReportFigure>,
    &'a dyn Fn(&Change) -> ReportFigure,
    &'a dyn Fn(Step) -> String,
);

/// A row for each place, highest first: the figures of the visits, and the changes of each comparison.
fn places(
    words: &Words,
    steps: &BTreeSet<Step>,
    shown: &[usize],
    changes: &[&[PlaceChange]],
    (cell, change, place): Cells<'_>,
) -> Vec<TableRow> {
    let row = |step: &Step| {
        let figures =
            shown.iter().map(|visit| cell(*visit, *step).unwrap_or_else(|| missing(words)));
        let changes = changes.iter().map(|of| {
            let found = of.iter().find(|of| of.step == *step);
            found.map_or_else(|| missing(words), |of| doubted(change(&of.change), of.is_doubtful))
        });
        TableRow { head: place(*step), figures: figures.chain(changes).collect() }
    };
    steps.iter().rev().map(row).collect()
}

/// A table with rows of places, and how to read what occurs in it.
fn table_of_places(
    words: &Words,
    title: String,
    shown: &[usize],
    compared: &[Comparison],
    rows: Vec<TableRow>,
) -> Table {
    let mut columns = vec![words.text("visits.column.place")];
    columns.extend(shown.iter().map(|visit| words.day(*visit)));
    columns.extend(compared.iter().map(|of| {
        let [earlier, _] = words.days(of);
        words.filled("visits.column.since", &[("date", &earlier)])
    }));
    let explanation = words.joined(&[
        (true, "visits.lengths"),
        (has(&rows, |of| of.mark == Reliability::Real), "visits.bold"),
        (has(&rows, is_doubtful), "visits.doubtful"),
        (has(&rows, |of| of.mark == Reliability::Missing), "visits.not_compared"),
    ]);
    let below = Some(words.text("visits.rounded"));
    Table { title, explanation: Some(explanation), columns, rows, below }
}

/// The girths at the levels, which are found again at each visit, of both legs beside each other.
pub(super) fn levels(words: &Words, shown: &[usize]) -> Option<Table> {
    let row = |(side, level): (Side, Level)| {
        let of = |visit: usize| {
            let levels = words.course.visits[visit].levels.get(side);
            levels.iter().find(|of| of.level == level)
        };
        let figure = |visit: &usize| match of(*visit) {
            None => missing(words),
            Some(of) => {
                let girth = cm_words(of.girth_mm, words.language);
                let height = of.height_mm.map(|mm| format!(" / {}", cm_words(mm, words.language)));
                let value = girth + &height.unwrap_or_default();
                ReportFigure::marked(value, of.mark)
            }
        };
        let values: [(&str, &dyn Display); 2] =
            [("level", &level.name()), ("leg", &words.language.word("leg.only", side.word()))];
        let is_any = shown.iter().any(|visit| of(*visit).is_some());
        is_any.then(|| TableRow {
            head: words.filled("visits.level", &values),
            figures: shown.iter().map(figure).collect(),
        })
    };
    let all = Side::FROM_FRONT
        .into_iter()
        .flat_map(|side| Level::ALL.into_iter().rev().map(move |level| (side, level)));
    let rows: Vec<TableRow> = all.filter_map(row).collect();
    let days = shown.iter().map(|visit| words.day(*visit));
    let explanation = words.joined(&[
        (true, "visits.levels_explained"),
        (has(&rows, is_doubtful), "visits.doubtful"),
        (has(&rows, |of| of.mark == Reliability::Estimated), "visits.estimated"),
        (has(&rows, |of| of.mark == Reliability::ByHand), "visits.by_hand"),
        (has(&rows, |of| of.mark == Reliability::Missing), "visits.not_found"),
    ]);
    (!rows.is_empty()).then(|| Table {
        title: words.text("visits.levels"),
        explanation: Some(explanation),
        columns: [words.text("visits.column.level")].into_iter().chain(days).collect(),
        rows,
        below: None,
    })
}

/// Whether a figure of these rows is such a one.
fn has(rows: &[TableRow], is_such: impl Fn(&ReportFigure) -> bool) -> bool {
    rows.iter().flat_map(|row| &row.figures).any(is_such)
}

fn is_doubtful(of: &ReportFigure) -> bool {
    of.mark == Reliability::Doubtful || of.value.ends_with(DOUBT)
}

fn ml(words: &Words, of: &Quantity) -> ReportFigure {
    ReportFigure::ml(of.value, Some(of.sd), words.language)
}

/// A volume by which the legs differ, with its sign.
fn ml_apart(words: &Words, of: &Quantity) -> ReportFigure {
    ReportFigure { value: words.ml_change(of.value), ..ml(words, of) }
}

fn mark(shown: Shown) -> Reliability {
    match shown {
        Shown::NoChange => Reliability::Sure,
        Shown::Larger | Shown::Smaller => Reliability::Real,
    }
}

/// A change with the sign of doubt beside what it shows.
fn doubted(figure: ReportFigure, is_doubtful: bool) -> ReportFigure {
    let sign = if is_doubtful { DOUBT } else { "" };
    ReportFigure { value: figure.value + sign, ..figure }
}

fn missing(words: &Words) -> ReportFigure {
    ReportFigure::missing(words.language.text("visits.missing"))
}
