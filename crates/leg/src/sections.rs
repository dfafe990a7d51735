//! The axis of a leg and the closed curves across it (paper 1.1, fig. 2b–2e): [`skin`] fits them
//! all together, [`plane`] and the paper's [`polynomial`] one by one.

pub mod around;
pub mod axis;
pub mod axis_fit;
pub mod axis_length;
pub mod bend;
pub(super) mod centroid;
pub mod cloth;
mod edges;
pub mod equidistant;
pub(super) mod hull;
pub(super) mod low_harmonics;
pub mod placed;
pub mod plane;
pub mod plane_frame;
pub mod point_pairs;
pub mod polynomial;
mod sag;
pub mod section;
pub mod skin;
pub mod slice;
