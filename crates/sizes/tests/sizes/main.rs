//! Size tables against cases, against an evaluation of another kind, and against hostile files.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

mod against_integration;
mod boundaries;
mod cases;
mod hostile;
mod page;
mod placed;
mod rules;
