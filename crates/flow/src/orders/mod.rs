//! Orders from practice software: which are new, and when they arrive.

pub mod habit;
pub mod news;
pub mod when;
