//! Girth over height with the levels, and the slope by which B1 is found (paper, fig. 3).

use gaiter_language::Language;
use gaiter_leg::{Level, Side};

use super::curves::{ROWS_PX, beside, diamond, is_outer_right, left_first, line, short};
use super::plot::{
    Frame, LINE, SMALL, Scale, TEXT, heading, kept_apart, lines, range, shape, small_text,
    text_mark,
};
use super::slopes;
use crate::measure::Measure;
use crate::picture::{Anchor, Ink, Mark, Picture};
use crate::report::Reliability;
use crate::schema::LegFigures;
use crate::{Record, rounding};

/// Width and height, px.
const SIZE: [f64; 2] = [720.0, 506.0];

/// Left and right of the chart of girths, px.
const GIRTHS_PX: [f64; 2] = [50.0, 452.0];

/// Where a narrow screen may cut between the charts, px.
const CUT_PX: f64 = 466.0;

/// Room left free for labels on each side of the curves, px.
const LABEL_PX: f64 = 80.0;

/// Peaks and valleys that stand out by less than this are not marked, mm.
const PROMINENCE_MIN_MM: f64 = 1.5;

struct ChartLevel {
    side: Side,
    name: &'static str,
    height_mm: f64,
    girth_mm: f64,
    is_estimate: bool,
    sign: &'static str,
}

/// The figure; `None` if no section was measured.
pub(super) fn picture(record: &Record, language: Language) -> Option<Picture> {
    let legs = || Side::FROM_FRONT.into_iter().filter_map(|side| Some((side, record.leg(side)?)));
    let frame = frame(legs().map(|(_, leg)| leg))?;
    let mut marks = titles(language);
    marks.extend(frame.rows(100.0, |mm| format!("{:.0}", mm / 10.0)));
    marks.extend(frame.columns(50.0, |mm| format!("{:.0}", mm / 10.0)));
    for (side, leg) in left_first(legs()) {
        marks.push(line(side, curve(leg).map(|of| of.map(|at| frame.at(at)))));
    }
    marks.extend(legs().flat_map(|(side, leg)| extremes(side, leg, &frame)));
    marks.extend(levels(record, &frame, language));
    marks.extend(feet(record, language));
    marks.extend(slopes::chart(record, &frame, language));
    marks.extend(legend(language));
    let title = language.text("picture.girths").to_owned();
    Some(Picture { title, size: SIZE, cuts: vec![CUT_PX], marks })
}

fn titles(language: Language) -> Vec<Mark> {
    let above = ROWS_PX[0] - 12.0;
    let girth = language.text("picture.girth_cm");
    let height = language.text("picture.height_cm");
    vec![
        heading([GIRTHS_PX[0], above], Anchor::Start, Ink::Text, girth),
        small_text([4.0, above - 18.0], Anchor::Start, height),
    ]
}

/// Girth and height of each measured section; `None` if a section is open.
fn curve(leg: &LegFigures) -> impl Iterator<Item = Option<[f64; 2]>> {
    leg.girth_curve.over_height(&leg.girth_curve.tape_mm)
}

fn frame<'a>(legs: impl Iterator<Item = &'a LegFigures> + Clone) -> Option<Frame> {
    let places = || legs.clone().flat_map(curve).flatten();
    let [_, top] = range(places().map(|[_, height]| height), 50.0)?;
    let [low, high] = range(places().map(|[girth, _]| girth), 10.0)?;
    let label_mm = (high - low) * LABEL_PX / (GIRTHS_PX[1] - GIRTHS_PX[0] - 2.0 * LABEL_PX);
    let with_labels = [(low - label_mm).max(0.0), high + label_mm];
    Some(Frame {
        x: Scale { range: range(with_labels.into_iter(), 50.0)?, px: GIRTHS_PX },
        y: Scale { range: [0.0, top], px: [ROWS_PX[1], ROWS_PX[0]] },
    })
}

