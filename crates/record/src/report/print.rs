//! What the report is printed on, and how much of it.

use serde::{Deserialize, Serialize};

/// How the report is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Print {
    /// The paper.
    pub paper: Paper,
    /// Whether the engineering figures follow: the fit of the surface and every figure in mm.
    pub has_appendix: bool,
}

/// The format of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Paper {
    /// ISO 216 A4: 210 mm × 297 mm.
    #[default]
    A4,
    /// ANSI letter: 8.5 in × 11 in.
    Letter,
}

impl Paper {
    /// The name in the configuration and in style sheets.
    pub const fn name(self) -> &'static str {
        match self {
            Paper::A4 => "A4",
            Paper::Letter => "letter",
        }
    }

    /// Width and height, pt.
    pub const fn size_pt(self) -> [f64; 2] {
        match self {
            Paper::A4 => [595.28, 841.89],
            Paper::Letter => [612.0, 792.0],
        }
    }
}
