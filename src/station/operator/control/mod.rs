//! The control socket: how `gaiter status` and similar commands query a running station.
//!
//! A Unix socket in the state folder, for the station's user and root. Each connection carries one
//! request, a line of JSON, and one answer, a line of JSON.

mod answer;
mod persons;
pub mod protocol;
mod server;
pub mod status;

pub use answer::answer;
pub use server::worker;
