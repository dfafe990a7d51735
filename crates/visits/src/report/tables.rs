//! The tables of a report of visits.

use std::fmt::Display;

use gaiter_leg::levels::at_height::PROFILE_STEP_MM;
use gaiter_leg::{Level, Side};
use gaiter_record::report::content::{Table, TableRow};
use gaiter_record::report::{Figure, Mark};
use gaiter_record::rounding::{cm_words, ml_margin, number, signed, tenths_words};

use super::summary::between;
use super::words::Words;
use crate::comparison::{Comparison, PlaceChange};
use crate::course::{Affected, Group};
use crate::place::{Step, along_mm};
use crate::quantity::{Change, Quantity, Shown};

/// Behind the time of a visit at another time of day than the last one.
const OTHER_TIME: &str = " †";

/// All visits, newest first: conditions, volumes, excess or difference.
pub(super) fn visits(words: &Words) -> Table {
    let legs = Side::FROM_FRONT
        .map(|side| words.filled("visits.column.volume", &[("leg", &words.leg_in_sentence(side))]));
    let [right, left] = legs;
    let columns = ["visits.column.visit", "visits.column.posture", "visits.column.phantom"];
    let columns = columns.map(|key| words.text(key)).into_iter();
    let course = words.course;
    let row = |visit: usize| {
        let of = &course.visits[visit];
        let group = course.groups.iter().find(|group| group.visits.contains(&visit));
        let phantom = of.phantom_mm.map_or_else(
            || Figure { value: words.text("visits.no_phantom"), margin: None, mark: Mark::Missing },
            |mm| plain(signed(mm, &tenths_words(mm, words.language))),
        );
        let volume = |side: Side| match group.and_then(|of| course.volume(of, visit, side)) {
            Some(volume) => ml(words, &volume),
            None => missing(words),
        };
        let [right, left] = Side::FROM_FRONT.map(volume);
        let apart = group.and_then(|group| apart(words, group, visit));
        let apart = apart.unwrap_or_else(|| missing(words));
        let figures = vec![plain(words.posture(of)), phantom, right, left, apart];
        let other_time = group.and_then(|group| course.other_time_of_day(group, visit));
        let sign = if other_time.is_some() { OTHER_TIME } else { "" };
        TableRow { head: words.time(of) + sign, figures }
    };
    Table {
        title: words.text("visits.all"),
        explanation: Some(words.text("visits.all_explained")),
        columns: columns.chain([right, left, words.text(apart_column(words))]).collect(),
        rows: (0..course.visits.len()).rev().map(row).collect(),
    }
}

/// The heading of what the legs differ by.
fn apart_column(words: &Words) -> &'static str {
    match words.course.choice.affected {
        Some(Affected::One(_)) => "visits.column.excess",
        Some(Affected::Both | Affected::Neither) | None => "visits.column.difference",
    }
}

/// The excess of the affected leg at a visit; without one, the difference of the legs.
fn apart(words: &Words, group: &Group, visit: usize) -> Option<Figure> {
    let course = words.course;
    let Some(Affected::One(_)) = course.choice.affected else {
        return Some(ml_apart(words, &course.left_minus_right(group, visit)?));
    };
    let excess = course.excess(group, visit)?;
    let percent = words.percent_change(excess.percent);
    Some(plain(format!("{} ({percent} %)", words.ml_change(excess.ml.value))))
}

