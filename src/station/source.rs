//! Reading a settled file whole, and only if it is still the file that settled.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use jiff::Timestamp;
use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;

use super::look;
use crate::flow::{ScanId, Stamp};
use crate::store::sums;

/// The bytes of one state of an export.
#[derive(Debug)]
pub struct Export {
    /// The bytes.
    pub bytes: Vec<u8>,
    /// Their id.
    pub scan: ScanId,
    /// The file's own time of last change.
    pub file_time: Option<Timestamp>,
}

/// Reads the file if it is in the state `stamp` before and after; else none, for it changed, was
/// replaced or left, and settling starts again.
///
/// # Errors
/// Any other I/O error.
pub fn read(path: &Path, stamp: Stamp) -> io::Result<Option<Export>> {
    // A link or a pipe may have taken the file's place: neither follow nor wait.
    let flags = OFlags::RDONLY | OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let mut file = match rustix::fs::open(path, flags, Mode::empty()) {
        Ok(file) => File::from(file),
        Err(Errno::NOENT | Errno::LOOP | Errno::NXIO) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    if !in_state(&file, stamp)? {
        return Ok(None);
    }
    let mut bytes = Vec::with_capacity(usize::try_from(stamp.size).unwrap_or(0));
    // One byte more than expected shows a file that grew; a bound in any case.
    (&mut file).take(stamp.size.saturating_add(1)).read_to_end(&mut bytes)?;
    if u64::try_from(bytes.len()) != Ok(stamp.size) || !in_state(&file, stamp)? {
        return Ok(None);
    }
    let file_time = Timestamp::from_nanosecond(stamp.mtime_ns).ok();
    Ok(Some(Export { scan: sums::scan_id(&bytes), bytes, file_time }))
}

fn in_state(file: &File, stamp: Stamp) -> io::Result<bool> {
    let metadata = file.metadata()?;
    Ok(metadata.is_file() && look::stamp(&metadata) == stamp)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_file_is_read_only_in_the_state_that_settled() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.obj");
        fs::write(&path, "v 0 0 0\n").unwrap();
        let stamp = look::stamp(&path.symlink_metadata().unwrap());
        let export = read(&path, stamp).unwrap().unwrap();
        assert_eq!(export.bytes, b"v 0 0 0\n");
        assert_eq!(export.scan, sums::scan_id(b"v 0 0 0\n"));

        fs::write(&path, "v 0 0 0\nv").unwrap();
        assert!(read(&path, stamp).unwrap().is_none(), "it grew");
        fs::remove_file(&path).unwrap();
        assert!(read(&path, stamp).unwrap().is_none(), "it left");
    }

    #[test]
    fn a_link_or_a_pipe_in_the_file_s_place_is_not_read() {
        let dir = tempfile::tempdir().unwrap();
        let (path, real) = (dir.path().join("a.obj"), dir.path().join("real.obj"));
        fs::write(&real, "v 0 0 0\n").unwrap();
        let stamp = look::stamp(&real.symlink_metadata().unwrap());
        std::os::unix::fs::symlink(&real, &path).unwrap();
        assert!(read(&path, stamp).unwrap().is_none());
        fs::remove_file(&path).unwrap();
        rustix::fs::mkfifoat(rustix::fs::CWD, &path, Mode::RUSR | Mode::WUSR).unwrap();
        assert!(read(&path, stamp).unwrap().is_none());
    }
}
