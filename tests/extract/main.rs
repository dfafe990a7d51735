//! `gaiter extract` as the real program, and everything that it refuses.

mod chart;
mod damaged;
mod folder;
mod measures;
mod refusals;
mod unreadable;
