//! Garments, size tables and what a table says about a leg. Knows no records and no files; today's date is an
//! argument.
//!
//! A verdict never chooses: every size is judged by itself, in the order of its table.

#![deny(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod check;
mod document;
mod fault;
pub mod garment;
mod parse;
mod point;
mod probability;
pub mod table;
pub mod verdict;

pub use fault::{Fault, What};
pub use garment::Garment;
pub use parse::{BYTES_MAX, parse};
pub use point::{Beyond, Point};
pub use probability::within;
pub use table::SizeTable;
