//! Girth over the length along each leg, at the visits that are beside each other.

use gaiter_leg::Side;
use gaiter_record::picture::figures::plot::{
    Frame, LINE, Scale, heading, range, small_text, stroked,
};
use gaiter_record::picture::{Anchor, Ink, Mark, Picture, Stroke};
use gaiter_record::rounding::number;

use super::super::words::Words;
use super::key;
use crate::leg::LegAtVisit;
use crate::place::along_mm;

/// Width, and space below the charts, px.
const WIDTH: f64 = 720.0;

/// Left and right end of the chart of each leg, right leg first, px.
const LEGS_PX: [[f64; 2]; 2] = [[46.0, 346.0], [402.0, 702.0]];

/// Bottom and top of the charts, px.
const ROWS_PX: [f64; 2] = [420.0, 44.0];

/// Space below the charts for the scale and a line for each visit, px.
const BELOW: f64 = 40.0;

/// Steps of the scales, mm.
const STEP_MM: f64 = 100.0;

/// The figure; `None` without girths.
pub(super) fn picture(words: &Words, shown: &[usize]) -> Option<Picture> {
    let leg = |visit: usize, side: Side| words.course.visits[visit].legs.get(side).as_ref();
    let all = || {
        let legs = shown.iter().flat_map(|visit| Side::BOTH.map(|side| leg(*visit, side)));
        legs.flatten().flat_map(|leg| &leg.places)
    };
    let girths = range(all().map(|(_, place)| place.girth_mm), STEP_MM)?;
    let lengths = range(all().map(|(step, _)| along_mm(*step)).chain([0.0]), STEP_MM)?;
    let mut marks = Vec::new();
    for (side, px) in Side::FROM_FRONT.into_iter().zip(LEGS_PX) {
        let x = Scale { range: girths, px };
        let frame = Frame { x, y: Scale { range: lengths, px: ROWS_PX } };
        let cm = |mm: f64| number(mm / 10.0, 0, words.language);
        marks.extend(frame.columns(STEP_MM, cm));
        marks.extend(frame.rows(STEP_MM, cm));
        let title = [f64::midpoint(px[0], px[1]), 18.0];
        marks.push(heading(title, Anchor::Middle, Ink::for_side(side), words.leg(side)));
        for (place, visit) in shown.iter().enumerate() {
            let Some(leg) = leg(*visit, side) else { continue };
            let pen = look(place, shown.len(), side);
            marks.push(curve(leg, &frame, pen));
            let at = [px[0], ROWS_PX[0] + BELOW + LINE * place as f64];
            marks.extend(key(at, pen, words.day(*visit)));
        }
    }
    let length = words.text("visits.picture.length_cm");
    marks.push(small_text([4.0, 34.0], Anchor::Start, length));
    let below = ROWS_PX[0] + 2.0 * LINE;
    let girth = words.text("picture.girth_cm");
    marks.push(small_text([WIDTH - 4.0, below], Anchor::End, girth));
    let height = ROWS_PX[0] + BELOW + LINE * shown.len() as f64;
    let title = words.text("visits.picture.profiles");
    Some(Picture { title, size: [WIDTH, height], cuts: Vec::new(), marks })
}

/// The pen of a visit: the last one solid in the leg's own ink, the first dashed, those between finer.
fn look(place: usize, visits: usize, side: Side) -> Option<Stroke> {
    match place {
        _ if place + 1 == visits => Stroke::solid(Ink::for_side(side), 2.0),
        0 => Stroke::dashed(Ink::Text, 1.5, 6.0),
        1 if visits > 3 => Stroke::dashed(Ink::Scan, 1.0, 2.0),
        _ => Stroke::solid(Ink::Muted, 1.0),
    }
}

/// The curve of a leg, broken where a girth is missing.
fn curve(leg: &LegAtVisit, frame: &Frame, stroke: Option<Stroke>) -> Mark {
    let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut before = None;
    for (step, place) in &leg.places {
        let at = frame.at([place.girth_mm, along_mm(*step)]);
        match lines.last_mut().filter(|_| before.is_some_and(|before| before + 1 == *step)) {
            Some(line) => line.push(at),
            None => lines.push(vec![at]),
        }
        before = Some(*step);
    }
    stroked(lines, stroke)
}
