//! Reading a settled file whole, and only if it is still the file that settled.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use jiff::Timestamp;
use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;

use super::look;
use super::patience::Pulse;
use super::spool::Companion;
use crate::flow::{ScanId, Settled, Stamp};
use crate::scan::ord;
use crate::store::sums;

/// A larger companion is none and is left out, bytes.
const COMPANION_BYTES_MAX: u64 = ord::BYTES_MAX as u64;

/// How much is read at a time, bytes: a step that a slow share makes well within the deadline.
const PIECE_BYTES: u64 = 1 << 20;

/// The bytes of one state of an export.
#[derive(Debug)]
pub struct Export {
    /// The bytes.
    pub bytes: Vec<u8>,
    /// Their id.
    pub scan: ScanId,
    /// The file's own time of last change.
    pub file_time: Option<Timestamp>,
    /// What goes with it.
    pub companions: Vec<Companion>,
    /// How many companions are left out because they are too large or cannot be read.
    pub left_out: usize,
}

/// Reads a settled file and what goes with it, if all is in the state that settled before and
/// after; else none, for something changed, was replaced or left, and settling starts again.
///
/// # Errors
/// Any other I/O error at the scan itself.
pub fn read(settled: &Settled, pulse: &Pulse) -> io::Result<Option<Export>> {
    let Some(bytes) = bytes(&settled.path, settled.stamp, pulse)? else { return Ok(None) };
    let (mut companions, mut left_out) = (Vec::new(), 0);
    for companion in &settled.companions {
        let is_small = companion.stamp.size <= COMPANION_BYTES_MAX;
        let read = is_small.then(|| self::bytes(&companion.path, companion.stamp, pulse));
        let name_ending = companion.name_ending.clone();
        match read {
            Some(Ok(Some(bytes))) => companions.push(Companion { name_ending, bytes }),
            Some(Ok(None)) => return Ok(None),
            // A scan is not lost for what lies beside it.
            Some(Err(_)) | None => left_out += 1,
        }
    }
    let file_time = Timestamp::from_nanosecond(settled.stamp.mtime_ns).ok();
    let scan = sums::scan_id(&bytes);
    Ok(Some(Export { scan, bytes, file_time, companions, left_out }))
}

/// The bytes of a file, if it is in this state before and after; else none.
///
/// # Errors
/// Any other I/O error.
pub fn bytes(path: &Path, stamp: Stamp, pulse: &Pulse) -> io::Result<Option<Vec<u8>>> {
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
    let mut rest = (&mut file).take(stamp.size.saturating_add(1));
    while (&mut rest).take(PIECE_BYTES).read_to_end(&mut bytes)? > 0 {
        pulse.beat();
    }
    let is_whole = u64::try_from(bytes.len()) == Ok(stamp.size) && in_state(&file, stamp)?;
    Ok(is_whole.then_some(bytes))
}

fn in_state(file: &File, stamp: Stamp) -> io::Result<bool> {
    let metadata = file.metadata()?;
    Ok(metadata.is_file() && look::stamp(&metadata) == stamp)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::time::Duration;

    use super::*;
    use crate::flow;
    use crate::flow::capture::Appeared;

    fn settled(path: &Path) -> Settled {
        let stamp = look::stamp(&path.symlink_metadata().unwrap());
        let appeared = Appeared { absent: None, seen: Duration::ZERO };
        Settled { path: path.to_owned(), stamp, companions: Vec::new(), awaited: false, appeared }
    }

    fn read(settled: &Settled) -> Option<Export> {
        super::read(settled, &Pulse::default()).unwrap()
    }

    #[test]
    fn a_file_is_read_only_in_the_state_that_settled() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.obj");
        fs::write(&path, "v 0 0 0\n").unwrap();
        let settled = settled(&path);
        let export = read(&settled).unwrap();
        assert_eq!(export.bytes, b"v 0 0 0\n");
        assert_eq!(export.scan, sums::scan_id(b"v 0 0 0\n"));

        fs::write(&path, "v 0 0 0\nv").unwrap();
        assert!(read(&settled).is_none(), "it grew");
        fs::remove_file(&path).unwrap();
        assert!(read(&settled).is_none(), "it left");
    }

    #[test]
    fn a_file_of_many_pieces_is_read_whole() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.obj");
        let bytes: Vec<u8> = (0..5 * PIECE_BYTES / 2).map(|n| (n % 251) as u8).collect();
        fs::write(&path, &bytes).unwrap();
        assert!(read(&settled(&path)).unwrap().bytes == bytes);
    }

    #[test]
    fn a_link_or_a_pipe_in_the_file_s_place_is_not_read() {
        let dir = tempfile::tempdir().unwrap();
        let (path, real) = (dir.path().join("a.obj"), dir.path().join("real.obj"));
        fs::write(&real, "v 0 0 0\n").unwrap();
        let settled = Settled { path: path.clone(), ..settled(&real) };
        std::os::unix::fs::symlink(&real, &path).unwrap();
        assert!(read(&settled).is_none());
        fs::remove_file(&path).unwrap();
        rustix::fs::mkfifoat(rustix::fs::CWD, &path, Mode::RUSR | Mode::WUSR).unwrap();
        assert!(read(&settled).is_none());
    }

    #[test]
    fn what_goes_with_a_scan_is_read_with_it_in_the_state_that_settled() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| dir.path().join(name);
        fs::write(at("a.obj"), "v 0 0 0\n").unwrap();
        fs::write(at("a.ord"), "MEASURE Calf=1\n").unwrap();
        File::create(at("a.mtl")).unwrap().set_len(COMPANION_BYTES_MAX + 1).unwrap();
        let mut settled = settled(&at("a.obj"));
        settled.companions = ["mtl", "ord"].map(|ending| beside(&at("a"), ending)).to_vec();
        let export = read(&settled).unwrap();
        let ord = Companion { name_ending: "ord".into(), bytes: b"MEASURE Calf=1\n".to_vec() };
        assert_eq!((export.companions, export.left_out), (vec![ord], 1));
        fs::write(at("a.ord"), "MEASURE Calf=2\nMEASURE").unwrap();
        assert!(read(&settled).is_none());
    }

    fn beside(stem: &Path, ending: &str) -> flow::Companion {
        let path = stem.with_extension(ending);
        let stamp = look::stamp(&path.symlink_metadata().unwrap());
        flow::Companion { path, stamp, name_ending: ending.into() }
    }
}