/// Volumes and excess at the two visits of a comparison.
pub(super) fn volumes(words: &Words, group: &Group, of: &Comparison) -> Table {
    let columns = ["subject", "earlier", "later", "change", "percent", "detectable", "shown"];
    let mut columns: Vec<String> =
        columns.iter().map(|key| words.of_code("visits.column", key, &[])).collect();
    [columns[1], columns[2]] = words.days(of);
    let leg = |side: Side| {
        let change = of.legs.get(side).as_ref()?.volume?;
        let at = |visit: usize| words.course.volume(group, visit, side);
        let figures = changed(words, [at(of.earlier)?, at(of.later)?], &change);
        Some(TableRow { head: words.leg(side).to_owned(), figures })
    };
    let apart = || match &of.excess {
        Some(excess) => {
            let side = words.language.word("leg.only", excess.later.affected.word());
            let head = words.filled("visits.excess_of", &[("side", &side)]);
            let volumes = [excess.earlier.ml, excess.later.ml];
            Some(TableRow { head, figures: changed_apart(words, volumes, &excess.change) })
        }
        None => {
            let at = |visit: usize| words.course.left_minus_right(group, visit);
            let volumes = [at(of.earlier)?, at(of.later)?];
            let head = words.text("visits.difference_of");
            let figures = changed_apart(words, volumes, of.left_minus_right.as_ref()?);
            Some(TableRow { head, figures })
        }
    };
    Table {
        title: words.filled("visits.volumes", &[("between", &between(words, of))]),
        explanation: None,
        columns,
        rows: Side::FROM_FRONT.into_iter().filter_map(leg).chain(apart()).collect(),
    }
}

fn changed(words: &Words, ends: [Quantity; 2], change: &Change) -> Vec<Figure> {
    let mark = mark(change.shown());
    let told = words.told(ends.map(|of| of.value), change);
    let [percent, percent_detectable] = words.told_percent(change);
    let [before, after] = ends.map(|of| Figure {
        value: number(of.value, told.decimals, words.language),
        ..ml(words, &of)
    });
    vec![
        before,
        after,
        Figure { value: told.change, margin: None, mark },
        Figure { value: percent, margin: None, mark },
        plain(format!("{} ({percent_detectable} %)", told.detectable)),
        plain(words.language.word("visits.shown", change.shown().word()).to_owned()),
    ]
}

/// The change of what the legs differ by. Its percent change is not told: that of an excess has a name of its own,
/// and a difference may be nothing.
fn changed_apart(words: &Words, ends: [Quantity; 2], change: &Change) -> Vec<Figure> {
    let mark = mark(change.shown());
    let told = words.told(ends.map(|of| of.value), change);
    let [before, after] =
        ends.map(|of| Figure { value: words.ml_apart(of.value, told.decimals), ..ml(words, &of) });
    vec![
        before,
        after,
        Figure { value: told.change, margin: None, mark },
        missing(words),
        plain(told.detectable),
        plain(words.language.word("visits.shown", change.shown().word()).to_owned()),
    ]
}

/// Girths of a leg at fixed places, highest first, at the visits beside each other; and their changes.
pub(super) fn girths(
    words: &Words,
    side: Side,
    shown: &[usize],
    compared: &[Comparison],
) -> Option<Table> {
    let girth = |visit: usize, step: Step| {
        let leg = words.course.visits[visit].legs.get(side).as_ref()?;
        let place = leg.places.get(&step)?;
        let mark = if place.is_doubtful { Mark::Doubtful } else { Mark::Sure };
        Some(Figure { value: cm_words(place.girth_mm, words.language), margin: None, mark })
    };
    let title = words.filled("visits.girths", &[("leg", &words.leg(side))]);
    let cell = |visit, step| girth(visit, step);
    let change = |change: &Change| {
        let value = signed(change.by, &cm_words(change.by, words.language));
        Figure { value, margin: None, mark: mark(change.shown()) }
    };
    let of = |of: &Comparison| of.legs.get(side).as_ref().map(|leg| leg.girths.clone());
    let changes: Vec<Vec<PlaceChange>> = compared.iter().filter_map(of).collect();
    let place = |step: Step| number(along_mm(step) / 10.0, 0, words.language);
    places(words, title, shown, &changes, compared, (&cell, &change, &place))
}

