//! The rules of the house, the README, the languages, and the checker of the invariants itself.

mod circles;
mod invariants;
mod languages;
mod layering;
mod readme;
