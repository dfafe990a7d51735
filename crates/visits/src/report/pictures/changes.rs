//! By how much the girths have changed along each leg, on a scale of its own: on that of the girths themselves a
//! centimetre cannot be seen.

use gaiter_leg::Side;
use gaiter_record::picture::figures::plot::{
    Frame, LINE, Scale, about_zero, heading, lines, range, small_text, stroked,
};
use gaiter_record::picture::{Anchor, Ink, Mark, Picture, Stroke};
use gaiter_record::rounding::{cm_words, number, signed};

use super::super::words::Words;
use super::key;
use crate::comparison::{Comparison, PlaceChange};
use crate::place::along_mm;
use crate::quantity::Shown;
use crate::report::summary::between;

/// Width, px.
const WIDTH: f64 = 720.0;

/// Left and right end of the chart of each leg, right leg first, px.
const LEGS_PX: [[f64; 2]; 2] = [[46.0, 346.0], [402.0, 702.0]];

/// Where a narrow screen may cut between the two, px.
const CUT_PX: f64 = 366.0;

/// Bottom and top of the charts, px.
const ROWS_PX: [f64; 2] = [216.0, 40.0];

/// From the bottom of the charts to the baseline of the first line that names a comparison, px.
const BELOW: f64 = 36.0;

/// Steps of the lengths, mm.
const STEP_MM: f64 = 100.0;

/// The scale reaches at least so far to either side, mm, so that a change of a millimetre does not look like one of a
/// centimetre.
const SCALE_MIN_MM: f64 = 10.0;

/// Steps of the scale, mm.
const STEPS_MM: [f64; 6] = [2.0, 5.0, 10.0, 20.0, 50.0, 100.0];

/// Radius of the dot of a change that is shown, px.
const DOT: f64 = 3.0;

/// The figure; `None` if no girth can be compared.
pub(super) fn picture(words: &Words, compared: &[Comparison]) -> Option<Picture> {
    let compared: Vec<&Comparison> =
        compared.iter().filter(|of| !of.is_of_other_posture()).collect();
    let all = || compared.iter().flat_map(|of| Side::BOTH.map(|side| of.girths(side))).flatten();
    let lengths = range(all().map(|of| along_mm(of.step)), STEP_MM)?;
    let figures = all().flat_map(|of| [of.change.by.abs(), of.change.detectable()]);
    let reach = figures.filter(|mm| mm.is_finite()).fold(SCALE_MIN_MM, f64::max);
    let mut marks = Vec::new();
    for (side, px) in Side::FROM_FRONT.into_iter().zip(LEGS_PX) {
        let y = Scale { range: lengths, px: ROWS_PX };
        let (x, step) = about_zero(reach, &STEPS_MM, px);
        let frame = Frame { x, y };
        marks.extend(leg(words, side, &frame, step));
        // The last one first, so that the first comparison lies above it.
        for (place, of) in compared.iter().enumerate().rev() {
            marks.extend(curve(of.girths(side), &frame, look(place, side)));
        }
        let drawn = compared.iter().enumerate().filter(|(_, of)| !of.girths(side).is_empty());
        for (place, of) in drawn {
            let pen = Some(look(place, side));
            marks.extend(key([px[0], below(place)], pen, between(words, of)));
        }
    }
    let length = words.text("visits.picture.length_cm");
    marks.push(small_text([4.0, ROWS_PX[1] - 8.0], Anchor::Start, length));
    let height = below(compared.len());
    let title = words.text("visits.picture.changes");
    Some(Picture { title, size: [WIDTH, height], cuts: vec![CUT_PX], marks })
}

/// How to read it: what occurs in it.
pub(super) fn caption(words: &Words, compared: &[Comparison]) -> String {
    let legs = compared.iter().flat_map(|of| Side::BOTH.map(|side| of.girths(side)));
    let is_shown = legs.flatten().any(|of| of.change.shown() != Shown::NoChange);
    words.joined(&[
        (true, "visits.caption.changes"),
        (is_shown, "visits.caption.dot"),
        (true, "visits.caption.dotted"),
    ])
}

/// The grid of a leg, with its name and the line of no change.
fn leg(words: &Words, side: Side, frame: &Frame, step: f64) -> Vec<Mark> {
    let language = words.language;
    let mut marks = frame.columns(step, |mm| signed(mm, &cm_words(mm, language)));
    marks.extend(frame.rows(STEP_MM, |mm| number(mm / 10.0, 0, language)));
    let [bottom, top] = frame.y.px;
    let middle = frame.x.at(0.0);
    marks.push(lines(vec![vec![[middle, bottom], [middle, top]]], Ink::Muted, 1.0));
    let title = words.filled("visits.picture.change_cm", &[("leg", &words.leg(side))]);
    marks.push(heading([middle, top - 22.0], Anchor::Middle, Ink::for_side(side), title));
    marks
}

/// The comparison with the first visit in the leg's own ink, that with the one before the last dashed.
fn look(place: usize, side: Side) -> Stroke {
    match place {
        0 => Stroke { ink: Ink::for_side(side), width: 2.0, dash: None },
        _ => Stroke { ink: Ink::Text, width: 1.2, dash: Some(5.0) },
    }
}

/// The changes along a leg; a dot where a change is shown. Of the comparison that is not dashed also from where on one
/// can be shown.
fn curve(of: &[PlaceChange], frame: &Frame, pen: Stroke) -> Vec<Mark> {
    let at = |place: &PlaceChange, mm: f64| frame.at([mm, along_mm(place.step)]);
    let runs = || of.chunk_by(|one, next| one.step + 1 == next.step);
    let line = |by: &dyn Fn(&PlaceChange) -> f64, pen: Stroke| {
        let lines = runs().map(|run| run.iter().map(|of| at(of, by(of))).collect());
        stroked(lines.collect(), Some(pen))
    };
    if of.is_empty() {
        return Vec::new();
    }
    let mut marks = Vec::new();
    if pen.dash.is_none() {
        let stroke = Stroke { ink: Ink::Muted, width: 1.0, dash: Some(2.0) };
        marks.push(line(&|of: &PlaceChange| of.change.detectable(), stroke));
        marks.push(line(&|of: &PlaceChange| -of.change.detectable(), stroke));
    }
    marks.push(line(&|of: &PlaceChange| of.change.by, pen));
    let shown = of.iter().filter(|of| of.change.shown() != Shown::NoChange);
    let dots: Vec<[f64; 2]> = shown.map(|of| at(of, of.change.by)).collect();
    if !dots.is_empty() {
        marks.push(Mark::Dots { at: dots, radius: DOT, fill: Some(pen.ink), stroke: None });
    }
    marks
}

/// The baseline of the name of a comparison, px.
fn below(place: usize) -> f64 {
    ROWS_PX[0] + BELOW + LINE * place as f64
}