/// Small hollow triangles at the peaks and valleys of the curve.
fn extremes(side: Side, leg: &LegFigures, frame: &Frame) -> Vec<Mark> {
    let places: Vec<[f64; 2]> = curve(leg).flatten().collect();
    let turns = turning(&places.iter().map(|[girth, _]| *girth).collect::<Vec<_>>());
    let mark = |(index, is_peak): (usize, bool)| {
        let outline = triangle(frame.at(places[index]), 3.5, is_peak);
        shape(outline, Ink::Paper, Ink::for_side(side), 1.0)
    };
    turns.into_iter().map(mark).collect()
}

/// Places in a row that stand out as peaks (true) or valleys (false) from the values between them.
fn turning(row: &[f64]) -> Vec<(usize, bool)> {
    let mut found: Vec<(usize, bool)> = Vec::new();
    // The highest and the lowest place since the last turn.
    let (mut high, mut low) = (0, 0);
    let mut is_rising = None;
    for (index, value) in row.iter().enumerate() {
        high = if *value > row[high] { index } else { high };
        low = if *value < row[low] { index } else { low };
        if is_rising != Some(false) && row[high] - value > PROMINENCE_MIN_MM {
            found.extend((high > 0).then_some((high, true)));
            (is_rising, low) = (Some(false), index);
        } else if is_rising != Some(true) && value - row[low] > PROMINENCE_MIN_MM {
            found.extend((low > 0).then_some((low, false)));
            (is_rising, high) = (Some(true), index);
        }
    }
    found
}

/// A triangle that points right, to larger girths, for a peak, and left for a valley.
fn triangle([x, y]: [f64; 2], size: f64, is_peak: bool) -> Vec<[f64; 2]> {
    let tip = if is_peak { size } else { -size };
    vec![[x + tip * 1.2, y], [x - tip * 0.8, y - size], [x - tip * 0.8, y + size]]
}

/// The levels across the leg with their girths, the labels on the outer sides of the two curves.
fn levels(record: &Record, frame: &Frame, language: Language) -> Vec<Mark> {
    let found: Vec<ChartLevel> =
        Side::FROM_FRONT.into_iter().flat_map(|side| of_leg(record, side)).collect();
    let mut marks = Vec::new();
    for at_right in [false, true] {
        let here: Vec<&ChartLevel> =
            found.iter().filter(|level| level.is_at_right(record) == at_right).collect();
        let wished: Vec<f64> = here.iter().map(|level| frame.y.at(level.height_mm)).collect();
        for (level, y) in here.iter().zip(kept_apart(&wished, LINE)) {
            marks.extend(labelled(level, frame, y, at_right, language));
        }
    }
    marks
}

/// The levels of a leg that have a height, with what counts.
fn of_leg(record: &Record, side: Side) -> Vec<ChartLevel> {
    let place = |level: Level| {
        let measure = Measure::find(record, side, level).ok()?;
        Some(ChartLevel {
            side,
            name: level.name(),
            height_mm: measure.height?.mm,
            girth_mm: measure.girth.mm,
            is_estimate: measure.mark() == Reliability::Estimated,
            sign: measure.mark().by_hand_sign(),
        })
    };
    Level::ALL.into_iter().filter_map(place).collect()
}

/// The girths of the feet as text, placed high up where no leg is that thin. They are not on the curve.
fn feet(record: &Record, language: Language) -> Vec<Mark> {
    let line = |(row, side): (usize, Side)| {
        let girth = |level: Level| {
            let measure = Measure::find(record, side, level).ok()?;
            let about = if measure.mark() == Reliability::Estimated { "≈ " } else { "" };
            let sign = measure.mark().by_hand_sign();
            let cm = rounding::cm_words(measure.girth.mm, language);
            Some(format!("{about}{} {cm}{sign}", level.name()))
        };
        let on_foot = Level::ALL.into_iter().rev().filter(|level| *level < Level::B);
        let girths: Vec<String> = on_foot.filter_map(girth).collect();
        let text = format!("{}: {}", language.word("leg", side.word()), girths.join(", "));
        let at = [GIRTHS_PX[0] + 8.0, ROWS_PX[0] + 18.0 + row as f64 * LINE];
        (!girths.is_empty()).then(|| text_mark(at, Anchor::Start, SMALL, Ink::for_side(side), text))
    };
    Side::FROM_FRONT.into_iter().enumerate().filter_map(line).collect()
}

