//! The station's decisions, played: simulation, adversary, everyday, ports.

mod adversary;
mod everyday;
mod simulation;
mod trigger_laws;
