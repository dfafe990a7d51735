//! The comparison of a patient's visits.

mod refusals;
mod stance;
mod swelling;
mod worked;
mod year;
