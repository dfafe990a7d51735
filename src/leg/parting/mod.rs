//! Cuts the two legs from the body at the crotch (paper 1, fig. 2a): follows them slice by slice,
//! and splits thighs that touch.

pub(super) mod cluster;
pub mod crotch;
pub mod footprint;
pub mod leg_tracking;
pub mod segment;
pub mod thigh_divider;
