//! Size tables and orders against cases, against an evaluation of another kind, and against hostile files.

mod against_integration;
mod boundaries;
mod cases;
mod hostile;
mod orders;
mod page;
mod rules;
