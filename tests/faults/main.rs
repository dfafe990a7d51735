//! Faults in every place: killed, cut off, full, failing, flooded, ruined. Most run for minutes and are
//! ignored by default.

mod erase;
mod errno;
mod flood;
mod journal;
mod kill;
mod memory;
mod power;
mod prerequisites;
mod root;
mod share;
mod soak;
