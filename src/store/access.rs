//! Who may read a store's records.

/// The permission bits of everybody but the owner.
pub const OTHERS: u32 = 0o077;

/// Who may read what is written. It holds scans of patients' bodies, so nobody else ever may.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Access {
    /// The owner only, whatever the umask.
    #[default]
    Private,
    /// Also the group of the folder it is made in, if that folder is set-group-id or has a default ACL.
    Group,
}

impl Access {
    /// The access to a folder with this mode.
    pub fn of_folder(mode: u32) -> Access {
        let group = Access::Group.folder_mode() & 0o070;
        if mode & group == group { Access::Group } else { Access::Private }
    }

    /// The permission bits of a file.
    pub fn file_mode(self) -> u32 {
        match self {
            Access::Private => 0o600,
            Access::Group => 0o640,
        }
    }

    /// The permission bits of a folder.
    pub fn folder_mode(self) -> u32 {
        match self {
            Access::Private => 0o700,
            Access::Group => 0o750,
        }
    }
}
