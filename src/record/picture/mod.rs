//! Pictures of a record as data: lines, dots and words in inks, which SVG, PDF and PNG are made of.

pub mod figures;
pub mod font;
mod ink;
mod outline;
pub mod png;
pub mod svg;

pub use ink::{Colour, Ink, Theme};
pub use outline::Segment;

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

impl Anchor {
    /// The share of the words' width that lies before their place.
    pub fn share(self) -> f64 {
        match self {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5,
            Anchor::End => 1.0,
        }
    }
}

impl Picture {
    /// This one with another below it, as one.
    pub fn above(self, below: Picture) -> Picture {
        let ([width, height], [other_width, other_height]) = (self.size, below.size);
        let moved = below.marks.into_iter().map(|mark| mark.moved_down(height));
        Picture {
            title: self.title,
            size: [width.max(other_width), height + other_height],
            marks: self.marks.into_iter().chain(moved).collect(),
        }
    }
}

impl Mark {
    fn moved_down(self, way: f64) -> Mark {
        let down = |[x, y]: [f64; 2]| [x, y + way];
        match self {
            Mark::Lines { lines, is_closed, fill, stroke } => {
                let moved = |line: Vec<[f64; 2]>| line.into_iter().map(down).collect();
                Mark::Lines {
                    lines: lines.into_iter().map(moved).collect(),
                    is_closed,
                    fill,
                    stroke,
                }
            }
            Mark::Dots { at, radius, fill, stroke } => {
                Mark::Dots { at: at.into_iter().map(down).collect(), radius, fill, stroke }
            }
            Mark::Words { at, anchor, size, is_bold, ink, words } => {
                Mark::Words { at: down(at), anchor, size, is_bold, ink, words }
            }
        }
    }
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