impl ChartLevel {
    /// Whether the level's label is on the right.
    fn is_at_right(&self, record: &Record) -> bool {
        let line = record.leg(self.side.other()).map(curve);
        is_outer_right(self.side, [self.girth_mm, self.height_mm], line)
    }
}

/// The mark of a level, and its label at the height `y`.
fn labelled(
    level: &ChartLevel,
    frame: &Frame,
    y: f64,
    at_right: bool,
    language: Language,
) -> Vec<Mark> {
    let at = frame.at([level.girth_mm, level.height_mm]);
    let (aside, anchor) = beside(at_right);
    let mark = match level.name {
        "B1" => diamond(at, 5.5),
        "C" => triangle(at, 5.5, true),
        "B" | "D" => triangle(at, 5.5, false),
        _ => round(at, 4.0),
    };
    let ink = Ink::for_side(level.side);
    let (fill, about) = if level.is_estimate { (Ink::Paper, "≈ ") } else { (ink, "") };
    let girth = rounding::cm_words(level.girth_mm, language);
    let label = [at[0] + aside, y + TEXT / 3.0];
    let way = vec![[at[0] + aside / 2.0, at[1]], [at[0] + aside * 0.85, y]];
    vec![
        lines(vec![way], Ink::Muted, 0.75),
        shape(mark, fill, ink, 1.5),
        text_mark(
            label,
            anchor,
            TEXT,
            ink,
            format!("{} {about}{} {girth}{}", short(level.side, language), level.name, level.sign),
        ),
    ]
}

fn round([x, y]: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let corner = |index: u32| {
        let (sin, cos) = (f64::from(index) * std::f64::consts::TAU / 16.0).sin_cos();
        [x + radius * cos, y + radius * sin]
    };
    (0..16).map(corner).collect()
}

fn legend(language: Language) -> Vec<Mark> {
    let y = SIZE[1] - 14.0;
    let mut marks = Vec::new();
    for (side, x) in Side::FROM_FRONT.into_iter().zip([10.0, 148.0]) {
        marks.push(line(side, [Some([x, y - 4.0]), Some([x + 26.0, y - 4.0])].into_iter()));
        let leg = format!("{} {}", short(side, language), language.word("leg", side.word()));
        marks.push(text_mark([x + 34.0, y], Anchor::Start, TEXT, Ink::for_side(side), leg));
    }
    let shapes = [
        (292.0, triangle([292.0, y - 4.0], 5.0, true), language.text("picture.peak")),
        (378.0, triangle([378.0, y - 4.0], 5.0, false), language.text("picture.valley")),
        (476.0, diamond([476.0, y - 4.0], 5.0), language.text("picture.steepest")),
        (598.0, round([598.0, y - 4.0], 4.0), language.text("picture.proportion")),
    ];
    for (index, (x, outline, word)) in shapes.into_iter().enumerate() {
        let fill = if index == 3 { Ink::Paper } else { Ink::Muted };
        marks.push(shape(outline, fill, Ink::Muted, 1.25));
        marks.push(text_mark([x + 11.0, y], Anchor::Start, TEXT, Ink::Text, word));
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_and_valleys_alternate_and_ripples_are_none() {
        let row = [0.0, 5.0, 10.0, 9.5, 10.5, 4.0, 3.5, 4.0, 3.0, 9.0, 8.0];
        assert_eq!(turning(&row), [(4, true), (8, false)]);
        assert_eq!(turning(&[1.0, 2.0, 3.0]), []);
        assert_eq!(turning(&[]), []);
    }
}
