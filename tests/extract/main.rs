//! `gaiter extract` as the real program, everything that it refuses, and the body of known girths.

mod cad_files;
mod chart;
mod damaged;
mod folder;
mod measures;
mod phantom;
mod refusals;
mod terminal;
mod unreadable;
