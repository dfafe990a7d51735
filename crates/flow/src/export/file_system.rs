//! Kinds of file systems, by their number in statfs(2), and which of them are on another machine: those
//! do not report changes that other machines make there, and may stall or go away.

/// A kind of file system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileSystem {
    /// One that has a name, as spelt in messages, and where it has its files.
    Known(&'static str, Medium),
    /// One that gaiter has no name for, by its number.
    Other(u32),
}

/// Where a file system has its files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Medium {
    Disk,
    Memory,
    Network,
}

/// Every kind that has a name, with its `f_type` of statfs(2); several if versions differ. FUSE counts as a network
/// because it mostly is one: sshfs, rclone. Local ones (the older NTFS driver, `mergerfs`) only lose a watch that
/// makes looks happen sooner.
static KINDS: [(&str, Medium, &[u32]); 17] = [
    ("SMB", Medium::Network, &[0x0000_517B, 0xFF53_4D42, 0xFE53_4D42]),
    ("NFS", Medium::Network, &[0x0000_6969]),
    ("FUSE", Medium::Network, &[0x6573_5546]),
    ("9P", Medium::Network, &[0x0102_1997]),
    ("Ceph", Medium::Network, &[0x00C3_6400]),
    ("AFS", Medium::Network, &[0x5346_414F]),
    ("Coda", Medium::Network, &[0x7375_7245]),
    ("ext4", Medium::Disk, &[0x0000_EF53]),
    ("xfs", Medium::Disk, &[0x5846_5342]),
    ("btrfs", Medium::Disk, &[0x9123_683E]),
    ("overlay", Medium::Disk, &[0x794C_7630]),
    ("FAT", Medium::Disk, &[0x0000_4D44]),
    ("exFAT", Medium::Disk, &[0x2011_BAB0]),
    ("NTFS", Medium::Disk, &[0x5346_544E, 0x7366_746E]),
    ("ZFS", Medium::Disk, &[0x2FC1_2FC1]),
    ("tmpfs", Medium::Memory, &[0x0102_1994]),
    ("ramfs", Medium::Memory, &[0x8584_58F6]),
];

impl FileSystem {
    /// The kind of this `f_type`.
    pub fn of_magic(magic: u32) -> FileSystem {
        let known = KINDS.iter().find(|(_, _, magics)| magics.contains(&magic));
        known.map_or(FileSystem::Other(magic), |(name, medium, _)| FileSystem::Known(name, *medium))
    }

    /// Whether other machines may change files there without a watch noticing it.
    pub fn is_network(self) -> bool {
        matches!(self, FileSystem::Known(_, Medium::Network))
    }

    /// Whether files there are lost when the power goes.
    pub fn is_memory(self) -> bool {
        matches!(self, FileSystem::Known(_, Medium::Memory))
    }
}

impl std::fmt::Display for FileSystem {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            FileSystem::Known(name, _) => out.write_str(name),
            FileSystem::Other(magic) => write!(out, "type {magic:#x}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_leads_to_one_kind() {
        for (name, medium, magics) in &KINDS {
            for magic in *magics {
                let known = FileSystem::Known(name, *medium);
                assert_eq!(FileSystem::of_magic(*magic), known, "{magic:#x}");
            }
        }
    }

    #[test]
    fn shares_and_memory_are_told_from_disks() {
        let of = |wanted: &str| {
            let (name, medium, _) = KINDS.iter().find(|(name, ..)| *name == wanted).unwrap();
            FileSystem::Known(name, *medium)
        };
        assert!(of("SMB").is_network() && of("NFS").is_network() && of("FUSE").is_network());
        assert!(!of("ext4").is_network() && !of("tmpfs").is_network());
        assert!(of("tmpfs").is_memory() && !of("ext4").is_memory());
        assert!(!FileSystem::of_magic(1).is_network());
        assert_eq!(FileSystem::of_magic(0x1234).to_string(), "type 0x1234");
    }
}
