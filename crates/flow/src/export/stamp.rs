//! The state of a file, as far as a look shows it.

use std::time::Duration;

use serde::{Deserialize, Serialize};

/// What distinguishes one state of a file from the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    pub dev: u64,
    pub ino: u64,
    /// Size, bytes.
    pub size: u64,
    /// Time of the last change of content, nanoseconds since 1970.
    pub mtime_ns: i128,
    /// Time of the last change of content or name, nanoseconds since 1970.
    pub ctime_ns: i128,
}

/// Whole seconds in both times are no coincidence: the file system keeps no finer times, and FAT only
/// even ones.
const COARSE: Duration = Duration::from_secs(2);

impl Stamp {
    /// Which file it is, whatever its name.
    pub(crate) fn inode(&self) -> (u64, u64) {
        (self.dev, self.ino)
    }

    /// Two changes within this time may leave the same stamp; zero if the file system keeps fine times.
    pub(crate) fn grain(&self) -> Duration {
        const SECOND_NS: i128 = 1_000_000_000;
        let is_whole = |ns: i128| ns % SECOND_NS == 0;
        let is_coarse = is_whole(self.mtime_ns) && is_whole(self.ctime_ns);
        if is_coarse { COARSE } else { Duration::ZERO }
    }

    /// Whether a file in this state has the same content as in an earlier one, as far as its size and time
    /// show it. A change of its name, mode or links changes neither.
    pub(crate) fn has_content_of(&self, earlier: &Stamp) -> bool {
        (self.dev, self.ino, self.size, self.mtime_ns)
            == (earlier.dev, earlier.ino, earlier.size, earlier.mtime_ns)
    }
}
