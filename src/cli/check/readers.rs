//! Whether the group that may read records gets to them: `store.folder.mode`.

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use rustix::io::Errno;

use super::row::{Row, Verdict};
use crate::config::Config;
use crate::store::Access;

/// The name of the check.
const CHECK: &str = "readers";

/// The bit that hands a folder's group on to what is made in it.
const SET_GROUP_ID: u32 = 0o2000;

/// If a group may read records: a row for each folder that hands its group on. At least one must; a folder
/// that does not, such as that of a backup, keeps its records to the station's own group.
pub(super) fn rows(config: &Config) -> Vec<Row> {
    let (folder, copy) = (&config.store.folder, config.store.copy.as_ref());
    if folder.access == Access::Private {
        return Vec::new();
    }
    let places = [Some(folder), copy].into_iter().flatten().map(|store| &*store.path);
    let rows: Vec<Row> = places.filter_map(handed_on).collect();
    match rows.is_empty() && folder.path.exists() {
        true => vec![nobody(&folder.path)],
        false => rows,
    }
}

/// The row of a folder whose records its group can read; `None` for any other folder.
fn handed_on(place: &Path) -> Option<Row> {
    let found = fs::metadata(place).ok()?;
    if has_default_acl(place) {
        return Some(Row::ok(CHECK, place, "new records follow the folder's default ACL"));
    }
    let is_handed_on = found.mode() & SET_GROUP_ID != 0;
    let detail = format!("new records can be read by group {}", found.gid());
    is_handed_on.then(|| Row::ok(CHECK, place, detail))
}

/// The row where no folder hands its group on.
fn nobody(place: &Path) -> Row {
    let detail = format!(
        "mode is \"group\", but new records get the station's own group: chgrp GROUP {0} && \
         chmod g+s {0}",
        place.display()
    );
    Row::at(CHECK, place.display(), Verdict::Warn, detail)
}

/// Whether the folder gives what is made in it an access list of its own.
fn has_default_acl(folder: &Path) -> bool {
    let mut list = [0_u8; 0];
    matches!(
        rustix::fs::getxattr(folder, "system.posix_acl_default", &mut list),
        Ok(1..) | Err(Errno::RANGE)
    )
}
