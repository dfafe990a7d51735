//! The scan's own points on the planes of the levels and the curves fitted to them, in polar
//! coordinates (paper, fig. 2d).

use gaiter_language::Language;
use gaiter_leg::{Level, Side};

use super::LEVELS;
use super::plot::{Frame, Scale, TEXT, heading, lines, range, small_text, text_mark};
use crate::picture::{Anchor, Ink, Mark, Picture};
use crate::schema::SectionFigures;
use crate::shape::OutlineFigures;
use crate::{Record, rounding};

/// Width, px.
const WIDTH: f64 = 720.0;

/// Space above the first row, px.
const TOP: f64 = 48.0;

/// Height of a level's row, px.
const ROW: f64 = 138.0;

/// Width of a leg's half, px.
const HALF: f64 = WIDTH / 2.0;

/// Left and right of a chart within its half, px.
const CHART_X: [f64; 2] = [44.0, 340.0];

/// The figure; `None` for a record without sections.
pub(super) fn picture(record: &Record, language: Language) -> Option<Picture> {
    record.legs.iter().flat_map(|leg| &leg.sections).next()?;
    let mut marks = Vec::new();
    for (half, side) in Side::FROM_FRONT.into_iter().enumerate() {
        let left = half as f64 * HALF;
        let ink = Ink::for_side(side);
        let title = [left + CHART_X[0], 18.0];
        marks.push(heading(title, Anchor::Start, ink, language.word("leg", side.word())));
        let radius = language.text("picture.radius_mm");
        marks.push(small_text([left + 4.0, 36.0], Anchor::Start, radius));
        for (row, level) in LEVELS.into_iter().enumerate() {
            let section = record
                .leg(side)
                .and_then(|leg| leg.sections.iter().find(|at| at.level == level.name()));
            let at = [left, TOP + row as f64 * ROW];
            marks.extend(cell(section, side, level, at, language));
        }
    }
    let y = TOP + LEVELS.len() as f64 * ROW + 10.0;
    marks.push(dots(vec![[CHART_X[0], y - 4.0]], 2.0));
    let points = language.text("picture.points");
    marks.push(text_mark([CHART_X[0] + 10.0, y], Anchor::Start, TEXT, Ink::Text, points));
    marks.push(lines(vec![vec![[200.0, y - 4.0], [226.0, y - 4.0]]], Ink::Text, 1.5));
    let fitted = language.text("picture.fitted");
    marks.push(text_mark([234.0, y], Anchor::Start, TEXT, Ink::Text, fitted));
    Some(Picture {
        title: language.text("picture.fit").to_owned(),
        size: [WIDTH, y + 14.0],
        cuts: vec![HALF],
        marks,
    })
}

fn cell(
    section: Option<&SectionFigures>,
    side: Side,
    level: Level,
    [left, top]: [f64; 2],
    language: Language,
) -> Vec<Mark> {
    let title = [left + CHART_X[0], top + 12.0];
    let mut marks = vec![heading(title, Anchor::Start, Ink::Text, level.name())];
    let Some(section) = section else {
        let at = [left + f64::midpoint(CHART_X[0], CHART_X[1]), top + ROW / 2.0];
        let absent = language.text("picture.absent");
        marks.push(text_mark(at, Anchor::Middle, TEXT, Ink::Muted, absent));
        return marks;
    };
    let rms = format!("rms {} mm", rounding::number(section.rms_mm, 2, language));
    let end = [left + CHART_X[1], top + 12.0];
    marks.push(small_text(end, Anchor::End, rms));
    marks.extend(chart(&section.outline, side, [left, top], language));
    marks
}

fn chart(
    outline: &OutlineFigures,
    side: Side,
    [left, top]: [f64; 2],
    language: Language,
) -> Vec<Mark> {
    let radii = outline.radius_mm.iter().chain(&outline.scan_radius_mm);
    let Some(range) = range(radii.copied(), 10.0) else { return Vec::new() };
    let frame = Frame {
        x: Scale { range: [-180.0, 180.0], px: CHART_X.map(|x| left + x) },
        y: Scale { range, px: [top + ROW - 32.0, top + 20.0] },
    };
    let step = if range[1] - range[0] > 30.0 { 20.0 } else { 10.0 };
    let mut marks = frame.rows(step, |mm| format!("{mm:.0}"));
    let direction = |angle: f64| match angle as i64 {
        -90 => language.text("picture.medial"),
        0 => language.text("picture.front"),
        90 => language.text("picture.lateral"),
        _ => language.text("picture.back"),
    };
    marks.extend(frame.columns(90.0, |angle| direction(angle).to_owned()));
    let scan = outline.scan_angle_deg.iter().zip(&outline.scan_radius_mm);
    marks.push(dots(scan.map(|(angle, radius)| frame.at([*angle, *radius])).collect(), 1.75));
    let count = outline.radius_mm.len();
    let place = |index: usize| {
        let angle = -180.0 + 360.0 * index as f64 / count as f64;
        frame.at([angle, outline.radius_mm[index % count]])
    };
    marks.push(lines(vec![(0..=count).map(place).collect()], Ink::for_side(side), 1.25));
    marks
}

fn dots(at: Vec<[f64; 2]>, radius: f64) -> Mark {
    Mark::Dots { at, radius, fill: Some(Ink::Scan), stroke: None }
}
