//! The state of a file, as far as a look tells it.

use serde::{Deserialize, Serialize};

/// What tells one state of a file from the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    /// Device.
    pub dev: u64,
    /// Inode.
    pub ino: u64,
    /// Size, bytes.
    pub size: u64,
    /// Time of the last change of content, nanoseconds since 1970.
    pub mtime_ns: i128,
    /// Time of the last change of content or name, nanoseconds since 1970.
    pub ctime_ns: i128,
}

impl Stamp {
    /// Whether a file in this state has the content that it had in an earlier one, as far as its size
    /// and time tell. A change of its name, mode or links changes neither.
    pub fn has_content_of(&self, earlier: &Stamp) -> bool {
        (self.dev, self.ino, self.size, self.mtime_ns)
            == (earlier.dev, earlier.ino, earlier.size, earlier.mtime_ns)
    }
}
