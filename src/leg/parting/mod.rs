//! The two legs cut from the body at the crotch (paper 1, fig. 2a): followed slice by slice, parted where
//! thighs touch.

pub(super) mod cluster;
pub mod crotch;
pub mod footprint;
pub mod leg_tracking;
pub mod segment;
pub mod thigh_divider;
