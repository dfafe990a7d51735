//! Cuts the two legs from the body at the crotch (paper 1, fig. 2a): follows them slice by slice,
//! and splits thighs that touch.

mod cloud_skin;
pub(super) mod cluster;
pub mod crotch;
mod crotch_by_slices;
mod crotch_search;
pub mod filled;
mod fold_end;
mod footprint;
pub(super) mod leg_tracking;
mod saddle;
pub mod segment;
mod skin_border;
mod thigh_divider;
