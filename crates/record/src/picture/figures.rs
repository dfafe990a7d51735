//! The figures of a record: those of the paper and a comparison of the legs, drawn only from the content of `record.json`.

mod curves;
mod differences;
pub mod error;
mod fit;
mod girths;
pub mod plot;
mod sections;
mod sheet;
mod slopes;
mod views;

use gaiter_language::Language;
use gaiter_leg::Level;

use super::{Picture, svg};
use crate::Record;

/// A figure and its file name.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnFigure {
    /// Lower-case ASCII, the same in every language.
    pub name: &'static str,
    /// What is drawn.
    pub picture: Picture,
    /// Its marks as SVG, written once for the page and for files.
    pub marks: String,
}

/// All figures for which the record has data, in reading order.
pub fn all(record: &Record, language: Language) -> Vec<DrawnFigure> {
    let figures = [
        (SHEET, sheet::picture(record, language)),
        ("views", views::picture(record, language)),
        ("girths", girths::picture(record, language)),
        ("differences", differences::picture(record, language)),
        ("sections", sections::picture(record, language)),
        ("fit", fit::picture(record, language)),
        ("error", error::picture(record, language)),
    ];
    let there = |(name, picture): (&'static str, Option<Picture>)| {
        let picture = picture?;
        let marks = svg::marks(&picture);
        Some(DrawnFigure { name, picture, marks })
    };
    figures.into_iter().filter_map(there).collect()
}

/// The legs and their girths in one drawing below each other, as an SVG file, if they are among a
/// record's figures. Its view `front` is the legs from the front alone.
pub(crate) fn overview(figures: &[DrawnFigure], language: Language) -> String {
    let ([mut width, mut height], mut marks) = ([0.0_f64, 0.0], String::new());
    let first = figures.iter().find(|figure| figure.name == OVERVIEW[0]);
    if let Some((front, cut)) = first.and_then(|first| Some((first, first.picture.cuts.first()?))) {
        let [_, height] = front.picture.size;
        marks += &format!("<view id=\"front\" viewBox=\"0 0 {cut:.2} {height:.2}\"/>\n");
    }
    for figure in figures.iter().filter(|figure| OVERVIEW.contains(&figure.name)) {
        let below = format!("<g transform=\"translate(0 {height:.2})\">\n{}</g>\n", figure.marks);
        marks += &below;
        width = width.max(figure.picture.size[0]);
        height += figure.picture.size[1];
    }
    svg::file(language.text("picture.views"), [width, height], &marks)
}

/// The name of the figure on the measuring sheet.
pub(crate) const SHEET: &str = "sheet";

/// The names of the figures that show both legs at a glance.
const OVERVIEW: [&str; 2] = ["views", "girths"];

/// The levels of the paper, highest first, as on a leg.
const LEVELS: [Level; 4] = [Level::D, Level::C, Level::B1, Level::B];
