//! How fast the girth grows upwards, beside the chart of girths: B1 lies where it grows fastest.

use gaiter_language::Language;
use gaiter_leg::{Level, Side};

use super::curves::{ROWS_PX, beside, diamond, is_outer_right, left_first, line, short};
use super::plot::{Frame, LINE, Scale, TEXT, area, heading, kept_apart, lines, range, text_mark};
use crate::picture::{Anchor, Ink, Mark};
use crate::schema::LegFigures;
use crate::{Record, rounding};

/// Left and right of the chart of slopes, px.
const SLOPES_PX: [f64; 2] = [500.0, 662.0];

/// Steps of which the smallest is labelled that gives at most [`LABELS_MAX`] labels.
const STEPS: [f64; 4] = [0.5, 1.0, 2.0, 5.0];

/// This many labels fit beside each other.
const LABELS_MAX: f64 = 6.0;

/// The chart, at the heights of that of the girths.
pub(super) fn chart(record: &Record, girths: &Frame, language: Language) -> Vec<Mark> {
    let legs = || Side::FROM_FRONT.into_iter().filter_map(|side| Some((side, record.leg(side)?)));
    let title = [SLOPES_PX[0], ROWS_PX[0] - 12.0];
    let title = heading(title, Anchor::Start, Ink::Text, language.text("picture.slope"));
    let Some(slopes) = frame(legs().map(|(_, leg)| leg), girths) else { return vec![title] };
    let [low, high] = slopes.x.range;
    let step = STEPS.into_iter().find(|step| (high - low) / step <= LABELS_MAX).unwrap_or(10.0);
    let mut marks = vec![title];
    marks.extend(slopes.columns(step, |slope| rounding::number(slope, 1, language)));
    marks.extend(slopes.rows(100.0, |mm| format!("{:.0}", mm / 10.0)));
    let zero = girths.y.range.map(|height| slopes.at([0.0, height]));
    marks.push(lines(vec![zero.to_vec()], Ink::Muted, 1.0));
    for (side, leg) in left_first(legs()) {
        marks.push(line(side, slope(leg, &slopes)));
    }
    marks.extend(steepest(record, &slopes, language));
    marks
}

/// The frame of the slopes from B up, if there are any. Below B, through heel and instep, slopes are ten
/// times as large.
fn frame<'a>(legs: impl Iterator<Item = &'a LegFigures>, girths: &Frame) -> Option<Frame> {
    let slopes = legs.flat_map(|leg| {
        let from_mm = leg.landmarks.get(Level::B.name()).map_or(100.0, |b| b.height_mm);
        slope_rows(leg).flatten().filter(move |[_, height]| *height >= from_mm)
    });
    let x = Scale { range: range(slopes.map(|[slope, _]| slope), 0.5)?, px: SLOPES_PX };
    Some(Frame { x, y: girths.y })
}

fn slope_rows(leg: &LegFigures) -> impl Iterator<Item = Option<[f64; 2]>> {
    leg.girth_curve.over_height(&leg.girth_curve.slope)
}

/// The line of the slope, as far as it is within its chart.
fn slope(leg: &LegFigures, slopes: &Frame) -> impl Iterator<Item = Option<[f64; 2]>> {
    let [low, high] = slopes.x.range;
    slope_rows(leg).map(move |row| {
        let is_within = |[slope, _]: &[f64; 2]| (low..=high).contains(slope);
        row.filter(is_within).map(|at| slopes.at(at))
    })
}

/// B1 on the slopes, with the labels on the outer sides of the two.
fn steepest(record: &Record, slopes: &Frame, language: Language) -> Vec<Mark> {
    let places: Vec<(Side, [f64; 2])> = Side::FROM_FRONT
        .into_iter()
        .filter_map(|side| Some((side, steepest_of(record.leg(side)?)?)))
        .collect();
    let mut marks = Vec::new();
    for at_right in [false, true] {
        let is_here = |(side, place): &&(Side, [f64; 2])| {
            let line = record.leg(side.other()).map(slope_rows);
            is_outer_right(*side, *place, line) == at_right
        };
        let here: Vec<&(Side, [f64; 2])> = places.iter().filter(is_here).collect();
        let wished: Vec<f64> = here.iter().map(|(_, place)| slopes.at(*place)[1]).collect();
        let (aside, anchor) = beside(at_right);
        for ((side, place), y) in here.into_iter().zip(kept_apart(&wished, LINE)) {
            let at = slopes.at(*place);
            let label = [at[0] + aside, y + TEXT / 3.0];
            marks.push(area(vec![diamond(at, 5.5)], Ink::for_side(*side)));
            let name = format!("{} {}", short(*side, language), Level::B1.name());
            marks.push(text_mark(label, anchor, TEXT, Ink::for_side(*side), name));
        }
    }
    marks
}

/// Slope and height of a leg's B1, if found.
fn steepest_of(leg: &LegFigures) -> Option<[f64; 2]> {
    let height_mm = leg.landmarks.get(Level::B1.name())?.height_mm;
    let far = |row: &[f64; 2]| (row[1] - height_mm).abs();
    let [slope, _] = slope_rows(leg).flatten().min_by(|a, b| far(a).total_cmp(&far(b)))?;
    Some([slope, height_mm])
}
