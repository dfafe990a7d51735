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
pub fn of(folder: &Path) -> io::Result<FileSystem> {
    // The magic numbers have 32 bits; the field is wider, and signed, on most machines.
    Ok(FileSystem::of_magic(statfs(folder)?.f_type as u32))
}

/// Free space for the station on the disk of a folder, bytes.
pub fn free_bytes(folder: &Path) -> io::Result<u64> {
    let disk = rustix::fs::statvfs(folder)?;
    Ok(disk.f_bavail.saturating_mul(disk.f_frsize))
}

/// Which folder a path leads to: device and inode.
///
/// # Errors
/// If it leads nowhere.
pub fn folder_id(folder: &Path) -> io::Result<(u64, u64)> {
    let metadata = fs::metadata(folder)?;
    Ok((metadata.dev(), metadata.ino()))
}

/// What can be found out about where an export folder lies.
pub fn mount(folder: &Path, config: &WatchConfig) -> io::Result<Mount> {
    let marker = config.expected.marker.as_ref();
    let has_marker = marker.is_some_and(|name| folder.join(name).symlink_metadata().is_ok());
    let is_mounted = config.mount_point.as_ref().is_none_or(|place| is_mount_point(place));
    Ok(Mount { file_system: of(folder)?, has_marker, is_mounted })
}

/// Whether a folder is on another device than its parent; a missing folder is not mounted either.
fn is_mount_point(place: &Path) -> bool {
    let device = |place: &Path| folder_id(place).map(|(device, _)| device).ok();
    let above = place.parent().and_then(device);
    device(place).is_some_and(|device| above != Some(device))
}
