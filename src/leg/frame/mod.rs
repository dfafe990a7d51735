//! The body frame (paper 1.1): what is one body at all, its unit, how it stands, where its toes point,
//! where the floor is.

pub mod body;
pub mod body_fault;
pub(super) mod components;
pub mod floor;
pub(super) mod point_cloud;
pub mod stance;
pub(super) mod union_find;
pub(super) mod unit_inference;
