//! The text of a TOML file → values, or every [`Fault`] of it.
//!
#![doc = include_str!("../README.md")]

mod fault;
mod faults;
mod notation;
mod place;
mod reader;
mod section;
mod value;

pub use fault::{Fault, Hint, What, printable};
pub use faults::utf8;
pub use notation::Guess;
pub use reader::{Absent, Found, Key, Reader, Removed};
pub use section::{Section, Value, read};
pub use value::{nearest, number, or_none, word};
