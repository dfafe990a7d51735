//! The sections at the levels with their feature points, and the curvature by which they are found
//! (paper, fig. 4b and 4c). Seen from the feet with the front up, as in radiology: the patient's right
//! is on the left.

use gaiter_language::Language;
use gaiter_leg::{Level, Side};

use super::LEVELS;
use super::plot::{
    Frame, LINE, SMALL, Scale, TEXT, heading, kept_apart, lines, range, shape, small_text,
    text_mark,
};
use crate::Record;
use crate::picture::{Anchor, Ink, Mark, Picture, Stroke};
use crate::rounding::cm_words;
use crate::schema::{FeatureFigures, LegFigures};
use crate::shape::OutlineFigures;

/// Width, px.
const WIDTH: f64 = 720.0;

/// Space above the first row, px.
const TOP: f64 = 56.0;

/// Height of a level's row, px.
const ROW: f64 = 176.0;

/// Width of a leg's half, px.
const HALF: f64 = WIDTH / 2.0;

/// Middle of a section within its half, px.
const OUTLINE_X: f64 = 90.0;

/// Middle of a section below the top of its row, px.
const MIDDLE: f64 = 82.0;

/// Radius of the largest section, px.
const RADIUS: f64 = 62.0;

/// Length of the scale bar, mm.
const BAR_MM: f64 = 50.0;

/// Left and right of a chart of curvature within its half, px.
const CHART_X: [f64; 2] = [200.0, 346.0];

/// Distance from a feature point to its name, px.
const ASIDE: f64 = 11.0;

/// A name that stands further around than this from its point has a line to it, degrees.
const LED_DEG: f64 = 5.0;

/// The figure; `None` for a record without outlines.
pub(super) fn picture(record: &Record, language: Language) -> Option<Picture> {
    let outlines = record.legs.iter().flat_map(|leg| LEVELS.map(|level| outline(leg, level)));
    let outlines: Vec<&OutlineFigures> = outlines.flatten().collect();
    let radii = outlines.iter().flat_map(|outline| outline.radius_mm.iter().copied());
    let [_, largest_mm] = range(radii, 1.0)?;
    let curvatures = outlines.iter().flat_map(|outline| outline.curvature_per_mm.iter());
    let range = range(curvatures.map(|per_mm| per_mm * 1000.0).chain([0.0]), 20.0)?;
    let sheet = Sheet { px_per_mm: RADIUS / largest_mm, per_metre: range, language };
    let mut marks = Vec::new();
    for (half, side) in Side::FROM_FRONT.into_iter().enumerate() {
        let left = half as f64 * HALF;
        let ink = Ink::for_side(side);
        let leg = language.word("leg", side.word());
        marks.push(heading([left + OUTLINE_X, 20.0], Anchor::Middle, ink, leg));
        let from_feet = language.text("picture.from_feet");
        marks.push(small_text([left + 8.0, 36.0], Anchor::Start, from_feet));
        let middle = f64::midpoint(CHART_X[0], CHART_X[1]);
        let curvature = language.text("picture.curvature");
        marks.push(heading([left + middle, 20.0], Anchor::Middle, Ink::Text, curvature));
        for (row, level) in LEVELS.into_iter().enumerate() {
            let at = [left, TOP + row as f64 * ROW];
            marks.extend(sheet.cell(record.leg(side), side, level, at));
        }
    }
    let size = [WIDTH, TOP + LEVELS.len() as f64 * ROW];
    let title = language.text("picture.sections").to_owned();
    Some(Picture { title, size, cuts: vec![HALF], marks })
}

fn outline(leg: &LegFigures, level: Level) -> Option<&OutlineFigures> {
    let at = leg.sections.iter().find(|section| section.level == level.name());
    at.map(|section| &section.outline)
}

/// The values that all cells share.
struct Sheet {
    px_per_mm: f64,
    /// Range of the curvature, 1/m.
    per_metre: [f64; 2],
    language: Language,
}

