//! Volumes, the legs' differences, and what the scanner's own measures say to ours.

pub mod difference;
pub mod opinion;
pub mod second_opinion;
pub mod volume;
