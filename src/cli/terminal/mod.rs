//! Terminal output: colours, tables, progress, and a screen that is redrawn.

pub mod paint;
pub mod progress;
pub mod screen;
pub mod table;
