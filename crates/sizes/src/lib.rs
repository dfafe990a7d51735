//! Garments, size tables and what a table says about a leg; how an order is written for a maker. Knows no records and no files; today's date is an
//! argument.
//!
//! A verdict never chooses: every size is judged by itself, in the order of its table.

#![deny(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod check;
mod document;
mod fault;
pub mod garment;
pub mod mapping;
mod parse;
mod point;
mod probability;
pub mod table;
pub mod verdict;

pub use fault::{Fault, What};
pub use garment::Garment;
pub use mapping::Mapping;
pub use parse::{BYTES_MAX, parse};
pub use point::{Beyond, Point};
pub use probability::within;
pub use table::SizeTable;
