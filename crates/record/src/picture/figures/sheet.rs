//! Both legs from the front with the girths at their levels, as on an order form: the patient's right leg on
//! the left.

use gaiter_language::Language;
use gaiter_leg::Side;

use super::plot::{LINE, TEXT, heading, kept_apart, lines};
use super::views::{Drawn, From, View, extent, outlines, ring};
use crate::Record;
use crate::picture::{Anchor, Ink, Mark, Picture};
use crate::report::Reliability;

/// Width, px.
const WIDTH: f64 = 460.0;

/// Space above and below the legs, px.
const TOP: f64 = 10.0;
const BOTTOM: f64 = 28.0;

/// Space on either side for the girths, px.
const MARGIN: f64 = 110.0;

/// The largest height at which the legs are drawn, px.
const HEIGHT_MAX: f64 = 320.0;

/// The figure; `None` for a record without shapes.
pub(super) fn picture(record: &Record, language: Language) -> Option<Picture> {
    let legs: Vec<Drawn> =
        Side::FROM_FRONT.into_iter().filter_map(|side| Drawn::new(record, side)).collect();
    let [low_mm, high_mm] = extent(&legs, From::Front)?;
    let points = || legs.iter().flat_map(Drawn::points);
    let top_mm = points().map(|point| point.z).fold(f64::NEG_INFINITY, f64::max);
    if top_mm <= 0.0 {
        return None;
    }
    let px_per_mm = ((WIDTH - 2.0 * MARGIN) / (high_mm - low_mm)).min(HEIGHT_MAX / top_mm);
    let left = (WIDTH - (low_mm + high_mm) * px_per_mm) / 2.0;
    let floor = TOP + top_mm * px_per_mm;
    let view = View { from: From::Front, left, floor, px_per_mm };
    let mut marks = Vec::new();
    for leg in &legs {
        marks.extend(view.leg(leg));
        marks.extend(girths(&view, leg, language));
    }
    marks.extend(view.below(&legs, language));
    let title = language.text("picture.sheet").to_owned();
    Some(Picture { title, size: [WIDTH, floor + BOTTOM], cuts: Vec::new(), marks })
}

/// The girths of a leg beside it, each on a line to its level.
fn girths(view: &View, leg: &Drawn, language: Language) -> Vec<Mark> {
    let found: Vec<(String, [f64; 2])> = outlines(leg.leg)
        .filter_map(|(level, outline)| {
            let (girth, mark) = leg.girth(level, language)?;
            let sign = if mark == Reliability::Doubtful { " ?" } else { mark.by_hand_sign() };
            let end = view.ends(&ring(outline))[usize::from(leg.side == Side::Left)];
            Some((format!("c{level} {girth}{sign}"), end))
        })
        .collect();
    let wished: Vec<f64> = found.iter().map(|(_, end)| end[1]).collect();
    let (x, tip, anchor) = match leg.side {
        Side::Right => (MARGIN - 16.0, MARGIN - 12.0, Anchor::End),
        Side::Left => (WIDTH - MARGIN + 16.0, WIDTH - MARGIN + 12.0, Anchor::Start),
    };
    let places = kept_apart(&wished, LINE);
    let label = |((words, end), y): (&(String, [f64; 2]), f64)| {
        let line = lines(vec![vec![[tip, y], *end]], Ink::for_side(leg.side), 0.8);
        [line, heading([x, y + TEXT / 3.0], anchor, Ink::for_side(leg.side), words.clone())]
    };
    found.iter().zip(places).flat_map(label).collect()
}
