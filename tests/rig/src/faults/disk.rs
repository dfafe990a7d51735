//! Disks whose power can be cut: ext4 on a loop device, shut down without flushing its log.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::station::PATIENCE;

/// The size of a disk: room for the scans and records of one run.
const BYTES: u64 = 32 << 20;

/// `EXT4_IOC_SHUTDOWN` with `NOLOGFLUSH` on each folder: what was not synced is gone. In Python,
/// for this project writes no unsafe code.
const CUT: &str = "import fcntl, os, struct, sys
for path in sys.argv[1:]:
    fcntl.ioctl(os.open(path, os.O_RDONLY), 0x8004587d, struct.pack('I', 2))";

/// A mounted disk, unmounted when dropped.
#[derive(Debug)]
pub struct Disk {
    _images: TempDir,
    image: PathBuf,
    at: PathBuf,
}

impl Disk {
    /// A new disk, mounted on a folder.
    pub fn new(at: PathBuf) -> Disk {
        Disk::sized(at, BYTES)
    }

    /// A new disk of so many bytes, mounted on a folder.
    pub fn sized(at: PathBuf, bytes: u64) -> Disk {
        // In memory where there is such a place: the host's disk has no part in what is tested.
        let memory = Path::new("/dev/shm");
        let images = match memory.is_dir() {
            true => TempDir::new_in(memory).unwrap(),
            false => TempDir::new().unwrap(),
        };
        let image = images.path().join("disk");
        File::create(&image).unwrap().set_len(bytes).unwrap();
        must("mkfs.ext4", &["-q".as_ref(), "-F".as_ref(), image.as_path()]);
        let disk = Disk { _images: images, image, at };
        disk.mount();
        disk
    }

    /// Mounts it; the file system replays its log.
    pub fn mount(&self) {
        must("mount", &["-o".as_ref(), "loop".as_ref(), self.image.as_path(), self.at.as_path()]);
    }

    /// Unmounts it.
    pub fn unmount(&self) {
        let deadline = Instant::now() + PATIENCE;
        while Instant::now() < deadline {
            if Command::new("umount").arg(&self.at).output().unwrap().status.success() {
                return;
            }
            // What was killed may not have let go yet.
            sleep(Duration::from_millis(10));
        }
        panic!("{} cannot be unmounted", self.at.display());
    }

    /// Lets every write to it wait. To be made after the station, so that it ends before it.
    pub fn freeze(&self) -> Frozen {
        must("fsfreeze", &["--freeze".as_ref(), self.at.as_path()]);
        Frozen(self.at.clone())
    }

    /// Lets every call to it fail with EIO from now on, until it is unmounted; what was not synced is
    /// gone.
    pub fn fail(&self) {
        fail(std::slice::from_ref(self));
    }

    /// Makes all that is on it durable.
    pub fn sync(&self) {
        must("sync", &["-f".as_ref(), self.at.as_path()]);
    }
}

/// A disk that takes no writes until this is dropped: they wait.
#[derive(Debug)]
pub struct Frozen(PathBuf);

impl Drop for Frozen {
    fn drop(&mut self) {
        let _ = Command::new("fsfreeze").arg("--unfreeze").arg(&self.0).output();
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(&self.at).output();
    }
}

fn fail(disks: &[Disk]) {
    // Without its site modules Python starts in half the time.
    let cut = ["-I", "-S", "-c", CUT].map(Path::new);
    let folders = disks.iter().map(|disk| disk.at.as_path());
    must("python3", &cut.into_iter().chain(folders).collect::<Vec<_>>());
}

/// Cuts the power of all disks, and gives it back.
pub fn power_cut(disks: &[Disk]) {
    fail(disks);
    for disk in disks {
        disk.unmount();
        disk.mount();
    }
}

/// Whether disks can be made and cut off here; else says what is missing.
pub fn can_be_cut() -> bool {
    let place = TempDir::new().unwrap();
    let tried = std::panic::catch_unwind(|| {
        let disk = Disk::new(place.path().to_owned());
        power_cut(&[disk]);
    });
    if tried.is_err() {
        println!("disks need root, loop devices, ext4, mkfs.ext4, mount and python3");
    }
    tried.is_ok()
}

fn must(program: &str, arguments: &[&Path]) {
    let output = Command::new(program).args(arguments).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{program}: {said}");
}
