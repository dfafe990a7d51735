//! The volumes of both legs over the dates of the visits, beside them what the legs differ by on a scale of its own,
//! with bars of uncertainty, and the phantom's mean error below them. Lines break where figures mean something else.

use gaiter_leg::Side;
use gaiter_record::picture::figures::plot::{
    Frame, LINE, SMALL, Scale, heading, lines, range, small_text, stroked, text_mark,
};
use gaiter_record::picture::{Anchor, Ink, Mark, Picture, Stroke};
use gaiter_record::rounding::{number, signed};
use jiff::Timestamp;

use super::super::words::Words;
use crate::course::{Affected, Group};
use crate::quantity::Quantity;

/// Width, px.
const WIDTH: f64 = 720.0;

/// Left and right end of the dates below the volumes, and below what the legs differ by, px.
const PANELS_PX: [[f64; 2]; 2] = [[50.0, 346.0], [422.0, 706.0]];

/// Where a narrow screen may cut between the two, px.
const CUT_PX: f64 = 366.0;

/// Bottom and top of the volumes, px.
const VOLUMES_PX: [f64; 2] = [200.0, 40.0];

/// Bottom and top of the phantom's errors, px.
const PHANTOM_PX: [f64; 2] = [286.0, 252.0];

/// Height with the phantom's errors, and without any, px.
const HEIGHTS: [f64; 2] = [298.0, 248.0];

/// The first and the last visit are so far inside, px.
const INSET_PX: f64 = 14.0;

/// The volumes span at least this share of their mean, so that little changes do not look large.
const SPAN_MIN_SHARE: f64 = 0.1;

/// What the legs differ by spans at least this, mL, for the same reason: a few times what can be shown of it.
const SPAN_APART_MIN_ML: f64 = 60.0;

/// About how many lines of volumes there are.
const ROWS: f64 = 5.0;

/// The phantom's errors span at least this, mm to either side.
const PHANTOM_MIN_MM: f64 = 1.0;

/// Dates nearer than this to the one before are not written, px.
const APART_PX: f64 = 74.0;

/// The names of two legs are this far apart, px.
const NAMES_PX: f64 = 92.0;

/// Half the width of the cap of a bar, px.
const CAP: f64 = 4.0;

/// Length of the dashes of the right leg's line, px.
const DASH: f64 = 6.0;

/// Radius of the dot of a visit, px.
const DOT: f64 = 3.5;

/// The right leg is drawn beside the left one by this, so that bars do not lie on each other, px.
const BESIDE_PX: f64 = 3.0;

/// A volume at a place of the scale of dates.
struct Point {
    x: f64,
    volume: Quantity,
    /// Whether the visit was at another time of day than the last one.
    is_other_time: bool,
}

/// A curve, in runs of visits that can be compared.
struct Curve {
    ink: Ink,
    dash: Option<f64>,
    /// How far it is drawn beside its places, px.
    beside: f64,
    runs: Vec<Vec<Point>>,
}

/// The figure; `None` without volumes.
pub(super) fn picture(words: &Words) -> Option<Picture> {
    let places = places(words);
    let legs = Side::FROM_FRONT.map(|side| of_leg(words, side, &places));
    let of_legs = |middle: f64| SPAN_MIN_SHARE * middle;
    let ml = |ml: f64| number(ml, 0, words.language);
    let [left_px, right_px] = PANELS_PX;
    let mut marks = panel(words, left_px, &places, &legs, (&of_legs, &ml))?;
    marks.extend(titles(words));
    let signed_ml = |ml: f64| signed(ml, &number(ml, 0, words.language));
    let of_apart = |_: f64| SPAN_APART_MIN_ML;
    let apart = [of_both(words, &places)];
    if let Some(of) = panel(words, right_px, &places, &apart, (&of_apart, &signed_ml)) {
        marks.extend(of);
        marks.push(apart_title(words, right_px));
    }
    marks.extend(phantom(words, &places, dates(left_px)));
    let title = words.text("visits.picture.volumes");
    let is_checked = words.course.visits.iter().any(|visit| visit.phantom_mm.is_some());
    let [checked, unchecked] = HEIGHTS;
    let height = if is_checked { checked } else { unchecked };
    Some(Picture { title, size: [WIDTH, height], cuts: vec![CUT_PX], marks })
}

