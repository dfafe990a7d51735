//! All that a station holds of one person: put together to be disclosed, and erased.

pub(in crate::station) mod erase;
mod found;
pub mod stopped;

pub(in crate::station) use found::{person, visits};
