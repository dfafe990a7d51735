//! `legs.svg`: height–girth curves with the levels (paper, fig. 3), and the section at each level
//! with its feature points (paper, fig. 4c). Seen from the feet with the front up, as in radiology:
//! the patient's right is on the left.

use std::fmt::Write;

use super::Language;
use super::rounding::{self, cm_words};
use crate::leg::feature::Kind;
use crate::leg::{Estimate, Extraction, Landmark, LegReport, Level, LevelSection, Side};

/// Size of the drawing, px.
const SIZE: [f64; 2] = [1080.0, 760.0];

/// The chart's frame: left, top, right, bottom, px.
const CHART: [f64; 4] = [70.0, 70.0, 560.0, 700.0];

/// Middle of the right and of the left leg's column of sections, px.
const COLUMNS: [f64; 2] = [700.0, 920.0];

/// Heights of the rows of sections, highest level first, px.
const ROWS: [(Level, f64); 4] =
    [(Level::D, 150.0), (Level::C, 310.0), (Level::B1, 475.0), (Level::B, 625.0)];

/// Sections are drawn to this scale, px per mm.
const SECTION_SCALE: f64 = 0.95;

/// Points of a section's outline.
const OUTLINE_POINTS: usize = 180;

/// The whole drawing.
pub fn legs(extraction: &Extraction) -> String {
    let [width, height] = SIZE;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"sans-serif\" font-size=\"13\" fill=\"#223\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
    );
    let chart = Chart::around(extraction);
    svg += &chart.frame();
    for leg in &extraction.legs {
        svg += &chart.curve(leg);
        svg += &sections(leg);
        svg += &foot(leg);
    }
    svg + &headings() + "</svg>\n"
}

fn colour(side: Side) -> &'static str {
    match side {
        Side::Left => "#0a6",
        Side::Right => "#c43",
    }
}

/// The patient's right is on the left.
fn column(side: Side) -> f64 {
    match side {
        Side::Right => COLUMNS[0],
        Side::Left => COLUMNS[1],
    }
}

fn headings() -> String {
    let mut text = String::new();
    for side in Side::BOTH {
        let x = column(side);
        let (colour, word) = (colour(side), side.word());
        let _ = writeln!(
            text,
            "<text x=\"{x}\" y=\"45\" text-anchor=\"middle\" font-weight=\"bold\" \
             fill=\"{colour}\">{word} leg</text>"
        );
    }
    let x = (COLUMNS[0] + COLUMNS[1]) / 2.0;
    let _ = writeln!(
        text,
        "<text x=\"{x}\" y=\"66\" text-anchor=\"middle\" font-size=\"11\">sections to scale, \
         seen from the feet, front up</text>"
    );
    for (level, y) in ROWS {
        let _ = writeln!(
            text,
            "<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" font-weight=\"bold\">{}</text>",
            level.name()
        );
    }
    text
}

/// Millimetres as the clinic reads them, of the figure that the record holds.
fn cm(mm: f64) -> String {
    cm_words(rounding::mm(mm), Language::En)
}

/// Scales of the height–girth chart: girth to the right, height up.
struct Chart {
    girth_mm: [f64; 2],
    height_mm: [f64; 2],
}

impl Chart {
    /// Scales that hold every measured section, ends at whole 50 mm.
    fn around(extraction: &Extraction) -> Chart {
        let rows = extraction.legs.iter().flat_map(|leg| &leg.girth_curve.rows);
        let measured = rows.filter_map(|row| row.measured);
        let (mut girth_mm, mut height_mm) = ([f64::INFINITY, 0.0_f64], [0.0, 0.0_f64]);
        for (height, girth) in measured {
            girth_mm = [girth_mm[0].min(girth.tape_mm), girth_mm[1].max(girth.tape_mm)];
            height_mm[1] = height_mm[1].max(height);
        }
        let whole =
            |[low, high]: [f64; 2]| [(low / 50.0).floor() * 50.0, (high / 50.0).ceil() * 50.0];
        Chart { girth_mm: whole(girth_mm), height_mm: whole(height_mm) }
    }

    fn x(&self, girth_mm: f64) -> f64 {
        let [low, high] = self.girth_mm;
        CHART[0] + (girth_mm - low) / (high - low) * (CHART[2] - CHART[0])
    }

    fn y(&self, height_mm: f64) -> f64 {
        let [low, high] = self.height_mm;
        CHART[3] - (height_mm - low) / (high - low) * (CHART[3] - CHART[1])
    }

    /// Grid lines every 50 mm of girth and 100 mm of height, with their figures in cm.
    fn frame(&self) -> String {
        let mut text = String::from(
            "<text x=\"70\" y=\"45\" font-weight=\"bold\">tape girth (cm, across) over height \
             (cm, up)</text>\n",
        );
        let [left, top, right, bottom] = CHART;
        for girth in steps(self.girth_mm, 50.0) {
            let x = self.x(girth);
            let _ = writeln!(
                text,
                "<path d=\"M{x:.1} {top}V{bottom}\" stroke=\"#dde\"/>\
                 <text x=\"{x:.1}\" y=\"718\" text-anchor=\"middle\">{:.0}</text>",
                girth / 10.0
            );
        }
        for height in steps(self.height_mm, 100.0) {
            let y = self.y(height);
            let _ = writeln!(
                text,
                "<path d=\"M{left} {y:.1}H{right}\" stroke=\"#dde\"/>\
                 <text x=\"62\" y=\"{:.1}\" text-anchor=\"end\">{:.0}</text>",
                y + 4.0,
                height / 10.0
            );
        }
        text
    }

