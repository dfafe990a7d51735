//! Bases, fits, surfaces: closed forms, laws, published figures.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

mod basis;
mod fit;
mod grid_refusals;
mod knots;
mod measure;
mod schoenberg_whitney;
mod solve;
mod surface;
mod surface_fit;
mod tensor;
mod tessellate;
