//! The station's decisions, played: simulation, adversary, everyday, ports.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

mod adversary;
mod everyday;
mod fleet;
mod simulation;
mod trigger_laws;
mod typed_laws;
mod worklist_laws;
