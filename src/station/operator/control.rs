//! What the station answers to `gaiter status` and similar commands, and to decisions on the page.
//!
//! The commands ask over HTTP at the control socket, a Unix socket in the state folder for the station's
//! user and root.

mod answer;
mod persons;
pub mod protocol;
pub mod status;

pub use answer::answer;
