//! Whether the group that may read records gets to them: `store.folder.mode` and `store.copy.mode`.

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use rustix::io::Errno;

use super::row::{Row, Verdict};
use crate::config::{Config, FolderStoreConfig};
use crate::store::access::Access;

/// The bit that hands a folder's group on to what is made in it.
const SET_GROUP_ID: u32 = 0o2000;

/// A row for each store whose records a group may read, if its folder exists.
pub(super) fn rows(config: &Config) -> Vec<Row> {
    let stores = [Some(&config.store.folder), config.store.copy.as_ref()];
    stores.into_iter().flatten().filter_map(readers).collect()
}

fn readers(store: &FolderStoreConfig) -> Option<Row> {
    if store.access == Access::Private {
        return None;
    }
    let found = fs::metadata(&store.path).ok()?;
    let (check, place) = ("readers", &*store.path);
    if has_default_acl(place) {
        return Some(Row::ok(check, place, "new records follow the folder's default ACL"));
    }
    let gid = found.gid();
    Some(match found.mode() & SET_GROUP_ID {
        0 => {
            let detail = format!(
                "mode is \"group\", but new records get the station's own group: chgrp GROUP {0} && \
                 chmod g+s {0}",
                place.display()
            );
            Row::new(check, place, Verdict::Warn, detail)
        }
        _ => Row::ok(check, place, format!("new records can be read by group {gid}")),
    })
}

/// Whether the folder gives what is made in it an access list of its own.
fn has_default_acl(folder: &Path) -> bool {
    let mut list = [0_u8; 0];
    matches!(
        rustix::fs::getxattr(folder, "system.posix_acl_default", &mut list),
        Ok(1..) | Err(Errno::RANGE)
    )
}
