//! Volumes, the legs' differences, and the comparison with the scanner's own measures.

pub mod difference;
pub mod opinion;
pub mod seams;
pub mod second_opinion;
mod shells;
pub mod smoothed;
pub mod tape_volume;
pub mod volume;
