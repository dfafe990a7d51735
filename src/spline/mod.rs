//! Cubic B-splines: bases, solvers, fits, curves and surfaces. Knows no legs.

#![deny(clippy::disallowed_methods, clippy::disallowed_types)]
