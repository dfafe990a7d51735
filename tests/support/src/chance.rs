//! Draws that are the same everywhere.

// Each user uses its own part.

/// A linear congruential generator (Knuth, MMIX): the same draws everywhere.
pub struct Chance(pub u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 11
    }

    /// Evenly from −reach to reach.
    pub fn even(&mut self, reach: f64) -> f64 {
        reach * (self.next() as f64 / (1u64 << 52) as f64 - 1.0)
    }

    /// Normal with standard deviation 1, as the sum of twelve even draws.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.even(0.5)).sum()
    }

    /// A number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// Evenly from 0 to below 1.
    pub fn unit(&mut self) -> f64 {
        self.next() as f64 / (1u64 << 53) as f64
    }

    /// One of them, if there are any.
    pub fn pick<'a, T>(&mut self, of: &'a [T]) -> Option<&'a T> {
        if of.is_empty() { None } else { of.get(self.below(of.len())) }
    }
}
