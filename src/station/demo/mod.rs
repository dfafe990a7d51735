//! The simulated scanner and button of `gaiter demo`.

pub mod button;
pub mod scanner;