/// The volumes of the pieces of a leg, highest first.
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
        let mark = if is_doubtful { Mark::Doubtful } else { Mark::Sure };
        Some(Figure { value: number(piece.ml, 0, words.language), margin: None, mark })
    };
    let title = words.filled("visits.slices", &[("leg", &words.leg(side))]);
    let change = |change: &Change| Figure {
        value: words.ml_change(change.by),
        margin: None,
        mark: mark(change.shown()),
    };
    let of = |of: &Comparison| of.legs.get(side).as_ref().map(|leg| leg.pieces.clone());
    let changes: Vec<Vec<PlaceChange>> = compared.iter().filter_map(of).collect();
    let place = |step: Step| {
        let cm = |mm: f64| number(mm / 10.0, 0, words.language);
        format!("{}–{}", cm(along_mm(step)), cm(along_mm(step) + PROFILE_STEP_MM))
    };
    places(words, title, shown, &changes, compared, (&cell, &change, &place))
}

/// What a table of places shows: a figure of a visit, a change, the name of a place.
type Cells<'a> = (
    &'a dyn Fn(usize, Step) -> Option<Figure>,
    &'a dyn Fn(&Change) -> Figure,
    &'a dyn Fn(Step) -> String,
);

/// A table with a row for each place. `None` if no change can be told.
fn places(
    words: &Words,
    title: String,
    shown: &[usize],
    changes: &[Vec<PlaceChange>],
    compared: &[Comparison],
    (cell, change, place): Cells<'_>,
) -> Option<Table> {
    let all = changes.iter().flatten().map(|of| of.step);
    let steps: std::collections::BTreeSet<Step> = all.collect();
    let mut columns = vec![words.text("visits.column.place")];
    columns.extend(shown.iter().map(|visit| words.day(*visit)));
    columns.extend(compared.iter().map(|of| {
        let [earlier, _] = words.days(of);
        words.filled("visits.column.since", &[("date", &earlier)])
    }));
    let row = |step: Step| {
        let figures =
            shown.iter().map(|visit| cell(*visit, step).unwrap_or_else(|| missing(words)));
        let changes = changes.iter().map(|of| {
            let found = of.iter().find(|of| of.step == step);
            found.map_or_else(|| missing(words), |of| doubted(change(&of.change), of.is_doubtful))
        });
        TableRow { head: place(step), figures: figures.chain(changes).collect() }
    };
    (!steps.is_empty()).then(|| Table {
        title,
        explanation: Some(words.text("visits.bold")),
        columns,
        rows: steps.into_iter().rev().map(row).collect(),
    })
}

/// The girths at the levels, which are found anew at each visit, of both legs beside each other.
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
                Figure { value, margin: None, mark: of.mark }
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
    (!rows.is_empty()).then(|| Table {
        title: words.text("visits.levels"),
        explanation: Some(words.text("visits.levels_explained")),
        columns: [words.text("visits.column.level")].into_iter().chain(days).collect(),
        rows,
    })
}

fn ml(words: &Words, of: &Quantity) -> Figure {
    Figure {
        value: number(of.value, 0, words.language),
        margin: Some(number(ml_margin(of.parts.total()), 0, words.language)),
        mark: Mark::Sure,
    }
}

/// A volume by which the legs differ, with its sign.
fn ml_apart(words: &Words, of: &Quantity) -> Figure {
    Figure { value: words.ml_change(of.value), ..ml(words, of) }
}

fn mark(shown: Shown) -> Mark {
    match shown {
        Shown::NoChange => Mark::Sure,
        Shown::Larger | Shown::Smaller => Mark::Real,
    }
}

/// A change with the sign of doubt beside what it shows.
fn doubted(figure: Figure, is_doubtful: bool) -> Figure {
    let sign = if is_doubtful { " ?" } else { "" };
    Figure { value: figure.value + sign, ..figure }
}

fn plain(value: String) -> Figure {
    Figure { value, margin: None, mark: Mark::Sure }
}

fn missing(words: &Words) -> Figure {
    Figure { value: words.text("visits.missing"), margin: None, mark: Mark::Missing }
}
