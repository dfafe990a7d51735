//! The error of the surface as a map: each leg unrolled as seen from the front, with its inner and outer
//! side where the viewer sees them. Colours and, for grey paper, signs: a dot is inside, a stroke outside, a
//! net was not seen.

use std::collections::BTreeMap;

use gaiter_language::Language;
use gaiter_leg::Side;

use super::LEVELS;
use super::plot::{
    Frame, LINE, SMALL, Scale, TEXT, area, heading, kept_apart, lines, range, small_text, stroked,
    text_mark,
};
use crate::picture::{Anchor, Ink, Mark, Picture, Stroke};
use crate::schema::LegFigures;
use crate::shape::SurfaceGridFigures;
use crate::{Record, rounding};

/// Width and height, px.
const SIZE: [f64; 2] = [720.0, 520.0];

/// Top and bottom of the maps, px.
const ROWS_PX: [f64; 2] = [44.0, 430.0];

/// Where a narrow screen may cut between the maps, px.
const CUT_PX: f64 = 366.0;

/// Left and right of each map, px.
const MAPS_PX: [[f64; 2]; 2] = [[52.0, 330.0], [412.0, 690.0]];

/// The scale of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapScale {
    /// Its ends, mm. Larger distances get the colour of the end.
    pub end_mm: f64,
    /// From this distance on a place has its sign, mm.
    pub sign_mm: f64,
}

/// The scale of the error: from half a millimetre on a place has its sign, because less is mostly the noise
/// of scanners.
const ERROR_SCALE: MapScale = MapScale { end_mm: 1.0, sign_mm: 0.5 };

/// Steps of colour on either side of zero.
const STEPS: f64 = 4.0;

/// From this share of the scale on, a colour is so strong that its sign must be pale.
const STRONG_SHARE: f64 = 0.625;

/// Radius of the dot for inside, px.
const DOT: f64 = 1.1;

/// Width of the stroke for outside, px.
const STROKE: f64 = 1.1;

/// Width of the net over what was not seen, px.
const NET: f64 = 0.7;

/// The figure; `None` for a record without shapes.
pub(super) fn picture(record: &Record, language: Language) -> Option<Picture> {
    map_of(record, ERROR_SCALE, language.text("picture.error"), language)
}

/// A map of the distances at the surfaces of a record; `None` without surfaces.
pub fn map_of(
    record: &Record,
    scale: MapScale,
    title: &str,
    language: Language,
) -> Option<Picture> {
    let surfaces = || record.legs.iter().filter_map(|leg| leg.shape.surface.as_ref());
    surfaces().next()?;
    let heights = surfaces().flat_map(heights);
    let y = Scale { range: range(heights, 50.0)?, px: [ROWS_PX[1], ROWS_PX[0]] };
    let mut marks = Vec::new();
    for (side, px) in Side::FROM_FRONT.into_iter().zip(MAPS_PX) {
        // The front is in the middle. On the right leg, lateral is to the viewer's left.
        let range = match side {
            Side::Left => [-180.0, 180.0],
            Side::Right => [180.0, -180.0],
        };
        let frame = Frame { x: Scale { range, px }, y };
        let middle = [f64::midpoint(px[0], px[1]), 20.0];
        let leg = language.word("leg", side.word());
        marks.push(heading(middle, Anchor::Middle, Ink::for_side(side), leg));
        marks.extend(frame.rows(100.0, |mm| format!("{:.0}", mm / 10.0)));
        marks.extend(around(&frame, language));
        marks.extend(map(record.leg(side), &frame, scale, language));
        marks.extend(legend(px[0], scale, language));
    }
    let height = language.text("picture.height_cm");
    marks.push(small_text([4.0, 32.0], Anchor::Start, height));
    Some(Picture { title: title.to_owned(), size: SIZE, cuts: vec![CUT_PX], marks })
}

/// The names of the directions below a map.
fn around(frame: &Frame, language: Language) -> Vec<Mark> {
    let names = [
        (-180.0, language.text("picture.back")),
        (-90.0, language.text("picture.medial")),
        (0.0, language.text("picture.front")),
        (90.0, language.text("picture.lateral")),
        (180.0, language.text("picture.back")),
    ];
    let name = |(angle, name): (f64, &str)| {
        let at = [frame.x.at(angle), ROWS_PX[1] + LINE];
        small_text(at, Anchor::Middle, name)
    };
    names.into_iter().map(name).collect()
}

