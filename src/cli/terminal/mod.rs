//! Terminal output: local time, colours, tables, progress, and a screen that is redrawn.

pub mod clock;
pub mod paint;
pub mod progress;
pub mod screen;
pub mod table;