    /// One leg's measured sections as a line, broken where sections are open, and its levels.
    fn curve(&self, leg: &LegReport) -> String {
        let mut path = String::new();
        let mut pen = 'M';
        for row in &leg.girth_curve.rows {
            let Some((height_mm, girth)) = row.measured else {
                pen = 'M';
                continue;
            };
            let _ = write!(path, "{pen}{:.1} {:.1}", self.x(girth.tape_mm), self.y(height_mm));
            pen = 'L';
        }
        let colour = colour(leg.side);
        let mut text =
            format!("<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>\n");
        for Landmark { level, height_mm, girth_tape_mm, .. } in &leg.landmarks {
            if is_across(*level) {
                text += &self.level(leg.side, *level, [*height_mm, *girth_tape_mm], true);
            }
        }
        for Estimate { level, height_mm, girth_tape_mm, .. } in &leg.estimates {
            if is_across(*level) {
                text += &self.level(leg.side, *level, [*height_mm, *girth_tape_mm], false);
            }
        }
        text
    }

    /// A level's dot on the curve, hollow where it is estimated; labels of the two legs keep to
    /// their own side of it.
    fn level(
        &self,
        side: Side,
        level: Level,
        [height_mm, girth_mm]: [f64; 2],
        is_found: bool,
    ) -> String {
        let (x, y) = (self.x(girth_mm), self.y(height_mm));
        let (fill, mark) = if is_found { (colour(side), "") } else { ("#fff", "~") };
        let (offset, anchor) = match side {
            Side::Left => (10.0, "start"),
            Side::Right => (-10.0, "end"),
        };
        format!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{fill}\" stroke=\"{}\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{mark}{} {}</text>\n",
            colour(side),
            x + offset,
            y + 4.0,
            level.name(),
            cm(girth_mm)
        )
    }
}

/// Multiples of a step within a range, both ends included.
fn steps([low, high]: [f64; 2], step: f64) -> impl Iterator<Item = f64> {
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last).map(move |index| index as f64 * step)
}

/// Whether a level is a section across the leg and so a place on the curve.
fn is_across(level: Level) -> bool {
    level >= Level::B
}

/// The measures of one leg's foot, below its sections.
fn foot(leg: &LegReport) -> String {
    let found = leg.landmarks.iter().map(|l| ("", l.level, l.girth_tape_mm));
    let estimated = leg.estimates.iter().map(|e| ("~", e.level, e.girth_tape_mm));
    let girths = found.chain(estimated).filter(|(_, level, _)| !is_across(*level));
    let mut words: Vec<String> =
        girths.map(|(mark, level, mm)| format!("{mark}{} {}", level.name(), cm(mm))).collect();
    words.extend(leg.foot.map(|foot| format!("foot {} long", cm(foot.length_mm))));
    format!(
        "<text x=\"{}\" y=\"738\" text-anchor=\"middle\" font-size=\"11\">{}</text>\n",
        column(leg.side),
        words.join(" · ")
    )
}

/// The sections at one leg's levels.
fn sections(leg: &LegReport) -> String {
    let at = |level: Level| leg.level_sections.iter().find(|section| section.level == level);
    let found = ROWS.iter().filter_map(|(level, y)| Some((at(*level)?, *y)));
    found.map(|(section, y)| outline(leg.side, section, y)).collect()
}

/// One section, front up, the patient's right leg's lateral side on the left.
fn outline(side: Side, at: &LevelSection, middle_y: f64) -> String {
    let middle_x = column(side);
    let place = |front: f64, lateral: f64| {
        let across = lateral * side.lateral_sign() * SECTION_SCALE;
        (middle_x + across, middle_y - front * SECTION_SCALE)
    };
    let points = at.section.curve.points(OUTLINE_POINTS);
    let path: Vec<String> = points
        .iter()
        .map(|point| place(point.x, point.y))
        .map(|(x, y)| format!("{x:.1} {y:.1}"))
        .collect();
    let mut text = format!(
        "<path d=\"M{}Z\" fill=\"#f6f7fb\" stroke=\"{}\" stroke-width=\"1.5\"/>\n",
        path.join("L"),
        colour(side)
    );
    for (index, feature) in at.features.iter().enumerate() {
        let angle = feature.angle_deg.to_radians();
        let [radius, ..] = at.section.curve.derivatives(angle);
        let (x, y) = place(radius * angle.cos(), radius * angle.sin());
        let (label_x, label_y) = place((radius - 9.0) * angle.cos(), (radius - 9.0) * angle.sin());
        let fill = if feature.kind == Kind::Peak { "#225" } else { "#fff" };
        let _ = writeln!(
            text,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.5\" fill=\"{fill}\" stroke=\"#225\"/>\
             <text x=\"{label_x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"7\">P{}</text>",
            label_y + 2.5,
            index + 1
        );
    }
    text
}
