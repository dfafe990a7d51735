//! Whether the expected share is mounted at an export folder. A share that is gone looks like an empty
//! folder, or like a healthy local one; no conclusion may be drawn from either.

use crate::cause::Cause;
use crate::export::file_system::FileSystem;

/// What one look found out about the file system of a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mount {
    /// The file system the folder is on.
    pub file_system: FileSystem,
    /// Whether it lacks the file that `scanner.marker` names.
    pub lacks_marker: bool,
}

/// Judges each look at one folder, and remembers whether it was ever on a share.
#[derive(Debug, Clone, Default)]
pub struct MountGuard {
    share: Option<FileSystem>,
}

impl MountGuard {
    /// Whether the folder may be trusted.
    ///
    /// # Errors
    /// The first reason against it, in words that follow "the export folder".
    pub fn check(&mut self, seen: Mount) -> Result<(), Cause> {
        let found = seen.file_system;
        if seen.lacks_marker {
            return Err(Cause::known("no-marker", []));
        }
        match self.share {
            Some(was) if !found.is_network() => {
                let names = [("was", was.to_string()), ("found", found.to_string())];
                Err(Cause::known("share-gone", names))
            }
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
    use crate::export::file_system::Medium;

    fn on(name: &'static str) -> Mount {
        let medium = match name {
            "ext4" => Medium::Disk,
            "tmpfs" => Medium::Memory,
            _ => Medium::Network,
        };
        Mount { file_system: FileSystem::Known(name, medium), lacks_marker: false }
    }

    #[test]
    fn a_folder_that_lacks_its_marker_is_not_trusted_and_any_other_is() {
        let mut guard = MountGuard::default();
        assert_eq!(guard.check(on("ext4")), Ok(()));
        let bare = Mount { lacks_marker: true, ..on("ext4") };
        assert_eq!(guard.check(bare), Err(Cause::known("no-marker", [])));
        assert_eq!(guard.check(on("NFS")), Ok(()));
    }

    #[test]
    fn a_share_that_turns_into_a_local_folder_is_gone_until_it_is_back() {
        let mut guard = MountGuard::default();
        assert_eq!(guard.check(on("FUSE")), Ok(()));
        for _ in 0..3 {
            let gone = guard.check(on("ext4"));
            assert!(gone.unwrap_err().to_string().contains("ext4"));
        }
        assert_eq!(guard.check(on("SMB")), Ok(()), "another kind of share will do");
        assert!(guard.check(on("tmpfs")).is_err());
    }
}
