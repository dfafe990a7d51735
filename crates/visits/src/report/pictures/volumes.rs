//! The volumes of both legs over the dates of the visits, with bars of uncertainty, and the phantom's mean
//! error below them. Lines break where figures mean something else.

use gaiter_leg::Side;
use gaiter_record::picture::figures::plot::{
    Frame, LINE, SMALL, Scale, heading, lines, range, words as label,
};
use gaiter_record::picture::{Anchor, Ink, Mark, Picture, Stroke};
use gaiter_record::rounding::number;
use jiff::Timestamp;

use super::super::words::Words;
use crate::quantity::Quantity;

/// Width and height, px.
const SIZE: [f64; 2] = [720.0, 392.0];

/// Left and right end of the dates, px.
const DATES_PX: [f64; 2] = [62.0, 690.0];

/// Bottom and top of the volumes, px.
const VOLUMES_PX: [f64; 2] = [250.0, 44.0];

/// Bottom and top of the phantom's errors, px.
const PHANTOM_PX: [f64; 2] = [362.0, 312.0];

/// The first and the last visit are so far inside, px.
const INSET_PX: f64 = 14.0;

/// The volumes span at least this share of their mean, so that little changes do not look large.
const SPAN_MIN_SHARE: f64 = 0.1;

/// About how many lines of volumes there are.
const ROWS: f64 = 6.0;

/// The phantom's errors span at least this, mm to either side.
const PHANTOM_MIN_MM: f64 = 1.0;

/// Dates nearer than this to the one before are not written, px.
const APART_PX: f64 = 74.0;

/// Half the width of the cap of a bar, px.
const CAP: f64 = 4.0;

/// Length of the dashes of the right leg's line, px.
const DASH: f64 = 6.0;

/// The right leg is drawn beside the left one by this, so that bars do not lie on each other, px.
const BESIDE_PX: f64 = 3.0;

/// A volume at a place of the scale of dates.
struct Point {
    x: f64,
    volume: Quantity,
}

/// The figure; `None` without volumes.
pub(super) fn picture(words: &Words) -> Option<Picture> {
    let places = places(words);
    let dates = Scale { range: [0.0, 1.0], px: [DATES_PX[0] + INSET_PX, DATES_PX[1] - INSET_PX] };
    let legs = Side::FROM_FRONT.map(|side| points(words, side, &places));
    let all = || legs.iter().flatten().flatten();
    let ends = all().flat_map(|of| {
        let half = of.volume.expanded();
        [of.volume.value - half, of.volume.value + half]
    });
    let [low, high] = range(ends, 1.0)?;
    let middle = f64::midpoint(low, high);
    let half = (high - low).max(SPAN_MIN_SHARE * middle) / 2.0;
    let step = step(2.0 * half / ROWS);
    let ends = [middle - half, middle + half];
    let volumes = Scale { range: range(ends.into_iter(), step)?, px: VOLUMES_PX };
    let frame = Frame { x: dates, y: volumes };
    let whole = Scale { range: [0.0, 1.0], px: DATES_PX };
    let mut marks = Frame { x: whole, y: volumes }.rows(step, |ml| number(ml, 0, words.language));
    marks.extend(titles(words));
    marks.extend(days(words, &places, &dates));
    marks.extend(breaks(words, &places, &dates));
    for (side, runs) in Side::FROM_FRONT.into_iter().zip(&legs) {
        marks.extend(runs.iter().flat_map(|run| leg(side, run, &frame)));
    }
    marks.extend(phantom(words, &places, dates));
    let title = words.text("visits.picture.volumes");
    let is_checked = words.course.visits.iter().any(|visit| visit.phantom_mm.is_some());
    let height = if is_checked { SIZE[1] } else { PHANTOM_PX[1] };
    Some(Picture { title, size: [SIZE[0], height], cuts: Vec::new(), marks })
}

/// Where the visits lie between the first and the last: by their times, or at equal distances if one has no
/// time.
fn places(words: &Words) -> Vec<f64> {
    let visits = &words.course.visits;
    let times: Option<Vec<Timestamp>> =
        visits.iter().map(|visit| Some(visit.acquired.as_ref()?.at)).collect();
    let last = visits.len().saturating_sub(1).max(1) as f64;
    let by_number = || (0..visits.len()).map(|at| at as f64 / last).collect();
    let Some(times) = times else { return by_number() };
    let seconds = |at: &Timestamp| at.as_second() as f64;
    match (times.first(), times.last()) {
        (Some(first), Some(end)) if end > first => {
            let whole = seconds(end) - seconds(first);
            times.iter().map(|at| (seconds(at) - seconds(first)) / whole).collect()
        }
        _ => by_number(),
    }
}

/// The volumes of a leg in runs of visits that can be compared: of one meaning, in one posture.
fn points(words: &Words, side: Side, places: &[f64]) -> Vec<Vec<Point>> {
    let course = words.course;
    let is_of_one_posture =
        |one: &usize, next: &usize| !course.visits[*one].is_of_other_posture(&course.visits[*next]);
    let runs = |group: &crate::course::Group| -> Vec<Vec<Point>> {
        let point = |visit: &usize| {
            Some(Point { x: places[*visit], volume: course.volume(group, *visit, side)? })
        };
        let runs = group.visits.chunk_by(is_of_one_posture);
        runs.map(|run| run.iter().filter_map(point).collect()).collect()
    };
    course.groups.iter().flat_map(runs).collect()
}

/// The next step of 1, 2 or 5 times a power of ten.
fn step(least: f64) -> f64 {
    let power = 10.0_f64.powf(least.max(1.0).log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|of| of * power).into_iter().find(|of| *of >= least).unwrap_or(least)
}