impl Sheet {
    /// One level of one leg.
    fn cell(&self, leg: Option<&LegFigures>, side: Side, level: Level, at: [f64; 2]) -> Vec<Mark> {
        let [left, top] = at;
        let middle = [left + OUTLINE_X, top + MIDDLE];
        let mut marks =
            vec![heading([left + 8.0, top + 18.0], Anchor::Start, Ink::Text, level.name())];
        let Some((leg, outline)) = leg.and_then(|leg| Some((leg, outline(leg, level)?))) else {
            let absent = self.language.text("picture.absent");
            marks.push(text_mark(middle, Anchor::Middle, TEXT, Ink::Muted, absent));
            return marks;
        };
        let features: Vec<&FeatureFigures> =
            leg.features.iter().filter(|feature| feature.level == level.name()).collect();
        marks.extend(self.section(outline, &features, side, middle));
        let girth = leg.landmarks.get(level.name()).map(|found| found.girth_tape_mm);
        marks.extend(girth.into_iter().flat_map(|mm| self.girth(mm, side, middle)));
        marks.extend(self.bar([left + 8.0, top + ROW - 12.0]));
        marks.extend(self.chart(outline, &features, side, at));
        marks
    }

    /// The girth by tape within the section.
    fn girth(&self, mm: f64, side: Side, [x, y]: [f64; 2]) -> [Mark; 2] {
        let ink = Ink::for_side(side);
        [
            heading([x, y + 1.0], Anchor::Middle, ink, cm_words(mm, self.language)),
            text_mark([x, y + 12.0], Anchor::Middle, SMALL, ink, "cm"),
        ]
    }

    /// The scale bar, from its left end.
    fn bar(&self, [x, y]: [f64; 2]) -> [Mark; 2] {
        let end = x + BAR_MM * self.px_per_mm;
        let tick = |x: f64| vec![[x, y - 3.0], [x, y + 3.0]];
        let words_at = [end + 5.0, y + SMALL / 3.0];
        let length = format!("{:.0} cm", BAR_MM / 10.0);
        [
            lines(vec![vec![[x, y], [end, y]], tick(x), tick(end)], Ink::Muted, 1.0),
            small_text(words_at, Anchor::Start, length),
        ]
    }

    fn section(
        &self,
        outline: &OutlineFigures,
        features: &[&FeatureFigures],
        side: Side,
        [x, y]: [f64; 2],
    ) -> Vec<Mark> {
        // Front up. Lateral is outward, so on the right leg it is to the viewer's left.
        let out = match side {
            Side::Left => 1.0,
            Side::Right => -1.0,
        };
        let place = |angle_deg: f64, px: f64| {
            let (sin, cos) = angle_deg.to_radians().sin_cos();
            [x + out * px * sin, y - px * cos]
        };
        let radius = |angle_deg: f64| at_angle(&outline.radius_mm, angle_deg) * self.px_per_mm;
        let count = outline.radius_mm.len();
        let angle = |index: usize| -180.0 + 360.0 * index as f64 / count as f64;
        let line = (0..count).map(|i| place(angle(i), outline.radius_mm[i] * self.px_per_mm));
        let mut marks = vec![shape(line.collect(), Ink::Skin, Ink::for_side(side), 1.75)];
        // Names are spaced around the section by the angle that a line of text needs there.
        let wished: Vec<f64> = features.iter().map(|feature| feature.angle_deg).collect();
        let mean_px = outline.radius_mm.iter().sum::<f64>() / count.max(1) as f64 * self.px_per_mm;
        let apart_deg = (16.0 / (mean_px + ASIDE)).to_degrees();
        for (feature, label_deg) in features.iter().zip(kept_apart(&wished, apart_deg)) {
            let px = radius(feature.angle_deg);
            let dot_at = place(feature.angle_deg, px);
            let far = radius(label_deg).max(px) + ASIDE;
            let [x, y] = place(label_deg, far);
            if (label_deg - feature.angle_deg).abs() > LED_DEG {
                let tip = place(label_deg, far - ASIDE / 2.0);
                marks.push(lines(vec![vec![dot_at, tip]], Ink::Muted, 0.6));
            }
            marks.push(dot(dot_at, feature));
            marks.push(feature_name([x, y + SMALL / 3.0], feature));
        }
        marks
    }

