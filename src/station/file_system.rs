//! Asking the kernel what a folder lies on.

use std::io;
use std::path::Path;

use rustix::fs::statfs;

use crate::flow::FileSystem;

/// The file system that a folder is on.
///
/// # Errors
/// Where the folder is not there or cannot be asked.
pub fn of(folder: &Path) -> io::Result<FileSystem> {
    // The magic numbers have 32 bits; the field is wider, and signed, on most machines.
    Ok(FileSystem::of_magic(statfs(folder)?.f_type as u32))
}

/// What is free for the station on the disk of a folder, bytes.
///
/// # Errors
/// As [`of`].
pub fn free_bytes(folder: &Path) -> io::Result<u64> {
    let disk = rustix::fs::statvfs(folder)?;
    Ok(disk.f_bavail.saturating_mul(disk.f_frsize))
}
