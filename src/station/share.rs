//! Folders on shares and disks: work there may hang, and others may change files during a read.

pub mod file_system;
pub(crate) mod stall;
pub(in crate::station) mod stamped_file;
