//! Files that may change while they are read: their stamps, and their bytes in one state.

use std::fs::{File, Metadata};
use std::io::{self, Read};
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use gaiter_flow::Stamp;
use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;

use super::stall::StepCounter;

/// How much is read at a time, bytes: a step that a slow share makes well within the deadline.
pub const PIECE_BYTES: u64 = 1 << 20;

/// A link or a pipe may have taken a file's place: neither follow nor wait.
pub const READ: OFlags =
    OFlags::RDONLY.union(OFlags::NOFOLLOW).union(OFlags::NONBLOCK).union(OFlags::CLOEXEC);

/// The bytes of a file if it is in this state before and after; otherwise `None`.
///
/// # Errors
/// Any other I/O error.
pub fn bytes(path: &Path, stamp: Stamp, counter: &StepCounter) -> io::Result<Option<Vec<u8>>> {
    let mut file = match rustix::fs::open(path, READ, Mode::empty()) {
        Ok(file) => File::from(file),
        Err(Errno::NOENT | Errno::LOOP | Errno::NXIO) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    if !in_state(&file, stamp)? {
        return Ok(None);
    }
    let mut bytes = Vec::with_capacity(usize::try_from(stamp.size).unwrap_or(0));
    // One byte more than expected reveals a file that grew; the read is bounded in any case.
    let mut rest = (&mut file).take(stamp.size.saturating_add(1));
    while (&mut rest).take(PIECE_BYTES).read_to_end(&mut bytes)? > 0 {
        counter.step();
    }
    let is_whole = u64::try_from(bytes.len()) == Ok(stamp.size) && in_state(&file, stamp)?;
    Ok(is_whole.then_some(bytes))
}

/// Whether an open file is in this state.
fn in_state(file: &File, stamp: Stamp) -> io::Result<bool> {
    let metadata = file.metadata()?;
    Ok(metadata.is_file() && self::stamp(&metadata) == stamp)
}

/// The stamp of a file.
pub fn stamp(metadata: &Metadata) -> Stamp {
    let ns = |seconds: i64, nanoseconds: i64| {
        i128::from(seconds) * 1_000_000_000 + i128::from(nanoseconds)
    };
    Stamp {
        dev: metadata.dev(),
        ino: metadata.ino(),
        size: metadata.size(),
        mtime_ns: ns(metadata.mtime(), metadata.mtime_nsec()),
        ctime_ns: ns(metadata.ctime(), metadata.ctime_nsec()),
    }
}
