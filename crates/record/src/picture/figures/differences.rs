//! Both legs at the same heights: their girths, and the difference as a bar on the side of the larger leg.
//! Heights go up from the floor as on the legs; the patient's right leg is on the left.

use gaiter_language::Language;
use gaiter_leg::Side;

use super::plot::{
    Frame, LINE, SMALL, Scale, TEXT, about_zero, heading, lines, shape, small_text, text_mark,
};
use crate::Record;
use crate::chart::{AtFigures, girth_difference, same_heights};
use crate::picture::{Anchor, Ink, Mark, Picture};
use crate::rounding::{cm, cm_margin, cm_words, exceeds, number};

/// Width, px.
const WIDTH: f64 = 440.0;

/// Place of the highest row, px.
const TOP: f64 = 62.0;

/// Distance of the rows, px.
const ROW: f64 = 16.0;

/// Space below the floor, px.
const BOTTOM: f64 = 46.0;

/// Ends of the columns of heights, of the right leg's and of the left leg's girths, px.
const HEIGHT_X: f64 = 34.0;
const GIRTH_X: [f64; 2] = [92.0, 394.0];

/// Left and right end of the scale of the bars, px.
const BARS_X: [f64; 2] = [108.0, 348.0];

/// Half the height of a bar, px.
const BAR: f64 = 5.0;

/// Half the height of the cap of a whisker, px.
const CAP: f64 = 3.0;

/// The smallest end of the scale, mm, so that legs that are alike do not look different.
const SCALE_MIN_MM: f64 = 10.0;

/// Steps of the scale, mm.
const STEPS_MM: [f64; 6] = [5.0, 10.0, 20.0, 50.0, 100.0, 200.0];

/// A height at which both legs have a girth.
struct Row<'a> {
    height_mm: f64,
    /// Right and left.
    girths: [&'a AtFigures; 2],
    /// Left minus right, mm.
    difference_mm: f64,
    /// Its standard error, mm; `None` if unknown.
    sd_mm: Option<f64>,
}

