//! Reads a settled file completely, and only if it is still the file that settled.

use std::fs::File;
use std::io;
use std::os::unix::fs::{FileExt, MetadataExt};
use std::path::Path;
use std::time::Duration;

use gaiter_flow::export::writing::END_BYTES;
use gaiter_flow::{Fingerprint, ScanId, Settled, Stamp};
use jiff::Timestamp;
use rustix::fs::Mode;

use crate::station::custody::spool::Companion;
use crate::station::share::stall::StepCounter;
use crate::station::share::stamped_file::{READ, bytes};
use crate::store::sums;

/// The bytes of one state of an export.
#[derive(Debug)]
pub struct Export {
    pub bytes: Vec<u8>,
    pub scan: ScanId,
    /// The file's own time of last change.
    pub file_time: Option<Timestamp>,
    /// The files that go with it.
    pub companions: Vec<Companion>,
    /// How many files beside it are left out because they are too large, too many or cannot be read.
    pub left_out: usize,
}

/// Reads a settled file and its companions if all are in the settled state before and after. Otherwise
/// returns `None`: something changed, was replaced or disappeared, and settling starts again.
///
/// # Errors
/// Any other I/O error at the scan itself.
pub fn read(settled: &Settled, counter: &StepCounter) -> io::Result<Option<Export>> {
    let Some(scan_bytes) = bytes(&settled.path, settled.group.stamp, counter)? else {
        return Ok(None);
    };
    let (mut companions, mut left_out) = (Vec::new(), settled.group.left_out);
    for companion in &settled.group.companions {
        let name_ending = companion.name_ending.clone();
        match bytes(&companion.path, companion.stamp, counter) {
            Ok(Some(bytes)) => companions.push(Companion { name_ending, bytes }),
            Ok(None) => return Ok(None),
            // A scan is not lost because of the files beside it.
            Err(_) => left_out += 1,
        }
    }
    let file_time = Timestamp::from_nanosecond(settled.group.stamp.mtime_ns).ok();
    let scan = sums::scan_id(&scan_bytes);
    Ok(Some(Export { scan, bytes: scan_bytes, file_time, companions, left_out }))
}

/// The ends of the part of a file that a look found in this state; `None` if it cannot be read or is
/// shorter by now. `now` returns the time.
pub fn mark(path: &Path, stamp: Stamp, now: impl Fn() -> Duration) -> Option<Fingerprint> {
    let began = now();
    let file = File::from(rustix::fs::open(path, READ, Mode::empty()).ok()?);
    let end = |offset: u64| {
        let length = stamp.size.min(END_BYTES as u64);
        let mut end = vec![0; usize::try_from(length).ok()?];
        file.read_exact_at(&mut end, offset).ok()?;
        Some(end)
    };
    let is_file = file.metadata().is_ok_and(|metadata| {
        (metadata.dev(), metadata.ino()) == (stamp.dev, stamp.ino) && metadata.is_file()
    });
    let (head, tail) = (end(0)?, end(stamp.size.saturating_sub(END_BYTES as u64))?);
    is_file.then(|| Fingerprint::new(began, now(), stamp.size, &head, &tail))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::station::share::stamped_file::{self, PIECE_BYTES};
    use gaiter_flow::{self as flow, Appeared, Writing};

    fn settled(path: &Path) -> Settled {
        let stamp = stamped_file::stamp(&path.symlink_metadata().unwrap());
        let writing = Writing::new(Appeared { absent: None, seen: Duration::ZERO });
        Settled {
            path: path.to_owned(),
            group: flow::Group::from(stamp),
            awaited: false,
            writing,
            has_late_companion: false,
        }
    }

    fn read(settled: &Settled) -> Option<Export> {
        super::read(settled, &StepCounter::default()).unwrap()
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
        fs::write(at("a.mtl"), "newmtl skin\n").unwrap();
        let mut settled = settled(&at("a.obj"));
        settled.group.companions = ["mtl", "ord"].map(|ending| beside(&at("a"), ending)).to_vec();
        settled.group.left_out = 3;
        let export = read(&settled).unwrap();
        let kept = |name_ending: &str, text: &str| Companion {
            name_ending: name_ending.into(),
            bytes: text.into(),
        };
        let both = vec![kept("mtl", "newmtl skin\n"), kept("ord", "MEASURE Calf=1\n")];
        assert_eq!((export.companions, export.left_out), (both, 3));
        fs::write(at("a.ord"), "MEASURE Calf=2\nMEASURE").unwrap();
        assert!(read(&settled).is_none());
    }

    fn beside(stem: &Path, ending: &str) -> flow::Companion {
        let path = stem.with_extension(ending);
        let stamp = stamped_file::stamp(&path.symlink_metadata().unwrap());
        flow::Companion { path, stamp, name_ending: ending.into() }
    }
}
