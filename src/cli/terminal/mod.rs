//! Terminal output: local time, colours, tables, progress, and text that fits it.

pub mod clock;
pub mod paint;
pub mod progress;
pub mod screen;
pub mod table;
