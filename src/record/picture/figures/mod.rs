//! The figures of a record: those of the paper, drawn only from the content of `record.json`.

mod error;
mod fit;
mod girths;
mod plot;
mod sections;
mod views;

use super::Picture;
use crate::language::Language;
use crate::leg::Level;
use crate::record::Record;

/// A figure and its file name.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Lower-case ASCII, the same in every language.
    pub name: &'static str,
    /// What is drawn.
    pub picture: Picture,
}

/// All figures for which the record has data, in reading order.
pub fn all(record: &Record, language: Language) -> Vec<Figure> {
    let figures = [
        ("views", views::picture(record, language)),
        ("girths", girths::picture(record, language)),
        ("sections", sections::picture(record, language)),
        ("fit", fit::picture(record, language)),
        ("error", error::picture(record, language)),
    ];
    let there = |(name, picture): (&'static str, Option<Picture>)| {
        picture.map(|picture| Figure { name, picture })
    };
    figures.into_iter().filter_map(there).collect()
}

/// The legs and their girths in one drawing, if they are among a record's figures.
pub fn overview(figures: &[Figure], language: Language) -> Picture {
    let parts = figures.iter().filter(|figure| OVERVIEW.contains(&figure.name));
    let title = language.text("picture.views").to_owned();
    let nothing = Picture { title, size: [0.0, 0.0], marks: Vec::new() };
    parts.map(|figure| figure.picture.clone()).fold(nothing, Picture::above)
}

/// The names of the figures that show both legs at a glance.
const OVERVIEW: [&str; 2] = ["views", "girths"];

/// The levels of the paper, highest first, as on a leg.
const LEVELS: [Level; 4] = [Level::D, Level::C, Level::B1, Level::B];