impl<'a> Row<'a> {
    /// The row of two girths, right and left; `None` if one of them is missing.
    fn new(girths: [&'a AtFigures; 2]) -> Option<Row<'a>> {
        let (difference_mm, sd_mm) = girth_difference(girths[0], girths[1])?;
        Some(Row { height_mm: girths[0].height_mm, girths, difference_mm, sd_mm })
    }

    /// The larger leg.
    fn larger(&self) -> Side {
        if self.difference_mm < 0.0 { Side::Right } else { Side::Left }
    }

    /// Whether the difference exceeds its uncertainty, both as the table beside it shows them.
    fn is_real(&self) -> bool {
        exceeds(cm(self.difference_mm), self.sd_mm.map(cm_margin))
    }
}

/// The figure; `None` for a record without two legs with girths at the same heights.
pub(super) fn picture(record: &Record, language: Language) -> Option<Picture> {
    let [right, left] = Side::FROM_FRONT.map(|side| record.leg(side));
    let pairs = same_heights([&right?.profile, &left?.profile]);
    let rows: Vec<Row> = pairs.into_iter().filter_map(Row::new).collect();
    let highest_mm = rows.last()?.height_mm;
    let apart_mm = rows.windows(2).map(|pair| pair[1].height_mm - pair[0].height_mm);
    let apart_mm = apart_mm.fold(highest_mm, f64::min);
    if apart_mm.is_nan() || apart_mm <= 0.0 {
        return None;
    }
    let floor = TOP + highest_mm / apart_mm * ROW;
    let heights = Scale { range: [0.0, highest_mm], px: [floor, TOP] };
    let (scale, step_mm) = bar_scale(&rows);
    let mut marks = grid(&scale, step_mm, floor, language);
    marks.extend(titles(language));
    for row in &rows {
        let y = heights.at(row.height_mm);
        marks.extend(girths(row, y, language));
        marks.extend(bar(row, y, &scale));
    }
    let most = largest(&rows, language);
    let at = [f64::midpoint(BARS_X[0], BARS_X[1]), floor + BOTTOM - 8.0];
    marks.push(heading(at, Anchor::Middle, Ink::Text, most.clone()));
    let title = format!("{}; {most}", language.text("picture.differences"));
    Some(Picture { title, size: [WIDTH, floor + BOTTOM], cuts: Vec::new(), marks })
}

/// The scale of the bars, mm, symmetric about zero, and the step of its labels.
fn bar_scale(rows: &[Row]) -> (Scale, f64) {
    let reach = |row: &Row| row.difference_mm.abs() + row.sd_mm.unwrap_or(0.0);
    let reach_mm = rows.iter().map(reach).fold(SCALE_MIN_MM, f64::max);
    about_zero(reach_mm, &STEPS_MM, BARS_X)
}

/// The lines of the scale, zero and the floor, with the amounts below.
fn grid(scale: &Scale, step_mm: f64, floor: f64, language: Language) -> Vec<Mark> {
    let y = Scale { range: [0.0, 1.0], px: [floor, TOP - ROW / 2.0] };
    let places = usize::from(step_mm < 10.0);
    let amount = |mm: f64| number(mm.abs() / 10.0, places, language);
    let mut marks = Frame { x: *scale, y }.columns(step_mm, amount);
    let zero = y.px.map(|y| [scale.at(0.0), y]).to_vec();
    let across = vec![[4.0, floor], [WIDTH - 4.0, floor]];
    marks.push(lines(vec![zero, across], Ink::Muted, 1.0));
    let name = language.text("picture.floor");
    marks.push(small_text([4.0, floor + LINE], Anchor::Start, name));
    marks
}

fn titles(language: Language) -> Vec<Mark> {
    let text = |key| language.text(key);
    let (first, second) = (16.0, 34.0);
    let middle = f64::midpoint(BARS_X[0], BARS_X[1]);
    let difference = text("picture.difference_cm");
    let mut marks = vec![
        small_text([4.0, second], Anchor::Start, text("picture.height_cm")),
        text_mark([middle, first], Anchor::Middle, SMALL, Ink::Text, difference),
    ];
    for (side, x) in Side::FROM_FRONT.into_iter().zip([GIRTH_X[0], WIDTH - 8.0]) {
        let leg = language.word("leg", side.word());
        marks.push(heading([x, first], Anchor::End, Ink::for_side(side), leg));
        let (at, anchor) = match side {
            Side::Right => (middle - 8.0, Anchor::End),
            Side::Left => (middle + 8.0, Anchor::Start),
        };
        let larger = language.word("picture.larger", side.word());
        marks.push(text_mark([at, second], anchor, SMALL, Ink::for_side(side), larger));
    }
    marks
}

/// The height and the girths of a row.
fn girths(row: &Row, y: f64, language: Language) -> Vec<Mark> {
    let y = y + TEXT / 3.0;
    let height = number(row.height_mm / 10.0, 0, language);
    let mut marks = vec![small_text([HEIGHT_X, y], Anchor::End, height)];
    for ((side, x), girth) in Side::FROM_FRONT.into_iter().zip(GIRTH_X).zip(row.girths) {
        let label = girth.girth_tape_mm.map(|mm| cm_words(mm, language)).unwrap_or_default();
        marks.push(text_mark([x, y], Anchor::End, TEXT, Ink::for_side(side), label));
        if !girth.doubts.is_empty() {
            marks.push(text_mark([x + 3.0, y], Anchor::Start, TEXT, Ink::Text, "?"));
        }
    }
    marks
}

/// The difference as a bar from zero, full if it exceeds its uncertainty and hollow if not, with its
/// standard error as a whisker.
fn bar(row: &Row, y: f64, scale: &Scale) -> Vec<Mark> {
    let ink = Ink::for_side(row.larger());
    let [zero, end] = [0.0, row.difference_mm].map(|mm| scale.at(mm));
    let outline = vec![[zero, y - BAR], [end, y - BAR], [end, y + BAR], [zero, y + BAR]];
    let fill = if row.is_real() { ink } else { Ink::Paper };
    let mut marks = vec![shape(outline, fill, ink, 1.0)];
    if let Some(sd_mm) = row.sd_mm {
        let [from, to] = [-sd_mm, sd_mm].map(|mm| scale.at(row.difference_mm + mm));
        let cap = |x: f64| vec![[x, y - CAP], [x, y + CAP]];
        let whisker = vec![vec![[from, y], [to, y]], cap(from), cap(to)];
        marks.push(lines(whisker, Ink::Text, 1.0));
    }
    marks
}

/// The largest of the differences that exceed their uncertainty, in words.
fn largest(rows: &[Row], language: Language) -> String {
    let real = rows.iter().filter(|row| row.is_real());
    let size = |row: &Row| row.difference_mm.abs();
    match real.max_by(|a, b| size(a).total_cmp(&size(b))) {
        Some(row) => language.filled(
            "picture.largest",
            &[
                ("side", &language.word("leg.only", row.larger().word())),
                ("cm", &cm_words(size(row), language)),
                ("height", &number(row.height_mm / 10.0, 0, language)),
            ],
        ),
        None => language.text("picture.none_differs").to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn girth(height_mm: f64, girth_mm: f64) -> AtFigures {
        AtFigures {
            height_mm,
            along_axis_mm: None,
            girth_tape_mm: Some(girth_mm),
            girth_contour_mm: None,
            girth_sd_mm: Some(0.2),
            doubts: Vec::new(),
        }
    }

    fn row<'a>(girths: [&'a AtFigures; 2], sd_mm: Option<f64>) -> Row<'a> {
        let [right, left] = girths.map(|of| of.girth_tape_mm.unwrap());
        Row { height_mm: girths[0].height_mm, girths, difference_mm: left - right, sd_mm }
    }

    #[test]
    fn a_difference_is_real_beyond_two_standard_errors_and_never_without_one() {
        let (small, large) = (girth(80.0, 200.0), girth(80.0, 206.0));
        for (sd_mm, is_real) in [(Some(2.4), true), (Some(3.1), false), (None, false)] {
            assert_eq!(row([&small, &large], sd_mm).is_real(), is_real, "{sd_mm:?}");
        }
        assert_eq!(row([&large, &small], None).larger(), Side::Right);
    }

    #[test]
    fn the_scale_ends_at_a_step_beyond_the_longest_whisker_and_has_few_labels() {
        let small = girth(80.0, 200.0);
        for (left_mm, end_mm, step_mm) in
            [(200.4, 10.0, 5.0), (239.0, 40.0, 10.0), (300.5, 150.0, 50.0)]
        {
            let left = girth(80.0, left_mm);
            let (scale, step) = bar_scale(&[row([&small, &left], Some(0.6))]);
            assert_eq!((scale.range, step), ([-end_mm, end_mm], step_mm), "{left_mm}");
        }
    }
}
