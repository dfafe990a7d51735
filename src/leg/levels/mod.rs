//! The height–girth curve and the levels on it (paper 1.2, fig. 3): B, B1, C, D by search, the others by
//! foot, crotch or a height that a person asked for.

pub mod at_height;
pub mod extremum;
pub mod foot;
pub mod girth;
pub mod landmark;
pub(super) mod level_reading;
pub(super) mod medial_length;
pub mod search;
pub(super) mod thigh;