fn titles(words: &Words) -> Vec<Mark> {
    let above = VOLUMES_PX[1] - 26.0;
    let mut marks =
        vec![heading([4.0, above], Anchor::Start, Ink::Text, words.text("visits.picture.ml"))];
    let mut x = DATES_PX[1];
    for side in Side::BOTH {
        let name = words.leg(side);
        marks.push(heading([x, above], Anchor::End, Ink::of(side), name));
        x -= 150.0;
    }
    marks
}

/// The dates below the volumes; a date too near to the one before is only a line.
fn days(words: &Words, places: &[f64], dates: &Scale) -> Vec<Mark> {
    let [bottom, _] = VOLUMES_PX;
    let mut marks = Vec::new();
    let mut before = f64::NEG_INFINITY;
    let last = places.len().saturating_sub(1);
    for (visit, place) in places.iter().enumerate() {
        let x = dates.at(*place);
        marks.push(lines(vec![vec![[x, bottom], [x, bottom + 4.0]]], Ink::Muted, 1.0));
        let is_before_last = visit != last && dates.at(places[last]) - x < APART_PX;
        if x - before < APART_PX || is_before_last {
            continue;
        }
        before = x;
        let anchor = match visit {
            0 => Anchor::Start,
            _ if visit == last => Anchor::End,
            _ => Anchor::Middle,
        };
        marks.push(label([x, bottom + LINE + 4.0], anchor, SMALL, Ink::Muted, words.day(visit)));
    }
    marks
}

/// Lines between visits that cannot be compared.
fn breaks(words: &Words, places: &[f64], dates: &Scale) -> Vec<Mark> {
    let ends = words.course.groups.windows(2).filter_map(|pair| {
        let (last, first) = (*pair[0].visits.last()?, *pair[1].visits.first()?);
        Some(dates.at(f64::midpoint(places[last], places[first])))
    });
    let [bottom, top] = VOLUMES_PX;
    let line = |x: f64| Mark::Lines {
        lines: vec![vec![[x, bottom], [x, top]]],
        is_closed: false,
        fill: None,
        stroke: Stroke::dashed(Ink::Text, 1.0, 3.0),
    };
    let name = |x: f64| {
        label([x, top - 6.0], Anchor::Middle, SMALL, Ink::Text, words.text("visits.picture.break"))
    };
    ends.flat_map(|x| [line(x), name(x)]).collect()
}

/// The line of a leg, and a bar at each visit: thin for the whole uncertainty, thick for what is of single
/// girths.
fn leg(side: Side, run: &[Point], frame: &Frame) -> Vec<Mark> {
    let ink = Ink::of(side);
    let aside = if side == Side::Right { -BESIDE_PX } else { BESIDE_PX };
    let at = |of: &Point, ml: f64| {
        let [x, y] = frame.at([of.x, ml]);
        [x + aside, y]
    };
    let line: Vec<[f64; 2]> = run.iter().map(|of| at(of, of.volume.value)).collect();
    let bar = |of: &Point, half: f64| {
        vec![at(of, of.volume.value - half), at(of, of.volume.value + half)]
    };
    let whole: Vec<Vec<[f64; 2]>> = run
        .iter()
        .flat_map(|of| {
            let bar = bar(of, of.volume.expanded());
            let cap = |[x, y]: [f64; 2]| vec![[x - CAP, y], [x + CAP, y]];
            let caps = [cap(bar[0]), cap(bar[1])];
            std::iter::once(bar).chain(caps)
        })
        .collect();
    let random = run.iter().map(|of| {
        let parts = crate::quantity::Parts { random: of.volume.parts.random, ..Default::default() };
        bar(of, Quantity { parts, ..of.volume }.expanded())
    });
    let stroke = match side {
        Side::Left => Stroke::of(ink, 2.0),
        Side::Right => Stroke::dashed(ink, 2.0, DASH),
    };
    vec![
        lines(whole, ink, 1.0),
        lines(random.collect(), ink, 4.0),
        Mark::Lines { lines: vec![line.clone()], is_closed: false, fill: None, stroke },
        Mark::Dots { at: line, radius: 3.5, fill: Some(ink), stroke: None },
    ]
}

/// The phantom's mean error before each visit.
fn phantom(words: &Words, places: &[f64], dates: Scale) -> Vec<Mark> {
    let visits = places.iter().zip(&words.course.visits);
    let errors: Vec<[f64; 2]> =
        visits.filter_map(|(place, visit)| Some([*place, visit.phantom_mm?])).collect();
    let most = errors.iter().map(|[_, mm]| mm.abs()).fold(PHANTOM_MIN_MM, f64::max).ceil();
    let frame = Frame { x: dates, y: Scale { range: [-most, most], px: PHANTOM_PX } };
    let above = PHANTOM_PX[1] - 14.0;
    let name = match errors.is_empty() {
        true => words.text("visits.picture.no_phantom"),
        false => words.text("visits.picture.phantom"),
    };
    let mut marks = vec![heading([4.0, above], Anchor::Start, Ink::Text, name)];
    if !errors.is_empty() {
        marks.extend(frame.rows(most, |mm| number(mm, 0, words.language)));
        let line: Vec<[f64; 2]> = errors.iter().map(|of| frame.at(*of)).collect();
        marks.push(lines(vec![line.clone()], Ink::Muted, 1.0));
        marks.push(Mark::Dots { at: line, radius: 3.0, fill: Some(Ink::Muted), stroke: None });
    }
    marks
}
