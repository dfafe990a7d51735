//! The rules of the house, the documents, the languages, and the checker of the invariants itself.

mod circles;
mod codes;
mod commands;
mod docs;
mod invariants;
mod languages;
mod lists;
mod rules;