/// The mean height of each row of a surface, mm.
fn heights(surface: &SurfaceGridFigures) -> Vec<f64> {
    let points = surface.points.as_points();
    let mean = |row: &[Option<nalgebra::Point3<f64>>]| {
        let seen = row.iter().flatten();
        seen.clone().map(|point| point.z).sum::<f64>() / seen.count().max(1) as f64
    };
    points.chunks(surface.columns.max(1)).map(mean).collect()
}

fn map(leg: Option<&LegFigures>, frame: &Frame, scale: MapScale, language: Language) -> Vec<Mark> {
    let surface = leg.and_then(|leg| leg.shape.surface.as_ref());
    let Some((leg, surface)) = leg.zip(surface) else {
        let at =
            [f64::midpoint(frame.x.px[0], frame.x.px[1]), f64::midpoint(ROWS_PX[0], ROWS_PX[1])];
        let none = language.text("picture.no_surface");
        return vec![text_mark(at, Anchor::Middle, TEXT, Ink::Muted, none)];
    };
    let mut marks = cells(surface, frame, scale);
    let named = LEVELS.map(|level| {
        leg.landmarks.get(level.name()).map(|found| (level.name(), frame.y.at(found.height_mm)))
    });
    let named: Vec<(&str, f64)> = named.into_iter().flatten().collect();
    let [left, right] = frame.x.px;
    let wished: Vec<f64> = named.iter().map(|(_, y)| *y).collect();
    for ((name, y), label_y) in named.iter().zip(kept_apart(&wished, LINE)) {
        // With its own background, because the map is equally bright in the dark theme.
        let across = vec![vec![[left, *y], [right, *y]]];
        marks.push(lines(across.clone(), Ink::Paper, 2.5));
        marks.push(stroked(across, Stroke::dashed(Ink::Text, 1.0, 4.0)));
        let at = [right + 6.0, label_y + TEXT / 3.0];
        marks.push(heading(at, Anchor::Start, Ink::Text, *name));
    }
    marks
}

/// The map's nodes as areas that reach halfway to their neighbours, one mark per colour, and their signs.
fn cells(surface: &SurfaceGridFigures, frame: &Frame, scale: MapScale) -> Vec<Mark> {
    let errors = surface.error.as_errors_mm();
    let heights = heights(surface);
    let columns = surface.columns.max(1);
    let width_deg = 360.0 / columns as f64;
    let edge = |row: usize| match (row.checked_sub(1).map(|below| heights[below]), heights.get(row))
    {
        (Some(below), Some(above)) => f64::midpoint(below, *above),
        (Some(end), None) => end,
        (None, first) => first.copied().unwrap_or(0.0),
    };
    let edge_x = |column: usize| frame.x.at(-180.0 + width_deg * column as f64);
    let mut by_step = BTreeMap::<Option<i64>, Vec<Vec<[f64; 2]>>>::new();
    let mut signs = Signs::from_scale(scale);
    for (row, errors) in errors.chunks(columns).enumerate().take(heights.len()) {
        let [low, high] = [edge(row), edge(row + 1)].map(|mm| frame.y.at(mm));
        let steps: Vec<Option<i64>> =
            errors.iter().map(|error| error.map(|mm| scale.step(mm))).collect();
        let mut first = 0;
        for run in steps.chunk_by(|a, b| a == b) {
            let [left, right] = [first, first + run.len()].map(edge_x);
            let area = vec![[left, low], [right, low], [right, high], [left, high]];
            by_step.entry(run[0]).or_default().push(area);
            if run[0].is_none() {
                let corners = (first..=first + run.len()).map(|column| {
                    [edge_x(column), if (column + row).is_multiple_of(2) { low } else { high }]
                });
                signs.net.push(corners.collect());
            }
            first += run.len();
        }
        for (column, mm) in errors.iter().enumerate() {
            if let Some(mm) = mm {
                signs.add(*mm, [edge_x(column), low], [edge_x(column + 1), high]);
            }
        }
    }
    let areas = by_step.into_iter().map(|(step, areas)| area(areas, ink(step)));
    areas.chain(signs.marks()).collect()
}

/// The signs of places, which are seen without colour too: dark on pale colours and pale on strong ones.
struct Signs {
    scale: MapScale,
    dots: [Vec<[f64; 2]>; 2],
    strokes: [Vec<Vec<[f64; 2]>>; 2],
    net: Vec<Vec<[f64; 2]>>,
}

impl Signs {
    fn from_scale(scale: MapScale) -> Signs {
        Signs { scale, dots: Default::default(), strokes: Default::default(), net: Vec::new() }
    }

