//! The folders above the files of a look. A file that is brought in with its folder keeps its own times,
//! and where another folder has taken the place of one, nothing is known to have been absent from it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::Settling;
use crate::export::stamp::Stamp;
use crate::export::writing::Appeared;

/// The folders that a look went through.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Folders {
    /// Which folder the path of the export folder led to: device and inode.
    pub export: (u64, u64),
    /// The folders in it, at any depth, in their states before they were listed.
    pub below: BTreeMap<PathBuf, Stamp>,
}

/// The folders above the files of the last look, and what has become of them since the look before.
#[derive(Debug, Default)]
pub(super) struct Above {
    /// `None` before the first look.
    folders: Option<Folders>,
    is_export_replaced: bool,
    /// Folders below the export folder that took the place of others.
    replaced: BTreeSet<PathBuf>,
}

impl Above {
    /// When a file appeared, if it did in the last look: where its folder took the place of another, it may
    /// have been in it for long.
    pub(super) fn appeared(&self, path: &Path, appeared: Appeared) -> Appeared {
        let is_replaced = |above: &Path| self.replaced.contains(above);
        let is_replaced = self.is_export_replaced || path.ancestors().skip(1).any(is_replaced);
        Appeared { absent: appeared.absent.filter(|_| !is_replaced), ..appeared }
    }

    /// How long after its content was last written a file got its name, its times or its place, by the clock
    /// of its own file system.
    pub(super) fn moved(&self, path: &Path, stamp: Stamp) -> Duration {
        let below = self.folders.as_ref().map(|folders| &folders.below);
        let above = path.ancestors().skip(1).map_while(|above| below?.get(above));
        // The folder that a file lies in is on its file system, whatever device the file itself names.
        let mut device = None;
        let above = above.take_while(|folder| *device.get_or_insert(folder.dev) == folder.dev);
        let came_ns = above.map(|folder| folder.ctime_ns).fold(stamp.ctime_ns, i128::max);
        let apart_ns = came_ns.saturating_sub(stamp.mtime_ns).max(0);
        Duration::from_nanos(u64::try_from(apart_ns).unwrap_or(u64::MAX))
    }
}

impl Settling {
    /// Takes in the folders of a look, before [`Settling::pass_over`] and [`Settling::observe`] take in its
    /// files.
    pub fn found_in(&mut self, folders: Folders) {
        let above = &mut self.above;
        (above.is_export_replaced, above.replaced) = match &above.folders {
            Some(before) => {
                // A folder that an exporter makes for each scan has the same device, and a renamed one shows
                // it by its change time.
                let is_other = |(path, folder): &(&PathBuf, &Stamp)| {
                    before.below.get(*path).is_some_and(|known| known.dev != folder.dev)
                };
                let replaced = folders.below.iter().filter(is_other);
                let replaced = replaced.map(|(path, _)| path.clone()).collect();
                (before.export != folders.export, replaced)
            }
            None => (false, BTreeSet::new()),
        };
        above.folders = Some(folders);
    }
}
