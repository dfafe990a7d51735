//! Whether there is room to take in another file: intake stops before the disk is full, and resumes once
//! there is clearly room again, so that it does not stop and resume at every scan.

/// Before intake resumes, this part of the floor must be free above it: a quarter.
const RESUME_ABOVE: u64 = 4;

/// The disk of the state folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Space {
    floor_bytes: u64,
    is_low: bool,
}

impl Space {
    /// A disk of which `floor_bytes` must stay free, assumed to have room.
    pub fn new(floor_bytes: u64) -> Space {
        Space { floor_bytes, is_low: false }
    }

    /// Whether a file of `size_bytes` may be taken in while `free_bytes` are free.
    pub fn admits(&mut self, free_bytes: u64, size_bytes: u64) -> bool {
        let above = if self.is_low { self.floor_bytes / RESUME_ABOVE } else { 0 };
        let stays = self.floor_bytes.saturating_add(above);
        self.is_low = free_bytes < stays.saturating_add(size_bytes);
        !self.is_low
    }

    /// What must stay free, bytes.
    pub fn floor_bytes(self) -> u64 {
        self.floor_bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intake_stops_before_the_floor_is_broken_and_resumes_well_above_it() {
        let mut space = Space::new(1000);
        assert!(space.admits(1100, 100));
        assert!(!space.admits(1099, 100), "the file itself would break the floor");
        assert!(!space.admits(1100, 100), "what was enough before is not enough to go on");
        assert!(!space.admits(1349, 100));
        assert!(space.admits(1350, 100));
        assert!(space.admits(1100, 100));
    }

    #[test]
    fn without_a_floor_a_file_must_still_fit() {
        let mut space = Space::new(0);
        assert!(space.admits(100, 100));
        assert!(!space.admits(99, 100));
        assert!(space.admits(100, 100));
    }

    #[test]
    fn absurd_sizes_do_not_overflow() {
        let mut space = Space::new(u64::MAX);
        assert!(!space.admits(u64::MAX - 1, u64::MAX));
        assert!(!space.admits(0, 0));
    }
}
