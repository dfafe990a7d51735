//! The figures of a record: the paper's, drawn from what stands in `record.json` and nothing else.

mod error;
mod fit;
mod girths;
mod plot;
mod sections;
mod views;
mod words;

use self::words::Words;
use super::Picture;
use crate::leg::Level;
use crate::record::{Language, Record};

/// A figure with the name of its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Lower-case ASCII, the same in every language.
    pub name: &'static str,
    /// What is drawn.
    pub picture: Picture,
}

/// All figures that the record has the data for, in the order in which they are read.
pub fn all(record: &Record, language: Language) -> Vec<Figure> {
    let words = Words::of(language);
    let figures = [
        ("views", views::picture(record, language, words)),
        ("girths", girths::picture(record, language, words)),
        ("sections", sections::picture(record, language, words)),
        ("fit", fit::picture(record, language, words)),
        ("error", error::picture(record, language, words)),
    ];
    let there = |(name, picture): (&'static str, Option<Picture>)| {
        picture.map(|picture| Figure { name, picture })
    };
    figures.into_iter().filter_map(there).collect()
}

/// The legs and their girths in one drawing, as far as the record has the data.
pub fn overview(record: &Record, language: Language) -> Picture {
    let words = Words::of(language);
    let parts = [views::picture(record, language, words), girths::picture(record, language, words)];
    let title = words.views.to_owned();
    let nothing = Picture { title, size: [0.0, 0.0], marks: Vec::new() };
    parts.into_iter().flatten().fold(nothing, Picture::above)
}

/// The levels of the paper, the highest first, as they stand on a leg.
const LEVELS: [Level; 4] = [Level::D, Level::C, Level::B1, Level::B];
