//! What every worker uses: beats, stops, the clock, caught panics, causes of errors.

pub mod beat;
pub mod caught;
pub mod causes;
pub mod clock;
pub mod jitter;
pub mod stop;
