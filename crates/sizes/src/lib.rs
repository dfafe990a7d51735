//! [`SizeTable`], [`Garment`] and the measures of a leg → a [`verdict`].
//!
#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

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

pub use document::BYTES_MAX;
pub use fault::{DocumentFault, What};
pub use garment::Garment;
pub use mapping::Mapping;
pub use parse::parse;
pub use point::{Beyond, Point};
pub use probability::within;
pub use table::SizeTable;