/// How to read it: what occurs in it.
pub(super) fn caption(words: &Words) -> String {
    let course = words.course;
    let places = places(words);
    let legs = Side::FROM_FRONT.map(|side| of_leg(words, side, &places));
    let apart = of_both(words, &places);
    let is_other_time = legs.iter().chain([&apart]).any(|of| {
        let mut points = of.runs.iter().flatten();
        points.any(|point| point.is_other_time)
    });
    let is_of_other_posture = course.groups.iter().any(|group| {
        let mut pairs = group.visits.windows(2);
        pairs.any(|pair| course.visits[pair[0]].is_of_other_posture(&course.visits[pair[1]]))
    });
    words.joined(&[
        (true, "visits.caption.volumes"),
        (!apart.runs.is_empty(), "visits.caption.apart"),
        (true, "visits.caption.bars"),
        (is_other_time, "visits.caption.hollow"),
        (course.groups.len() > 1, "visits.caption.break"),
        (is_of_other_posture, "visits.caption.posture"),
    ])
}

/// The scale of dates between two ends, px.
fn dates([from, to]: [f64; 2]) -> Scale {
    Scale { range: [0.0, 1.0], px: [from + INSET_PX, to - INSET_PX] }
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

/// The volumes of a leg.
fn of_leg(words: &Words, side: Side, places: &[f64]) -> Curve {
    let (dash, beside) = match side {
        Side::Left => (None, BESIDE_PX),
        Side::Right => (Some(DASH), -BESIDE_PX),
    };
    let runs = runs(words, places, |group, visit| words.course.volume(group, visit, side));
    Curve { ink: Ink::for_side(side), dash, beside, runs }
}

/// The excess of the affected leg; without one, the difference of the legs.
fn of_both(words: &Words, places: &[f64]) -> Curve {
    let course = words.course;
    let (ink, runs) = match course.choice.affected {
        Some(Affected::One(side)) => {
            let ml = |group: &Group, visit: usize| Some(course.excess(group, visit)?.ml);
            (Ink::for_side(side), runs(words, places, ml))
        }
        Some(Affected::Both | Affected::Neither) | None => {
            let ml = |group: &Group, visit: usize| course.left_minus_right(group, visit);
            (Ink::Text, runs(words, places, ml))
        }
    };
    Curve { ink, dash: None, beside: 0.0, runs }
}

/// Figures in runs of visits that can be compared: of one meaning, in one posture.
fn runs(
    words: &Words,
    places: &[f64],
    volume: impl Fn(&Group, usize) -> Option<Quantity>,
) -> Vec<Vec<Point>> {
    let course = words.course;
    let is_of_one_posture =
        |one: &usize, next: &usize| !course.visits[*one].is_of_other_posture(&course.visits[*next]);
    let mut all = Vec::new();
    for group in &course.groups {
        let point = |visit: &usize| {
            Some(Point {
                x: places[*visit],
                volume: volume(group, *visit)?,
                is_other_time: course.other_time_of_day(group, *visit).is_some(),
            })
        };
        let of_group = group.visits.chunk_by(is_of_one_posture);
        let runs = of_group.map(|run| run.iter().filter_map(point).collect::<Vec<Point>>());
        all.extend(runs.filter(|run| !run.is_empty()));
    }
    all
}

/// How a panel is scaled and labelled: the least span about a middle, and the words of a volume.
type Looks<'a> = (&'a dyn Fn(f64) -> f64, &'a dyn Fn(f64) -> String);

/// Curves over the dates of the visits, on a scale of their own.
fn panel(
    words: &Words,
    px: [f64; 2],
    places: &[f64],
    curves: &[Curve],
    (span_min, ml): Looks<'_>,
) -> Option<Vec<Mark>> {
    let points = curves.iter().flat_map(|of| of.runs.iter().flatten());
    let ends = points.flat_map(|of| {
        let half = of.volume.expanded();
        [of.volume.value - half, of.volume.value + half]
    });
    let [low, high] = range(ends, 1.0)?;
    let middle = f64::midpoint(low, high);
    let half = (high - low).max(span_min(middle)) / 2.0;
    let step = step(2.0 * half / ROWS);
    let ends = [middle - half, middle + half];
    let y = Scale { range: range(ends.into_iter(), step)?, px: VOLUMES_PX };
    let x = dates(px);
    let whole = Scale { range: [0.0, 1.0], px };
    let mut marks = Frame { x: whole, y }.rows(step, ml);
    let [bottom, top] = y.range;
    if bottom < 0.0 && top > 0.0 {
        marks.push(lines(vec![px.map(|x| [x, y.at(0.0)]).to_vec()], Ink::Muted, 1.0));
    }
    marks.extend(days(words, places, &x));
    marks.extend(breaks(words, places, &x));
    let frame = Frame { x, y };
    marks
        .extend(curves.iter().flat_map(|of| of.runs.iter().flat_map(|run| curve(of, run, &frame))));
    Some(marks)
}

/// The next step of 1, 2 or 5 times a power of ten.
fn step(least: f64) -> f64 {
    let power = 10.0_f64.powf(least.max(1.0).log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|of| of * power).into_iter().find(|of| *of >= least).unwrap_or(least)
}

fn titles(words: &Words) -> Vec<Mark> {
    let above = VOLUMES_PX[1] - 24.0;
    let mut marks =
        vec![heading([4.0, above], Anchor::Start, Ink::Text, words.text("visits.picture.ml"))];
    let mut x = PANELS_PX[0][1];
    for side in Side::BOTH {
        marks.push(heading([x, above], Anchor::End, Ink::for_side(side), words.leg(side)));
        x -= NAMES_PX;
    }
    marks
}

/// What the legs differ by, as the heading of its panel.
fn apart_title(words: &Words, [_, right]: [f64; 2]) -> Mark {
    let (name, ink) = match words.course.choice.affected {
        Some(Affected::One(side)) => {
            let only = words.language.word("leg.only", side.word());
            (words.filled("visits.excess_of", &[("side", &only)]), Ink::for_side(side))
        }
        Some(Affected::Both | Affected::Neither) | None => {
            (words.text("visits.difference_of"), Ink::Text)
        }
    };
    heading([right, VOLUMES_PX[1] - 24.0], Anchor::End, ink, format!("{name}, mL"))
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
        marks.push(small_text([x, bottom + LINE + 4.0], anchor, words.day(visit)));
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
    let name = words.text("visits.picture.break");
    let marks = ends.flat_map(|x| {
        let line = vec![vec![[x, bottom], [x, top]]];
        [
            stroked(line, Stroke::dashed(Ink::Text, 1.0, 3.0)),
            text_mark([x, top - 6.0], Anchor::Middle, SMALL, Ink::Text, name.as_str()),
        ]
    });
    marks.collect()
}

/// A run of a curve, with a bar of uncertainty at each visit; a visit at another time of day has a hollow dot.
fn curve(of: &Curve, run: &[Point], frame: &Frame) -> Vec<Mark> {
    let at = |point: &Point, ml: f64| {
        let [x, y] = frame.at([point.x, ml]);
        [x + of.beside, y]
    };
    let bars = run.iter().flat_map(|point| {
        let half = point.volume.expanded();
        let ends = [-half, half].map(|half| at(point, point.volume.value + half));
        let cap = |[x, y]: [f64; 2]| vec![[x - CAP, y], [x + CAP, y]];
        let [low, high] = ends;
        [ends.to_vec(), cap(low), cap(high)]
    });
    let line = run.iter().map(|point| at(point, point.volume.value)).collect();
    let dots = |is_other_time: bool| -> Vec<[f64; 2]> {
        let points = run.iter().filter(|point| point.is_other_time == is_other_time);
        points.map(|point| at(point, point.volume.value)).collect()
    };
    let stroke = Stroke { ink: of.ink, width: 2.0, dash: of.dash };
    let mut marks = vec![lines(bars.collect(), of.ink, 1.0), stroked(vec![line], Some(stroke))];
    for (at, fill, stroke) in
        [(dots(false), of.ink, None), (dots(true), Ink::Paper, Stroke::solid(of.ink, 1.5))]
    {
        if !at.is_empty() {
            marks.push(Mark::Dots { at, radius: DOT, fill: Some(fill), stroke });
        }
    }
    marks
}

/// The phantom's mean error before each visit.
fn phantom(words: &Words, places: &[f64], dates: Scale) -> Vec<Mark> {
    let visits = places.iter().zip(&words.course.visits);
    let errors: Vec<[f64; 2]> =
        visits.filter_map(|(place, visit)| Some([*place, visit.phantom_mm?])).collect();
    let most = errors.iter().map(|[_, mm]| mm.abs()).fold(PHANTOM_MIN_MM, f64::max).ceil();
    let frame = Frame { x: dates, y: Scale { range: [-most, most], px: PHANTOM_PX } };
    let above = PHANTOM_PX[1] - 12.0;
    let name = match errors.is_empty() {
        true => words.text("visits.picture.no_phantom"),
        false => words.text("visits.picture.phantom"),
    };
    let mut marks = vec![heading([4.0, above], Anchor::Start, Ink::Text, name)];
    if !errors.is_empty() {
        marks.extend(frame.rows(most, |mm| signed(mm, &number(mm, 0, words.language))));
        let line: Vec<[f64; 2]> = errors.iter().map(|of| frame.at(*of)).collect();
        marks.push(lines(vec![line.clone()], Ink::Muted, 1.0));
        marks.push(Mark::Dots { at: line, radius: 3.0, fill: Some(Ink::Muted), stroke: None });
    }
    marks
}
