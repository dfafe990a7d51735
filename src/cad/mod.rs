//! Surface → CAD files, as bytes. Knows no legs and no patients: names come in as text.
//!
//! | file | what it holds |
//! |---|---|
//! | [`step`] | STEP AP214: the tube as one B-spline face |
//! | `step/exchange.rs` | the notation of STEP files (ISO 10303-21) |
//! | `step/outward.rs` | which side of the tube is its outside |
//!
//! Files are in millimetres, in the frame of the surface's control points. The same input gives
//! the same bytes.

#![deny(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod step;

pub use step::StepHeader;