    fn chart(
        &self,
        outline: &OutlineFigures,
        features: &[&FeatureFigures],
        side: Side,
        [left, top]: [f64; 2],
    ) -> Vec<Mark> {
        let frame = Frame {
            x: Scale { range: [-180.0, 180.0], px: CHART_X.map(|x| left + x) },
            y: Scale { range: self.per_metre, px: [top + ROW - 38.0, top + 22.0] },
        };
        let mut marks = frame.rows(20.0, |per_metre| format!("{per_metre:.0}"));
        marks.extend(frame.columns(90.0, |_| String::new()));
        // Below the names of the valleys.
        let below = frame.y.px[0] + LINE + SMALL;
        let names = ["picture.medial", "picture.front", "picture.lateral"];
        let names = [-90.0, 0.0, 90.0].into_iter().zip(names.map(|key| self.language.text(key)));
        marks.extend(
            names.map(|(angle, name)| small_text([frame.x.at(angle), below], Anchor::Middle, name)),
        );
        let count = outline.curvature_per_mm.len().max(1);
        let place = |index: usize| {
            let angle = -180.0 + 360.0 * index as f64 / count as f64;
            frame.at([angle, outline.curvature_per_mm[index % count] * 1000.0])
        };
        // Closes the curve.
        marks.push(lines(vec![(0..=count).map(place).collect()], Ink::for_side(side), 1.5));
        for is_peak in [true, false] {
            let here: Vec<&FeatureFigures> =
                features.iter().copied().filter(|feature| is_peak == rises(feature)).collect();
            let at = |feature: &FeatureFigures| {
                let per_mm = at_angle(&outline.curvature_per_mm, feature.angle_deg);
                frame.at([feature.angle_deg, per_mm * 1000.0])
            };
            let wished: Vec<f64> = here.iter().map(|feature| at(feature)[0]).collect();
            for (feature, x) in here.iter().zip(kept_apart(&wished, 15.0)) {
                let [dot_x, y] = at(feature);
                marks.push(dot([dot_x, y], feature));
                let y = if is_peak { y - 6.0 } else { y + 6.0 + SMALL * 0.75 };
                marks.push(feature_name([x, y], feature));
            }
        }
        marks
    }
}

/// The value of a row around the section at an angle, interpolated between the two nearest places.
fn at_angle(row: &[f64], angle_deg: f64) -> f64 {
    let count = row.len();
    if count == 0 {
        return 0.0;
    }
    let place = (angle_deg + 180.0).rem_euclid(360.0) / 360.0 * count as f64;
    let (below, part) = (place as usize, place.fract());
    let at = |index: usize| row[index % count];
    at(below) + part * (at(below + 1) - at(below))
}

fn rises(feature: &FeatureFigures) -> bool {
    feature.kind == "peak"
}

/// A feature point: filled for a peak, hollow for a valley.
fn dot(at: [f64; 2], feature: &FeatureFigures) -> Mark {
    let fill = if rises(feature) { Ink::Text } else { Ink::Paper };
    Mark::Dots {
        at: vec![at],
        radius: 3.0,
        fill: Some(fill),
        stroke: Stroke::solid(Ink::Text, 1.25),
    }
}

/// The name of a feature point.
fn feature_name(at: [f64; 2], feature: &FeatureFigures) -> Mark {
    text_mark(at, Anchor::Middle, SMALL, Ink::Text, feature.label.as_str())
}
