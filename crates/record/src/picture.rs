//! Pictures of a record as data: lines, dots and text in inks, from which SVG and PDF are made.

pub mod figures;
pub(super) mod font;
mod ink;
pub mod svg;

pub use ink::{Colour, Ink, Theme};

/// A drawing; x to the right, y down, px.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// A description for people who do not see the picture.
    pub title: String,
    /// Width and height, px.
    pub size: [f64; 2],
    /// Where it may be cut into parts for a narrow screen: places from the left that no mark crosses,
    /// ascending, px.
    pub cuts: Vec<f64>,
    /// The marks, later ones over earlier ones.
    pub marks: Vec<Mark>,
}

/// One mark of a drawing.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// Lines, each through its points.
    Lines {
        /// The points of each, px.
        lines: Vec<Vec<[f64; 2]>>,
        /// Whether each line is closed.
        is_closed: bool,
        /// Their fill, if any, by the even-odd rule.
        fill: Option<Ink>,
        /// Their stroke, if any.
        stroke: Option<Stroke>,
    },
    /// Round dots of one size.
    Dots {
        /// Their centres, px.
        at: Vec<[f64; 2]>,
        /// Radius, px.
        radius: f64,
        /// Their fill, if any.
        fill: Option<Ink>,
        /// Their stroke, if any.
        stroke: Option<Stroke>,
    },
    /// One line of text.
    Words {
        /// Where the baseline starts, is centred or ends, px.
        at: [f64; 2],
        /// Which of these it is.
        anchor: Anchor,
        /// Font size, px.
        size: f64,
        /// Whether the text is bold.
        is_bold: bool,
        /// Its ink.
        ink: Ink,
        /// The text.
        words: String,
    },
}

/// The pen of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Its ink.
    pub ink: Ink,
    /// Its width, px.
    pub width: f64,
    /// Length of the dashes and of the gaps between them, px; `None` for a solid line.
    pub dash: Option<f64>,
}

/// Which part of a text is at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

impl Anchor {
    /// The share of the text's width that lies before its place.
    pub fn share(self) -> f64 {
        match self {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5,
            Anchor::End => 1.0,
        }
    }
}

impl Stroke {
    /// A solid line.
    pub fn solid(ink: Ink, width: f64) -> Option<Stroke> {
        Some(Stroke { ink, width, dash: None })
    }

    /// A dashed line.
    pub fn dashed(ink: Ink, width: f64, dash: f64) -> Option<Stroke> {
        Some(Stroke { ink, width, dash: Some(dash) })
    }
}
