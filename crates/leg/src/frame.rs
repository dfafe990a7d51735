//! The body frame (paper 1.1): what belongs to the body, its unit, its stance, the direction of its
//! toes, and the floor.

pub mod body;
pub(super) mod body_fault;
mod bystanders;
mod calves;
pub(super) mod components;
mod crown;
pub mod floor;
mod floor_plane;
pub(super) mod layers;
pub(super) mod point_cloud;
pub mod soles;
pub mod stance;
pub(super) mod union_find;
pub(super) mod unit_inference;
pub(super) mod winding;
