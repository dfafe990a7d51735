//! Size tables against cases, against an evaluation of another kind, and against hostile files.

mod against_integration;
mod boundaries;
mod cases;
mod hostile;
mod page;
mod placed;
mod rules;
