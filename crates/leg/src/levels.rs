//! The height–girth curve and its levels (paper 1.2, fig. 3): B, B1, C, D by search, the others by
//! the foot, the crotch or a requested height.

pub mod at_height;
pub mod extremum;
pub mod foot;
pub mod girth;
pub mod landmark;
pub(super) mod level_reading;
pub mod search;
pub(super) mod thigh;
pub(super) mod tilt;
