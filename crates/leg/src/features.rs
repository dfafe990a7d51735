//! Curvature around a section and its feature points (paper 1.3, fig. 4, 5).

pub(super) mod circular_extrema;
mod curvature;
pub mod feature;
pub(super) mod harmonic;
