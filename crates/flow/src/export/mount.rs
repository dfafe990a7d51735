//! Whether the expected share is mounted at an export folder. A share that is gone looks like an empty
//! folder, or like a healthy local one; no conclusion may be drawn from either.

use crate::cause::Cause;
use crate::export::file_system::FileSystem;

/// What must be true of an export folder, according to the configuration.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Expected {
    /// It contains a file of this name.
    pub marker: Option<String>,
    /// It is on one of these; on any if the list is empty.
    pub file_systems: Vec<FileSystem>,
}

/// What one look found out about the file system of a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mount {
    /// The file system the folder is on.
    pub file_system: FileSystem,
    /// Whether it contains the marker file.
    pub has_marker: bool,
    /// Whether something is mounted at the configured mount point; true if none is configured.
    pub is_mounted: bool,
}

/// Why a folder counts as not mounted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NotMounted {
    /// Nothing is mounted at `scanner.mount_point`.
    NoMount,
    /// It is on another file system than `scanner.file_system` allows.
    FileSystem {
        /// The file system it is on.
        found: FileSystem,
    },
    /// The marker file is missing.
    NoMarker,
    /// It was on a share and is now on a local file system.
    ShareGone {
        /// The share's kind.
        was: FileSystem,
        /// The file system it is on now.
        found: FileSystem,
    },
}

impl From<&NotMounted> for Cause {
    /// In words that follow "the export folder".
    fn from(why: &NotMounted) -> Cause {
        match *why {
            NotMounted::NoMount => Cause::known("no-mount", []),
            NotMounted::FileSystem { found } => {
                Cause::known("other-file-system", [("found", found.to_string())])
            }
            NotMounted::NoMarker => Cause::known("no-marker", []),
            NotMounted::ShareGone { was, found } => {
                let names = [("was", was.to_string()), ("found", found.to_string())];
                Cause::known("share-gone", names)
            }
        }
    }
}

/// Judges each look at one folder, and remembers whether it was ever on a share.
#[derive(Debug, Clone)]
pub struct MountGuard {
    expected: Expected,
    share: Option<FileSystem>,
}

impl MountGuard {
    /// A guard that has seen nothing yet.
    pub fn new(expected: Expected) -> MountGuard {
        MountGuard { expected, share: None }
    }

    /// Whether the folder may be trusted.
    ///
    /// # Errors
    /// The first reason against it.
    pub fn judge(&mut self, seen: Mount) -> Result<(), NotMounted> {
        let found = seen.file_system;
        let allowed = &self.expected.file_systems;
        if !seen.is_mounted {
            return Err(NotMounted::NoMount);
        }
        if !allowed.is_empty() && !allowed.contains(&found) {
            return Err(NotMounted::FileSystem { found });
        }
        if self.expected.marker.is_some() && !seen.has_marker {
            return Err(NotMounted::NoMarker);
        }
        match self.share {
            Some(was) if !found.is_network() => Err(NotMounted::ShareGone { was, found }),
            _ => {
                self.share = found.is_network().then_some(found);
                Ok(())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(name: &str) -> Mount {
        let file_system = FileSystem::of_name(name).unwrap();
        Mount { file_system, has_marker: true, is_mounted: true }
    }

    fn guard(expected: Expected) -> MountGuard {
        MountGuard::new(expected)
    }

    #[test]
    fn without_expectations_any_folder_will_do() {
        let mut guard = guard(Expected::default());
        let bare = Mount { has_marker: false, ..on("ext4") };
        assert_eq!(guard.judge(bare), Ok(()));
        assert_eq!(guard.judge(on("NFS")), Ok(()));
    }

    #[test]
    fn each_expectation_speaks() {
        let marker = Expected { marker: Some("here".into()), ..Expected::default() };
        let without = Mount { has_marker: false, ..on("ext4") };
        assert_eq!(guard(marker.clone()).judge(without), Err(NotMounted::NoMarker));
        assert_eq!(guard(marker).judge(on("ext4")), Ok(()));

        let smb = FileSystem::of_name("SMB").unwrap();
        let shares = Expected { file_systems: vec![smb], ..Expected::default() };
        let found = FileSystem::of_name("ext4").unwrap();
        assert_eq!(guard(shares.clone()).judge(on("ext4")), Err(NotMounted::FileSystem { found }));
        assert_eq!(guard(shares).judge(on("SMB")), Ok(()));

        let unmounted = Mount { is_mounted: false, ..on("ext4") };
        assert_eq!(guard(Expected::default()).judge(unmounted), Err(NotMounted::NoMount));
    }

    #[test]
    fn a_share_that_turns_into_a_local_folder_is_gone_until_it_is_back() {
        let mut guard = guard(Expected::default());
        assert_eq!(guard.judge(on("FUSE")), Ok(()));
        for _ in 0..3 {
            let gone = guard.judge(on("ext4"));
            assert!(matches!(gone, Err(NotMounted::ShareGone { .. })), "{gone:?}");
        }
        assert_eq!(guard.judge(on("SMB")), Ok(()), "another kind of share will do");
        assert!(guard.judge(on("tmpfs")).is_err());
    }
}
