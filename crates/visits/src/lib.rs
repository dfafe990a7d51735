//! Records of one patient → [`Course`].
//!
#![doc = include_str!("../README.md")]
//!
//! | step | where |
//! |---|---|
//! | which scans are visits; a record as one: places, stance, scanner, definition | [`visit`], [`leg`], [`stance`] |
//! | the visits in order, and which can be compared | [`course`] |
//! | what is no visit though it was delivered | [`left_out`] |
//! | what changed between two of them | [`comparison`], [`excess`] |
//! | reasons for caution in comparing them | [`caution`] |
//!
//! The two parts of an uncertainty are in [`quantity`].

#![warn(missing_docs)]

pub mod caution;
pub mod comparison;
pub mod course;
pub mod excess;
pub mod left_out;
pub mod leg;
pub mod overlay;
pub mod place;
pub mod quantity;
mod registration;
pub mod report;
pub mod schema;
pub mod stance;
pub mod threshold;
pub mod visit;

pub use caution::Caution;
pub use comparison::{Comparison, LegChange, PlaceChange};
pub use course::{Affected, Choice, Course, CourseFault, Group};
pub use left_out::LeftOut;
pub use quantity::{Change, Quantity, Shown};
pub use visit::{GIRTH_COMMON_MM, Visit, last_of_days};
