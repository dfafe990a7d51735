//! Scattered data, and the cells that they lie in.

/// Scattered data of a function of two variables; all slices have the same length.
#[derive(Debug, Clone, Copy)]
pub struct Scatter<'a> {
    /// Positions along, within the clamped basis.
    pub u: &'a [f64],
    /// Positions around, wrapped.
    pub v: &'a [f64],
    /// Values.
    pub value: &'a [f64],
}

/// The interval of ascending breakpoints that contains `x`, or the nearest one.
pub(super) fn place(breakpoints: &[f64], x: f64) -> usize {
    let last = breakpoints.len() - 2;
    breakpoints.partition_point(|breakpoint| *breakpoint <= x).saturating_sub(1).min(last)
}
