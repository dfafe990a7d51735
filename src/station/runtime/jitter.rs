//! The station's randomness: jitter and temporary names. Nothing secret depends on it.

use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};

/// Random bits; each `RandomState` differs from the previous one and from those of other runs.
pub fn bits() -> u64 {
    RandomState::new().build_hasher().finish()
}

/// Uniform in [0, 1).
pub fn unit() -> f64 {
    // 53 bits are what an f64 can hold between 0 and 1.
    (bits() >> 11) as f64 / (1_u64 << 53) as f64
}
