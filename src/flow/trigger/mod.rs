//! What comes from a port → presses and ids, and how a port lives: found, lost and found again.
//!
//! ```text
//! bytes ── lines ── token ──┐
//! levels, reports, keys ── edge ── button ──▶ Heard::Press
//! bytes or keys ── code ──────────────────▶ Heard::Named
//! ```
//!
//! `now` is the station's monotonic clock. Nothing that comes from a port can make anything here
//! grow: buffers are bounded, and what they cannot hold is counted and dropped.

pub mod button;
pub mod code;
pub mod ear;
pub mod edge;
pub mod life;
pub mod lines;
pub mod report;
pub mod token;

pub use ear::{Ear, Input};
pub use life::{FaultKind, Life, PortFault, PortState};
