//! What the scanner's own measures imply about ours.

use crate::figure::{AsFigure, Figure};

/// A measure that has a counterpart here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Height of the body.
    Stature,
    /// Girth of the calf, at C.
    Calf,
    /// Girth over the malleoli, somewhat larger than B.
    Ankle,
}

impl AsFigure for Measure {
    fn figure(&self) -> Option<Figure> {
        None
    }
}

coded_enum! {
    /// A disagreement between the scanner's measures and ours, or the reason for not comparing them.
    #[derive(Debug, Clone, PartialEq)]
    pub enum SecondOpinion {
        /// The measurement file could not be read.
        Unreadable {
            /// The reason.
            why: String,
        } => "ord-unreadable",
        /// More than one measurement file could belong to the scan.
        Ambiguous {
            /// How many.
            files: usize,
        } => "ord-ambiguous",
        /// The scanner's stature is ours in another unit.
        Unit {
            /// The scanner's stature, mm by its unit.
            theirs_mm: f64,
            /// Our stature, mm.
            ours_mm: f64,
            /// Ratio of the units.
            factor: f64,
        } => "ord-unit",
        /// A measure differs by more than the definitions of two programs explain.
        Disagrees {
            /// Which measure.
            measure: Measure,
            /// The scanner's value, mm.
            theirs_mm: f64,
            /// Our value, mm.
            ours_mm: f64,
        } => "ord-disagrees",
        /// Each calf fits the other leg.
        Sides {
            /// The scanner's left calf, mm.
            left_mm: f64,
            /// The scanner's right calf, mm.
            right_mm: f64,
        } => "ord-sides",
    }
}
