//! The comparison of a patient's visits.

#![allow(clippy::disallowed_methods, clippy::disallowed_types)]

mod left_out;
mod refusals;
mod sheet;
mod stance;
mod swelling;
mod words;
mod worked;
mod year;
