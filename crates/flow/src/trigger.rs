//! Input from a port → presses and ids, and the lifecycle of a port: found, lost and found again.
//!
//! ```text
//! bytes ── lines ───────────────┐
//! levels, reports, keys ── debounce ── button ──▶ PortEvent::Press
//! bytes ── lines ── code ──────────────────▶ PortEvent::Named, PortEvent::Unread
//! keys ── typed ── code ──────────────────▶ PortEvent::Named, PortEvent::Unread
//! ```
//!
//! `now` is the station's monotonic clock. No input from a port can make anything here grow: buffers are
//! bounded, and what they cannot hold is counted and dropped.

mod button;
pub mod code;
mod debounce;
pub mod input_decoder;
pub mod lines;
pub mod port_lifecycle;
pub mod report;
mod typed;

pub use input_decoder::{Input, InputDecoder};
pub use port_lifecycle::{PortFault, PortFaultKind, PortLifecycle, PortState};
pub use typed::KeyAction;
