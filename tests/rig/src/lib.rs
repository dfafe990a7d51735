//! What the tests of the real program share: stations with their booths, faults, and what must hold after
//! any of them.

pub mod booth;
pub mod day;
pub mod faults;
pub mod images;
pub mod invariants;
pub mod process;
pub mod pty;
pub mod refusal;
pub mod station;
pub mod stored;
pub mod verb;
pub mod web;
pub mod whole;
pub mod worklist;

pub use station::*;
