//! Bodies, legs and clouds whose measures are known.

pub mod bodies;
pub mod cloud;
pub mod mesh;
pub mod metric;
pub mod noise;
pub mod solids;
pub mod stance;
pub mod strip;
pub mod test_leg;
pub mod tubes;
pub mod wavefront;
