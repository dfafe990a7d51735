//! Asks the kernel what a folder lies on.

use std::fs;
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use gaiter_flow::FileSystem;
use gaiter_flow::export::mount::Mount;
use rustix::fs::statfs;

use crate::config::WatchConfig;

/// The file system that a folder is on.
///
/// # Errors
/// If the folder does not exist or cannot be examined.
pub fn detect(folder: &Path) -> io::Result<FileSystem> {
    // The magic numbers have 32 bits; the field is wider, and signed, on most machines.
    Ok(FileSystem::of_magic(statfs(folder)?.f_type as u32))
}

/// Free space for the station on the disk of a folder, bytes.
pub fn free_bytes(folder: &Path) -> io::Result<u64> {
    let disk = rustix::fs::statvfs(folder)?;
    Ok(disk.f_bavail.saturating_mul(disk.f_frsize))
}

/// Which folder, or file, a path leads to: device and inode.
///
/// # Errors
/// If it leads nowhere.
pub fn folder_id(folder: &Path) -> io::Result<(u64, u64)> {
    let metadata = fs::metadata(folder)?;
    Ok((metadata.dev(), metadata.ino()))
}

/// What can be found out about where an export folder lies.
pub fn mount(folder: &Path, config: &WatchConfig) -> io::Result<Mount> {
    let lacks = |name: &String| folder.join(name).symlink_metadata().is_err();
    Ok(Mount {
        file_system: detect(folder)?,
        lacks_marker: config.marker.as_ref().is_some_and(lacks),
    })
}