    /// Adds the sign of a distance between two corners of its place.
    fn add(&mut self, mm: f64, [left, low]: [f64; 2], [right, high]: [f64; 2]) {
        if mm.abs() < self.scale.sign_mm {
            return;
        }
        let is_strong = usize::from(self.scale.step(mm).abs() as f64 / STEPS >= STRONG_SHARE);
        if mm < 0.0 {
            self.dots[is_strong].push([f64::midpoint(left, right), f64::midpoint(low, high)]);
        } else {
            // Uphill on both maps, although angles go the other way round on the right leg's.
            let [from, to] = [left.min(right), left.max(right)];
            self.strokes[is_strong].push(vec![[from, low], [to, high]]);
        }
    }

    fn marks(self) -> Vec<Mark> {
        let dots = self
            .dots
            .into_iter()
            .zip([Ink::Off(-1.0), Ink::Off(0.0)])
            .map(|(at, ink)| Mark::Dots { at, radius: DOT, fill: Some(ink), stroke: None });
        let strokes = self.strokes.into_iter().zip([Ink::Off(1.0), Ink::Off(0.0)]);
        let strokes = strokes.map(|(of, ink)| lines(of, ink, STROKE));
        let net = lines(self.net, Ink::Muted, NET);
        let is_any = |mark: &Mark| match mark {
            Mark::Dots { at, .. } => !at.is_empty(),
            Mark::Lines { lines, .. } => !lines.is_empty(),
            Mark::Words { .. } => true,
        };
        dots.chain(strokes).chain([net]).filter(is_any).collect()
    }
}

impl MapScale {
    /// The colour step of a distance.
    fn step(self, mm: f64) -> i64 {
        (mm / self.end_mm * STEPS).round().clamp(-STEPS, STEPS) as i64
    }
}

fn ink(step: Option<i64>) -> Ink {
    step.map_or(Ink::Skin, |step| Ink::Off(step as f64 / STEPS))
}

/// The scale below a map, from its left end.
fn legend(left: f64, scale: MapScale, language: Language) -> Vec<Mark> {
    const BOX: [f64; 2] = [20.0, 12.0];
    let top = ROWS_PX[1] + 38.0;
    let mut marks = Vec::new();
    let mut signs = Signs::from_scale(scale);
    let box_at =
        |x: f64| vec![[x, top], [x + BOX[0], top], [x + BOX[0], top + BOX[1]], [x, top + BOX[1]]];
    for (index, step) in (-(STEPS as i64)..=STEPS as i64).enumerate() {
        let x = left + index as f64 * BOX[0];
        let mm = step as f64 / STEPS * scale.end_mm;
        marks.push(area(vec![box_at(x)], ink(Some(step))));
        let middle = x + BOX[0] / 2.0;
        let half = BOX[1] / 2.0;
        signs.add(mm, [middle - half, top + BOX[1]], [middle + half, top]);
        if step % 2 == 0 {
            let mm = rounding::number(mm, 1, language);
            let at = [middle, top + BOX[1] + LINE];
            marks.push(small_text(at, Anchor::Middle, mm));
        }
    }
    let end = left + (2.0 * STEPS + 1.0) * BOX[0];
    let unseen = end + 16.0;
    marks.push(area(vec![box_at(unseen)], ink(None)));
    let corner = |index: u32| {
        let y = if index.is_multiple_of(2) { top + BOX[1] } else { top };
        [unseen + f64::from(index) * BOX[0] / 4.0, y]
    };
    signs.net.push((0..=4).map(corner).collect());
    marks.extend(signs.marks());
    for frame in [[left, end], [unseen, unseen + BOX[0]]] {
        let [from, to] = frame;
        let frame =
            vec![[from, top], [to, top], [to, top + BOX[1]], [from, top + BOX[1]], [from, top]];
        marks.push(lines(vec![frame], Ink::Muted, 0.75));
    }
    let below = [left, top + BOX[1] + 2.0 * LINE + 2.0];
    marks.push(text_mark(below, Anchor::Start, SMALL, Ink::Text, language.text("picture.off_mm")));
    let at = [unseen + BOX[0] + 5.0, top + BOX[1] - 2.0];
    marks.push(text_mark(at, Anchor::Start, SMALL, Ink::Text, language.text("picture.unseen")));
    marks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_the_nearest_and_end_with_the_scale() {
        assert_eq!(
            [-9.0, -0.13, -0.12, 0.0, 0.13, 0.3, 1.0].map(|mm| ERROR_SCALE.step(mm)),
            [-4, -1, 0, 0, 1, 1, 4]
        );
    }
}
