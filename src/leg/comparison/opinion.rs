//! What the scanner's own measures say about ours.

/// A measure that has a counterpart here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// Height of the body.
    Stature,
    /// Girth of the calf: C.
    Calf,
    /// Girth over the malleoli, somewhat more than B.
    Ankle,
}

impl Measure {
    fn word(self) -> &'static str {
        match self {
            Measure::Stature => "body height",
            Measure::Calf => "calf girth",
            Measure::Ankle => "ankle girth",
        }
    }

    /// What a measure of theirs is compared with.
    fn own(self) -> &'static str {
        match self {
            Measure::Stature => "body height",
            Measure::Calf => "C",
            Measure::Ankle => "B",
        }
    }
}

/// What the scanner's measures say to ours, or why they say nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SecondOpinion {
    /// The measurement file could not be read.
    #[error("the scanner's own measures (.ord) were not compared: {why}")]
    Unreadable {
        /// Why not.
        why: String,
    },
    /// More than one measurement file could be the scan's.
    #[error("{files} measurement files (.ord) bear this scan's name; none of them was compared")]
    Ambiguous {
        /// How many.
        files: usize,
    },
    /// Its stature is ours in another unit.
    #[error(
        "the scanner's stature is {theirs_mm:.0} mm, gaiter's {ours_mm:.0} mm, a factor of \
         {factor}: a wrong unit in one of the two files?"
    )]
    Unit {
        /// Theirs, mm by their unit.
        theirs_mm: f64,
        /// Ours, mm.
        ours_mm: f64,
        /// Ratio of the units.
        factor: f64,
    },
    /// A measure differs by more than two programs' definitions do.
    #[error("the scanner's {} is {theirs_mm:.0} mm, gaiter's {} {ours_mm:.0} mm", measure.word(), measure.own())]
    Disagrees {
        /// Which.
        measure: Measure,
        /// Theirs, mm.
        theirs_mm: f64,
        /// Ours, mm.
        ours_mm: f64,
    },
    /// Each calf fits the other leg.
    #[error(
        "the scanner's calves, {left_mm:.0} mm left and {right_mm:.0} mm right, fit the other leg \
         each: are left and right swapped?"
    )]
    Sides {
        /// Theirs, left, mm.
        left_mm: f64,
        /// Theirs, right, mm.
        right_mm: f64,
    },
}

impl SecondOpinion {
    /// The stable code used in records and the README's table.
    pub fn code(&self) -> &'static str {
        match self {
            SecondOpinion::Unreadable { .. } => "ord-unreadable",
            SecondOpinion::Ambiguous { .. } => "ord-ambiguous",
            SecondOpinion::Unit { .. } => "ord-unit",
            SecondOpinion::Disagrees { .. } => "ord-disagrees",
            SecondOpinion::Sides { .. } => "ord-sides",
        }
    }
}
