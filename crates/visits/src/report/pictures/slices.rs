//! How much the volume of each slice of 4 cm has changed: bars that stay grey inside their uncertainty.

use gaiter_leg::Side;
use gaiter_leg::levels::at_height::PROFILE_STEP_MM;
use gaiter_record::picture::figures::plot::{
    Frame, SMALL, Scale, about_zero, area, heading, lines, small_text,
};
use gaiter_record::picture::{Anchor, Ink, Mark, Picture};
use gaiter_record::rounding::{number, signed};

use super::super::words::Words;
use crate::comparison::{Comparison, PlaceChange};
use crate::course::Group;
use crate::place::along_mm;
use crate::quantity::Shown;
use crate::report::summary::between;

/// Width, px.
const WIDTH: f64 = 720.0;

/// Left and right end of the bars of each leg, right leg first, px.
const LEGS_PX: [[f64; 2]; 2] = [[56.0, 346.0], [412.0, 702.0]];

/// From the top to the highest slice, px.
const HEAD: f64 = 50.0;

/// Height of a slice, px.
const ROW: f64 = 13.0;

/// Half the height of a bar, px.
const BAR: f64 = 4.5;

/// Half the height of the cap of a whisker, px.
const CAP: f64 = 2.5;

/// Space below the lowest slice, px.
const BELOW: f64 = 34.0;

/// The smallest end of the scale, mL.
const SCALE_MIN_ML: f64 = 20.0;

/// Steps of the scale, mL.
const STEPS_ML: [f64; 7] = [5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0];

/// The figure of a comparison; `None` if no slice can be compared.
pub(super) fn picture(words: &Words, group: &Group, of: &Comparison) -> Option<Picture> {
    if of.is_of_other_posture() {
        return None;
    }
    let steps = &group.pieces.left | &group.pieces.right;
    let (low, high) = (*steps.first()?, *steps.last()?);
    let legs = Side::FROM_FRONT.map(|side| of.pieces(side));
    let reach = legs.into_iter().flatten();
    let reach = reach.map(|of| of.change.by.abs() + of.change.detectable());
    let reach = reach.filter(|ml| ml.is_finite()).fold(SCALE_MIN_ML, f64::max);
    let mut marks = vec![heading([4.0, 16.0], Anchor::Start, Ink::Text, between(words, of))];
    let rows = Scale {
        range: [along_mm(low), along_mm(high) + PROFILE_STEP_MM],
        px: [HEAD + ROW * f64::from(high - low + 1), HEAD],
    };
    for ((side, slices), px) in Side::FROM_FRONT.into_iter().zip(legs).zip(LEGS_PX) {
        let (scale, step) = about_zero(reach, &STEPS_ML, px);
        marks.extend(grid(words, side, &scale, step, &rows));
        marks.extend(slices.iter().flat_map(|of| bar(side, of, &scale, &rows)));
    }
    let height = rows.px[0] + BELOW;
    let title = words.text("visits.picture.slices");
    Some(Picture { title, size: [WIDTH, height], cuts: Vec::new(), marks })
}

fn grid(words: &Words, side: Side, scale: &Scale, step: f64, rows: &Scale) -> Vec<Mark> {
    let frame = Frame { x: *scale, y: *rows };
    let mut marks = frame.columns(step, |ml| signed(ml, &number(ml, 0, words.language)));
    let [bottom, top] = rows.px;
    let middle = scale.at(0.0);
    marks.push(lines(vec![vec![[middle, top], [middle, bottom]]], Ink::Muted, 1.0));
    let name = words.filled("visits.picture.change_ml", &[("leg", &words.leg(side))]);
    marks.push(heading([middle, top - 12.0], Anchor::Middle, Ink::for_side(side), name));
    marks.extend(rows.steps(2.0 * PROFILE_STEP_MM).map(|mm| {
        let at = [scale.px[0] - 6.0, rows.at(mm) + SMALL / 3.0];
        small_text(at, Anchor::End, number(mm / 10.0, 0, words.language))
    }));
    marks
}

/// The bar of a slice with its whisker: in the leg's ink if the change is shown, else grey.
fn bar(side: Side, of: &PlaceChange, scale: &Scale, rows: &Scale) -> Vec<Mark> {
    let y = rows.at(along_mm(of.step) + PROFILE_STEP_MM / 2.0);
    let [zero, end] = [0.0, of.change.by].map(|ml| scale.at(ml));
    let ink = match of.change.shown() {
        Shown::NoChange => Ink::Unseen,
        Shown::Larger | Shown::Smaller => Ink::for_side(side),
    };
    let outline = vec![[zero, y - BAR], [end, y - BAR], [end, y + BAR], [zero, y + BAR]];
    let half = of.change.detectable();
    let ends = [of.change.by - half, of.change.by + half].map(|ml| scale.at(ml));
    let cap = |x: f64| vec![[x, y - CAP], [x, y + CAP]];
    let whisker = vec![vec![[ends[0], y], [ends[1], y]], cap(ends[0]), cap(ends[1])];
    vec![area(vec![outline], ink), lines(whisker, Ink::Muted, 0.8)]
}
