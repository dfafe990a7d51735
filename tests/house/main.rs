//! The rules of the house, the README, and the checker of the invariants itself.

mod circles;
mod invariants;
mod layering;
mod readme;
