//! Pictures of a record as data: lines, dots and words in inks, which SVG, PDF and PNG are made of.

pub mod figures;
mod ink;
pub mod svg;

pub use ink::{Colour, Ink, Theme};

/// A drawing; x to the right, y down, px.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// What it shows, in words, for those who do not see it.
    pub title: String,
    /// Width and height, px.
    pub size: [f64; 2],
    /// What is drawn, the later over the earlier.
    pub marks: Vec<Mark>,
}

/// One thing that is drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// Lines, each through its points.
    Lines {
        /// The points of each, px.
        lines: Vec<Vec<[f64; 2]>>,
        /// Whether each goes back to its beginning.
        is_closed: bool,
        /// What fills them; where they overlap by the rule of even and odd.
        fill: Option<Ink>,
        /// What they are drawn with.
        stroke: Option<Stroke>,
    },
    /// Round dots of one size.
    Dots {
        /// Their middles, px.
        at: Vec<[f64; 2]>,
        /// px.
        radius: f64,
        /// What fills them.
        fill: Option<Ink>,
        /// What they are drawn with.
        stroke: Option<Stroke>,
    },
    /// Words on a line.
    Words {
        /// Where the line of the letters begins, is centred or ends, px.
        at: [f64; 2],
        /// Which of these.
        anchor: Anchor,
        /// Height of the letters with their room, px.
        size: f64,
        /// Whether they stand out.
        is_bold: bool,
        /// What they are written with.
        ink: Ink,
        /// What they say.
        words: String,
    },
}

/// A line's pen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Its ink.
    pub ink: Ink,
    /// Its width, px.
    pub width: f64,
    /// Length of dashes and of the gaps between them, px; none: one line.
    pub dash: Option<f64>,
}

/// What of a line of words lies at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

impl Stroke {
    /// A whole line.
    pub fn of(ink: Ink, width: f64) -> Option<Stroke> {
        Some(Stroke { ink, width, dash: None })
    }

    /// A dashed line.
    pub fn dashed(ink: Ink, width: f64, dash: f64) -> Option<Stroke> {
        Some(Stroke { ink, width, dash: Some(dash) })
    }
}
