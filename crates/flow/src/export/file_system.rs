//! Kinds of file systems, by their number in statfs(2), and which of them are on another machine: those
//! do not report changes that other machines make there, and may stall or go away.

/// A kind of file system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileSystem {
    /// One of [`KINDS`].
    Known(&'static Kind),
    /// One that gaiter has no name for, by its number.
    Other(u32),
}

/// A kind that gaiter has a name for.
#[derive(Debug, PartialEq, Eq)]
pub struct Kind {
    /// Its name, as spelt in messages.
    pub name: &'static str,
    /// `f_type` of statfs(2); several if versions differ.
    magics: &'static [u32],
    place: Medium,
}

#[derive(Debug, PartialEq, Eq)]
enum Medium {
    Disk,
    Memory,
    Network,
}

const fn kind(name: &'static str, place: Medium, magics: &'static [u32]) -> Kind {
    Kind { name, magics, place }
}

/// Every kind that has a name. FUSE counts as a network because it mostly is one: sshfs, rclone. Local
/// ones (the older NTFS driver, `mergerfs`) only lose a watch that makes looks happen sooner.
pub static KINDS: [Kind; 17] = [
    kind("SMB", Medium::Network, &[0x0000_517B, 0xFF53_4D42, 0xFE53_4D42]),
    kind("NFS", Medium::Network, &[0x0000_6969]),
    kind("FUSE", Medium::Network, &[0x6573_5546]),
    kind("9P", Medium::Network, &[0x0102_1997]),
    kind("Ceph", Medium::Network, &[0x00C3_6400]),
    kind("AFS", Medium::Network, &[0x5346_414F]),
    kind("Coda", Medium::Network, &[0x7375_7245]),
    kind("ext4", Medium::Disk, &[0x0000_EF53]),
    kind("xfs", Medium::Disk, &[0x5846_5342]),
    kind("btrfs", Medium::Disk, &[0x9123_683E]),
    kind("overlay", Medium::Disk, &[0x794C_7630]),
    kind("FAT", Medium::Disk, &[0x0000_4D44]),
    kind("exFAT", Medium::Disk, &[0x2011_BAB0]),
    kind("NTFS", Medium::Disk, &[0x5346_544E, 0x7366_746E]),
    kind("ZFS", Medium::Disk, &[0x2FC1_2FC1]),
    kind("tmpfs", Medium::Memory, &[0x0102_1994]),
    kind("ramfs", Medium::Memory, &[0x8584_58F6]),
];

impl FileSystem {
    /// The kind of this `f_type`.
    pub fn of_magic(magic: u32) -> FileSystem {
        let known = KINDS.iter().find(|kind| kind.magics.contains(&magic));
        known.map_or(FileSystem::Other(magic), FileSystem::Known)
    }

    /// Whether other machines may change files there without a watch noticing it.
    pub fn is_network(self) -> bool {
        matches!(self, FileSystem::Known(Kind { place: Medium::Network, .. }))
    }

    /// Whether files there are lost when the power goes.
    pub fn is_memory(self) -> bool {
        matches!(self, FileSystem::Known(Kind { place: Medium::Memory, .. }))
    }
}

impl std::fmt::Display for FileSystem {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            FileSystem::Known(kind) => out.write_str(kind.name),
            FileSystem::Other(magic) => write!(out, "type {magic:#x}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_leads_to_one_kind() {
        for kind in &KINDS {
            for magic in kind.magics {
                assert_eq!(FileSystem::of_magic(*magic), FileSystem::Known(kind), "{magic:#x}");
            }
        }
    }

    #[test]
    fn shares_and_memory_are_told_from_disks() {
        let of =
            |name: &str| FileSystem::Known(KINDS.iter().find(|kind| kind.name == name).unwrap());
        assert!(of("SMB").is_network() && of("NFS").is_network() && of("FUSE").is_network());
        assert!(!of("ext4").is_network() && !of("tmpfs").is_network());
        assert!(of("tmpfs").is_memory() && !of("ext4").is_memory());
        assert!(!FileSystem::of_magic(1).is_network());
        assert_eq!(FileSystem::of_magic(0x1234).to_string(), "type 0x1234");
    }
}
